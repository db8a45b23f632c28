"""The action execute_trajectory: every goal is accepted, and what is refused aborted with a text.

A rejected goal would carry no reason to the client.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.errors import RobomechError
from robomech_ros.execution.job import Code, End, Job, Outcome
from robomech_ros.execution.joints import State
from robomech_ros.nodes.controller.robot import SimulatedRobot
from robomech_ros.nodes.conversions import duration_from_seconds, floats
from robomech_ros.nodes.error_codes import code_of

__all__ = ["GoalServer"]

# A client may ask for the result this long after the motion has ended, s.
_RESULT_KEPT = 60


@dataclass
class _Goal:
    """A goal on its way."""

    handle: ServerGoalHandle
    job: Job


class GoalServer:
    """Serves the action; the robot is moved by the node's timer, nothing here waits.

    Parameters
    ----------
    node : Node
        Owner of the action server.
    robot : SimulatedRobot
        What executes.
    """

    def __init__(self, node: Node, robot: SimulatedRobot) -> None:
        self._node = node
        self._robot = robot
        self._goals: dict[bytes, _Goal] = {}
        self._idle: Future = Future()
        self._destroyed = False
        self._feedback = ExecuteTrajectory.Feedback(joint_names=robot.joint_names)
        self._server = ActionServer(
            node,
            ExecuteTrajectory,
            "~/execute_trajectory",
            self._execute,
            cancel_callback=self._cancel,
            result_timeout=_RESULT_KEPT,
        )

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        ended: Future = Future()
        try:
            goal = handle.request
            by = "a newer goal of the action"
            job = self._robot.execute(goal.trajectory, by, ended.set_result, goal)
        except RobomechError as error:
            self._node.get_logger().warning(f"goal refused: {error}")
            handle.abort()
            return self._result(code_of(error), str(error))
        key = _key(handle)
        self._goals[key] = _Goal(handle, job)
        if handle.is_cancel_requested:
            self._cancel(handle)
        outcome: Outcome = await ended
        del self._goals[key]
        self._conclude(handle, outcome)
        if not self._goals and not self._idle.done():
            self._idle.set_result(None)
        return self._result(outcome.code, outcome.text, outcome.error)

    def _conclude(self, handle: ServerGoalHandle, outcome: Outcome) -> None:
        if outcome.end is End.REACHED:
            handle.succeed()
        elif outcome.end is End.CANCELLED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        if outcome.code:
            self._node.get_logger().warning(f"goal ended early: {outcome.text}")

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        goal = self._goals.get(_key(handle))
        if goal is None:
            # It has not begun yet: it is cancelled as soon as it begins.
            return CancelResponse.ACCEPT
        if goal.job.outcome is not None:
            return CancelResponse.REJECT
        text = "cancelled by the client; the robot has stopped on its path"
        self._robot.follower.stop(End.CANCELLED, Code.PREEMPTED, text, goal.job)
        return CancelResponse.ACCEPT

    def _result(
        self, code: int, text: str, error: "np.ndarray[Any, np.dtype[np.float64]] | None" = None
    ) -> Any:
        return ExecuteTrajectory.Result(
            joint_names=self._robot.joint_names,
            final_position_error=[] if error is None else floats(error),
            error_code=code,
            error_msg=text,
        )

    def publish_feedback(self) -> None:
        """Tell the clients how far their goals have come."""
        for goal in self._goals.values():
            self._fill_feedback(goal.job)
            goal.handle.publish_feedback(self._feedback)

    def destroy(self) -> None:
        """Give up the action server; once is enough."""
        if not self._destroyed:
            self._destroyed = True
            self._server.destroy()

    def all_ended(self) -> Future:
        """Give a future that is done when the results of all goals have been handed over."""
        self._idle = Future()
        if not self._goals:
            self._idle.set_result(None)
        return self._idle

    @property
    def busy(self) -> bool:
        """Whether there are goals on their way."""
        return bool(self._goals)

    def _fill_feedback(self, job: Job) -> None:
        message, follower = self._feedback, self._robot.follower
        wanted, actual = follower.wanted, follower.actual
        if job is follower.waiting:
            wanted = actual
        message.header.stamp = self._node.get_clock().now().to_msg()
        _put(message.desired, wanted)
        _put(message.actual, actual)
        message.error.positions = floats(wanted.position - actual.position)
        message.error.velocities = floats(wanted.velocity - actual.velocity)
        message.desired.time_from_start = duration_from_seconds(job.time)
        message.actual.time_from_start = message.desired.time_from_start
        message.error.time_from_start = message.desired.time_from_start
        message.progress = job.progress


def _put(point: Any, state: State) -> None:
    point.positions = floats(state.position)
    point.velocities = floats(state.velocity)
    point.accelerations = floats(state.acceleration)


def _key(handle: ServerGoalHandle) -> bytes:
    return bytes(handle.goal_id.uuid)
