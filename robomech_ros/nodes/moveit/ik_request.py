"""Requests of compute_ik, read and checked field by field."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any, NamedTuple

from moveit_msgs.msg import MoveItErrorCodes

from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.messages.message_fields import seconds_from_duration
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.moveit.constraints import Conditions, frames_of
from robomech_ros.nodes.moveit.serving import RejectedError, chain_of, refused_as
from robomech_ros.nodes.moveit.whole_robot import Positions, WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array


class IkTarget(NamedTuple):
    """The wanted pose of one link."""

    chain: SerialChain  #: Chain from its base to the link.
    pose: Array  #: ``T_base_link`` in the base of the chain (m), shape (4, 4).


@dataclass(frozen=True)
class IkRequest:
    """Checked content of an inverse kinematics request."""

    targets: tuple[IkTarget, ...]  #: Targets of chains without common joints.
    positions: Positions  #: Positions of all joints (rad or m).
    conditions: Conditions  #: Conditions on the answer.
    timeout: float | None  #: Longest search (s); None for no limit.


async def read_ik_request(request: Any, robot: WholeRobot, patience: float) -> IkRequest:
    """Read a request.

    - ``request``: PositionIKRequest.
    - ``patience``: how long to wait for the present state and for frames (s).

    Raises RejectedError: the node cannot serve a part of the request; the code says which.
    """
    links, wanted = _links_and_poses(request, len(robot.joint_names))
    chains = [chain_of(robot.model, request.group_name, link) for link in links]
    _check_apart(chains, robot)
    frames = [pose.header.frame_id for pose in wanted]
    with refused_as(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS):
        poses = [matrix_from_pose(pose.pose, "pose_stamped.pose") for pose in wanted]
        named = [*frames, *frames_of(request.constraints)]
        places = await robot.places(named, patience)
        conditions = Conditions(request.constraints, robot, places)
    with refused_as(MoveItErrorCodes.INVALID_ROBOT_STATE):
        given = robot.read(request.robot_state)
        # What a difference leaves out must be known, and what a condition is about; else a seed is
        # a hint, of which the middle of the range is as good as any.
        relative = request.robot_state.is_diff and bool(given)
        solved = {name for chain in chains for name in chain.joint_names}
        to_bases = [name for chain in chains for name in robot.joints_to_base_of(chain)]
        needed = robot.joint_names if relative else (*conditions.joints, *to_bases)
        needed = [name for name in needed if relative or name not in solved]
        moving = [name for frame in frames for name in places[frame].joint_names]
        needed = list(dict.fromkeys([*needed, *moving]))
        positions = await robot.with_needed(given, needed, patience)
    with refused_as(MoveItErrorCodes.FAILURE):
        timeout = seconds_from_duration(request.timeout, "timeout") or None
    positions = robot.with_defaults(positions)
    targets = []
    for chain, T, frame in zip(chains, poses, frames, strict=True):
        pose = places[frame].pose(positions) @ T
        targets.append(IkTarget(chain, robot.in_base_of(chain, pose, positions)))
    return IkRequest(tuple(targets), positions, conditions, timeout)


def _links_and_poses(request: Any, most: int) -> tuple[list[str], list[Any]]:
    """Find the links of a request and their wanted poses, no more than joints."""
    poses = list(request.pose_stamped_vector) or [request.pose_stamped]
    links = list(request.ik_link_names) or [request.ik_link_name]
    if len(links) != len(poses):
        count = counted(len(links), "link")
        reason = f"{count} in ik_link_names, expected one per pose: {len(poses)}"
        raise RejectedError(MoveItErrorCodes.INVALID_LINK_NAME, reason)
    if len(poses) > most:
        reason = f"pose_stamped_vector has {len(poses)} poses, expected at most one a joint: {most}"
        raise RejectedError(MoveItErrorCodes.INVALID_LINK_NAME, reason)
    return links, poses


def _check_apart(chains: Sequence[SerialChain], robot: WholeRobot) -> None:
    """Refuse links of which one moves with the joints of another: each has a tip of its own."""
    for one, other in permutations(chains, 2):
        moving = (*other.joint_names, *robot.joints_to_base_of(other))
        shared = next((name for name in moving if name in one.joint_names), None)
        if shared is not None:
            reason = (
                f"ik_link_names: joint '{shared}' moves both '{one.tip}' and '{other.tip}', "
                "expected links that have no joint in common"
            )
            raise RejectedError(MoveItErrorCodes.INVALID_LINK_NAME, reason)
