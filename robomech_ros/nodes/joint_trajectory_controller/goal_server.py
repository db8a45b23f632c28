"""Serves an action that executes trajectories.

Every goal is accepted, and one that is refused is aborted with a text: a rejected goal would carry
no reason to the client.
"""

import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from builtin_interfaces.msg import Time
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.trajectory_goal import End, Job, Outcome
from robomech_ros.execution.joints import State
from robomech_ros.execution.tolerance import Tolerances
from robomech_ros.nodes.common.conversions import duration_from_seconds, floats
from robomech_ros.nodes.common.pauses import wake
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot
from robomech_ros.outcomes import Code

__all__ = ["Dialect", "GoalServer", "fill_states"]

# A client may ask for the result this long after the motion has ended, s.
_RESULT_KEPT = 60


class Dialect(Protocol):
    """An action type: what its goals ask for, and how its results are put.

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
        self, goal: Any, default: Tolerances, joint_names: Sequence[str]
    ) -> tuple[Tolerances, str]:
        """Read the tolerances of a goal, and say what of them does not hold."""

    def refused(self, error: Exception) -> Any:
        """Make the result of a goal that is not executed; most errors are RobomechError."""

    def ended(self, outcome: Outcome, note: str) -> Any:
        """Make the result of a motion."""

    def feedback(self, job: Job, wanted: State, actual: State, stamp: Time) -> Any:
        """Tell how far a motion has come."""


@dataclass
class _Goal:
    """A goal on its way."""

    handle: ServerGoalHandle
    job: Job


class GoalServer:
    """Serves the action; the robot is moved by the node's cycles, nothing here waits.

    Parameters
    ----------
    node : Node
        Owner of the action server.
    robot : SimulatedRobot
        What executes.
    dialect : Dialect
        The action.
    """

    def __init__(self, node: Node, robot: SimulatedRobot, dialect: Dialect) -> None:
        self._node = node
        self._robot = robot
        self._dialect = dialect
        self._goals: dict[bytes, _Goal] = {}
        self._idle: Future = Future()
        self._destroyed = False
        self._server = ActionServer(
            node,
            dialect.kind,
            f"~/{dialect.name}",
            self._execute,
            cancel_callback=self._cancel,
            result_timeout=_RESULT_KEPT,
        )

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        ended: Future = Future()
        try:
            job, note = self._start(handle.request, ended)
        except RobomechError as error:
            self._node.get_logger().warning(f"goal refused: {error}")
            handle.abort()
            return self._dialect.refused(error)
        except Exception as error:
            text = f"goal failed, please report:\n{traceback.format_exc()}"
            self._node.get_logger().error(text)
            handle.abort()
            return self._dialect.refused(error)
        key = _key(handle)
        with self._robot.lock:
            self._goals[key] = _Goal(handle, job)
        if handle.is_cancel_requested:
            self._cancel(handle)
        outcome: Outcome = await ended
        with self._robot.lock:
            del self._goals[key]
        self._conclude(handle, outcome)
        if not self._goals and not self._idle.done():
            self._idle.set_result(None)
        return self._dialect.ended(outcome, note)

    def _start(self, goal: Any, ended: Future) -> tuple[Job, str]:
        """Have a goal executed; returns its job, and what of it does not hold."""
        notes: list[str] = []

        def tolerances(default: Tolerances) -> Tolerances:
            found, note = self._dialect.tolerances(goal, default, self._robot.joint_names)
            notes.append(note)
            return found

        def end(outcome: Outcome) -> None:
            ended.set_result(outcome)
            wake(self._node)

        by = "a newer goal of the action"
        job = self._robot.execute(goal.trajectory, by, end, tolerances)
        if notes[0]:
            self._node.get_logger().warning(notes[0])
        return job, notes[0]

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
        text = "cancelled by the client; the robot has stopped on its path"
        with self._robot.lock:
            if goal.job.outcome is not None:
                return CancelResponse.REJECT
            self._robot.follower.stop(End.CANCELLED, Code.PREEMPTED, text, goal.job)
        return CancelResponse.ACCEPT

    def publish_feedback(self) -> None:
        """Tell the clients how far their goals have come; the robot's lock is to be held."""
        follower = self._robot.follower
        seconds, nanoseconds = self._robot.stamp()
        stamp = Time(sec=seconds, nanosec=nanoseconds)
        for goal in self._goals.values():
            wanted = follower.actual if goal.job is follower.waiting else follower.wanted
            goal.handle.publish_feedback(
                self._dialect.feedback(goal.job, wanted, follower.actual, stamp)
            )

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


def fill_states(message: Any, wanted: State, actual: State, time: float) -> None:
    """Fill the points desired, actual and error of a feedback, at a time (s) of the trajectory."""
    _put(message.desired, wanted)
    _put(message.actual, actual)
    message.error.positions = floats(wanted.position - actual.position)
    message.error.velocities = floats(wanted.velocity - actual.velocity)
    message.desired.time_from_start = duration_from_seconds(time)
    message.actual.time_from_start = message.desired.time_from_start
    message.error.time_from_start = message.desired.time_from_start


def _put(point: Any, state: State) -> None:
    point.positions = floats(state.position)
    point.velocities = floats(state.velocity)
    point.accelerations = floats(state.acceleration)


def _key(handle: ServerGoalHandle) -> bytes:
    return bytes(handle.goal_id.uuid)
