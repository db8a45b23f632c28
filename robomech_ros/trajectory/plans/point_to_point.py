"""Motion from point to point in joint space, by profile."""

from __future__ import annotations

from typing import Any, ClassVar, Protocol

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.timing import straight as time_straight
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import finite_within
from robomech_ros.trajectory.curves.time_scaling import checked_duration
from robomech_ros.trajectory.joint_points import check_numbers, joint_values
from robomech_ros.trajectory.limits import RATES, JointLimits, Limits, Rate
from robomech_ros.trajectory.profiles.jerk_limited import JerkLimited
from robomech_ros.trajectory.profiles.rest_to_rest import (
    CubicSplineMotion,
    Cycloidal,
    Polynomial345,
    Polynomial4567,
)
from robomech_ros.trajectory.profiles.velocity_profiles import DoubleS, Trapezoidal
from robomech_ros.trajectory.timing.time_optimal_motions import TimeOptimalMotion
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import Array, ArrayLike

both_within = direct(time_straight.both_within)
# Least scale of a limit: a motion at a millionth of the speed takes weeks, and the powers of its
# duration are still far from overflow.
SMALLEST_SCALE = 1e-6


class Profile(Protocol):
    """A way to move from one point to another, which cannot be planned without some limits.

    It can start from other than rest if it ``STARTS_MOVING``. Where ``ACCELERATION_STEPS``, samples
    of accelerations do not tell the curve.
    """

    REQUIRED: ClassVar[tuple[Rate, ...]]
    STARTS_MOVING: ClassVar[bool]
    ACCELERATION_STEPS: ClassVar[bool]

    @classmethod
    def plan(
        cls, start: Array, goal: Array, limits: Limits, duration: float | None = None
    ) -> PiecewiseTrajectory:
        """Plan from `start` to rest at `goal` (n,), within `limits`."""


PROFILES: dict[str, type[Profile]] = {
    "poly345": Polynomial345,
    "poly4567": Polynomial4567,
    "cycloidal": Cycloidal,
    "cubic_spline": CubicSplineMotion,
    "trapezoidal": Trapezoidal,
    "double_s": DoubleS,
    "ruckig": JerkLimited,
    "time_optimal": TimeOptimalMotion,
}


def profile_named(name: str) -> type[Profile]:
    """Look a profile up by its name, in capitals or not."""
    found = PROFILES.get(name.lower()) if isinstance(name, str) else None
    if found is None:
        raise BadValueError("profile", name, "one of " + ", ".join(sorted(PROFILES)))
    return found


