"""Opens and closes the gripper of a running robot, by its action."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from robomech_ros.nodes.common.robot.gripper_names import (
    gripper_goal,
    gripper_outcome,
    known_gripper,
)
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.middleware.queue_depth import ask_action
from robomech_ros.nodes.rvs.settings import RvsSettings

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live import LiveLayer


class GripperClient:
    """Commands the gripper; methods may be called from any thread.

    - ``view``: shows the results.
    """

    def __init__(
        self, node: Node, model: RobotModel, settings: RvsSettings, view: LiveLayer
    ) -> None:
        self._node, self._view = node, view
        self._lock = threading.Lock()
        # Number of the latest command, and the handle of its goal.
        self._number = 0
        self._handle: Any = None
        self._name = f"{settings.gripper_controller}/gripper_cmd"
        #: The gripper; None if the robot has none, or control_msgs is not installed.
        self.gripper = None if model.mechanism is not None else known_gripper(model, settings)
        self.moves = False
        if self.gripper is None:
            return
        try:
            from control_msgs.action import GripperCommand
        except ImportError as error:
            self.gripper = None
            node.get_logger().info(f"no slider for the gripper: {error}")
        else:
            self._client = ask_action(node, GripperCommand, self._name)

    def move(self, value: float) -> None:
        """Open or close to a value of the gripper, instead of what it does."""
        with self._lock:
            self._number += 1
            number, self.moves = self._number, True
        soon(self._node, lambda: self._send(number, value))

    def stop(self) -> None:
        """Slow down and hold."""
        with self._lock:
            self._number += 1
            handle, self._handle, self.moves = self._handle, None, False
        if handle is not None:
            soon(self._node, handle.cancel_goal_async)

    def _send(self, number: int, value: float) -> None:
        # The latest of several waiting values counts.
        if number != self._number:
            return
        assert self.gripper is not None
        if not self._client.server_is_ready():
            self._end(number, f"Gripper: nobody serves '{self._name}'.", failed=True)
            return
        sent = self._client.send_goal_async(gripper_goal(self.gripper, value))
        sent.add_done_callback(lambda future: self._take_handle(number, future.result()))

    def _take_handle(self, number: int, handle: Any) -> None:
        if not handle.accepted:
            self._end(number, f"Gripper: '{self._name}' rejected the goal.", failed=True)
            return
        with self._lock:
            latest = number == self._number
            if latest:
                self._handle = handle
        if not latest:
            # Stopped before the goal was accepted; a newer goal replaces it anyway.
            handle.cancel_goal_async()
            return

        def take(future: Any) -> None:
            assert self.gripper is not None
            text, reached = gripper_outcome(self.gripper, future.result().result)
            self._end(number, f"Gripper: {text}.", failed=not reached)

        handle.get_result_async().add_done_callback(take)

    def _end(self, number: int, text: str, *, failed: bool) -> None:
        """Say what came of a command, unless there is a newer one."""
        with self._lock:
            if number != self._number:
                return
            self._handle, self.moves = None, False
        self._view.show_gripper(text, failed=failed)


def soon(node: Node, what: Callable[[], object]) -> None:
    """Run a function on the thread that serves a node."""
    if node.executor is not None:
        node.executor.create_task(what)
