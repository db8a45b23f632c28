"""The univariate approach: the problem of degree sixteen as an eigenvalue problem.

References
----------
Raghavan and Roth, ASME J. Mechanical Design 115 (1993), pp. 502-508.
Manocha and Canny, IEEE Trans. Robotics and Automation 10(5), 1994, pp. 648-657.
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.3.
"""

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinematics.oracles.closure import ClosureEquations, posture_of
from robomech_ros.robots.chain import SerialChain

__all__ = ["solve_univariate"]

Array = NDArray[np.float64]

# From (cos, sin, 1) to the coefficients of x^2, x, 1, with x the half angle's tangent.
_HALF = np.array([[-1.0, 0.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 1.0]])
# x_3 = (a t + b) / (c t + d) keeps all roots away from infinity.
_MOEBIUS = (0.83, -0.41, 0.57, 0.92)
# Imaginary part of a root below which it is tried as real, and least distance of two postures.
_NEARLY_REAL = 1e-4
_APART = 1e-6


def solve_univariate(chain: SerialChain, T: Array) -> Array:
    """Find the postures of an arm of six revolute joints from 24 eigenvalues.

    With twelve equations in twelve monomials of x_4 and x_5, quadratic in x_3,
    ``(A x^2 + B x + C) v = 0`` has 24 eigenvalues: 8 of them are plus and minus i, the others
    belong to postures, real or complex.  Postures that share joint 3 may be lost, so that arms
    with a spherical wrist are none for this approach.

    Parameters
    ----------
    chain : SerialChain
    T : ndarray, shape (4, 4)
        Target pose of the tip in the base (m).

    Returns
    -------
    ndarray, shape (k, 6)
        Joint angles (rad), distinct, by increasing joint 3.
    """
    equations = ClosureEquations.of(chain, T)
    six = np.einsum("xi,yj,zk,eijk->xeyz", _HALF, _HALF, _HALF, equations.free)
    six = six.reshape(3, 6, 9)
    twelve = np.zeros((3, 12, 12))
    twelve[:, :6, 3:] = six
    twelve[:, 6:, :9] = six
    found: list[Array] = []
    for x3, vector in _eigenpairs(twelve):
        if abs(x3.imag) > _NEARLY_REAL * (1.0 + abs(x3) ** 2):
            continue
        x4, x5 = _half_tangents(vector)
        angles = [2.0 * float(np.arctan(x.real)) for x in (x3, x4, x5)]
        q = posture_of(equations, *angles)
        if q is not None and all(_distance(q, other) > _APART for other in found):
            found.append(q)
    found.sort(key=lambda q: float(q[2]))
    return np.array(found).reshape(-1, 6)


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
