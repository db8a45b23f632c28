"""Poses along a path, and the twist per unit of the path, exact from differential geometry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.trajectory.paths.arc_length import ArcLength, dot, measured
from robomech_ros.trajectory.paths.curve import Curve, as_curve
from robomech_ros.trajectory.paths.curve_arguments import as_number, as_parameters
from robomech_ros.trajectory.paths.orientation import Orientation
from robomech_ros.trajectory.tolerances import PARAMETER_SLACK
from robomech_ros.typing import Array, ArrayLike

# Step of a twist, over a unit of the path and turned into lengths by the path's own, that is no
# rounding: second derivatives of blends of a millimetre keep eight digits.
RATE_STEP = 1e-7


class PoseSample(NamedTuple):
    """Pose of a path at one coordinate, or at many; unpacks in this order.

    Attributes
    ----------
    pose : ndarray, shape (4, 4) or (m, 4, 4)
        ``T_base_tool`` (m).
    twist : ndarray, shape (6,) or (m, 6)
        [omega'; p'] per unit of the path coordinate (rad/m and 1), in the base frame, at the
        tool's origin.
    twist_rate : ndarray, shape (6,) or (m, 6)
        Its derivative with respect to the path coordinate.
    """

    pose: Array
    twist: Array
    twist_rate: Array


@dataclass(frozen=True, eq=False)
class PosePath:
    """Poses as functions of a path coordinate s (m), from 0 to `length`.

    Along the path ``|p'|^2 + radius^2 |omega'|^2 = 1``: with the radius 0 the coordinate is the
    arc length of the tool's origin; otherwise a turn counts as well, with the length it has at
    this distance from the origin, so that a path may turn on the spot.

    Attributes
    ----------
    curve : Curve
        Curve of the tool's origin, over a parameter.
    orientation : Orientation
        Over the same parameter.
    radius : float
        What a turn counts (m/rad).
    measure : ArcLength
        Path coordinate and parameter.
    parameters : ndarray, shape (k + 1,)
        Parameters of the ends and of all places where a derivative steps.
    waypoints : ndarray, shape (m, 4, 4), or None
        The poses (m) through which it was laid, by whose numbers places on it are told; None for
        its own parts.
    """

    curve: Curve
    orientation: Orientation
    radius: float
    measure: ArcLength
    parameters: Array
    waypoints: Array | None = None

    @property
    def length(self) -> float:
        """Last path coordinate (m)."""
        return self.measure.length

    @cached_property
    def breaks(self) -> Array:
        """Coordinates of the ends and of all places where the twist or a derivative steps (m)."""
        return self.measure.lengths[np.searchsorted(self.measure.parameters, self.parameters)]

    @cached_property
    def stops(self) -> Array:
        """Those of the inner breaks at which the twist itself steps: a robot must rest there."""
        inner = self.breaks[1:-1]
        if not len(inner):
            return inner
        after = self.sample(inner).twist
        before = self.sample(np.nextafter(inner, 0.0)).twist
        scale = np.array([self.length] * 3 + [1.0] * 3)
        step = np.abs((after - before) * scale).max(axis=1)
        size = np.maximum(np.abs(after * scale).max(axis=1), 1.0)
        return inner[step > RATE_STEP * size]

    def sample(self, s: ArrayLike) -> PoseSample:
        """Sample pose, twist and its derivative.

        Parameters
        ----------
        s : array_like, shape () or (m,)
            Path coordinates (m); at an inner break the part after it counts.
        """
        inside = as_parameters("s", s, 0.0, self.length)
        u = self.measure.parameter(np.atleast_1d(inside))
        r, turning = self.curve.derivatives(u), self.orientation.turning(u)
        pose = np.zeros((len(u), 4, 4))
        pose[:, :3, :3], pose[:, :3, 3], pose[:, 3, 3] = turning.rotation, r[0], 1.0
        rate = np.concatenate([turning.velocity, r[1]], axis=1)
        second = np.concatenate([turning.acceleration, r[2]], axis=1)
        weight = self.radius**2
        g = dot(r[1], r[1]) + weight * dot(turning.velocity, turning.velocity)
        growth = dot(r[1], r[2]) + weight * dot(turning.velocity, turning.acceleration)
        # With ds/du = sqrt(g): u' = g^(-1/2) and u'' = -(dg/du) / (2 g^2).
        slope = (1.0 / np.sqrt(g))[:, None]
        bend = (-growth / g**2)[:, None]
        found = PoseSample(pose, rate * slope, second * slope**2 + rate * bend)
        return found if inside.ndim else PoseSample(*(value[0] for value in found))


def pose_path(curve: Curve, orientation: Orientation, *, radius: float = 0.0) -> PosePath:
    """Combine a curve and an orientation over the same parameter into a path of poses.

    Parameters
    ----------
    curve : Curve
        Curve of the tool's origin in the base frame (m).
    orientation : Orientation
        ``R_base_tool`` over the curve's parameter: a constant one, one by geodesics, one by a
        spline or one by the curve's Frenet frame.
    radius : float, optional
        What a turn counts in the path coordinate (m/rad).  With the default 0 the coordinate is
        the arc length, and the tool's origin must not stop.

    Raises
    ------
    BadValueError
        Not a curve, an orientation that does not cover it, a negative radius, or a place where
        nothing moves.
    """
    curve = as_curve("curve", curve)
    if not (hasattr(orientation, "breaks") and callable(getattr(orientation, "turning", None))):
        raise BadValueError("orientation", orientation, "one with breaks and turning(u)")
    weight = as_number("radius", radius)
    if weight < 0.0:
        raise BadValueError("radius", weight, "at least 0")
    parameters = _common_breaks(curve.breaks, orientation.breaks)

    def speed(u: Array) -> Array:
        linear = curve.derivatives(u)[1]
        if weight == 0.0:
            return np.sqrt(dot(linear, linear))
        angular = orientation.turning(u).velocity
        return np.sqrt(dot(linear, linear) + weight**2 * dot(angular, angular))

    hint = "" if weight else ", or a radius above 0 for a path that turns on the spot"
    expected = f"above 0: the path must not stop{hint}"
    return PosePath(curve, orientation, weight, measured(speed, parameters, expected), parameters)


def _common_breaks(curve: Array, orientation: Array) -> Array:
    """Unite the breaks of both; refuse an orientation that ends before the curve."""
    start, end = float(curve[0]), float(curve[-1])
    slack = PARAMETER_SLACK * (end - start)
    if not len(orientation):
        return curve
    first, last = float(orientation[0]), float(orientation[-1])
    if first > start + slack or last < end - slack or not math.isfinite(first + last):
        expected = f"from {start:.9g} to {end:.9g}, the range of the curve"
        raise BadValueError("range of the orientation", (first, last), expected)
    after = np.clip(np.searchsorted(curve, orientation), 1, len(curve) - 1)
    nearest = np.minimum(np.abs(orientation - curve[after - 1]), np.abs(orientation - curve[after]))
    apart = nearest > slack
    inner = orientation[apart & (orientation > start) & (orientation < end)]
    return np.sort(np.concatenate([curve, inner]))
