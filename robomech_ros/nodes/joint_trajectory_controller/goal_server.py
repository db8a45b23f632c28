"""Serves an action that executes trajectories.

Every goal is accepted, and one that is refused is aborted with a text: a rejected goal would carry
no reason to the client.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.task import Future

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.joints import State
from robomech_ros.execution.motion_tolerances import Tolerances, override_tolerances
from robomech_ros.execution.received_trajectory import joint_order
from robomech_ros.nodes.common.cooperative_wait import wake
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.nodes.common.messages.message_fields import floats, seconds_from_duration
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.commands import log_end
from robomech_ros.nodes.joint_trajectory_controller.messages import fill_feedback
from robomech_ros.outcomes import Code

if TYPE_CHECKING:
    from robomech_ros.nodes.joint_trajectory_controller.follow_messages import FollowMessages

_FIELDS = ("path_position_tolerance", "goal_position_tolerance", "goal_velocity_tolerance")


class ExecuteMessages:
    """Reads goals and writes results of ExecuteTrajectory.

    - ``joint_names``: the joints that trajectories move.
    - ``others``: joints that follow them and may be named, too: the passive ones of a parallel
      robot.
    """

    kind = ExecuteTrajectory
    name = "execute_trajectory"

    def __init__(self, joint_names: Sequence[str], others: Sequence[str] = ()) -> None:
        self._joint_names, self._others = list(joint_names), tuple(others)
        self._feedback = ExecuteTrajectory.Feedback(joint_names=self._joint_names)

    def tolerances(
        self, message: Any, default: Tolerances, joint_names: Sequence[str]
    ) -> tuple[Tolerances, str]:
        """Read the tolerances of a goal, with no remark; invalid tolerances are rejected."""
        names = message.trajectory.joint_names
        order = joint_order(names, [*joint_names, *self._others], partial=True)[: len(joint_names)]
        path, at_goal, velocity = (
            override_tolerances(values, getattr(message, field), order, names, field)
            for field, values in zip(
                _FIELDS, (default.path, default.goal, default.velocity), strict=True
            )
        )
        time = seconds_from_duration(message.goal_time_tolerance, "goal_time_tolerance")
        found = replace(
            default, path=path, goal=at_goal, velocity=velocity, goal_time=time or default.goal_time
        )
        return found, ""

    def refused(self, error: Exception) -> Any:
        """Make the result of a goal that is not executed."""
        return ExecuteTrajectory.Result(
            joint_names=self._joint_names, error_code=code_of(error), error_msg=str(error)
        )

    def ended(self, result: GoalResult, note: str) -> Any:
        """Make the result of a motion."""
        return ExecuteTrajectory.Result(
            joint_names=self._joint_names,
            final_position_error=floats(result.error),
            error_code=result.code,
            error_msg=result.text,
        )

    def feedback(self, goal: TrajectoryGoal, desired: State, actual: State, stamp: Time) -> Any:
        """Tell how far a motion has come."""
        self._feedback.header.stamp = stamp
        fill_feedback(self._feedback, desired, actual, goal.time)
        self._feedback.progress = goal.progress
        return self._feedback


class GoalServer(ActionBase[TrajectoryGoal]):
    """Serves the action.

    - ``messages``: reads the goals of the action, and writes its feedback and results.
    """

    _what = "goal"

    def __init__(
        self, node: Node, robot: CommandedJoints, messages: "ExecuteMessages | FollowMessages"
    ) -> None:
        self._robot, self._messages = robot, messages
        super().__init__(node, robot, messages.kind, f"{robot.place}/{messages.name}")

    def _refused(self, error: Exception) -> Any:
        if isinstance(error, RobomechError):
            self._log.warning(f"goal refused: {error}")
        return self._messages.refused(error)

    def _ended(self, outcome: tuple[GoalResult, str]) -> tuple[Any, bool, bool]:
        result, note = outcome
        if result.code:
            log_end(self._log, "goal", result)
        reached, cancelled = result.end is End.REACHED, result.end is End.CANCELLED
        return self._messages.ended(result, note), reached, cancelled

    def _start(self, request: Any, ended: Future) -> TrajectoryGoal:
        # Parts of the request that are not followed.
        notes: list[str] = []

        def tolerances(default: Tolerances) -> Tolerances:
            found, note = self._messages.tolerances(request, default, self._robot.joint_names)
            notes.append(note)
            return found

        def end(result: GoalResult) -> None:
            ended.set_result((result, notes[0]))
            wake(self._node)

        by = "a newer goal of the action"
        goal = self._robot.execute(request.trajectory, by, end, tolerances)
        for text in (notes[0], goal.strain):
            if text:
                self._log.warning(text)
        return goal

    def _stop(self, motion: TrajectoryGoal) -> bool:
        if motion.result is not None:
            return False
        text = "cancelled by the client; the robot has stopped on its path"
        self._robot.follower.stop(End.CANCELLED, Code.PREEMPTED, text, motion)
        return True

    def publish_feedback(self) -> None:
        """Tell the clients how far their goals have come; the robot's lock is to be held."""
        follower = self._robot.follower
        seconds, nanoseconds = self._robot.stamp()
        stamp = Time(sec=seconds, nanosec=nanoseconds)
        for handle, goal in self._served.values():
            desired = follower.actual if goal is follower.waiting else follower.desired
            handle.publish_feedback(self._messages.feedback(goal, desired, follower.actual, stamp))
