"""compute_ik and compute_fk: what MoveIt's move_group answers, from the solvers of this package."""

import math
from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np
from moveit_msgs.msg import MoveItErrorCodes
from moveit_msgs.srv import GetPositionFK, GetPositionIK
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.errors import WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics import InverseKinematicsResult, inverse_kinematics
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.nodes.common.cooperative_wait import TimeSlices
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.moveit.ik_request import IkRequest, IkTarget, read_ik_request
from robomech_ros.nodes.moveit.serving import Collisions, RejectedError, answering, refused_as
from robomech_ros.nodes.moveit.whole_robot import Positions, WholeRobot
from robomech_ros.spatial import inverse_pose

# Combinations of solutions of several links that are tried, so that nobody waits for all.
_MOST_COMBINATIONS = 4096


class MoveItServices:
    """The services compute_ik and compute_fk of one node."""

    def __init__(
        self, node: Node, robot: WholeRobot, settings: Callable[[], Any], collisions: Collisions
    ) -> None:
        self._node, self._robot = node, robot
        self._settings, self._collisions = settings, collisions
        for kind, name, callback in (
            (GetPositionIK, "compute_ik", self._compute_ik),
            (GetPositionFK, "compute_fk", self._compute_fk),
        ):
            group = ReentrantCallbackGroup()
            serve(node, kind, name, answering(node, callback), callback_group=group)

    async def _compute_ik(self, request: Any, response: Any) -> tuple[int, str]:
        patience = self._settings().state_timeout
        question = await read_ik_request(request.ik_request, self._robot, patience)
        avoiding = request.ik_request.avoid_collisions
        contact = self._collisions.contact if avoiding else lambda positions: ""
        judged = avoiding or bool(question.conditions)
        results = [_solved(target, question, judged) for target in question.targets]
        for target, result in zip(question.targets, results, strict=True):
            if not len(result):
                which = f"link '{target.chain.tip}': " if len(results) > 1 else ""
                late = result.status == Status.TIMED_OUT
                code = MoveItErrorCodes.TIMED_OUT if late else MoveItErrorCodes.NO_IK_SOLUTION
                return code, f"{which}{result.reason}"
        positions, broken = _first_that_holds(question, results, contact)
        if broken:
            return MoveItErrorCodes.NO_IK_SOLUTION, broken
        response.solution.joint_state = self._robot.state(positions)
        frame = self._robot.model.base_frame
        response.solution.multi_dof_joint_state.header.frame_id = frame
        notes = [result.reason for result in results]
        notes += [self._collisions.unchecked] if avoiding else []
        return MoveItErrorCodes.SUCCESS, "; ".join(filter(None, notes))

    async def _compute_fk(self, request: Any, response: Any) -> tuple[int, str]:
        names = request.fk_link_names
        if not names:
            return MoveItErrorCodes.INVALID_LINK_NAME, "fk_link_names is empty"
        with refused_as(MoveItErrorCodes.FAILURE):
            most = self._settings().max_links
            if len(names) > most:
                expected = f"at most {most}, the parameter max_links"
                raise WrongSizeError("fk_link_names", len(names), expected)
        with refused_as(MoveItErrorCodes.INVALID_ROBOT_STATE):
            frame, patience = request.header.frame_id, self._settings().state_timeout
            place = (await self._robot.places([frame], patience))[frame]
            given = self._robot.read(request.robot_state)
            joints, faults = self._joints_to(dict.fromkeys(names))
            needed = dict.fromkeys(name for links in joints.values() for name in links)
            needed |= dict.fromkeys(place.joint_names)
            positions = await self._robot.with_needed(given, needed, patience)
        to_frame = inverse_pose(place.pose(positions))
        where, turns = self._robot.model.full_frame(frame), TimeSlices(self._node)
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
            except RejectedError as error:
                faults.append(error.reason)
        return joints, faults


def _solved(target: IkTarget, question: IkRequest, judged: bool) -> InverseKinematicsResult:
    """Find the solution nearest to the seed, or all of them if each is to be judged."""
    chain = target.chain
    seed = np.array([question.positions[name] for name in chain.joint_names])
    # A robot at its stop reports positions beyond it; the seed says where to be near to.
    inside = np.clip(seed, chain.lower, chain.upper)
    return inverse_kinematics(
        chain,
        target.pose,
        seed=inside,
        timeout=question.timeout,
        include_windings=judged,
        max_solutions=None if judged else 1,
    )


def _first_that_holds(
    question: IkRequest,
    results: Sequence[InverseKinematicsResult],
    contact: Callable[[Positions], str],
) -> tuple[Positions, str]:
    """Find the nearest solutions that break no condition and touch nothing, for all joints.

    Where all break one, the text says what the nearest of all breaks; else it is empty.
    """
    first, count = "", 0
    names = [name for target in question.targets for name in target.chain.joint_names]
    for ranks in _combinations([len(result) for result in results]):
        q = np.concatenate([result.q[rank] for result, rank in zip(results, ranks, strict=True)])
        positions = {**question.positions, **dict(zip(names, q.tolist(), strict=True))}
        broken = question.conditions.broken(positions) or contact(positions)
        if not broken:
            return positions, ""
        first, count = first or broken, count + 1
    whole = count == math.prod(map(len, results)) and all(result.complete for result in results)
    tried = f"{counted(count, 'solution')} tried, {'these are all' if whole else 'more may exist'}"
    return {}, f"no solution keeps the constraints without contact ({tried}); the nearest: {first}"


def _combinations(counts: Sequence[int]) -> list[tuple[int, ...]]:
    """List which solution of each link goes with which, the nearest ones first."""
    if len(counts) > 1:
        most = int(_MOST_COMBINATIONS ** (1.0 / len(counts)))
        counts = [min(count, most) for count in counts]
    return sorted(product(*map(range, counts)), key=lambda ranks: (max(ranks), sum(ranks)))
