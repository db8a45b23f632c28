"""Decoding of PlanJoint requests, and encoding of plans."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import PlanJoint
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.joints.plan_settings import SHORTEST_PERIOD
from robomech_ros.nodes.common.messages.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.messages.message_fields import (
    check_waypoints,
    duration_from_seconds,
    finite_number,
    floats,
    seconds_from_duration,
)
from robomech_ros.nodes.trajectory_planner.settings import PlannerSettings
from robomech_ros.trajectory import VIA_PROFILES, Limits, SampledPlan, Waypoints
from robomech_ros.trajectory.plans.fitting_plan import check_duration
from robomech_ros.trajectory.plans.point_to_point import both_within
from robomech_ros.trajectory.plans.via_polynomials import MOST_VIAS
from robomech_ros.typing import Array

# The profiles by their numbers, which are the same in both services.
PROFILE_NAMES = {
    getattr(PlanJoint.Request, name): name
    for name in ("POLY345", "POLY4567", "CYCLOIDAL", "CUBIC_SPLINE", "RUCKIG", "TIME_OPTIMAL")
}
# The profiles a request may ask for, with their numbers, in words.
OFFERED = ", ".join(f"{name} ({number})" for number, name in PROFILE_NAMES.items())
# The profiles that pass a few points, and any number.
_MOST_VIAS = {"poly345": MOST_VIAS, "poly4567": MOST_VIAS}
_ANY_VIAS = [name for name in VIA_PROFILES if name not in _MOST_VIAS]
# Those that find the instants at which points are passed themselves.
_OWN_INSTANTS = ("ruckig", "time_optimal")
_SCALES = ("velocity_scale", "acceleration_scale", "jerk_scale")


def read_plan_request(
    request: Any, limits: Limits, settings: PlannerSettings
) -> tuple[Array, dict[str, Any]]:
    """Read a PlanJoint request except its start and goal.

    - ``request``: PlanJoint.Request; its zeros stand for defaults.
    - ``limits``: limits of n joints.
    - ``settings``: gives max_duration, max_waypoints and limit_margin.

    Returns the points (m, n) to pass on the way (rad or m), and keywords of `fitting_plan`:
    `wanted_period`, and those of `through_points`.

    Raises RobomechError: an unknown profile, via points that it does not take or that are invalid,
    a value out of range.
    """
    options = _plan_options(request, settings.max_duration)
    options |= {name: options[name] * (1.0 - settings.limit_margin) for name in _SCALES}
    via = _via_points(request, limits, settings.max_waypoints)
    return via, options | {"wanted_period": _wanted_period(request)}


def named(what: str, number: int, names: Mapping[int, str]) -> str:
    """Return the name of a number in a request, in small letters; refuse others by those known."""
    name = names.get(number)
    if name is None:
        offered = ", ".join(f"{known} ({n})" for n, known in names.items())
        raise BadValueError(what, number, f"one of {offered}")
    return name.lower()


def _plan_options(request: Any, max_duration: float) -> dict[str, Any]:
    """Read what a PlanJoint request wants as keywords of `through_points`; zeros are defaults."""
    options: dict[str, Any] = {"profile": named("profile", request.profile, PROFILE_NAMES)}
    profile, count = PROFILE_NAMES[request.profile], len(request.via)
    if count and options["profile"] not in VIA_PROFILES:
        able = ", ".join(name.upper() for name in VIA_PROFILES)
        expected = f"none for {profile}; {able} take some"
        raise BadValueError("via", counted(count, "point"), expected)
    if count > _MOST_VIAS.get(options["profile"], count):
        able = ", ".join(name for name in PROFILE_NAMES.values() if name.lower() in _ANY_VIAS)
        expected = f"at most {MOST_VIAS} points for {profile}; {able} take more"
        raise BadValueError("via", counted(count, "point"), expected)
    options["duration"] = seconds_from_duration(request.duration, "duration") or None
    check_duration(options["duration"] or 0.0, max_duration)
    options["at"] = _instants(request, options["profile"], options["duration"])
    return options | {name: getattr(request, name) or 1.0 for name in _SCALES}


def _via_points(request: Any, limits: Limits, most: int) -> Array:
    """Read the points to pass on the way, shape (m, n): at most `most` of n positions each."""
    check_waypoints("via", len(request.via), most)
    n = len(limits.joint_names)
    points = np.empty((len(request.via), n))
    for k, point in enumerate(request.via):
        for what in ("velocities", "accelerations", "effort"):
            if getattr(point, what):
                raise BadValueError(f"via[{k}].{what}", list(getattr(point, what)), "none")
        if len(point.positions) != n:
            raise WrongSizeError(f"via[{k}].positions", len(point.positions), n)
        points[k] = point.positions
        if not np.isfinite(points[k]).all():
            raise NonFiniteError(f"via[{k}].positions", points[k])
        limits.check_goal(points[k], f"via[{k}].positions")
        _check_size(points[k], f"via[{k}].positions", limits)
    return points


def plan_points(start: Array, via: Array, goal: Array, limits: Limits) -> Array:
    """Put start (n,), via points (m, n) and goal (n,), rad or m, together.

    Raises SeedOutsideLimitsError, LimitExceededError, BadValueError: start or goal is outside the
    position limits, or beyond all sense.
    """
    points = np.concatenate([start[None], via, goal[None]])
    if not both_within(start, goal, limits.ranges):
        limits.check_start(start)
        limits.check_goal(goal)
        _check_size(start, "start", limits)
        _check_size(goal, "goal", limits)
    return points


def _check_size(values: Array, what: str, limits: Limits) -> None:
    """Refuse positions (n,) of joints without limits with which nothing can be computed."""
    k = int(np.argmax(np.abs(values)))
    if abs(values[k]) > LARGEST_LENGTH:
        name, expected = limits.joint_names[k], f"a magnitude of at most {LARGEST_LENGTH:g}"
        raise BadValueError(f"{what} of joint '{name}'", float(values[k]), expected)


def _instants(request: Any, profile: str, duration: float | None) -> list[float] | None:
    """Read which part of the duration is over at each via point; None where none says."""
    if not request.via:
        return None
    names = [f"via[{k}].time_from_start" for k in range(len(request.via))]
    seconds = [
        seconds_from_duration(point.time_from_start, name)
        for point, name in zip(request.via, names, strict=True)
    ]
    if not any(seconds):
        return None
    first = next(k for k, instant in enumerate(seconds) if instant)
    if profile in _OWN_INSTANTS:
        expected = f"0: {profile.upper()} finds the instants itself"
        raise BadValueError(names[first], seconds[first], expected)
    if duration is None:
        expected = "0, or a duration of the motion as well"
        raise BadValueError(names[first], seconds[first], expected)
    for name, before, instant in zip(names, [0.0, *seconds], seconds, strict=False):
        if not before < instant < duration:
            expected = f"more than {before:.9g} s and less than the duration, {duration:.9g} s"
            raise BadValueError(name, instant, f"{expected}; or 0 at all via points")
    return [instant / duration for instant in seconds]


def _wanted_period(request: Any) -> float:
    """Read the largest time between two points (s) that a request wants; 0 = any."""
    seconds = finite_number("sample_period", request.sample_period)
    if seconds and seconds < SHORTEST_PERIOD:
        expected = f"at least {SHORTEST_PERIOD:g} s, or 0 for the default"
        raise BadValueError("sample_period", seconds, expected)
    return seconds


def encode_plan(
    plan: SampledPlan,
    limits: Limits,
    options: dict[str, Any],
    messages: TrajectoryPoints,
    response: Any,
) -> Any:
    """Fill a PlanJoint response; ratios are relative to the limits of the joints, not scaled."""
    points, peaks = plan.waypoints, plan.verification
    encode_waypoints(points, limits.joint_names, messages, response.trajectory)
    response.duration = duration_from_seconds(float(points.times[-1]))
    velocity, acceleration, jerk = (options[name] for name in _SCALES)
    response.peak_velocity_ratio = floats(peaks.peak_velocity_ratio * velocity)
    response.peak_acceleration_ratio = floats(peaks.peak_acceleration_ratio * acceleration)
    if np.isfinite(limits.jerk).any():
        response.peak_jerk_ratio = floats(peaks.peak_jerk_ratio * jerk)
    return response


def encode_waypoints(
    points: Waypoints, names: Sequence[str], messages: TrajectoryPoints, trajectory: JointTrajectory
) -> None:
    """Fill the trajectory message of waypoints that have velocities and accelerations."""
    rates: Any = points.velocities, points.accelerations
    trajectory.joint_names = list(names)
    trajectory.points = messages.filled(points.times, points.positions, *rates)
