"""Decoding of PlanJoint requests, encoding of plans, and the path that a plan lets the tip take."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from numpy.typing import NDArray
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import PlanJoint
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import tip_poses
from robomech_ros.nodes.conversions import (
    TrajectoryPoints,
    duration_from_seconds,
    fill_pose,
    floats,
    joint_trajectory,
    seconds_from_duration,
)
from robomech_ros.nodes.planning import check_duration, check_waypoints
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import VIA_PROFILES, Limits, SampledPlan, Waypoints

__all__ = [
    "OFFERED",
    "SHORTEST_PERIOD",
    "TipPath",
    "encode_plan",
    "encode_waypoints",
    "plan_options",
    "profile_name",
    "via_points",
    "wanted_period",
]

# Between samples nearer than this (s) the jerk drowns in the rounding of the positions.
SHORTEST_PERIOD = 1e-4
# Pose messages that are kept from one path to the next, 2 kB each.
_POSES_KEPT = 2000

_NAMES = {
    getattr(PlanJoint.Request, name): name
    for name in ("POLY345", "POLY4567", "CYCLOIDAL", "CUBIC_SPLINE", "RUCKIG", "TIME_OPTIMAL")
}
# The profiles a request may ask for, with their numbers, in words.
OFFERED = ", ".join(f"{name} ({number})" for number, name in _NAMES.items())
_SCALES = ("velocity_scale", "acceleration_scale", "jerk_scale")


def profile_name(number: int) -> str:
    """Give the name in `PROFILES` of a profile's number in a request.

    Raises
    ------
    BadValueError
        There is no such profile; those there are get listed.
    """
    name = _NAMES.get(number)
    if name is None:
        raise BadValueError("profile", number, f"one of {OFFERED}")
    return name.lower()


def plan_options(request: Any, max_duration: float) -> dict[str, Any]:
    """Read what a PlanJoint request wants as keywords of `through_points`.

    Parameters
    ----------
    request : PlanJoint.Request
        Its zeros stand for defaults.
    max_duration : float
        Longest trajectory (s).

    Raises
    ------
    BadValueError, NonFiniteError
        An unknown profile, via points it does not take, a value out of range.
    """
    options: dict[str, Any] = {"profile": profile_name(request.profile)}
    if request.via and options["profile"] not in VIA_PROFILES:
        able = ", ".join(name.upper() for name in VIA_PROFILES)
        expected = f"none for {_NAMES[request.profile]}; {able} take some"
        raise BadValueError("via", f"{len(request.via)} points", expected)
    options["duration"] = seconds_from_duration(request.duration, "duration") or None
    check_duration(options["duration"] or 0.0, max_duration)
    options["at"] = _instants(request, options["duration"])
    return options | {name: getattr(request, name) or 1.0 for name in _SCALES}


def via_points(request: Any, limits: Limits, most: int) -> NDArray[np.float64]:
    """Read the points to pass on the way, shape (m, n).

    Parameters
    ----------
    request : PlanJoint.Request
    limits : Limits
        Of n joints.
    most : int
        How many there may be.

    Raises
    ------
    WrongSizeError, NonFiniteError
        More than ``most`` points, or one that has not a finite position for each joint.
    BadValueError
        A point states velocities, accelerations or efforts: they follow from the profile.
    LimitExceededError
        A point is outside the position limits.
    """
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
    return points


def _instants(request: Any, duration: float | None) -> list[float] | None:
    """Read which part of the duration is over at each via point; None where none says."""
    seconds = [
        seconds_from_duration(point.time_from_start, f"via[{k}].time_from_start")
        for k, point in enumerate(request.via)
    ]
    if not any(seconds):
        return None
    if duration is None:
        expected = "0, or a duration of the motion as well"
        raise BadValueError("via[0].time_from_start", seconds[0], expected)
    return [instant / duration for instant in seconds]


def wanted_period(request: Any) -> float:
    """Read the largest time between two points (s) that a PlanJoint request wants; 0 = any.

    Raises
    ------
    BadValueError, NonFiniteError
        It is negative, too short, or no number.
    """
    seconds: float = request.sample_period
    if not np.isfinite(seconds):
        raise NonFiniteError("sample_period", seconds)
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
    response.trajectory = encode_waypoints(points, limits.joint_names, messages)
    response.duration = duration_from_seconds(float(points.times[-1]))
    velocity, acceleration, jerk = (options[name] for name in _SCALES)
    response.peak_velocity_ratio = floats(peaks.peak_velocity_ratio * velocity)
    response.peak_acceleration_ratio = floats(peaks.peak_acceleration_ratio * acceleration)
    if np.isfinite(limits.jerk).any():
        response.peak_jerk_ratio = floats(peaks.peak_jerk_ratio * jerk)
    return response


def encode_waypoints(
    points: Waypoints, joint_names: Sequence[str], messages: TrajectoryPoints
) -> JointTrajectory:
    """Make the trajectory message of waypoints that have velocities and accelerations."""
    assert points.velocities is not None
    assert points.accelerations is not None
    return joint_trajectory(
        joint_names,
        points.times,
        points.positions,
        points.velocities,
        points.accelerations,
        messages,
    )


class TipPath:
    """The path of the tip in the base link, for one plan after the other.

    Pose messages are used again: to make one takes longer than to fill it, and a message that is
    published has been copied.

    Parameters
    ----------
    chain : SerialChain
        n joints.
    """

    def __init__(self, chain: SerialChain) -> None:
        self._chain = chain
        self._poses: list[PoseStamped] = []

    def along(self, positions: NDArray[np.float64]) -> Path:
        """Make the path of m poses, of stamp 0, for joint values (rad or m) of shape (m, n).

        It holds until the next one is made.
        """
        transforms = tip_poses(self._chain, positions)
        new = [PoseStamped() for _ in range(len(transforms) - len(self._poses))]
        for message in new:
            message.header.frame_id = self._chain.base
        poses = self._poses[: len(transforms)] + new
        for message, T in zip(poses, transforms, strict=True):
            fill_pose(message.pose, T)
        self._poses += new[: max(0, _POSES_KEPT - len(self._poses))]
        path = Path(poses=poses)
        path.header.frame_id = self._chain.base
        return path
