"""Clients and actions whose queues hold a burst of calls.

The default queue of a ROS service holds ten requests; those that come while it is full vanish,
and their clients wait for ever. The same holds for a client's queue of answers:
https://github.com/ros2/rmw/issues/372, open in November 2026. Look again in May 2027.
"""

from collections.abc import Awaitable, Callable
from typing import Any

from rclpy.action import ActionClient, ActionServer
from rclpy.client import Client
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future

# Calls that a queue holds; a thousand at once took 30 MB.
DEPTH = 2000
DEEP = QoSProfile(depth=DEPTH)
# The three services of an action.
_ACTION = ("goal_service_qos_profile", "result_service_qos_profile", "cancel_service_qos_profile")


def ask(node: Node, kind: Any, name: str) -> Client:
    """Create a client that keeps up to `DEPTH` answers, its own and those of other clients."""
    return node.create_client(kind, name, qos_profile=DEEP)


def serve_action(
    node: Node, kind: Any, name: str, execute: Callable[[Any], Awaitable[Any]], **options: Any
) -> ActionServer:
    """Create an action server that keeps up to `DEPTH` goals, cancellations and asked results.

    What a goal asked for is kept until it has ended, and no longer.
    """

    async def executed(handle: Any) -> Any:
        try:
            return await execute(handle)
        finally:
            # rclpy keeps it beside the result: 7 MB of each trajectory of 10,000 points.
            handle._goal_request = None

    return ActionServer(node, kind, name, executed, **dict.fromkeys(_ACTION, DEEP), **options)


def ask_action(node: Node, kind: Any, name: str) -> ActionClient:
    """Create an action client that keeps up to `DEPTH` answers."""
    return _GoalSender(node, kind, name, **dict.fromkeys(_ACTION, DEEP))


class _GoalSender(ActionClient):
    """Keeps nothing of goals that are over."""

    def send_goal_async(self, *arguments: Any, **options: Any) -> Future:
        """Send a goal; see ActionClient."""
        known = set(self._futures)
        answer = super().send_goal_async(*arguments, **options)
        # rclpy 9.1 makes two futures for each goal, one of which is never done and kept for ever.
        # Mended by https://github.com/ros2/rclpy/pull/1532: remove this with the last rclpy before.
        for future in set(self._futures) - known - {answer}:
            self.remove_future(future)
        return answer
