"""Plans verified as samples too: the curve that a controller makes of them keeps the limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros.errors import BadValueError, DurationTooShortError
from robomech_ros.printing import Printed
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.motion_to_rest import MotionThrough, MotionToRest
from robomech_ros.trajectory.curves.time_scaling import checked_duration
from robomech_ros.trajectory.limits import JERK_MARGIN, MARGIN, JointLimits, Limits
from robomech_ros.trajectory.plans.point_to_point import (
    PROFILES,
    point_to_point,
    profile_named,
    scaled_limits,
)
from robomech_ros.trajectory.plans.verification import Verification, verify
from robomech_ros.trajectory.waypoints import (
    PiecewiseTrajectory,
    Waypoints,
    discretise,
    position_rounding,
)
from robomech_ros.typing import Array

Planner = Callable[[Limits], PiecewiseTrajectory]

# Rounding may do this to the jerk between two samples that are near to each other because jerk
# steps are: in parts of the lowest jerk limit, and at most (rad/s^3, m/s^3).  Less would merge
# steps farther apart, and that costs more.
_JERK_ERROR, _LARGEST_JERK_ERROR = 0.05, 100.0
# An excess up to this ratio is taken off the limits themselves (it costs a third of it in time).
_SMALL_EXCESS = 1.003
# A greater one comes from jerk steps of several joints that nearly coincide: the jerk limits are
# staggered by up to this part, joint by joint, which moves the steps apart.
_STAGGER = 0.004
# Both settle in a round or two; more would be a defect, which the verification then names.
_STAGGERED_ROUNDS = 3
_ROUNDS = 20
# Where a motion is slowed down for its rounding: how often, by how much more than the last samples
# ask for (those of the slower one are rounded anew), and by which part of its duration at most,
# which grows with every plan, as planning many via points anew takes seconds.
_SLOWED_ROUNDS, _OVERSLOWED, _SLOWER = 6, 1.2, 0.012


@dataclass(frozen=True, eq=False)
class SampledPlan(Printed):
    """A planned motion, its waypoints, and the proof that these keep to the limits.

    Attributes
    ----------
    trajectory : PiecewiseTrajectory
        The motion itself.
    waypoints : Waypoints
        Its samples, as a trajectory message takes them.
    verification : Verification
        Verification of the curve that a controller interpolates through the samples; always `ok`.
    """

    trajectory: PiecewiseTrajectory
    waypoints: Waypoints
    verification: Verification


def sampled_motion(
    planner: Planner,
    start: npt.ArrayLike,
    limits: JointLimits | Any,
    *,
    period: float,
    max_points: int,
    free: bool = True,
) -> SampledPlan:
    """Plan, sample, and verify the samples.

    Where the interpolation between samples would exceed a limit (two joints change their jerk
    at almost the same instant), the motion is planned anew within slightly tighter limits.

    Parameters
    ----------
    planner : callable
        Plans a motion from `start` to rest within the limits it is given.
    start : array_like, shape (n,)
        Joint values, rad or m.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes, of n joints.
    period : float
        Largest time between two samples in s.
    max_points : int
        The most samples there may be.
    free : bool
        Whether the planner may take more time; else only rounding is forgiven.

    Returns
    -------
    SampledPlan
        First sample the start at t = 0, last the goal at rest.

    Raises
    ------
    RobomechError
        As the planner, `discretise` and `verify` do.
    """
    if not callable(planner) or isinstance(planner, type):
        raise BadValueError("planner", planner, "a function of limits that gives a motion")
    known = Limits.of(limits)
    first = known.with_margin if free else known
    factors = np.ones((3, len(known.joint_names)))
    jerk_error = min(_JERK_ERROR * float(known.least_rates[2]), _LARGEST_JERK_ERROR)

    def sampled(motion: PiecewiseTrajectory) -> SampledPlan:
        waypoints = discretise(motion, period, max_points, jerk_error=jerk_error)
        return SampledPlan(motion, waypoints, verify(waypoints, known, start=start))

    plan: SampledPlan | None = None
    for attempt in range(_ROUNDS):
        try:
            trajectory = planner(
                first.scaled(velocity=factors[0], acceleration=factors[1], jerk=factors[2])
                if attempt
                else first
            )
        except DurationTooShortError:
            if plan is None or not plan.verification.ok:
                raise
            return plan  # over the limits by rounding only, and there is no time to spare
        plan = sampled(trajectory)
        ratios = _shown_ratios(plan, known)
        if (ratios <= 1.0).all():
            break
        slowest = 1.0 + _SLOWER * (attempt + 1) if free else 1.0
        slowed = _slowed(plan, known, slowest, sampled)
        if slowed is not None:
            return slowed
        _tighten(factors, ratios, stagger=attempt < _STAGGERED_ROUNDS)
    assert plan is not None
    plan.verification.require_ok()
    return plan


def sampled_point_to_point(
    q0: npt.ArrayLike,
    q1: npt.ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str,
    period: float,
    max_points: int,
    duration: float | None = None,
    velocity_scale: float = 1.0,
    acceleration_scale: float = 1.0,
    jerk_scale: float = 1.0,
    start_velocity: npt.ArrayLike | None = None,
) -> SampledPlan:
    """Plan from point to point, sample, and verify the samples against the scaled limits.

    Parameters
    ----------
    q0, q1, limits, profile, duration
        As for `point_to_point`, except for profiles whose acceleration steps.
    velocity_scale, acceleration_scale, jerk_scale, start_velocity
        As for `point_to_point`.
    period, max_points
        As for `sampled_motion`.

    Returns
    -------
    SampledPlan
        First sample the start at t = 0, last the goal at rest.

    Raises
    ------
    RobomechError
        As `point_to_point`, `discretise` and `verify` do.
    """
    method = profile_named(profile)
    check_can_be_sampled(profile)
    allowed = scaled_limits(
        Limits.of(limits), method, velocity_scale, acceleration_scale, jerk_scale
    )
    seconds = checked_duration(duration)
    options: dict[str, Any] = {"duration": seconds, "start_velocity": start_velocity}

    def planner(tightened: Limits) -> PiecewiseTrajectory:
        return point_to_point(q0, q1, limits=tightened, profile=profile, **options)

    return sampled_motion(
        planner, q0, allowed, period=period, max_points=max_points, free=seconds is None
    )


def check_can_be_sampled(profile: str) -> None:
    """Raise BadValueError for a profile whose acceleration steps: samples do not tell when."""
    if profile_named(profile).ACCELERATION_STEPS:
        able = sorted(name for name, one in PROFILES.items() if not one.ACCELERATION_STEPS)
        expected = f"one with continuous acceleration, as samples need it: {', '.join(able)}"
        raise BadValueError("profile", profile, expected)


def stretched_motion(plan: SampledPlan, factor: float) -> PiecewiseTrajectory:
    """Return the motion of a plan over a time longer by a factor."""
    goal, pieces = plan.waypoints.positions[-1], plan.trajectory.pieces.stretched(factor)
    knots = getattr(plan.trajectory, "knots", None)
    return (
        MotionToRest(goal, pieces) if knots is None else MotionThrough(goal, pieces, factor * knots)
    )


def _tighten(factors: Array, ratios: Array, *, stagger: bool) -> None:
    """Reduce the factors (3, n) of the limits after the ratios (3, n) of a plan within them."""
    if stagger and ratios.max() > _SMALL_EXCESS:
        joints = factors.shape[1]
        factors[2] *= 1.0 - _STAGGER * np.arange(1, joints + 1) / joints
        ratios = np.minimum(ratios, _SMALL_EXCESS)
    factors /= 1.0 + 1.1 * np.maximum(ratios - 1.0, 0.0) + MARGIN


def _shown_ratios(plan: SampledPlan, limits: Limits) -> Array:
    """Find the ratios (3, n) of velocity, acceleration and jerk to their limits, as sampled.

    A verification forgives what may be rounding; who receives the samples need not, so that here
    it counts where samples are so near to each other that it can be seen.
    """
    # Rounding of positions can use up the margins of acceleration or jerk.
    times, (_, acceleration, jerk) = plan.waypoints.times, limits.least_rates.tolist()
    shortest = float((times[1:] - times[:-1]).min(initial=np.inf))
    least = shortest**2 * min(MARGIN * acceleration, shortest * JERK_MARGIN * jerk)
    if not position_rounding(plan.waypoints.positions) > least:
        seen = plan.verification
        return np.array(
            (seen.peak_velocity_ratio, seen.peak_acceleration_ratio, seen.peak_jerk_ratio)
        )
    low, high = extremes(plan.waypoints.curve)
    return np.maximum(-low, high)[1:] / limits.rates


def _slowed(
    plan: SampledPlan,
    limits: Limits,
    slowest: float,
    sampled: Callable[[PiecewiseTrajectory], SampledPlan],
) -> SampledPlan | None:
    """Slow a plan down by up to a factor until its rounding, too, is within the limits, if it gets.

    Where rounding is all that is wrong that takes less time than to plan anew.
    """
    factor, ratios = 1.0, _shown_ratios(plan, limits)
    for _ in range(_SLOWED_ROUNDS):
        needed = float(((ratios + MARGIN).max(axis=1) ** (1.0 / np.arange(1.0, 4.0))).max())
        factor *= 1.0 + _OVERSLOWED * (needed - 1.0)
        if factor > slowest:
            return None
        slowed = sampled(stretched_motion(plan, factor))
        ratios = _shown_ratios(slowed, limits)
        if slowed.verification.ok and (ratios <= 1.0).all():
            return slowed
    return None
