"""The univariate approach: the problem of degree sixteen as an eigenvalue problem.

References
----------
Raghavan and Roth, ASME J. Mechanical Design 115 (1993), pp. 502-508.
Manocha and Canny, IEEE Trans. Robotics and Automation 10(5), 1994, pp. 648-657.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from robomech_ros.kinematics.inverse.target import as_targets
from robomech_ros.kinematics.oracles.closure import ClosureEquations, posture_of
from robomech_ros.robots.chain import SerialChain

__all__ = ["UnivariateSolutions", "solve_univariate"]

Array = NDArray[np.float64]

# From (cos, sin, 1) to the coefficients of x^2, x, 1, with x the half angle's tangent.
_HALF = np.array([[-1.0, 0.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 1.0]])
# x_3 = (a t + b) / (c t + d) keeps all roots away from infinity.
_MOEBIUS = (0.83, -0.41, 0.57, 0.92)
# Imaginary part of a root below which it is tried as real, and least distance of two postures.
_NEARLY_REAL = 1e-4
_APART = 1e-6
# Imaginary part of a root below which it may belong to a real posture, as one of several equal
# roots that rounding has parted, and how far from plus or minus i extraneous roots may be.
_MAYBE_REAL = 1e-2
_NOT_EXTRANEOUS = 1e-4
_ROOTS, _EXTRANEOUS = 24, 8


@dataclass(frozen=True, eq=False)
class UnivariateSolutions:
    """Postures from eigenvalues; a sequence of them, and an array (k, 6) for numpy.

    Parameters
    ----------
    q : ndarray, shape (k, 6)
        Joint angles (rad), distinct, by increasing joint 3.
    complete : bool
        Whether every root that may be real has led to a posture of its own.  It is False wherever
        postures share joint 3, as those of arms with parallel axes or a spherical wrist do, since
        their eigenvectors are mixed.
    reason : str
        What is missing; empty where nothing is.
    """

    q: Array
    complete: bool
    reason: str

    def __len__(self) -> int:
        return len(self.q)

    def __iter__(self) -> Iterator[Array]:
        return iter(self.q)

    def __getitem__(self, k: int) -> Array:
        row: Array = self.q[k]
        return row

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> Array:
        array: Array = np.array(self.q, dtype=dtype)
        return array


def solve_univariate(chain: SerialChain, T: ArrayLike) -> UnivariateSolutions:
    """Find the postures of an arm of six revolute joints from 24 eigenvalues.

    With twelve equations in twelve monomials of x_4 and x_5, quadratic in x_3,
    ``(A x^2 + B x + C) v = 0`` has 24 eigenvalues: 8 of them are plus and minus i, the others
    belong to postures, real or complex.  Postures that share joint 3 may be lost, as of
    arms with parallel axes or a spherical wrist; then the result is not ``complete``.

    Parameters
    ----------
    chain : SerialChain
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).

    Returns
    -------
    UnivariateSolutions

    Raises
    ------
    BadValueError
        No arm of six revolute joints, or no pose.
    WrongSizeError, NonFiniteError
        No pose.
    """
    equations = ClosureEquations.of(chain, as_targets(T)[0])
    six = np.einsum("xi,yj,zk,eijk->xeyz", _HALF, _HALF, _HALF, equations.free)
    six = six.reshape(3, 6, 9)
    twelve = np.zeros((3, 12, 12))
    twelve[:, :6, 3:] = six
    twelve[:, 6:, :9] = six
    found: list[Array] = []
    maybe_real = extraneous = 0
    for x3, vector in _eigenpairs(twelve):
        scale = 1.0 + abs(x3) ** 2
        extraneous += min(abs(x3 - 1j), abs(x3 + 1j)) < _NOT_EXTRANEOUS
        maybe_real += abs(x3.imag) <= _MAYBE_REAL * scale
        if abs(x3.imag) > _NEARLY_REAL * scale:
            continue
        x4, x5 = _half_tangents(vector)
        angles = [2.0 * float(np.arctan(x.real)) for x in (x3, x4, x5)]
        q = posture_of(equations, *angles)
        if q is not None and all(_distance(q, other) > _APART for other in found):
            found.append(q)
    found.sort(key=lambda q: float(q[2]))
    reason = ""
    if extraneous != _EXTRANEOUS:
        reason = f"{extraneous} of {_ROOTS} roots are plus or minus i, not {_EXTRANEOUS}"
    elif maybe_real != len(found):
        reason = f"{maybe_real} roots that may be real led to {len(found)} postures"
    return UnivariateSolutions(np.array(found).reshape(-1, 6), not reason, reason)


def _eigenpairs(coefficients: Array) -> list[tuple[complex, NDArray[np.complex128]]]:
    """Solve ``(A x^2 + B x + C) v = 0`` by linearisation, after a change of variable."""
    A, B, C = coefficients
    a, b, c, d = _MOEBIUS
    leading = a * a * A + a * c * B + c * c * C
    middle = 2.0 * a * b * A + (a * d + b * c) * B + 2.0 * c * d * C
    last = b * b * A + b * d * B + d * d * C
    companion = np.zeros((24, 24))
    companion[:12, 12:] = np.eye(12)
    companion[12:] = -np.linalg.solve(leading, np.hstack((last, middle)))
    values, vectors = np.linalg.eig(companion)
    pairs = []
    for t, column in zip(values, vectors.T, strict=True):
        upper, lower = column[:12], column[12:]
        vector = upper if np.linalg.norm(upper) >= np.linalg.norm(lower) else lower
        pairs.append(((a * t + b) / (c * t + d), vector))
    return pairs


def _half_tangents(vector: NDArray[np.complex128]) -> tuple[complex, complex]:
    """Read x_4 and x_5 off the monomials x_4^3 .. 1 times x_5^2, x_5, 1."""
    table = vector.reshape(4, 3)
    high, low = table[:3].ravel(), table[1:].ravel()
    k = int(np.argmax(np.abs(high) + np.abs(low)))
    x4 = high[k] / low[k] if abs(low[k]) > 1e-12 * abs(high[k]) else 1e12
    high, low = table[:, :2].ravel(), table[:, 1:].ravel()
    k = int(np.argmax(np.abs(high) + np.abs(low)))
    x5 = high[k] / low[k] if abs(low[k]) > 1e-12 * abs(high[k]) else 1e12
    return complex(x4), complex(x5)


def _distance(q: Array, p: Array) -> float:
    return float(np.abs((q - p + np.pi) % (2.0 * np.pi) - np.pi).max())
