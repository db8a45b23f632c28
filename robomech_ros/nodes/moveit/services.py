"""compute_ik and compute_fk: what MoveIt's move_group answers, from the solvers of this package."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from moveit_msgs.msg import MoveItErrorCodes
from moveit_msgs.srv import GetPositionFK, GetPositionIK
from numpy.typing import NDArray
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.kinematics import InverseKinematicsResult, inverse_kinematics
from robomech_ros.nodes.common.deep_queues import serve
from robomech_ros.nodes.common.message_fields import seconds_from_duration
from robomech_ros.nodes.common.pauses import Turns
from robomech_ros.nodes.common.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.moveit.conditions import Conditions, frames_of
from robomech_ros.nodes.moveit.refusals import RefusedError, code_of_outcome, refused_as
from robomech_ros.nodes.moveit.serving import (
    answering,
    chain_of,
    refuse_collision_checks,
)
from robomech_ros.nodes.moveit.whole_robot import Positions, WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.spatial import inverse_pose

__all__ = ["MoveItServices"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Question:
    """A request of inverse kinematics, read and checked."""

    chain: SerialChain
    target: Array
    positions: Positions
    conditions: Conditions
    timeout: float | None


class MoveItServices:
    """The services compute_ik and compute_fk of one node.

    Parameters
    ----------
    node : Node
        Gets the services under its own name.
    robot : WholeRobot
    patience : callable
        Gives the time (s) that a request waits for the present state.
    check_size : callable
        Raises where there is more of something than the node handles at once.
    """

    def __init__(
        self,
        node: Node,
        robot: WholeRobot,
        patience: Callable[[], float],
        check_size: Callable[[str, int], None],
    ) -> None:
        self._node = node
        self._robot = robot
        self._patience = patience
        self._check_size = check_size
        for kind, name, callback in (
            (GetPositionIK, "~/compute_ik", self._compute_ik),
            (GetPositionFK, "~/compute_fk", self._compute_fk),
        ):
            group = ReentrantCallbackGroup()
            serve(node, kind, name, answering(node, callback), callback_group=group)

    async def _compute_ik(self, request: Any, response: Any) -> tuple[int, str]:
        question = await self._read(request.ik_request)
        result = self._solve(question)
        if not len(result):
            return code_of_outcome(result.status), result.reason
        positions, broken = _first_that_holds(question, result)
        if broken:
            return MoveItErrorCodes.NO_IK_SOLUTION, broken
        response.solution.joint_state = self._robot.state(positions)
        frame = self._robot.model.base_frame
        response.solution.multi_dof_joint_state.header.frame_id = frame
        return MoveItErrorCodes.SUCCESS, result.reason

    async def _read(self, request: Any) -> _Question:
        link, pose = _one_pose(request)
        chain = chain_of(self._robot.model, request.group_name, link)
        refuse_collision_checks(request)
        frame = pose.header.frame_id
        with refused_as(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS):
            T = matrix_from_pose(pose.pose, "pose_stamped.pose")
            named = [frame, *frames_of(request.constraints)]
            places = await self._robot.places(named, self._patience())
            conditions = Conditions(request.constraints, self._robot, places)
        with refused_as(MoveItErrorCodes.INVALID_ROBOT_STATE):
            given = self._robot.read(request.robot_state)
            # What a difference leaves out must be known, and what a condition is about; else a
            # seed is a hint, of which the middle of the range is as good as any.
            relative = request.robot_state.is_diff and bool(given)
            to_base = self._robot.joints_to_base_of(chain)
            needed = self._robot.joint_names if relative else (*conditions.joints, *to_base)
            needed = [name for name in needed if relative or name not in chain.joint_names]
            needed += [name for name in places[frame].joint_names if name not in needed]
            positions = await self._robot.with_needed(given, needed, self._patience())
        with refused_as(MoveItErrorCodes.FAILURE):
            timeout = seconds_from_duration(request.timeout, "timeout") or None
        positions = self._robot.with_defaults(positions)
        in_base = places[frame].pose(positions)
        target = T if in_base is None else in_base @ T
        if chain.base != self._robot.model.chain.base:
            target = inverse_pose(self._robot.base_of(chain, positions)) @ target
        return _Question(chain, target, positions, conditions, timeout)

    @staticmethod
    def _solve(question: _Question) -> InverseKinematicsResult:
        chain = question.chain
        seed = np.array([question.positions[name] for name in chain.joint_names])
        # A robot at its stop reports positions beyond it; the seed says where to be near to.
        inside = np.clip(seed, chain.lower, chain.upper)
        judged = bool(question.conditions)
        return inverse_kinematics(
            chain,
            question.target,
            seed=inside,
            timeout=question.timeout,
            include_windings=judged,
            max_solutions=None if judged else 1,
        )

    async def _compute_fk(self, request: Any, response: Any) -> tuple[int, str]:
        names = request.fk_link_names
        if not names:
            return MoveItErrorCodes.INVALID_LINK_NAME, "fk_link_names is empty"
        with refused_as(MoveItErrorCodes.FAILURE):
            self._check_size("fk_link_names", len(names))
        with refused_as(MoveItErrorCodes.INVALID_ROBOT_STATE):
            frame, patience = request.header.frame_id, self._patience()
            place = (await self._robot.places([frame], patience))[frame]
            given = self._robot.read(request.robot_state)
            joints, faults = self._joints_to(dict.fromkeys(names))
            needed = dict.fromkeys(name for links in joints.values() for name in links)
            needed |= dict.fromkeys(place.joint_names)
            positions = await self._robot.with_needed(given, needed, patience)
        in_base = place.pose(positions)
        to_frame = np.eye(4) if in_base is None else inverse_pose(in_base)
        where, turns = self._robot.model.full_frame(frame), Turns(self._node)
        poses = {}
        for link in joints:
            poses[link] = stamped_pose(to_frame @ self._robot.pose(link, positions), where)
            await turns.end_if_over()
        response.fk_link_names = [link for link in names if link in poses]
        response.pose_stamped = [poses[link] for link in response.fk_link_names]
        if faults:
            return MoveItErrorCodes.INVALID_LINK_NAME, "; ".join(faults[:10])
        return MoveItErrorCodes.SUCCESS, ""

    def _joints_to(self, links: Any) -> tuple[dict[str, tuple[str, ...]], list[str]]:
        """Find the joints that move each link, and say what is wrong with those that have none."""
        joints, faults = {}, []
        for link in links:
            try:
                with refused_as(MoveItErrorCodes.INVALID_LINK_NAME):
                    joints[link] = self._robot.joints_to(link)
            except RefusedError as error:
                faults.append(error.reason)
        return joints, faults


def _first_that_holds(
    question: _Question, result: InverseKinematicsResult
) -> tuple[Positions, str]:
    """Find the nearest solution that breaks no condition, as positions of all joints.

    Where each breaks one, the text says what the nearest of all breaks; else it is empty.
    """
    first = ""
    for q in result.q.tolist():
        solved = zip(question.chain.joint_names, q, strict=True)
        positions = {**question.positions, **dict(solved)}
        broken = question.conditions.broken(positions)
        if not broken:
            return positions, ""
        first = first or broken
    found = f"all {len(result)}" if result.complete else f"the {len(result)} known"
    return {}, f"{found} solutions break a constraint; the nearest: {first}"


def _one_pose(request: Any) -> tuple[str, Any]:
    """Find the one link of a request and its wanted pose."""
    poses = list(request.pose_stamped_vector) or [request.pose_stamped]
    links = list(request.ik_link_names) or [request.ik_link_name]
    if len(links) != len(poses):
        reason = f"{len(links)} names in ik_link_names for {len(poses)} poses, expected one of each"
        raise RefusedError(MoveItErrorCodes.INVALID_LINK_NAME, reason)
    if len(poses) > 1:
        reason = f"pose_stamped_vector has {len(poses)} poses, expected one: the group has one tip"
        raise RefusedError(MoveItErrorCodes.INVALID_LINK_NAME, reason)
    return links[0], poses[0]
