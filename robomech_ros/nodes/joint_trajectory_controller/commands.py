"""Commands for the robot: topic joint_trajectory, services hold and reset."""

import math
from collections.abc import Callable, Sequence

from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.nodes.common.services import serve_trigger
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.middleware.reliable_topics import subscribe_reliably
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.outcomes import Code, name_of

_TOPIC = "joint_trajectory"
_BY = f"a trajectory on the topic {_TOPIC}"
# A stream goes on after a process was held up for a second.
_DEPTH = 100
# Messages of a stream follow one another within this time (s).
_STREAM = 0.2
# Positions (rad or m) that differ by less are the same.
_SAME = 1e-6


class TrajectoryTopic:
    """Executes what comes on the topic joint_trajectory.

    - ``on_refused``: called when a trajectory was refused, whose sender gets no answer.
    """

    def __init__(self, node: Node, joints: CommandedJoints, on_refused: Callable[[], None]) -> None:
        self._log = ThrottledLog(node.get_logger())
        self._joints, self._on_refused = joints, on_refused
        # End of the topic's last message, and its arrival (s).
        self._end: tuple[tuple[str, ...], tuple[float, ...]] | None = None
        self._received_at = -math.inf
        subscribe_reliably(node, JointTrajectory, f"{joints.place}/{_TOPIC}", self._execute, _DEPTH)

    def _execute(self, trajectory: JointTrajectory) -> None:
        try:
            if self._is_replaced(trajectory):
                return
            goal = self._joints.execute(trajectory, _BY, self._log_end, streamed=True)
            if goal.strain:
                self._log.warning(goal.strain)
        except RobomechError as error:
            code = code_of(error)
            self._log.error(f"trajectory refused ({code} {name_of(code)}): {error}")
            self._on_refused()

    def _is_replaced(self, trajectory: JointTrajectory) -> bool:
        """Return whether it belongs to a stream that an action goal has already replaced.

        That comes soon after the message before it, and ends where that one ended.
        """
        points, known = trajectory.points, self._end
        end = (tuple(trajectory.joint_names), tuple(points[-1].positions)) if points else None
        with self._joints.lock:
            self._joints.advance()
            now, goal = self._joints.follower.now, self._joints.follower.active
        soon = now < self._received_at + _STREAM
        self._received_at, self._end = now, end
        if not soon or goal is None or goal.streamed or end is None or known is None:
            return False
        same = end[0] == known[0] and len(end[1]) == len(known[1])
        return same and all(abs(x - y) <= _SAME for x, y in zip(end[1], known[1], strict=True))

    def _log_end(self, result: GoalResult) -> None:
        # Each message of a stream replaces the one before.
        if result.code and not result.text.startswith(f"preempted by {_BY}"):
            log_end(self._log, "trajectory", result)


def log_end(log: ThrottledLog, what: str, result: GoalResult) -> None:
    """Log a motion that ended early: what somebody asked for is no warning."""
    text = f"{what} ended early: {result.text}"
    (log.info if result.code == Code.PREEMPTED else log.warning)(text)


class Commands:
    """The services hold, of the arm, and reset, of the whole robot.

    - ``commanded``: the arm, and what else is put back; they share a lock.
    - ``on_reset``: called when the robot was put elsewhere at once; the lock is held.
    """

    def __init__(
        self, node: Node, commanded: Sequence[CommandedJoints], on_reset: Callable[[], None]
    ) -> None:
        self._commanded, self._on_reset = commanded, on_reset
        serve_trigger(node, "~/hold", self._hold)
        serve_trigger(node, "~/reset", self._reset)

    def _hold(self) -> str:
        text, arm = "stopped by the service hold", self._commanded[0]
        with arm.lock:
            stopped = arm.follower.stop(End.ABORTED, Code.PREEMPTED, text)
        return "the robot slows down and holds" if stopped else "the robot holds"

    def _reset(self) -> str:
        with self._commanded[0].lock:
            for joints in self._commanded:
                joints.advance()
                joints.reset("ended by the service reset")
            self._on_reset()
        return "the robot is at its initial position"
