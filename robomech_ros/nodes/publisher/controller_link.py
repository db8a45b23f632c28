"""The way to the controller by topic and by action, and to the state of the robot."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.execution.delivery import Delivery, Transport
from robomech_ros.execution.job import Code
from robomech_ros.nodes.controller.motion_clock import MotionClock
from robomech_ros.nodes.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.publisher.trajectory_message import trajectory_message
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["ControllerLink"]

_DEPTH = 10

OnResult = Callable[[Delivery, int, str], None]


class ControllerLink:
    """Sends trajectories to one controller.

    Parameters
    ----------
    node : Node
        Owner of publisher, client and subscription.
    controller : str
        Name of the controller.
    clock : MotionClock
        The time of deliveries.
    on_result : callable
        Called with every delivery by action whose result has come, its code and its text.
    """

    def __init__(
        self, node: Node, controller: str, clock: MotionClock, on_result: OnResult
    ) -> None:
        self._on_result = on_result
        self._monitor = JointStateMonitor(node)
        self._publisher = node.create_publisher(
            JointTrajectory, f"{controller}/joint_trajectory", _DEPTH
        )
        name = f"{controller}/execute_trajectory"
        self._client = ActionClient(node, ExecuteTrajectory, name)
        self._action_name = node.resolve_service_name(name)
        self._destroyed = False
        self._continuous: frozenset[str] | None = None
        self._acceleration: dict[str, float] = {}
        self._clock = clock
        # Goals are numbered; the result of the last one counts.
        self._last = self._cancelled = 0
        self._handles: dict[int, Any] = {}

    def know_robot(self, continuous: Sequence[str], acceleration: Mapping[str, float]) -> None:
        """Take note of the joints that turn without limits, and of acceleration limits by joint."""
        self._continuous = frozenset(continuous)
        self._acceleration = dict(acceleration)

    def missing(self, transport: Transport) -> str:
        """Say what is not there to send by; empty if all is."""
        if transport is Transport.ACTION:
            there = self._client.server_is_ready()
            return "" if there else f"action '{self._action_name}'"
        there = self._publisher.get_subscription_count() > 0
        return "" if there else f"subscriber of '{self._publisher.topic_name}'"

    def positions(self, names: Sequence[str]) -> NDArray[np.float64] | None:
        """Give the present positions, rad or m; None if not known."""
        return self._monitor.positions(names)

    def heard(self, names: Sequence[str]) -> int:
        """Give a number that has grown when all these joints were heard of anew."""
        return self._monitor.heard(names)

    def continuous(self, names: Sequence[str]) -> NDArray[np.bool_]:
        """Say which joints turn without limits; all may as long as the robot is not known.

        The controller has the last word on a start that is a whole turn away.
        """
        known = self._continuous
        return np.array([known is None or name in known for name in names])

    def acceleration(self, names: Sequence[str]) -> FloatArray | None:
        """Give the acceleration limits, rad/s^2 or m/s^2; None where they are not all known."""
        if not all(name in self._acceleration for name in names):
            return None
        return np.array([self._acceleration[name] for name in names])

    def send(self, delivery: Delivery) -> None:
        """Send by the transport of the delivery."""
        message = trajectory_message(delivery, self._clock.stamp(delivery.sent_at))
        if delivery.transport is Transport.TOPIC:
            self._publisher.publish(message)
            return
        self._last += 1
        number = self._last
        sent = self._client.send_goal_async(ExecuteTrajectory.Goal(trajectory=message))
        sent.add_done_callback(lambda future: self._take_handle(number, delivery, future))

    def runs_before(self, delivery: Delivery) -> bool:
        """Say whether the controller still executes a goal before the last one."""
        return bool(self._handles)

    def cancel(self, delivery: Delivery) -> None:
        """Ask the controller to give up all that was sent, also what it has not accepted yet."""
        self._cancelled = self._last
        for handle in self._handles.values():
            handle.cancel_goal_async()

    def destroy(self) -> None:
        """Give up the action client; once is enough."""
        if not self._destroyed:
            self._destroyed = True
            self._client.destroy()

    def _take_handle(self, number: int, delivery: Delivery, future: Future) -> None:
        if future.exception() is not None:
            text = f"sending the goal failed: {future.exception()}"
            self._conclude(number, delivery, Code.REJECTED, text)
            return
        handle = future.result()
        if not handle.accepted:
            text = f"action '{self._action_name}' rejected the goal without a reason"
            self._conclude(number, delivery, Code.REJECTED, text)
            return
        self._handles[number] = handle
        if number <= self._cancelled:
            handle.cancel_goal_async()
        result = handle.get_result_async()
        result.add_done_callback(lambda done: self._take_result(number, delivery, done))

    def _take_result(self, number: int, delivery: Delivery, future: Future) -> None:
        self._handles.pop(number, None)
        if future.exception() is not None:
            text = f"asking for the result failed: {future.exception()}"
            self._conclude(number, delivery, Code.REJECTED, text)
            return
        result = future.result().result
        self._conclude(number, delivery, result.error_code, result.error_msg)

    def _conclude(self, number: int, delivery: Delivery, code: int, text: str) -> None:
        """Hand over the result of what was sent last."""
        if number == self._last:
            self._on_result(delivery, code, text)
