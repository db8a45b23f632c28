"""Decoding of PlanCartesian requests, and encoding of what came of them."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanCartesian
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.nodes.common.cartesian_planning import FollowedPath, PathBounds
from robomech_ros.nodes.common.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.plan_sampling import check_waypoints
from robomech_ros.nodes.common.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.nodes.trajectory_planner.plan_messages import encode_waypoints
from robomech_ros.trajectory import SampledPlan, TipSpeeds

__all__ = ["encode_path_plan", "path_bounds", "path_profile", "tip_speeds", "waypoint_poses"]

_PROFILES = {
    getattr(PlanCartesian.Request, name): name.lower()
    for name in ("POLY345", "POLY4567", "CYCLOIDAL", "CUBIC_SPLINE", "RUCKIG", "TIME_OPTIMAL")
}
# Slower motions would take years; finer steps would fill the memory.
_LEAST = {"max_linear_speed": 1e-6, "max_angular_speed": 1e-6, "max_step": 1e-5}
_MOST = {"max_linear_speed": LARGEST_LENGTH, "max_angular_speed": LARGEST_LENGTH}
_AT_SINGULARITY = {PlanCartesian.Request.STOP: "STOP", PlanCartesian.Request.SLOW: "SLOW"}


def path_profile(number: int) -> str:
    """Give the name in `PATH_PROFILES` of a profile's number in a request.

    Raises
    ------
    BadValueError
        There is no such profile; those there are get listed.
    """
    name = _PROFILES.get(number)
    if name is None:
        offered = ", ".join(f"{known.upper()} ({n})" for n, known in _PROFILES.items())
        raise BadValueError("profile", number, f"one of {offered}")
    return name


def waypoint_poses(request: Any, model: RobotModel, most: int) -> NDArray[np.float64]:
    """Read the waypoints in the base, shape (m, 4, 4).

    Raises
    ------
    RobomechError
        More than ``most``, a frame that the base does not know, or a pose that is none.
    """
    check_waypoints("waypoints", len(request.waypoints), most)
    poses = np.empty((len(request.waypoints), 4, 4))
    for k, waypoint in enumerate(request.waypoints):
        frame = model.frame_in_base(waypoint.header.frame_id)
        pose = matrix_from_pose(waypoint.pose, f"waypoints[{k}]")
        far = float(np.abs(pose[:3, 3]).max())
        if far > LARGEST_LENGTH:
            expected = f"coordinates of at most {LARGEST_LENGTH:g} m"
            raise BadValueError(f"waypoints[{k}].position", far, expected)
        poses[k] = pose if frame is None else frame @ pose
    return poses


def path_bounds(request: Any, settings: Any) -> PathBounds:
    """Read what ends a path; zeros stand for the node's parameters of the same names.

    Raises
    ------
    BadValueError, NonFiniteError
        A number that is none or negative, or an unknown value of at_singularity.
    """
    if request.at_singularity not in _AT_SINGULARITY:
        known = ", ".join(f"{name} ({number})" for number, name in _AT_SINGULARITY.items())
        raise BadValueError("at_singularity", request.at_singularity, f"one of {known}")
    numbers = [
        _positive(request, name) or getattr(settings, name)
        for name in (
            "condition_limit",
            "max_step",
            "revolute_jump_threshold",
            "prismatic_jump_threshold",
        )
    ]
    if request.at_singularity == PlanCartesian.Request.SLOW:
        numbers[0] = math.inf
    return PathBounds(*numbers)


def tip_speeds(request: Any) -> TipSpeeds:
    """Read the largest speeds of the tip; zeros stand for none.

    Raises
    ------
    BadValueError, NonFiniteError
        A number that is none or negative.
    """
    linear, angular = (
        _positive(request, name) or math.inf for name in ("max_linear_speed", "max_angular_speed")
    )
    return TipSpeeds(linear, angular)


def _positive(request: Any, name: str) -> float:
    value = float(getattr(request, name))
    if not math.isfinite(value):
        raise NonFiniteError(name, value)
    least = _LEAST.get(name, 0.0)
    if (value and not value >= least) or value < 0.0:
        expected = f"at least {least:g}" if least else "a positive number"
        raise BadValueError(name, value, f"{expected}, or 0 for the default")
    most = _MOST.get(name, math.inf)
    if value > most:
        raise BadValueError(name, value, f"at most {most:g}, or 0 for no limit of its own")
    return value


def encode_path_plan(
    followed: FollowedPath,
    plan: SampledPlan | None,
    joint_names: Sequence[str],
    messages: TrajectoryPoints,
    response: Any,
) -> Any:
    """Fill a PlanCartesian response with what can be followed, and why not more."""
    if plan is not None:
        response.trajectory = encode_waypoints(plan.waypoints, joint_names, messages)
    response.fraction = float(followed.fraction)
    response.stop_index = followed.stop_index
    response.stop_reason = followed.tracking.reason
    response.error_code = followed.code
    if followed.code != ErrorCode.NONE:
        part = f"{100.0 * followed.fraction:.4g} % of the path"
        response.error_msg = f"{part}: {followed.tracking.reason}"
    return response
