"""Timing of a path around obstacles: a smooth curve if possible, proved as it is sent."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros.collision.distances import checked_clearance
from robomech_ros.collision.scene import PlanningScene
from robomech_ros.errors import BadValueError, DurationTooShortError, RobomechError
from robomech_ros.kinematics.joint_values import as_finite_values
from robomech_ros.trajectory import (
    SampledPlan,
    Waypoints,
    discretise,
    sampled_through_points,
    verify,
)
from robomech_ros.trajectory.curves.motion_to_rest import MotionThrough, MotionToRest
from robomech_ros.trajectory.curves.piecewise import joined
from robomech_ros.trajectory.curves.time_scaling import checked_duration, stretch_needed
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.plans.point_to_point import (
    point_to_point,
    profile_named,
    scaled_limits,
)
from robomech_ros.trajectory.plans.sampled_plan import stretched_motion
from robomech_ros.trajectory.tolerances import DURATION_ROUNDING
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array

# Most rounds of added waypoints before the robot stops at each of them instead.
_ROUNDS = 3
# Place of an added waypoint on a straight piece, from either end.
_NEAR_ENDS = 0.2


class NotFreeError(RobomechError):
    """A path that is to be timed is not proved free of contact."""


def timed_path(
    scene: PlanningScene,
    waypoints: npt.ArrayLike,
    limits: JointLimits | Any = None,
    *,
    profile: str = "time_optimal",
    clearance: float = 0.0,
    period: float = 0.01,
    max_points: int = 20_000,
    duration: float | None = None,
    velocity_scale: float = 1.0,
    acceleration_scale: float = 1.0,
    jerk_scale: float = 1.0,
) -> SampledPlan:
    """Time a path that is free of contact, and prove the curve that a controller makes of it.

    The robot passes the waypoints on a smooth curve.  If that would touch something, waypoints are
    added on the straight lines between them; if that does not help, the robot stops at each.
    If the path begins in contact, the robot stops at the first free waypoint, and only the rest is
    proved.

    Parameters
    ----------
    scene : PlanningScene
    waypoints : array_like, shape (m, n)
        Joint values (rad or m), as `PlanningScene.plan` gives them.
    limits : JointLimits, optional
        By default those of the scene's chain.
    profile : str
        As for `through_points`.
    clearance : float
        Distance that bodies must exceed (m).
    period : float
        Largest time between two samples (s).
    max_points : int
        The most samples there may be.
    duration : float, optional
        Wanted duration in s; None (or 0) for the shortest.
    velocity_scale, acceleration_scale, jerk_scale : float
        Part of each kind of limit that may be used, from 1e-6 to 1.

    Returns
    -------
    SampledPlan
        With the motion (``.trajectory``: ``.duration``, ``.sample(t)``) and its samples, whose
        curve is within the limits and proved free.

    Raises
    ------
    NotFreeError
        The path itself is not free, or not proved.
    DurationTooShortError
        The limits do not allow the wanted duration on this path.
    """
    checked_clearance(clearance)
    chain = scene.chain
    points = as_finite_values(chain, waypoints, "waypoints")
    if points.ndim != 2 or len(points) < 2:
        raise BadValueError("waypoints", points.shape, f"at least two, (m, {chain.n})")
    allowed = Limits.of(chain if limits is None else limits)
    scales = (velocity_scale, acceleration_scale, jerk_scale)
    smooth = partial(
        sampled_through_points,
        limits=allowed,
        profile=profile,
        velocity_scale=velocity_scale,
        acceleration_scale=acceleration_scale,
        jerk_scale=jerk_scale,
        period=period,
        max_points=max_points,
    )
    seconds = checked_duration(duration)
    tight = scaled_limits(allowed, profile_named(profile), *scales)
    sampled = partial(_sampled, limits=tight, period=period, max_points=max_points)
    left = int(np.argmax(scene.is_free(points, clearance=clearance)))
    rest = _proved(scene, points[left:], smooth, clearance)
    is_proved = rest is not None and seconds is None
    if rest is None:
        rest = sampled(_with_stops(points[left:], tight.with_margin, profile))
    parts = [smooth(points[: left + 1]), rest] if left else [rest]
    if seconds is not None:
        parts = [sampled(part) for part in _stretched(parts, seconds, tight)]
    if not (is_proved or scene.check_motion(parts[-1].waypoints, clearance=clearance).certified):
        raise NotFreeError("the samples of the path come nearer than the path; take more")
    return _joined(parts[0], parts[1], tight) if left else parts[0]


def _proved(
    scene: PlanningScene, points: Array, smooth: Callable[[Array], SampledPlan], clearance: float
) -> SampledPlan | None:
    """Return a smooth motion along a path that is proved free; None if it needs stops."""
    found = scene.check_motion(points, clearance=clearance)
    if not found.certified:
        names = " and ".join(f"'{name}'" for name in found.bodies)
        what = "is not proved free of contact" if found.free else "is in contact"
        raise NotFreeError(f"the path {what} at waypoint {found.parameter:.4g}: {names}")
    places = points
    for _ in range(_ROUNDS if len(points) > 2 else 1):
        try:
            plan = smooth(places)
        except RobomechError:
            if len(points) == 2:
                raise
            break
        if scene.check_motion(plan.waypoints, clearance=clearance).certified:
            return plan
        places = _denser(places)
    return None


def _joined(first: SampledPlan, second: SampledPlan, limits: Limits) -> SampledPlan:
    """Append a motion to another that ends at rest."""
    one, other = first.waypoints, second.waypoints
    rows = [
        np.concatenate([getattr(one, name), getattr(other, name)[1:]])
        for name in ("positions", "velocities", "accelerations")
    ]
    both = Waypoints(np.append(one.times, one.times[-1] + other.times[1:]), *rows)
    pieces = joined([first.trajectory.pieces, second.trajectory.pieces])
    verification = verify(both, limits, start=both.positions[0])
    verification.require_ok()
    return SampledPlan(MotionToRest(both.positions[-1], pieces), both, verification)


def _denser(points: Array) -> Array:
    """Add two waypoints to each straight piece, near its ends, so that a curve keeps to it."""
    steps = np.diff(points, axis=0)
    rows = [points[:-1], points[:-1] + _NEAR_ENDS * steps, points[1:] - _NEAR_ENDS * steps]
    between = np.stack(rows, axis=1).reshape(-1, points.shape[1])
    return np.concatenate([between, points[-1:]])


def _with_stops(points: Array, limits: Limits, profile: str) -> MotionThrough:
    """Go straight from waypoint to waypoint, at rest at each."""
    pieces = [
        point_to_point(a, b, limits=limits, profile=profile).pieces
        for a, b in pairwise(points)
        if np.abs(b - a).max() > 0.0
    ]
    knots = np.append(0.0, np.cumsum([piece.breaks[-1] for piece in pieces]))
    return MotionThrough(points[-1], joined(pieces), knots)


def _stretched(
    parts: list[SampledPlan], seconds: float, limits: Limits
) -> list[PiecewiseTrajectory]:
    """Scale successive motions to a desired total duration."""
    shortest = sum(part.trajectory.duration for part in parts)
    if seconds < shortest - DURATION_ROUNDING * (1.0 + shortest):
        curve = joined([part.trajectory.pieces for part in parts])
        _, joint, rate = stretch_needed(curve, limits)
        raise DurationTooShortError(seconds, shortest, limits.joint_names[joint], rate)
    return [stretched_motion(part, max(seconds / shortest, 1.0)) for part in parts]


def _sampled(
    motion: PiecewiseTrajectory, limits: Limits, period: float, max_points: int
) -> SampledPlan:
    waypoints = discretise(motion, period, max_points)
    verification = verify(waypoints, limits, start=waypoints.positions[0])
    verification.require_ok()
    return SampledPlan(motion, waypoints, verification)
