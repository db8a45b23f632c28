"""Decoding of PlanCartesian requests, and encoding of their answers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomech_interfaces.srv import PlanCartesian
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.cartesian import CartesianPlan, PathStopLimits, waypoint_path
from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.messages.message_fields import check_waypoints, finite_number
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.frames.robot_frames import Positions, RobotFrames
from robomech_ros.nodes.trajectory_planner.plan_messages import (
    PROFILE_NAMES,
    encode_waypoints,
    named,
)
from robomech_ros.nodes.trajectory_planner.settings import PlannerSettings
from robomech_ros.trajectory import PosePath, TipSpeeds
from robomech_ros.typing import Array

_KINDS = {getattr(PlanCartesian.Request, name): name for name in ("STRAIGHT", "SPLINE", "ARC")}
# Slower motions would take years; finer steps would fill the memory.
_LEAST = {"max_linear_speed": 1e-6, "max_angular_speed": 1e-6, "max_step": 1e-5}
# The largest speeds of the tip; zeros stand for none.
_MOST = {"max_linear_speed": LARGEST_LENGTH, "max_angular_speed": LARGEST_LENGTH}
_AT_SINGULARITY = {PlanCartesian.Request.STOP: "STOP", PlanCartesian.Request.SLOW: "SLOW"}


@dataclass(frozen=True, eq=False)
class PathRequest:
    """Content of a PlanCartesian request, apart from its start."""

    waypoints: Array  #: Poses (m), shape (m, 4, 4).
    kind: Any  #: str; of the path, as `waypoint_path` knows it.
    options: dict[str, Any]  #: Keywords of `plan_along`.

    def path_from(self, pose: Array) -> PosePath:
        """Lay the path from a pose (4, 4); refuse waypoints that all are that pose."""
        path = waypoint_path(pose, self.waypoints, self.kind, self.options["task_mask"])
        if path is None:
            found = f"{counted(len(self.waypoints), 'pose')} equal to the start"
            raise BadValueError("waypoints", found, "at least one other pose")
        return path


def read_path_request(request: Any, settings: PlannerSettings) -> PathRequest:
    """Read a PlanCartesian request except its start; the waypoints stay in their frames.

    - ``request``: PlanCartesian.Request; its zeros stand for the parameters of the same names, and
      for no speed limits.

    Raises RobomechError: an unknown kind of path or profile, a value out of range, a pose that is
    none.
    """
    options = {
        "profile": named("profile", request.profile, PROFILE_NAMES),
        "speeds": TipSpeeds(*(_positive(request, name) or math.inf for name in _MOST)),
        "task_mask": [bool(held) for held in request.task_mask],
        "bounds": _path_bounds(request, settings),
    }
    waypoints = _waypoint_poses(request, settings.max_waypoints)
    return PathRequest(waypoints, named("path", request.path, _KINDS), options)


async def in_base(
    asked: PathRequest, request: Any, frames: RobotFrames, at: Positions, patience: float
) -> PathRequest:
    """Return a request with its waypoints in the base.

    - ``asked``: request with waypoints in the frames that the message names.
    - ``request``: the message, a PlanCartesian.Request.
    - ``at``: positions of the joints at the start (rad or m), which place the links.
    - ``patience``: longest wait for each frame (s).

    Raises FrameUnavailableError, NoStateError, BadValueError: a frame is not known, or puts a
    waypoint too far away.
    """
    poses = asked.waypoints.copy()
    for k, waypoint in enumerate(request.waypoints):
        frame, stamp = waypoint.header.frame_id, waypoint.header.stamp
        pose = await frames.in_base(frame, patience, stamp, at)
        poses[k] = pose @ poses[k]
        _check_near(k, poses[k])
    return replace(asked, waypoints=poses)


def _waypoint_poses(request: Any, most: int) -> Array:
    """Read the waypoints in their frames, shape (m, 4, 4), `most` at most."""
    check_waypoints("waypoints", len(request.waypoints), most)
    poses = np.empty((len(request.waypoints), 4, 4))
    for k, waypoint in enumerate(request.waypoints):
        poses[k] = matrix_from_pose(waypoint.pose, f"waypoints[{k}]")
        _check_near(k, poses[k])
    return poses


def _check_near(k: int, pose: Array) -> None:
    far = float(np.abs(pose[:3, 3]).max())
    if far > LARGEST_LENGTH:
        expected = f"coordinates of at most {LARGEST_LENGTH:g} m"
        raise BadValueError(f"waypoints[{k}].position", far, expected)


def _path_bounds(request: Any, settings: PlannerSettings) -> PathStopLimits:
    """Read what ends a path; zeros stand for the node's parameters of the same names."""
    named("at_singularity", request.at_singularity, _AT_SINGULARITY)
    names = ("condition_limit", "max_step", "revolute_jump_threshold", "prismatic_jump_threshold")
    bounds = (_positive(request, name) or getattr(settings, name) for name in names)
    condition, step, revolute, prismatic = bounds
    if request.at_singularity == PlanCartesian.Request.SLOW:
        condition = math.inf
    return PathStopLimits(condition, step, revolute, prismatic)


def _positive(request: Any, name: str) -> float:
    value = finite_number(name, getattr(request, name))
    least = _LEAST.get(name, 0.0)
    if (value and not value >= least) or value < 0.0:
        expected = f"at least {least:g}" if least else "a positive number"
        raise BadValueError(name, value, f"{expected}, or 0 for the default")
    most = _MOST.get(name, math.inf)
    if value > most:
        raise BadValueError(name, value, f"at most {most:g}, or 0 for no limit of its own")
    return value


def encode_path_plan(
    plan: CartesianPlan,
    wanted: PathRequest,
    joint_names: Sequence[str],
    messages: TrajectoryPoints,
    response: Any,
) -> Any:
    """Fill a PlanCartesian response with what can be followed, and why not more."""
    if plan.samples is not None:
        encode_waypoints(plan.samples, joint_names, messages, response.trajectory)
    response.fraction, stop = float(plan.fraction), plan.stop
    response.stop_index = len(wanted.waypoints) if stop is None else stop.index
    if stop is None:
        return answer(response)
    response.stop_reason = stop.text
    part = f"{100.0 * plan.fraction:.4g} % of the path"
    return answer(response, stop.kind.code, f"{part}: {stop.text}")
