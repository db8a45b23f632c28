"""The way to the controller by topic and by action, and to the state of the robot."""

from collections.abc import Callable, Sequence
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
from robomech_ros.nodes.joint_state_monitor import JointStateMonitor

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
    on_result : callable
        Called with every delivery by action whose result has come, its code and its text.
    """

    def __init__(self, node: Node, controller: str, on_result: OnResult) -> None:
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
        self._handle: tuple[Delivery, Any] | None = None

    def know_continuous(self, joints: Sequence[str]) -> None:
        """Take note of the joints that turn without limits."""
        self._continuous = frozenset(joints)

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

    def send(self, delivery: Delivery) -> None:
        """Send by the transport of the delivery."""
        if delivery.transport is Transport.TOPIC:
            self._publisher.publish(delivery.trajectory)
            return
        goal = ExecuteTrajectory.Goal(trajectory=delivery.trajectory)
        sent = self._client.send_goal_async(goal)
        sent.add_done_callback(lambda future: self._take_handle(delivery, future))

    def cancel(self, delivery: Delivery) -> None:
        """Ask the controller to give up a delivery."""
        if self._handle is not None and self._handle[0] is delivery:
            self._handle[1].cancel_goal_async()

    def destroy(self) -> None:
        """Give up the action client; once is enough."""
        if not self._destroyed:
            self._destroyed = True
            self._client.destroy()

    def _take_handle(self, delivery: Delivery, future: Future) -> None:
        if future.exception() is not None:
            self._on_result(
                delivery, Code.REJECTED, f"sending the goal failed: {future.exception()}"
            )
            return
        handle = future.result()
        if not handle.accepted:
            text = f"action '{self._action_name}' rejected the goal without a reason"
            self._on_result(delivery, Code.REJECTED, text)
            return
        self._handle = delivery, handle
        result = handle.get_result_async()
        result.add_done_callback(lambda done: self._take_result(delivery, done))

    def _take_result(self, delivery: Delivery, future: Future) -> None:
        if future.exception() is not None:
            text = f"asking for the result failed: {future.exception()}"
            self._on_result(delivery, Code.REJECTED, text)
            return
        result = future.result().result
        self._on_result(delivery, result.error_code, result.error_msg)
