"""Motions from rest to rest through via points in joint space, by profile."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, LimitExceededError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.trajectory.curves.bounded_spline import bounded_spline
from robomech_ros.trajectory.curves.knots import knots_at, spaced_knots
from robomech_ros.trajectory.curves.time_scaling import checked_duration, fitted
from robomech_ros.trajectory.joint_points import joint_points
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.plans.jerk_limited_through import jerk_limited_through
from robomech_ros.trajectory.plans.point_to_point import (
    point_to_point,
    profile_named,
    scaled_limits,
)
from robomech_ros.trajectory.plans.sampled_plan import (
    SampledPlan,
    check_can_be_sampled,
    sampled_motion,
)
from robomech_ros.trajectory.plans.spline_motions import Spline, spline_through
from robomech_ros.trajectory.plans.via_polynomials import MOST_VIAS, via_polynomial
from robomech_ros.trajectory.timing.time_optimal_motions import time_optimal_through
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array, ArrayLike

# Through more points than these the search for the best knots takes long.
_OPTIMISED = 20

Through = Callable[[Array, Limits, Array | None, float | None], PiecewiseTrajectory]


def _polynomial(
    profile: str, points: Array, limits: Limits, at: Array | None, duration: float | None
) -> PiecewiseTrajectory:
    if len(points) > MOST_VIAS + 2:
        expected = f"at most {MOST_VIAS} for {profile}; cubic_spline passes more"
        raise BadValueError("number of via points", len(points) - 2, expected)
    return via_polynomial(points, limits=limits, profile=profile, at=at, duration=duration)


def _spline(
    points: Array, limits: Limits, at: Array | None, duration: float | None
) -> PiecewiseTrajectory:
    spacing = "optimal" if len(points) <= _OPTIMISED else "balanced"
    try:
        return spline_through(points, limits=limits, at=at, spacing=spacing, duration=duration)
    except LimitExceededError:
        # By distances it swings out less between the points, and with more knots not at all.
        try:
            return spline_through(points, limits=limits, at=at, duration=duration)
        except LimitExceededError:
            inside = _inside_limits(points, limits, at, duration)
            if inside is None:
                raise
            return inside


def _inside_limits(
    points: Array, limits: Limits, at: Array | None, duration: float | None
) -> Spline | None:
    """Plan a spline that the position limits hold back between the points."""
    spaced = spaced_knots(points, "centripetal", limits.velocity)
    knots = spaced if at is None else knots_at(at, len(points))
    # A start outside, within the slack, may stay there.
    lower, upper = np.minimum(limits.lower, points[0]), np.maximum(limits.upper, points[0])
    shape = bounded_spline(knots, points, lower, upper)
    if shape is None:
        return None
    pieces = fitted(shape, limits, duration)
    return Spline(points, knots * (pieces.duration / shape.duration), "rest", pieces)


def _finding_instants(
    profile: str, points: Array, limits: Limits, at: Array | None, duration: float | None
) -> PiecewiseTrajectory:
    if at is not None:
        expected = f"none for {profile}, which finds the instants itself"
        raise BadValueError("at", at.tolist(), expected)
    plan = jerk_limited_through if profile == "ruckig" else time_optimal_through
    return plan(points, limits, duration)


# Profiles that can pass via points on their way.
VIA_PROFILES: dict[str, Through] = {
    "poly345": partial(_polynomial, "poly345"),
    "poly4567": partial(_polynomial, "poly4567"),
    "cubic_spline": _spline,
    "ruckig": partial(_finding_instants, "ruckig"),
    "time_optimal": partial(_finding_instants, "time_optimal"),
}


def through_points(
    points: ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str = "cubic_spline",
    at: ArrayLike | None = None,
    duration: float | None = None,
    velocity_scale: float = 1.0,
    acceleration_scale: float = 1.0,
    jerk_scale: float = 1.0,
) -> PiecewiseTrajectory:
    """Plan from rest to rest through via points, which are passed without a stop.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Start, via points and goal, rad or m, m >= 2.
    limits : JointLimits
        As for `point_to_point`.
    profile : str
        With via points ``"cubic_spline"``, ``"ruckig"``, ``"time_optimal"`` (along the natural
        cubic spline through all points), or ``"poly345"`` and ``"poly4567"`` for at most two of
        them; without any of `PROFILES`.  Splines that would leave the position limits between
        the points have more knots there.
    at : array_like, shape (m - 2,), optional
        Which part of the duration is over at each via point, strictly between 0 and 1 and
        increasing; default the best that is known.  Not with ``"ruckig"`` and ``"time_optimal"``.
    duration : float, optional
        Wanted duration in s; None (or 0) for the shortest within the limits.
    velocity_scale, acceleration_scale, jerk_scale : float
        Part of each kind of limit that may be used, from 1e-6 to 1.

    Returns
    -------
    PiecewiseTrajectory
        With ``.duration`` (s), ``.sample(t)`` and ``.pieces``.

    Raises
    ------
    RobomechError
        As `point_to_point`, `spline_through` and `via_polynomial` do.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 6.5 and 6.6.

    Examples
    --------
    >>> from robomech_ros.trajectory import Limits, through_points
    >>> limits = Limits(["turn", "lift"], velocity=1.0, acceleration=4.0)
    >>> points = [[0.0, 0.0], [0.5, 0.2], [1.0, 0.0]]
    >>> motion = through_points(points, limits=limits, duration=4.0)
    >>> motion.sample(motion.knots[1]).position.round(6)
    array([0.5, 0.2])
    """
    method = profile_named(profile)
    known = Limits.of(limits)
    allowed = scaled_limits(known, method, velocity_scale, acceleration_scale, jerk_scale)
    places = joint_points(points, len(allowed.joint_names))
    return _planned(places, allowed, profile, at, checked_duration(duration))


def _planned(
    places: Array, allowed: Limits, profile: str, at: ArrayLike | None, duration: float | None
) -> PiecewiseTrajectory:
    """Plan through points (m, n) that are checked, within limits that are scaled."""
    if len(places) == 2 and at is None:
        return point_to_point(*places, limits=allowed, profile=profile, duration=duration)
    through = VIA_PROFILES.get(profile.lower())
    if through is None:
        expected = f"none for {profile}; {', '.join(VIA_PROFILES)} take some"
        raise BadValueError("number of via points", len(places) - 2, expected)
    parts = None if at is None else real_array("at", at)
    return through(places, allowed, parts, duration)


def sampled_through_points(
    points: ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str,
    period: float,
    max_points: int,
    at: ArrayLike | None = None,
    duration: float | None = None,
    velocity_scale: float = 1.0,
    acceleration_scale: float = 1.0,
    jerk_scale: float = 1.0,
) -> SampledPlan:
    """Plan as `through_points` does, sample, and verify the samples against the scaled limits.

    Parameters
    ----------
    points, limits, profile, at, duration, velocity_scale, acceleration_scale, jerk_scale
        As for `through_points`, except for profiles whose acceleration steps.
    period, max_points
        As for `sampled_motion`.

    Returns
    -------
    SampledPlan
        First sample the start at t = 0, last the goal at rest.

    Raises
    ------
    RobomechError
        As `through_points`, `discretise` and `verify` do.
    """
    scales = (velocity_scale, acceleration_scale, jerk_scale)
    check_can_be_sampled(profile)
    allowed = scaled_limits(Limits.of(limits), profile_named(profile), *scales)
    places = joint_points(points, len(allowed.joint_names))
    seconds = checked_duration(duration)

    def planner(tightened: Limits) -> PiecewiseTrajectory:
        return _planned(places, tightened, profile, at, seconds)

    return sampled_motion(
        planner, places[0], allowed, period=period, max_points=max_points, free=seconds is None
    )
