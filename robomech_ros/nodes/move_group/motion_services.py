"""Plans and executions by MoveIt's services and actions."""

from collections.abc import Awaitable
from typing import Any

from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import MoveItErrorCodes
from moveit_msgs.srv import GetMotionPlan
from rclpy.action import CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.middleware.queue_depth import serve_action
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.move_group.execution import Execution
from robomech_ros.nodes.move_group.planning import MotionPlanning
from robomech_ros.nodes.moveit.serving import Outcomes, RejectedError, refused_as

_SUCCESS = MoveItErrorCodes.SUCCESS


class MotionServices:
    """The service plan_kinematic_path, and the actions move_action and execute_trajectory.

    Every goal is accepted, and one that is refused is aborted with a text: a rejected goal would
    carry no reason to the client.
    """

    def __init__(self, node: Node, planning: MotionPlanning, execution: Execution) -> None:
        self._planning, self._execution = planning, execution
        self._outcomes, self._log = Outcomes(node), ThrottledLog(node.get_logger())
        group = ReentrantCallbackGroup()
        serve(node, GetMotionPlan, "plan_kinematic_path", self._plan, callback_group=group)
        self._actions = [
            serve_action(
                node,
                kind,
                name,
                execute,
                callback_group=group,
                cancel_callback=lambda _: CancelResponse.ACCEPT,
            )
            for kind, name, execute in (
                (MoveGroup, "move_action", self._move),
                (ExecuteTrajectory, "execute_trajectory", self._execute),
            )
        ]

    def destroy(self) -> None:
        """Destroy the actions, once."""
        while self._actions:
            self._actions.pop().destroy()

    async def _plan(self, request: Any, response: Any) -> Any:
        answer = response.motion_plan_response
        answer.group_name = request.motion_plan_request.group_name

        async def plan() -> tuple[int, str]:
            motion = await self._planning.plan(request.motion_plan_request)
            answer.trajectory_start, answer.trajectory = motion.start, motion.trajectory
            answer.planning_time = motion.seconds
            return _SUCCESS, motion.note

        answer.error_code, _ = await self._outcomes.of(plan())
        return response

    async def _move(self, handle: Any) -> Any:
        result = MoveGroup.Result()

        async def move() -> tuple[int, str]:
            goal = handle.request
            _refuse_options(goal.planning_options)
            handle.publish_feedback(MoveGroup.Feedback(state="PLANNING"))
            motion = await self._planning.plan(goal.request, lambda: handle.is_cancel_requested)
            result.trajectory_start = motion.start
            result.planned_trajectory = motion.trajectory
            result.planning_time = motion.seconds
            if goal.planning_options.plan_only:
                return _SUCCESS, motion.note
            handle.publish_feedback(MoveGroup.Feedback(state="MONITOR"))
            code, text = await self._run(handle, motion.trajectory.joint_trajectory)
            if code == _SUCCESS:
                result.executed_trajectory = motion.trajectory
            return code, "; ".join(filter(None, (text, motion.note)))

        return await self._concluded(handle, result, move())

    async def _execute(self, handle: Any) -> Any:
        async def execute() -> tuple[int, str]:
            trajectory = handle.request.trajectory
            if trajectory.multi_dof_joint_trajectory.points:
                with refused_as(MoveItErrorCodes.INVALID_MOTION_PLAN):
                    count = len(trajectory.multi_dof_joint_trajectory.points)
                    raise BadValueError(
                        "multi_dof_joint_trajectory", counted(count, "point"), "none"
                    )
            handle.publish_feedback(ExecuteTrajectory.Feedback(state="MONITOR"))
            code, text = await self._run(handle, trajectory.joint_trajectory)
            return code, "; ".join(filter(None, (text, self._execution.unchecked)))

        return await self._concluded(handle, ExecuteTrajectory.Result(), execute())

    async def _run(self, handle: Any, trajectory: Any) -> tuple[int, str]:
        return await self._execution.run(trajectory, lambda: handle.is_cancel_requested)

    async def _concluded(self, handle: Any, result: Any, work: Awaitable[tuple[int, str]]) -> Any:
        """Do the work of a goal, and end the goal as MoveIt does."""
        result.error_code, _ = await self._outcomes.of(work)
        if result.error_code.val == _SUCCESS:
            handle.succeed()
            return result
        self._log.warning(f"the goal failed: {result.error_code.message}")
        if handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return result


def _refuse_options(options: Any) -> None:
    """Refuse planning options that this node does not have, by name."""
    diff = options.planning_scene_diff
    given = {
        "replan": options.replan,
        "look_around": options.look_around,
        "planning_scene_diff": diff.world.collision_objects
        or diff.robot_state.attached_collision_objects
        or diff.allowed_collision_matrix.entry_names,
    }
    remedies = {
        "replan": "send a new goal when this one has failed",
        "look_around": "the node has no sensors",
        "planning_scene_diff": "change the scene by apply_planning_scene",
    }
    for name, value in given.items():
        if value:
            raise RejectedError(
                MoveItErrorCodes.FAILURE,
                f"planning_options.{name} is set, expected it not to be: {remedies[name]}",
            )
