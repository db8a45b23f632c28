"""compute_cartesian_path: straight lines of a link, timed within the limits of every joint."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from moveit_msgs.msg import MoveItErrorCodes
from moveit_msgs.srv import GetCartesianPath
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.cartesian import (
    PathFollowingResult,
    PathStopLimits,
    Sampling,
    follow_path,
    link_speed_limit,
    plan_followed,
    relative_jump,
    stop_on_condition,
    waypoint_fraction,
    waypoint_path,
)
from robomech_ros.collision import PlanningScene, stop_before_contact
from robomech_ros.collision.planning import in_words
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.messages.joint_messages import joint_trajectory
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.moveit.cartesian_request import CartesianQuestion, read_question
from robomech_ros.nodes.moveit.serving import Collisions, answering, refused_as
from robomech_ros.nodes.moveit.whole_robot import WholeRobot
from robomech_ros.outcomes import Code
from robomech_ros.trajectory import (
    Limits,
    PathTrackingStatus,
    PosePath,
    SampledPlan,
    SpeedLimit,
    sampled_through_points,
)
from robomech_ros.typing import Array

# The task mask of a position alone.
_POSITION = (True, True, True, False, False, False)


class CartesianPathService:
    """The service compute_cartesian_path of one node."""

    def __init__(
        self,
        node: Node,
        robot: WholeRobot,
        settings: Callable[[], Any],
        worker: Worker,
        collisions: Collisions,
    ) -> None:
        self._robot, self._settings, self._worker = robot, settings, worker
        self._collisions = collisions
        answer, group = answering(node, self._compute), ReentrantCallbackGroup()
        serve(node, GetCartesianPath, "compute_cartesian_path", answer, callback_group=group)

    async def _compute(self, request: Any, response: Any) -> tuple[int, str]:
        settings = self._settings()
        question = await read_question(request, self._robot, settings)
        response.start_state.joint_state = self._robot.state(question.positions)
        response.start_state.is_diff = len(question.positions) < len(self._robot.joint_names)
        scene, notes = None, []
        if request.avoid_collisions:
            scene = (await self._collisions.of(question.chain, question.positions)).copy()
            notes = [self._collisions.unchecked]
        solve = partial(_solved, question, settings, scene)
        plan, response.fraction, (code, text) = await self._worker.do(solve)
        if plan is not None:
            response.solution.joint_trajectory = self._trajectory(question, plan)
        return code, "; ".join(filter(None, (text, *notes)))

    def _trajectory(self, question: CartesianQuestion, plan: SampledPlan) -> Any:
        """Make the message of all joints of the group; those that are not on the way stand."""
        chain, points = question.chain, plan.waypoints
        assert points.velocities is not None
        assert points.accelerations is not None
        still = [
            name
            for name in question.joint_names
            if name not in chain.joint_names and name in question.positions
        ]
        places = np.array([question.positions[name] for name in still])
        count = len(points.times)
        message = joint_trajectory(
            (*chain.joint_names, *still),
            points.times,
            np.hstack([points.positions, np.tile(places, (count, 1))]),
            np.hstack([points.velocities, np.zeros((count, len(still)))]),
            np.hstack([points.accelerations, np.zeros((count, len(still)))]),
        )
        message.header.frame_id = self._robot.model.base_frame
        return message


def _solved(
    question: CartesianQuestion, settings: Any, scene: PlanningScene | None
) -> tuple[SampledPlan | None, float, tuple[int, str]]:
    """Lay the path, follow it as far as possible, before any contact in a scene, and plan.

    Return the plan if there is one, the reached fraction of the waypoints, code and text.
    """
    if scene is not None and not scene.is_free(question.start):
        found = scene.clearance(question.start)
        text = f"the start is in contact: {in_words(found.bodies, found.distance)}"
        return None, 0.0, (int(MoveItErrorCodes.START_STATE_IN_COLLISION), text)
    with refused_as(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS):
        start = forward_kinematics(question.chain, question.start)
        mask = _POSITION if settings.position_only_ik else None
        path = waypoint_path(start, question.waypoints, task_mask=mask)
    if path is None:
        standstill = sampled_through_points(
            [question.start, question.start],
            limits=question.chain,
            profile="time_optimal",
            period=settings.sample_period,
            max_points=settings.max_points,
        )
        return standstill, 1.0, (int(MoveItErrorCodes.SUCCESS), "")
    followed = _followed(question, path, mask, scene)
    plan = plan_followed(
        followed,
        profile="time_optimal",
        limits=Limits.of(question.chain).scaled(
            velocity=question.velocity_scale, acceleration=question.acceleration_scale
        ),
        speed_limits=_speed_limits(question, followed),
        sampling=Sampling(
            settings.sample_period, settings.max_points, settings.max_duration, question.step
        ),
    )
    assert path.waypoints is not None
    fraction = waypoint_fraction(followed, path.waypoints)
    return plan, fraction, _outcome(followed, fraction)


def _followed(
    question: CartesianQuestion,
    path: PosePath,
    task_mask: tuple[bool, ...] | None,
    scene: PlanningScene | None,
) -> PathFollowingResult:
    """Follow the path until joints jump or leave their limits, a constraint breaks, or contact."""
    chain, step = question.chain, question.step
    checks = [relative_jump(chain, step, question.relative_jump)]
    if question.conditions:

        def broken(q: Array) -> str:
            moved = zip(chain.joint_names, q.tolist(), strict=True)
            return question.conditions.broken({**question.positions, **dict(moved)})

        checks.append(stop_on_condition(broken, step))
    if scene is not None:
        checks.append(stop_before_contact(scene))
    jumps = question.revolute_jump, question.prismatic_jump
    bounds = PathStopLimits(math.inf, step, *jumps, checks)
    with refused_as(MoveItErrorCodes.START_STATE_INVALID):
        return follow_path(chain, path, question.start, task_mask=task_mask, bounds=bounds)


def _speed_limits(question: CartesianQuestion, followed: PathFollowingResult) -> list[SpeedLimit]:
    if math.isinf(question.speed) or followed.joints is None:
        return []
    return [
        link_speed_limit(
            question.chain, followed.joints, question.limited, question.speed, question.positions
        )
    ]


def _outcome(followed: PathFollowingResult, fraction: float) -> tuple[int, str]:
    stop = followed.stop
    if stop is None:
        return int(MoveItErrorCodes.SUCCESS), ""
    unreached = stop.kind.code in (Code.IK_LOST, Code.LIMIT)
    code = MoveItErrorCodes.NO_IK_SOLUTION if unreached else MoveItErrorCodes.PLANNING_FAILED
    if stop.kind is PathTrackingStatus.REJECTED and followed.joints is None:
        code = MoveItErrorCodes.START_STATE_VIOLATES_PATH_CONSTRAINTS
    return int(code), f"{100.0 * fraction:.4g} % of the waypoints: {stop.text}"
