"""Closure equations of a platform in angles: their polynomial, all its roots, and their contours.

Every equation is linear in cosine and sine of each of its angles, so a table (3, 3) holds it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.equations.closure import as_angles, circle
from robomech_ros.kinematics.equations.half_angles import (
    angles_of_line,
    angles_of_roots,
    half_angle_polynomial,
    waves_of_samples,
)
from robomech_ros.numerics import CurvePair
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.parallel.equations.elimination import (
    Numbers,
    crossing_angles,
    line_resultant,
    refined_angles,
    sylvester,
)
from robomech_ros.spatial.rows import common_shape
from robomech_ros.typing import Array, ArrayLike, ComplexArray

# Relative size below which the polynomial vanishes, because the platform can move.
_VANISHING = 1e-13
# Imaginary part (rad) below which a root may be real.
_MAYBE_REAL = 1e-3
# Distance below which solutions are one (rad); largest distance of a solution from its estimate.
_SAME, _OWN = 1e-6, 1e-2
# Products of some cosines of such angles (rad) do not overflow.
_MOST_IMAGINARY = 100.0


@dataclass(frozen=True, eq=False)
class PlatformRoots:
    """All roots of the polynomial of a platform, and the poses they lead to.

    Parameters
    ----------
    polynomial : ndarray, shape (2 m + 1,)
        Coefficients of x^2m .. 1 for x the tangent of half the first angle, the greatest 1 or -1.
        The first vanishes if a half turn is a root.
    roots : ndarray of complex, shape (2 m,)
        The first angle (rad) at each root.
    angles : ndarray of complex, shape (k, n)
        All angles (rad) of the distinct solutions, refined on the equations.
    poses : ndarray of complex, shape (k, 4, 4)
        ``T_base_platform`` (m) of each solution.
    complete : bool
        Whether every root has led to a solution of its own, or every root that may be real to a
        real one.
    reason : str
        What is missing; empty if nothing is.
    """

    polynomial: Array
    roots: ComplexArray
    angles: ComplexArray
    poses: ComplexArray
    complete: bool
    reason: str

    @property
    def tangents(self) -> ComplexArray:
        """Roots of the polynomial, infinite at half turns; shape (2 m,)."""
        s, c = np.sin(0.5 * self.roots), np.cos(0.5 * self.roots)
        with np.errstate(divide="ignore", invalid="ignore"):
            found: ComplexArray = np.where(np.abs(c) > 1e-14 * np.abs(s), s / c, np.inf)
        return found

    @property
    def real(self) -> Array:
        """The real poses (m), shape (r, 4, 4)."""
        return self.poses.real[_are_real(self.angles)]


@dataclass(frozen=True, eq=False)
class PlatformEquations:
    r"""Closure equations of a platform, :math:`u(\phi_i)^T E\, u(\phi_j) = 0`, u = (cos, sin, 1).

    Parameters
    ----------
    family : str
        Kind of the robot.
    names : tuple of str
        The n angles: two, or three of which each equation contains two.
    tables : ndarray, shape (m, 3, 3)
        E of each equation; lengths are divided by the size of the robot.
    pairs : tuple of tuple of int
        i and j of each equation.
    degree : int
        Degree of the polynomial in the tangent of half the first angle.
    placed : callable
        From angles (n,) in rad, real or complex, to the pose (4, 4) in m.
    """

    family: str
    names: tuple[str, ...]
    tables: Array
    pairs: tuple[tuple[int, int], ...]
    degree: int
    placed: Callable[[Numbers], Numbers]

    def residual(self, angles: ArrayLike) -> Numbers:
        """Return the left sides at angles (n,) in rad, real or complex; shape (m,)."""
        return self._left_sides(self._checked(angles))

    def _left_sides(self, angles: Numbers) -> Numbers:
        u = circle(angles)
        return np.array(
            [
                u[:, i] @ table @ u[:, j]
                for table, (i, j) in zip(self.tables, self.pairs, strict=True)
            ]
        )

    def pose(self, angles: ArrayLike) -> Numbers:
        """Return the pose (4, 4) in m at angles (n,) that solve the equations (rad)."""
        return self.placed(self._checked(angles))

    def curves(self, first: ArrayLike, second: ArrayLike) -> Array:
        """Return two equations in the first and the second angle (rad), shapes (...).

        With three angles the second one is the resultant of the equations that contain the third.
        `numerics.bivariate`, `CurvePair` and `rvs.view_equations` accept this method.

        Returns
        -------
        ndarray, shape (2, ...)
        """
        first, second = _moderate("first", first), _moderate("second", second)
        common_shape("first and second", first.shape, second.shape)
        one = self._bilinear(0, first, second)
        if len(self.names) == 2:
            return np.stack((one, self._bilinear(1, first, second)))
        return np.stack((one, self._lines(first, second)))

    def contours(self) -> CurvePair:
        """Return the contours of :meth:`curves` over a turn of both angles.

        Its methods ``refine`` and ``all`` return the crossings, which are solutions.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.4 and 10.2.
        """
        return CurvePair(self.curves, period=2.0 * np.pi)

    def solutions_at(self, first: complex, second: complex) -> ComplexArray:
        """Return all angles (k, n) of solutions near estimates of the first two (rad)."""
        return self._refined(_angle("first", first), _angle("second", second))

    def _refined(self, first: complex, second: complex) -> ComplexArray:
        starts = [np.array([first, second], complex)]
        if len(self.names) == 3:
            thirds = crossing_angles(
                circle(first) @ self.tables[1], circle(second) @ self.tables[2]
            )
            starts = [np.array([first, second, third], complex) for third in thirds]
        found = [refined_angles(self._left_sides, start) for start in starts]
        kept = [
            end
            for start, end in zip(starts, found, strict=True)
            if end is not None and _apart(end[:2], start[:2]) < _OWN
        ]
        return np.array(kept, complex).reshape(-1, len(self.names))

    def resultant(self, first: float) -> float:
        """Return the eliminant at the first angle (rad), a polynomial in its cosine and sine.

        With three angles it is the determinant of :meth:`dialytic_matrix`.
        """
        first = finite_number("first", first, "rad")
        if len(self.names) == 2:
            u = circle(first)
            return float(line_resultant(u @ self.tables[0], u @ self.tables[1]))
        return float(np.linalg.det(self.dialytic_matrix(first)))

    def dialytic_matrix(self, first: float) -> Array:
        """Return the matrix (6, 6) whose determinant eliminates the second of three angles.

        References
        ----------
        Nanua, Waldron and Murthy, IEEE Trans. Robotics and Automation 6 (1990), pp. 438-444.
        """
        if len(self.names) == 2:
            raise BadValueError("number of angles", 2, "3: two need no dialytic matrix")
        return sylvester(self.tables[0], self._lines, finite_number("first", first, "rad"))

    def roots(self) -> PlatformRoots:
        """Find all roots of the polynomial, real and complex, and the poses they lead to."""
        samples = 2.0 * np.pi * np.arange(self.degree + 1) / (self.degree + 1)
        waves = waves_of_samples(np.array([self.resultant(angle) for angle in samples]))
        polynomial = half_angle_polynomial(waves)
        greatest = np.abs(polynomial).max()
        n = len(self.names)
        if not greatest > _VANISHING * self._size(samples):
            nothing = np.empty(0, complex), np.empty((0, n), complex), np.empty((0, 4, 4), complex)
            reason = (
                "the polynomial vanishes up to rounding: the platform can move, or a length is 0 "
                "or far beyond its size"
            )
            return PlatformRoots(0.0 * polynomial, *nothing, False, reason)
        roots = angles_of_roots(waves)
        found: list[ComplexArray] = []
        for root in roots[np.isfinite(roots)]:
            for second in self._seconds(root):
                for end in self._refined(root, second):
                    angles = end.real + 0j if _apart(end, end.conj()) < _SAME else end
                    if all(_apart(angles, other) > _SAME for other in found):
                        found.append(angles)
        angles = np.array(found, complex).reshape(-1, n)
        poses = np.array([self.placed(one) for one in angles], complex).reshape(-1, 4, 4)
        maybe, real = int(np.sum(np.abs(roots.imag) < _MAYBE_REAL)), int(_are_real(angles).sum())
        reason = ""
        if len(angles) != self.degree and maybe != real:
            reason = f"{counted(maybe, 'root')} that may be real led to {counted(real, 'pose')}"
        return PlatformRoots(polynomial / greatest, roots, angles, poses, not reason, reason)

    def _checked(self, angles: ArrayLike) -> Numbers:
        given = _moderate("angles", angles)
        if given.shape != (len(self.names),):
            raise WrongSizeError("angles", given.shape, f"({len(self.names)},)")
        return given

    def _bilinear(self, k: int, one: Numbers, other: Numbers) -> Numbers:
        return np.asarray(
            np.einsum("i...,ij,j...->...", circle(one), self.tables[k], circle(other))
        )

    def _lines(self, first: Numbers, second: Numbers) -> Numbers:
        """Return the resultant of the equations in the third angle."""
        g = np.einsum("i...,ij->j...", circle(first), self.tables[1])
        return line_resultant(g, np.einsum("i...,ij->j...", circle(second), self.tables[2]))

    def _seconds(self, first: complex) -> list[complex]:
        """Return the values of the second angle (rad) at a root."""
        u = circle(first)
        if len(self.names) == 2:
            return crossing_angles(u @ self.tables[0], u @ self.tables[1])
        return list(angles_of_line(*(u @ self.tables[0]).tolist()))

    def _size(self, samples: Array) -> float:
        """Return the greatest bound of the resultant at samples (k,) of the first angle."""
        u = circle(samples).T
        if len(self.names) == 2:
            norms = np.linalg.norm(u @ self.tables, axis=2)
            return float(np.prod(norms, axis=0).max() ** 2)
        rows = [np.linalg.norm(self.dialytic_matrix(one), axis=1) for one in samples]
        return float(np.prod(rows, axis=1).max())


def _moderate(what: str, value: ArrayLike) -> Numbers:
    """Check angles (rad), real or complex, of any shape."""
    angles = as_angles(what, value)
    largest = float(np.abs(angles.imag).max(initial=0.0))
    if largest > _MOST_IMAGINARY:
        expected = f"at most {_MOST_IMAGINARY:g} rad, else cosines overflow"
        raise BadValueError(f"largest imaginary part of {what}", largest, expected)
    return angles


def _angle(what: str, value: complex) -> complex:
    given = _moderate(what, value)
    if given.ndim:
        raise WrongSizeError(what, given.shape, "()")
    return complex(given)


def _apart(one: Numbers, other: Numbers) -> float:
    """Return the greatest difference of angles (rad) up to whole turns."""
    difference = one - other
    turned = (difference.real + np.pi) % (2.0 * np.pi) - np.pi
    return float(np.abs(turned + 1j * np.imag(difference)).max())


def _are_real(angles: ComplexArray) -> Array:
    return np.all(angles.imag == 0.0, axis=1)
