"""Serves an action that executes trajectories.

Every goal is accepted, and one that is refused is aborted with a text: a rejected goal would carry
no reason to the client.
"""

import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from builtin_interfaces.msg import Time
from rclpy.action import CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.joints import State
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.nodes.common.deep_queues import serve_action
from robomech_ros.nodes.common.pauses import wake
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.outcomes import Code

__all__ = ["ActionMessages", "GoalServer"]

# A client may ask for the result this long after the motion has ended, s.
_RESULT_KEPT = 60


class ActionMessages(Protocol):
    """Messages of an action: what its goals ask for, and how its results are put.

    Attributes
    ----------
    kind : type
        The action.
    name : str
        Its name below the node.
    """

    kind: Any
    name: str

    def tolerances(
        self, message: Any, default: Tolerances, joint_names: Sequence[str]
    ) -> tuple[Tolerances, str]:
        """Read the tolerances of a goal, and say what of them does not hold."""

    def refused(self, error: Exception) -> Any:
        """Make the result of a goal that is not executed; most errors are RobomechError."""

    def ended(self, result: GoalResult, note: str) -> Any:
        """Make the result of a motion."""

    def feedback(self, goal: TrajectoryGoal, desired: State, actual: State, stamp: Time) -> Any:
        """Tell how far a motion has come."""


@dataclass
class _ServedGoal:
    """A goal on its way."""

    handle: ServerGoalHandle
    goal: TrajectoryGoal


class GoalServer:
    """Serves the action; the robot is moved by the node's cycles, nothing here waits.

    Parameters
    ----------
    node : Node
        Owner of the action server.
    robot : CommandedJoints
        What executes.
    messages : ActionMessages
        Those of the action.
    """

    def __init__(self, node: Node, robot: CommandedJoints, messages: ActionMessages) -> None:
        self._node = node
        self._robot = robot
        self._messages = messages
        self._served: dict[bytes, _ServedGoal] = {}
        self._idle: Future = Future()
        self._destroyed = False
        self._server = serve_action(
            node,
            messages.kind,
            f"~/{messages.name}",
            self._execute,
            cancel_callback=self._cancel,
            result_timeout=_RESULT_KEPT,
        )

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        ended: Future = Future()
        try:
            goal, note = self._start(handle.request, ended)
        except Exception as error:
            self._log_refusal(error)
            handle.abort()
            return self._messages.refused(error)
        result = await self._serve(_ServedGoal(handle, goal), ended)
        self._conclude(handle, result)
        if not self._served and not self._idle.done():
            self._idle.set_result(None)
        return self._messages.ended(result, note)

    def _start(self, message: Any, ended: Future) -> tuple[TrajectoryGoal, str]:
        """Have a goal executed; returns it, and what of the message does not hold."""
        notes: list[str] = []

        def tolerances(default: Tolerances) -> Tolerances:
            found, note = self._messages.tolerances(message, default, self._robot.joint_names)
            notes.append(note)
            return found

        def end(result: GoalResult) -> None:
            ended.set_result(result)
            wake(self._node)

        by = "a newer goal of the action"
        goal = self._robot.execute(message.trajectory, by, end, tolerances)
        if notes[0]:
            self._node.get_logger().warning(notes[0])
        return goal, notes[0]

    def _log_refusal(self, error: Exception) -> None:
        """Log why a goal is not executed; to be called while the error is handled."""
        if isinstance(error, RobomechError):
            self._node.get_logger().warning(f"goal refused: {error}")
        else:
            text = f"goal failed, please report:\n{traceback.format_exc()}"
            self._node.get_logger().error(text)

    async def _serve(self, served: _ServedGoal, ended: Future) -> GoalResult:
        """Let the client cancel a goal and see how far it has come, until it has ended."""
        key = _key(served.handle)
        with self._robot.lock:
            self._served[key] = served
        if served.handle.is_cancel_requested:
            self._cancel(served.handle)
        result: GoalResult = await ended
        with self._robot.lock:
            del self._served[key]
        return result

    def _conclude(self, handle: ServerGoalHandle, result: GoalResult) -> None:
        if result.end is End.REACHED:
            handle.succeed()
        elif result.end is End.CANCELLED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        if result.code:
            self._node.get_logger().warning(f"goal ended early: {result.text}")

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        served = self._served.get(_key(handle))
        if served is None:
            # It has not begun yet: it is cancelled as soon as it begins.
            return CancelResponse.ACCEPT
        text = "cancelled by the client; the robot has stopped on its path"
        with self._robot.lock:
            if served.goal.result is not None:
                return CancelResponse.REJECT
            self._robot.follower.stop(End.CANCELLED, Code.PREEMPTED, text, served.goal)
        return CancelResponse.ACCEPT

    def publish_feedback(self) -> None:
        """Tell the clients how far their goals have come; the robot's lock is to be held."""
        follower = self._robot.follower
        seconds, nanoseconds = self._robot.stamp()
        stamp = Time(sec=seconds, nanosec=nanoseconds)
        for served in self._served.values():
            desired = follower.actual if served.goal is follower.waiting else follower.desired
            served.handle.publish_feedback(
                self._messages.feedback(served.goal, desired, follower.actual, stamp)
            )

    def destroy(self) -> None:
        """Give up the action server; once is enough."""
        if not self._destroyed:
            self._destroyed = True
            self._server.destroy()

    def all_ended(self) -> Future:
        """Give a future that is done when the results of all goals have been handed over."""
        self._idle = Future()
        if not self._served:
            self._idle.set_result(None)
        return self._idle


def _key(handle: ServerGoalHandle) -> bytes:
    return bytes(handle.goal_id.uuid)
