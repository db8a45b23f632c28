"""How others command the robot: the topic joint_trajectory, the services hold and reset."""

from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult
from robomech_ros.nodes.common.deep_queues import serve
from robomech_ros.nodes.common.error_codes import code_of
from robomech_ros.nodes.common.reliable_topics import subscribe_reliably
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.outcomes import Code, name_of

__all__ = ["Commands", "TrajectoryTopic"]

_TOPIC = "joint_trajectory"
_DEPTH = 10
# A stream replaces its trajectory a hundred times a second: that is said this often at the most, s.
_SELDOM = 5.0


class TrajectoryTopic:
    """Executes what comes on the topic joint_trajectory.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    joints : CommandedJoints
        What executes.
    on_refused : callable
        Called when a trajectory was refused, whose sender gets no answer.
    """

    def __init__(self, node: Node, joints: CommandedJoints, on_refused: Callable[[], None]) -> None:
        self._logger = node.get_logger()
        self._joints = joints
        self._on_refused = on_refused
        topic = f"{joints.place}/{_TOPIC}"
        subscribe_reliably(node, JointTrajectory, topic, self._execute, _DEPTH)

    def _execute(self, trajectory: JointTrajectory) -> None:
        try:
            by = "a trajectory on the topic joint_trajectory"
            self._joints.execute(trajectory, by, self._log_end)
        except RobomechError as error:
            code = code_of(error)
            self._logger.error(f"trajectory refused ({code} {name_of(code)}): {error}")
            self._on_refused()

    def _log_end(self, result: GoalResult) -> None:
        if result.code:
            text = f"trajectory ended early: {result.text}"
            self._logger.warning(text, throttle_duration_sec=_SELDOM)


class Commands:
    """The services hold, of the arm, and reset, of the whole robot.

    Parameters
    ----------
    node : Node
        Owner of the services.
    commanded : sequence of CommandedJoints
        The arm, and what else is put back; they share a lock.
    on_reset : callable
        Called when the robot was put elsewhere at once; the lock is held.
    """

    def __init__(
        self, node: Node, commanded: Sequence[CommandedJoints], on_reset: Callable[[], None]
    ) -> None:
        self._commanded = commanded
        self._on_reset = on_reset
        serve(node, Trigger, "~/hold", self._hold)
        serve(node, Trigger, "~/reset", self._reset)

    def _hold(self, request: Any, response: Any) -> Any:
        text, arm = "stopped by the service hold", self._commanded[0]
        with arm.lock:
            stopped = arm.follower.stop(End.ABORTED, Code.PREEMPTED, text)
        response.success = True
        response.message = "the robot slows down and holds" if stopped else "the robot holds"
        return response

    def _reset(self, request: Any, response: Any) -> Any:
        with self._commanded[0].lock:
            for joints in self._commanded:
                joints.advance()
                joints.reset("ended by the service reset")
            self._on_reset()
        response.success = True
        response.message = "the robot is at its initial position"
        return response
