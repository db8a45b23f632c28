"""Serves an action that executes trajectories.

Every goal is accepted, and one that is refused is aborted with a text: a rejected goal would carry
no reason to the client.
"""

from typing import TYPE_CHECKING, Any

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.nodes.common.cooperative_wait import wake
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.commands import log_end
from robomech_ros.outcomes import Code

if TYPE_CHECKING:
    from robomech_ros.nodes.joint_trajectory_controller.execute_messages import ExecuteMessages
    from robomech_ros.nodes.joint_trajectory_controller.follow_messages import FollowMessages


class GoalServer(ActionBase[TrajectoryGoal]):
    """Serves the action.

    Parameters
    ----------
    node : Node
        Owner of the action server.
    robot : CommandedJoints
        What executes.
    messages : ExecuteMessages or FollowMessages
        Those of the action: what its goals ask for, and how its results are put.
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
