"""Readiness of a node: the service ``~/ready`` says what it waits for."""

from typing import Any

from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.services import serve

# Period of the log of a waiting node, s.
REMINDER = 10.0


class Readiness:
    """Answers ``~/ready``, and repeats in the log what is missing.

    - ``waits_for``: what is missing, as a sentence; empty if nothing is.
    """

    def __init__(self, node: Node, waits_for: str = "") -> None:
        self._waits_for = waits_for
        serve(node, Trigger, "~/ready", self._answer)
        if waits_for:
            node.get_logger().info(waits_for)
            logger = node.get_logger()
            self._timer = steady_timer(node, REMINDER, lambda: logger.warning(self._waits_for))

    def wait_for(self, what: str) -> None:
        """Store the missing part, as a sentence that is already in the log."""
        self._waits_for = what

    def reached(self) -> None:
        """Report readiness."""
        if self._waits_for:
            self._waits_for = ""
            self._timer.cancel()

    def _answer(self, request: Any, response: Any) -> Any:
        response.success = not self._waits_for
        response.message = self._waits_for or "ready"
        return response
