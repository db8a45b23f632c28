"""Clients and servers of different processes that know each other.

A server that does not know its client yet loses the answer
(https://github.com/ros2/rmw_fastrtps/issues/842).
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.node import Node
from unique_identifier_msgs.msg import UUID

# A busy machine starts the servers within this time, and they answer within this time, s.
_START, _PATIENCE = 180.0, 60.0
# A request without an answer is repeated after this time, s.
_AGAIN = 2.0


def connect(node: Node, wait: Callable[[Any, float], object]) -> None:
    """Ask each service of all clients of a node, those of its action clients too, until it answers.

    Parameters
    ----------
    node : Node
    wait : callable
        Waits for a future for so long (s) while the node spins.
    """
    for client in tuple(node.clients):
        name = client.srv_name
        assert client.wait_for_service(_START), f"no {name}"
        _ask_until_answered(name, partial(client.call_async, client.srv_type.Request()), wait)
    for action in [one for one in node.waitables if isinstance(one, ActionClient)]:
        name = action._action_name
        assert action.wait_for_server(_START), f"no {name}"
        unknown = ClientGoalHandle(action, UUID(uuid=list(uuid.uuid4().bytes)), None)
        for ask in (unknown.cancel_goal_async, unknown.get_result_async):
            _ask_until_answered(name, ask, wait)
        goal = partial(action.send_goal_async, action._action_type.Goal())
        handle = _ask_until_answered(name, goal, wait)
        if handle.accepted:
            _ask_until_answered(name, handle.get_result_async, wait)


def _ask_until_answered(
    name: str, ask: Callable[[], Any], wait: Callable[[Any, float], object]
) -> Any:
    """Return the answer to a request that is sent again until there is one."""
    until = time.monotonic() + _PATIENCE
    while time.monotonic() < until:
        future = ask()
        wait(future, _AGAIN)
        if future.done():
            return future.result()
    raise AssertionError(f"{name} does not answer")
