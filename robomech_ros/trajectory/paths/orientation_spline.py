"""A C2 spline through orientations."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.rotations.axis_angle import (
    matrix_from_rotation_vector,
    rotation_vector_from_matrix,
)
from robomech_ros.spatial.rotations.rates import angular_motion
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.quintic_spline import Ends, Side, matched
from robomech_ros.trajectory.paths.orientation import (
    PiecewiseRotation,
    applied,
    as_rotations,
    turns_between,
)
from robomech_ros.trajectory.paths.spline_curves import as_ends, checked_end_rates
from robomech_ros.trajectory.tolerances import COINCIDENT
from robomech_ros.typing import Array, ArrayLike

# Newton steps for a rotation spline; convergence is quadratic.
SPLINE_STEPS = 50

# In how many parts the quadratic term is brought in: all at once serves nearly always.
_PARTS = (1, 8, 64)
# A Newton step longer than this, in terms of the largest mean velocity, leads nowhere.
_LARGEST_STEP = 1e3


def orientation_spline(
    rotations: ArrayLike,
    knots: ArrayLike,
    *,
    ends: Ends = "natural",
    end_rates: ArrayLike | None = None,
) -> PiecewiseRotation:
    """Turn smoothly through orientations: angular velocity and acceleration are continuous.

    In each segment the rotation vector from the orientation at its beginning is a cubic; the
    angular velocities at the knots follow from the continuity of the angular acceleration.  That
    system is the one of a cubic spline, to which it reduces about a fixed axis, with a quadratic
    term, and is solved by Newton's method.  The curve passes through the orientations by
    construction, and depends neither on the choice of the base frame nor on that of the tool's.

    Parameters
    ----------
    rotations : array_like, shape (n, 3, 3)
        ``R_base_tool``; of a closed motion the last equals the first.
    knots : array_like, shape (n,)
        Parameters at which they are reached.
    ends : str, optional
        ``natural``: no angular acceleration at the ends; ``clamped``: `end_rates`; ``periodic``:
        as smooth where the motion closes as elsewhere.
    end_rates : array_like, shape (2, 3), optional
        Of clamped ends: angular velocities in the base frame (rad per unit of the parameter).

    Raises
    ------
    BadValueError, WrongSizeError
        Not rotations, knots or rates, neighbours opposite to each other, a motion that should close
        and does not, or orientations so far apart that no smooth motion was found.

    References
    ----------
    I. G. Kang and F. C. Park, Cubic spline algorithms for orientation interpolation, Int. J.
    Numerical Methods in Engineering 46 (1999) 45-64.
    """
    kind = as_ends(ends)
    given, parameters = as_rotations("rotations", rotations, knots)
    if kind == "periodic":
        given = _closed(given)
    turns = turns_between("rotations", given)
    expected = "angular velocities, since the ends are clamped"
    at_ends = checked_end_rates(end_rates, kind, (2, 3), expected)
    if at_ends is not None:
        # In the axes of their knots.
        at_ends = applied(np.swapaxes(given[[0, -1]], -1, -2), at_ends)
    system = _System(np.diff(parameters), turns, kind, at_ends)
    rates = system.solution()
    h = system.h[:, None]
    end = applied(system.to_vector, rates[1:])
    start, mean = rates[:-1], turns / h
    cubic = [np.zeros_like(turns), start, (3.0 * mean - 2.0 * start - end) / h]
    cubic.append((start + end - 2.0 * mean) / h**2)
    return PiecewiseRotation(given, PiecewisePolynomial(parameters, np.stack(cubic)))


class _System:
    """Equations for the angular velocities w (n, 3) at the knots, each in the axes of its knot.

    The cubic of segment k has the slopes w[k] and A w[k + 1], A the inverse of the matrix J that
    gives the moving frame's velocity.  Its angular acceleration is, at its beginning,
    ``6 turn / h^2 - 4 w[k] / h - 2 A w[k + 1] / h`` and at its end, in the axes of knot k + 1,
    ``-6 turn / h^2 + 2 J w[k] / h + 4 w[k + 1] / h + N(A w[k + 1])`` with a quadratic N.
    """

    def __init__(self, h: Array, turns: Array, ends: Ends, rates: Array | None) -> None:
        self.h, self.turns, self.ends, self.rates = h, turns, ends, rates
        # From the rate of a rotation vector to the moving frame's own velocity: seen from it, the
        # fixed frame turns back.
        back = np.repeat(-turns[:, None], 3, axis=1)
        velocities = angular_motion(back, "rotation-vector", np.broadcast_to(np.eye(3), back.shape))
        self.to_body = np.swapaxes(velocities[0], -1, -2)
        self.to_vector = np.linalg.inv(self.to_body).astype(np.float64, copy=False)
        self.back: Array = np.swapaxes(matrix_from_rotation_vector(turns), -1, -2)

    def solution(self) -> Array:
        """Solve by Newton's method, if need be with the quadratic term brought in by parts."""
        for parts in _PARTS:
            w: Array | None = np.zeros((len(self.h) + 1, 3))
            for part in range(1, parts + 1):
                w = None if w is None else self._newton(w, part / parts)
            if w is not None:
                return w
        raise BadValueError(
            "angles (rad) between the rotations",
            np.linalg.norm(self.turns, axis=1).tolist(),
            "smaller turns between neighbours: no smooth motion through all was found",
        )

    def _newton(self, w: Array, weight: float) -> Array | None:
        """Solve with the quadratic term times a weight; None where the steps do not converge."""
        scale = float((np.linalg.norm(self.turns, axis=1) / self.h).max())
        if self.rates is not None:
            scale = max(scale, float(np.abs(self.rates).max()))
        for _ in range(SPLINE_STEPS):
            step = self._step(w, weight)
            w = w + step
            size = float(np.abs(step).max())
            if size <= 1e-13 * scale:
                return w
            if not size <= _LARGEST_STEP * scale:
                return None
        return None

    def _step(self, w: Array, weight: float) -> Array:
        begin, end = self._accelerations(w, weight)
        h = self.h[:, None, None]
        here = 4.0 / h * np.eye(3)
        start = Side(-here, -2.0 / h * self.to_vector, begin[:, :, None])
        stop = Side(2.0 / h * self.to_body, here + weight * self._slopes(w), end[:, :, None])
        missing = None if self.rates is None else (self.rates - w[[0, -1]])[:, :, None]
        return matched(start, stop, self.ends, missing)[:, :, 0]

    def _accelerations(self, w: Array, weight: float) -> tuple[Array, Array]:
        """Angular accelerations (n - 1, 3) at the beginning and at the end of the segments."""
        h = self.h[:, None]
        last = applied(self.to_vector, w[1:])
        mean = 6.0 * self.turns / h**2
        begin = mean - 4.0 / h * w[:-1] - 2.0 / h * last
        linear = 2.0 / h * applied(self.to_body, w[:-1]) + 4.0 / h * w[1:] - mean
        return begin, linear + weight * self._quadratic(last)

    def _quadratic(self, vector: Array) -> Array:
        return applied(self.back, angular_motion(self.turns, "rotation-vector", vector)[1])

    def _slopes(self, w: Array) -> Array:
        """Differentiate the quadratic term, (n - 1, 3, 3); its differences are exact."""
        last = applied(self.to_vector, w[1:])
        # Differences as large as the vector itself keep its digits.
        size = np.maximum(np.linalg.norm(last, axis=1), np.linalg.norm(self.turns, axis=1) / self.h)
        size = np.where(size > 0.0, size, 1.0)[:, None]
        columns = [
            (self._quadratic(last + size * axis) - self._quadratic(last - size * axis))
            / (2.0 * size)
            for axis in np.eye(3)
        ]
        return np.stack(columns, axis=-1) @ self.to_vector


def _closed(rotations: Array) -> Array:
    """Put the last orientation on the first, where it is up to rounding."""
    if len(rotations) < 4:
        raise WrongSizeError("rotations", rotations.shape, "(n, 3, 3) with n at least 4, if closed")
    between = rotations[-1].T @ rotations[0]
    angle = float(np.linalg.norm(rotation_vector_from_matrix(between)))
    if angle > COINCIDENT:
        what = f"angle (rad) from rotations[0] to rotations[{len(rotations) - 1}]"
        raise BadValueError(what, angle, "0, for a motion that closes")
    return np.concatenate([rotations[:-1], rotations[:1]])
