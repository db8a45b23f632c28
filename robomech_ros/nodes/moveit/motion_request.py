"""Requests for a motion to a goal, read and checked field by field."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from geometry_msgs.msg import Pose
from moveit_msgs.msg import MoveItErrorCodes
from shape_msgs.msg import SolidPrimitive

from robomech_ros.collision.libraries import PLANNERS
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.messages.message_fields import finite_number, not_negative
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, point_vector
from robomech_ros.nodes.frames.robot_frames import FrameAttachment
from robomech_ros.nodes.moveit.cartesian_request import ChainRequest, read_scale
from robomech_ros.nodes.moveit.constraints import Conditions, frames_of
from robomech_ros.nodes.moveit.serving import RejectedError, chain_of, refused_as
from robomech_ros.nodes.moveit.whole_robot import Positions, WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# The one pipeline of planners.
PIPELINE = "ompl"
_INVALID = MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS


@dataclass(frozen=True, eq=False)
class PoseTarget:
    """The pose of a link that a goal asks for.

    - ``position_tolerance``, ``orientation_tolerance``: how far the link may be from the pose, m
      and rad; 0 for the solver's default.
    """

    chain: SerialChain  #: Chain from its base to the link.
    pose: Array  #: ``T_base_link`` in the base of the chain (m), shape (4, 4).
    #: Which components of the pose count, x y z rx ry rz in the axes of the pose.
    task_mask: tuple[bool, ...]
    position_tolerance: float
    orientation_tolerance: float


@dataclass(frozen=True, eq=False)
class MotionGoal:
    """One set of goal constraints."""

    joints: Positions  #: Wanted positions of joints (rad or m).
    target: PoseTarget | None  #: The wanted pose of a link.
    conditions: Conditions  #: All constraints of the set.


@dataclass(frozen=True, eq=False)
class MotionRequest(ChainRequest):
    """Checked content of a MotionPlanRequest."""

    goals: tuple[MotionGoal, ...]  #: Alternatives; the motion reaches one.
    time: float  #: Time allowed for planning (s).
    planner: str  #: Name of a planner; empty for the default.


async def read_motion_request(request: Any, robot: WholeRobot, settings: Any) -> MotionRequest:
    """Read a request.

    - ``request``: MotionPlanRequest.
    - ``settings``: MoveGroupSettings.

    Raises RejectedError: the node cannot serve a part of the request; the code says which.
    """
    chain = chain_of(robot.model, request.group_name, "")
    _refuse_unserved(request)
    with refused_as(MoveItErrorCodes.FAILURE):
        expected = "a time that is not negative (s), or 0 for the default"
        time = not_negative("allowed_planning_time", request.allowed_planning_time, expected)
        speed = finite_number("max_cartesian_speed", request.max_cartesian_speed)
        planner = _planner(request)
        scales = [
            read_scale(request, f"max_{what}_scaling_factor")
            for what in ("velocity", "acceleration")
        ]
    slow = request.cartesian_speed_limited_link
    limited = chain_of(robot.model, "", slow) if speed > 0.0 and slow else chain
    frames = [frame for goal in request.goal_constraints for frame in frames_of(goal)]
    to_links = [
        _chain_to_link(goal, robot, request.group_name, chain, f"goal_constraints[{i}]")
        for i, goal in enumerate(request.goal_constraints)
    ]
    with refused_as(_INVALID):
        places = await robot.places(frames, settings.state_timeout)
        conditions = [
            Conditions(goal, robot, places, f"goal_constraints[{i}]")
            for i, goal in enumerate(request.goal_constraints)
        ]
    with refused_as(MoveItErrorCodes.START_STATE_INVALID):
        joints = (
            *chain.joint_names,
            *limited.joint_names,
            *(name for one in conditions for name in one.joints),
            *robot.joints_to_base_of(chain),
        )
        positions = await robot.start(request.start_state, joints, settings)
    with refused_as(_INVALID):
        goals = [
            MotionGoal(
                _wanted_joints(goal, chain, f"goal_constraints[{i}]"),
                _target(goal, robot, to_links[i], places, positions, f"goal_constraints[{i}]"),
                conditions[i],
            )
            for i, goal in enumerate(request.goal_constraints)
        ]
    return MotionRequest(
        chain=chain,
        positions=positions,
        goals=tuple(goals),
        velocity_scale=scales[0],
        acceleration_scale=scales[1],
        limited=limited,
        speed=speed if speed > 0.0 else math.inf,
        time=time or settings.planning_time,
        planner=planner,
    )


def _planner(request: Any) -> str:
    """Return the name of the planner in OMPL; empty for the default.

    MoveIt's names of configurations, such as RRTConnectkConfigDefault, mean their planners.
    """
    if request.pipeline_id not in ("", PIPELINE):
        expected = f"'{PIPELINE}', or empty for the default"
        raise BadValueError("pipeline_id", request.pipeline_id, expected)
    name = request.planner_id.removeprefix("geometric::").removesuffix("kConfigDefault")
    if name and name not in PLANNERS:
        expected = f"one of {', '.join(PLANNERS)}, or empty for the default"
        raise BadValueError("planner_id", request.planner_id, expected)
    return name


def _refuse_unserved(request: Any) -> None:
    """Refuse what this planner does not do, by name."""
    if not request.goal_constraints:
        raise RejectedError(_INVALID, "goal_constraints is empty, expected at least one goal")
    unserved = {
        f"path_constraints.{kind}_constraints": getattr(
            request.path_constraints, f"{kind}_constraints"
        )
        for kind in ("joint", "position", "orientation", "visibility")
    }
    unserved["trajectory_constraints"] = request.trajectory_constraints.constraints
    unserved["reference_trajectories"] = request.reference_trajectories
    for name, listed in unserved.items():
        if listed:
            raise RejectedError(
                _INVALID,
                f"{name} has length {len(listed)}, expected an empty list: no motion to a goal can "
                "be planned with them; compute_cartesian_path accepts path_constraints",
            )


def _wanted_joints(goal: Any, chain: SerialChain, what: str) -> dict[str, float]:
    """Return the positions of joints that a goal names; of a range the middle."""
    wanted = {}
    for i, one in enumerate(goal.joint_constraints):
        if one.joint_name not in chain.joint_names:
            expected = f"a joint of the group: {', '.join(chain.joint_names)}"
            name = f"{what}.joint_constraints[{i}].joint_name"
            raise BadValueError(name, one.joint_name, expected)
        wanted[one.joint_name] = one.position + 0.5 * (one.tolerance_above - one.tolerance_below)
    return wanted


def _chain_to_link(
    goal: Any, robot: WholeRobot, group: str, whole: SerialChain, what: str
) -> SerialChain | None:
    """Return the chain to the link whose pose a goal is about; None if there is none.

    Raises RejectedError: the goal is about several links, or about one behind joints that do not
    move.
    """
    regions, turns = goal.position_constraints, goal.orientation_constraints
    with refused_as(_INVALID):
        for name, listed in (("position", regions), ("orientation", turns)):
            if len(listed) > 1:
                expected = "at most one"
                raise BadValueError(f"{what}.{name}_constraints", len(listed), expected)
        links = [one.link_name for one in (*regions, *turns)]
        if len(set(links)) > 1:
            name = f"{what}.orientation_constraints[0].link_name"
            raise BadValueError(name, links[1], f"'{links[0]}', the link of the position")
    if not links:
        return None
    chain = chain_of(robot.model, group, links[0])
    beyond = [name for name in chain.joint_names if name not in whole.joint_names]
    if beyond:
        reason = f"link '{links[0]}' is moved by joint '{beyond[0]}', which is not of the group"
        raise RejectedError(MoveItErrorCodes.INVALID_LINK_NAME, f"{what}: {reason}")
    return chain


def _target(
    goal: Any,
    robot: WholeRobot,
    chain: SerialChain | None,
    places: Mapping[str, FrameAttachment],
    positions: Positions,
    what: str,
) -> PoseTarget | None:
    """Return the pose that a goal asks for: the middle of its region and its orientation."""
    if chain is None:
        return None
    pose, near, angle = np.eye(4), 0.0, 0.0
    free = np.ones(6, dtype=bool)
    for one in goal.orientation_constraints:
        T = matrix_from_pose(
            Pose(orientation=one.orientation), f"{what}.orientation_constraints[0]"
        )
        frame = places[one.header.frame_id].pose(positions)
        pose[:3, :3] = (frame @ T)[:3, :3]
        most = np.array([getattr(one, f"absolute_{axis}_axis_tolerance") for axis in "xyz"])
        free[3:] = most >= math.pi
        angle = float(most.min())
    for one in goal.position_constraints:
        offset = point_vector(one.target_point_offset, f"{what}: target_point_offset")
        if offset.any() and free[3:].any():
            expected = "zero without the orientation of the link"
            raise BadValueError(f"{what}: target_point_offset", offset.tolist(), expected)
        region = one.constraint_region
        T = matrix_from_pose(region.primitive_poses[0], f"{what}: primitive_poses[0]")
        frame = places[one.header.frame_id].pose(positions)
        pose[:3, 3] = (frame @ T)[:3, 3] - pose[:3, :3] @ offset
        free[:3] = False
        near = _radius(region.primitives[0])
    in_base = robot.in_base_of(chain, pose, positions)
    return PoseTarget(chain, in_base, tuple((~free).tolist()), near, angle)


def _radius(shape: Any) -> float:
    """Return the radius (m) of the ball inside a primitive."""
    if shape.type == SolidPrimitive.BOX:
        return 0.5 * float(min(shape.dimensions))
    if shape.type == SolidPrimitive.CYLINDER:
        height, radius = shape.dimensions
        return float(min(0.5 * height, radius))
    return float(shape.dimensions[0])