def point_to_point(
    q0: ArrayLike,
    q1: ArrayLike,
    *,
    limits: JointLimits | Any,
    profile: str = "poly345",
    duration: float | None = None,
    velocity_scale: float = 1.0,
    acceleration_scale: float = 1.0,
    jerk_scale: float = 1.0,
    start_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
) -> PiecewiseTrajectory:
    r"""Plan a motion of all joints together, from one point to rest at another.

    .. math:: q(t) = q_0 + (q_1 - q_0)\, s(t / T)

    for all profiles but ``ruckig``, whose joints do not keep the ratio of their displacements.

    Parameters
    ----------
    q0, q1 : array_like, shape (n,)
        Start and goal, rad or m.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes.  Velocity and acceleration
        limits of every joint are needed, and jerk limits for ``double_s`` and ``ruckig``; the
        others but ``trapezoidal`` keep to those jerk limits that are there.
    profile : str
        A name in `PROFILES`, in capitals or not: ``poly345``, ``poly4567``, ``cycloidal`` (the
        book's laws), ``cubic_spline``, ``trapezoidal``, ``double_s``, ``ruckig`` (the fastest;
        the only one that may start moving), ``time_optimal`` (the fastest on the straight line;
        without a jerk limit an acceleration takes 20 ms to rise).
    duration : float, optional
        Wanted duration in s; None (or 0) for the shortest within the limits, which is 1 ms at
        the least.
    velocity_scale, acceleration_scale, jerk_scale : float
        Part of each kind of limit that may be used, from 1e-6 to 1.
    start_velocity, start_acceleration : array_like, shape (n,), optional
        Rates at the start, rad or m over s and s^2, where the profile can start moving; rest
        where not given.

    Returns
    -------
    PiecewiseTrajectory
        With ``.duration`` (s), ``.sample(t)`` and ``.pieces``, whose breaks increase strictly; the
        limits are kept to 1e-9 of them everywhere.

    Raises
    ------
    WrongSizeError, NonFiniteError
        If start, goal or rates do not have one finite number for each joint.
    BadValueError
        If the profile is unknown or cannot start moving, or a scale or the duration is out of
        range.
    MissingLimitsError
        If a joint lacks a limit that is needed.
    SeedOutsideLimitsError, LimitExceededError
        If the start, or the goal or another part of the motion, is outside the limits.
    DurationTooShortError
        If the limits do not allow the wanted duration.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 6.2 to 6.4.

    Examples
    --------
    >>> from robomech_ros.robots import load_robot
    >>> from robomech_ros.trajectory import point_to_point
    >>> puma = load_robot("puma560")
    >>> motion = point_to_point([0.0] * 6, [0.5] * 6, limits=puma, profile="poly345", duration=2.0)
    >>> at = motion.sample(1.0)
    >>> round(float(at.position[0]), 6), round(float(at.velocity[0]), 6)
    (0.25, 0.46875)
    """
    method = profile_named(profile)
    known = limits if type(limits) is Limits else Limits.of(limits)
    allowed = scaled_limits(known, method, velocity_scale, acceleration_scale, jerk_scale)
    shape = allowed.lower.shape
    start, goal = joint_values("start", q0, shape), joint_values("goal", q1, shape)
    if not both_within(start, goal, allowed.ranges):
        check_numbers("start", start)
        check_numbers("goal", goal)
        allowed.check_start(start)
        allowed.check_goal(goal)
    seconds = None if duration is None else checked_duration(duration)
    if start_velocity is None and start_acceleration is None:
        return method.plan(start, goal, allowed, seconds)
    moving = _rates_at_start(start_velocity, start_acceleration, shape)
    if not method.STARTS_MOVING:
        _check_at_rest(profile, moving)
        return method.plan(start, goal, allowed, seconds)
    plan: Any = method.plan
    return plan(start, goal, allowed, seconds, **moving)


def scaled_limits(
    limits: Limits, method: type[Profile], velocity: float, acceleration: float, jerk: float
) -> Limits:
    """Scale the limits as a request wants them; refuse where one that is needed is missing."""
    a, b, c = velocity, acceleration, jerk
    if type(a) is type(b) is type(c) is float and a == b == c == 1.0:  # the usual case, at once
        limits.require(*method.REQUIRED)
        return limits
    expected = f"at least {SMALLEST_SCALE:g} and at most 1"
    for rate, given in zip(RATES, (a, b, c), strict=True):
        finite_within(f"{rate}_scale", given, expected, SMALLEST_SCALE, 1.0)
    limits.require(*method.REQUIRED)
    if jerk != 1.0:
        limits.require("jerk")  # else the scale would mean nothing, silently
    return limits.scaled(velocity=velocity, acceleration=acceleration, jerk=jerk)


def _rates_at_start(
    velocity: ArrayLike | None, acceleration: ArrayLike | None, shape: tuple[int, ...]
) -> dict[str, Array]:
    """Check the rates (n,) at the start, those that are given."""
    moving = {}
    for what, values in (("start_velocity", velocity), ("start_acceleration", acceleration)):
        if values is not None:
            moving[what] = joint_values(what, values, shape)
            check_numbers(what, moving[what])
    return moving


def _check_at_rest(profile: str, moving: dict[str, Array]) -> None:
    able = [name for name, method in sorted(PROFILES.items()) if method.STARTS_MOVING]
    for what, values in moving.items():
        if values.any():
            expected = f"zero, for {profile.lower()} starts from rest ({', '.join(able)} need not)"
            raise BadValueError(what, values.tolist(), expected)
