"""The univariate approach: one polynomial of degree sixteen, all its roots and their postures.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.3 and 9.6.
Manocha and Canny, IEEE Trans. Robotics and Automation 10(5), 1994, pp. 648-657.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.equations.closure import ClosureEquations, Numbers, closure_equations
from robomech_ros.kinematics.equations.crowded_roots import angles_beside
from robomech_ros.kinematics.equations.half_angles import (
    angle_of_ratio,
    half_angle_polynomial,
    null_vectors,
    sampled_determinants,
    waves_of_samples,
)
from robomech_ros.kinematics.equations.li_woernle_hiller import li_woernle_hiller_matrix
from robomech_ros.kinematics.equations.postures import posture_of, same_posture
from robomech_ros.kinematics.equations.raghavan_roth import raghavan_roth_matrix
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, ComplexArray

_DEGREE = 16
# Least over greatest singular value below which a matrix is singular up to rounding.
_SINGULAR = 1e-10
# Roots this near to each other (rad) may be one, parted by rounding: of two, of four, of eight.
_CROWDS = (1e-6, 1e-3, 2e-2)
# Imaginary part (rad) of a root below which it may belong to a real posture.
_MAYBE_REAL = 2e-2
# Imaginary part (rad) from which on an angle is at infinity: its cosine has lost half the digits.
_INFINITE = 18.0
# Cosine over sine of half an angle that is rounding.
_HALF_TURN = 1e-14


@dataclass(frozen=True, eq=False)
class UnivariateRoots:
    """Result of a univariate procedure.

    Parameters
    ----------
    procedure : str
        One of ``PROCEDURES``.
    equations : ClosureEquations
        What it begins with.
    joint : int
        Number of the joint of the chain, from 1, whose angle the polynomial is in.
    matrix : ndarray, shape (3, n, n)
        Coefficients of x^2, x and 1 for x = tan(angle / 2): n is 12 or 8.
    polynomial : ndarray, shape (17,)
        Coefficients of x^16 .. 1, the greatest of them 1 or -1: the determinant without what is
        extraneous.  The first vanishes where a half turn is a root.
    angles : ndarray of complex, shape (16,)
        All roots (rad), from eigenvalues of the matrix, by increasing real part.
    condition : ndarray, shape (16,)
        Greatest singular value of the matrix there over the least but one: how well its null
        vector, and with it two more angles, is known.  Great where postures share the angle.
    q : ndarray of complex, shape (k, 6)
        The postures they lead to (rad), refined on the pose, each once, in the order of the roots;
        real ones have no imaginary part.
    complete : bool
        Whether every root that may be real has led to a real posture of its own.
    reason : str
        What is missing; empty where nothing is.
    """

    procedure: str
    equations: ClosureEquations
    joint: int
    matrix: Array
    polynomial: Array
    angles: ComplexArray
    condition: Array
    q: ComplexArray
    complete: bool
    reason: str

    @property
    def tangents(self) -> ComplexArray:
        """Roots of the polynomial, infinite at half turns; shape (16,)."""
        s, c = np.sin(0.5 * self.angles), np.cos(0.5 * self.angles)
        with np.errstate(divide="ignore", invalid="ignore"):
            found: ComplexArray = np.where(np.abs(c) > _HALF_TURN * np.abs(s), s / c, np.inf)
        return found

    @property
    def real(self) -> Array:
        """The real postures (rad), shape (m, 6)."""
        return self.q.real[np.all(self.q.imag == 0.0, axis=1)]


@dataclass(frozen=True)
class _Procedure:
    """Layout of equations in a matrix, its hidden joint of 3 to 5, and the values read off it."""

    matrix: Callable[[ClosureEquations], Array]
    place: int
    columns: int


PROCEDURES = {
    "raghavan-roth": _Procedure(raghavan_roth_matrix, 0, 3),
    "li-woernle-hiller": _Procedure(li_woernle_hiller_matrix, 2, 2),
}


def raghavan_roth(chain: SerialChain, T: ArrayLike, *, first: int | None = None) -> UnivariateRoots:
    """Find all roots of Raghavan and Roth's polynomial, and their postures.

    Parameters
    ----------
    chain : SerialChain
        Chain of six revolute joints.
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).
    first : int, optional
        The joint that the equations call 1, so that joint 3 is hidden for 1.  By default 1, or,
        where the matrix is singular for all angles as with a spherical wrist, the one with the most
        regular matrix.

    See Also
    --------
    robomech_ros.kinematics.inverse_kinematics : fast, and complete for all arms.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.3.1 and 9.6.1.

    Examples
    --------
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.kinematics.equations import raghavan_roth
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("diestro")
    >>> found = raghavan_roth(arm, forward_kinematics(arm, [0.3, 1.2, -1.4, 1.1, -2.0, 0.7]))
    >>> found.polynomial.shape, found.q.shape, found.real.shape
    ((17,), (16, 6), (4, 6))
    """
    return univariate_roots("raghavan-roth", chain, T, first)


def li_woernle_hiller(
    chain: SerialChain, T: ArrayLike, *, first: int | None = None
) -> UnivariateRoots:
    """Find all roots of Li, Woernle and Hiller's polynomial, and their postures.

    Parameters
    ----------
    chain, T
        As for `raghavan_roth`.
    first : int, optional
        The joint that the equations call 1, so that joint 5 is hidden for 1.  The default is chosen
        as there.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.3.2 and 9.6.2.
    """
    return univariate_roots("li-woernle-hiller", chain, T, first)


def univariate_roots(
    name: str, chain: SerialChain, T: ArrayLike, first: int | None = None
) -> UnivariateRoots:
    """Follow one of ``PROCEDURES`` by name; see `raghavan_roth`."""
    procedure = PROCEDURES[name]
    equations, matrix, front = _most_regular(procedure, chain, T, first)
    joint = int(equations.joints[2 + procedure.place]) + 1
    polynomial = half_angle_polynomial(
        waves_of_samples(sampled_determinants(matrix, _DEGREE + 1)[1])
    )
    polynomial = polynomial / (np.abs(polynomial).max() or 1.0)
    given = (name, equations, joint, matrix, polynomial)
    if front is None:
        nothing = np.empty(0)
        reason = "the determinant vanishes for all angles"
        return UnivariateRoots(
            *given, nothing.astype(complex), nothing, np.empty((0, 6), complex), False, reason
        )
    angles, vectors = null_vectors(matrix, front)
    kept = np.argsort(np.abs(angles.imag), kind="stable")[:_DEGREE]
    kept = kept[np.argsort(angles.real[kept], kind="stable")]
    angles, vectors = angles[kept], vectors[kept]
    found: list[Numbers] = []
    for angle, vector in zip(angles, vectors, strict=True):
        three = _three_angles(vector, procedure, angle)
        _add(equations, found, three)
    _add_crowded(equations, found, procedure.place, angles)
    condition = np.array([_condition(matrix, angle) for angle in angles])
    q = np.array(found, complex).reshape(-1, 6)
    missing = int(np.sum(np.abs(angles.imag) < _MAYBE_REAL))
    real = int(np.sum(np.all(q.imag == 0.0, axis=1)))
    reason = ""
    if len(q) != _DEGREE and missing != real:
        reason = f"{counted(missing, 'root')} that may be real led to {counted(real, 'posture')}"
    return UnivariateRoots(*given, angles, condition, q, not reason, reason)


def _most_regular(
    procedure: _Procedure, chain: SerialChain, T: ArrayLike, first: int | None
) -> tuple[ClosureEquations, Array, float | None]:
    """Choose where the loop is cut; give the matrix and an angle at which it is regular."""
    best, choice = -1.0, None
    for number in range(1, 7) if first is None else (first,):
        equations = closure_equations(chain, T, first=number)
        matrix = procedure.matrix(equations)
        angles = sampled_determinants(matrix, _DEGREE + 1)[0]
        conditions = np.array([_condition(matrix, angle, 1) for angle in angles])
        k = int(np.argmin(conditions))
        # If joints 1 and 2 are indistinguishable, roots mean nothing.
        regular = 1.0 / max(conditions[k], float(np.linalg.cond(equations.right[:, :8])))
        if regular > best:
            best, choice = regular, (equations, matrix, float(angles[k]))
        if number == 1 and best > _SINGULAR:
            break
    assert choice is not None
    return choice if best > _SINGULAR else (*choice[:2], None)


def _condition(matrix: Array, angle: complex, last: int = 2) -> float:
    """Return the greatest singular value over the last one, or the last but one."""
    s, c = np.sin(0.5 * angle), np.cos(0.5 * angle)
    sizes = np.linalg.svd(
        s * s * matrix[0] + s * c * matrix[1] + c * c * matrix[2], compute_uv=False
    )
    return float(sizes[0] / max(sizes[-last], np.finfo(float).tiny * max(sizes[0], 1.0)))


def _three_angles(vector: ComplexArray, procedure: _Procedure, angle: complex) -> ComplexArray:
    """Read joints 3, 4 and 5 off a null vector: x_4^3 .. 1 times x_5^2, x_5, 1 or x_3, 1."""
    table = vector.reshape(4, procedure.columns)
    q4 = angle_of_ratio(table[:3], table[1:])
    other = angle_of_ratio(table[:, :-1], table[:, 1:])
    return np.array([angle, q4, other] if procedure.place == 0 else [other, q4, angle])


def _add(equations: ClosureEquations, found: list[Numbers], three: ComplexArray) -> None:
    """Refine a posture and note it unless it is there; one that may be real, as real first."""
    if not (np.abs(three.imag) < _INFINITE).all():
        return
    q = None
    if np.abs(three.imag).max() < _MAYBE_REAL:
        q = posture_of(equations, *three.real.tolist())
    if q is None:
        q = posture_of(equations, *three.tolist())
    if q is not None and np.any(q.imag) and same_posture(equations, q, q.conj()):
        q = q.real
    if q is not None and not any(same_posture(equations, q, other) for other in found):
        found.append(q)


def _add_crowded(
    equations: ClosureEquations, found: list[Numbers], place: int, angles: ComplexArray
) -> None:
    """Look for postures that share an angle, where fewer were found than there are roots."""
    z = np.exp(1j * angles)
    joint = equations.joints[2 + place]
    for middle, many, apart in _crowds(z):
        known = np.array([np.exp(1j * q[joint]) for q in found])
        if np.sum(np.abs(known / middle - 1.0) < apart) >= many:
            continue
        for three in angles_beside(equations, place, complex(-1j * np.log(middle))):
            _add(equations, found, three)


def _crowds(z: ComplexArray) -> Iterator[tuple[complex, int, float]]:
    """Yield the middle of numbers close to each other, how many they are, and how close.

    Close ones come first: among others their middle would be lost.
    """
    for apart in _CROWDS:
        left = np.ones(len(z), dtype=bool)
        for one in z:
            near = left & (np.abs(z / one - 1.0) < apart)
            left &= ~near
            if near.sum() > 1:
                yield complex(z[near].mean()), int(near.sum()), apart
