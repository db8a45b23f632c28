"""Subscriptions whose waiting messages are all handled in one turn of the executor.

The executor of rclpy takes one message of each subscription in a turn. When turns last longer than
the period of the messages, the messages are handled later and later.
"""

from collections.abc import Awaitable, Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node

# Messages in a turn at most; one change of a scene takes half a millisecond.
_MOST = 100


def create_drained_subscription(
    node: Node,
    kind: Any,
    topic: str,
    callback: Callable[[Any], Awaitable[object]],
    depth: int,
    callback_group: CallbackGroup,
) -> None:
    """Create a subscription that handles all waiting messages in their order.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    kind : type
        Type of the messages.
    topic : str
        Name of the topic.
    callback : callable
        A coroutine function that handles one message.
    depth : int
        Number of messages that may wait.
    callback_group : CallbackGroup
        A mutually exclusive group keeps the messages in order.
    """

    async def take(message: Any) -> None:
        await callback(message)
        for _ in range(_MOST):
            with subscription.handle:
                taken = subscription.handle.take_message(kind, False)
            if taken is None:
                break
            await callback(taken[0])

    subscription = node.create_subscription(kind, topic, take, depth, callback_group=callback_group)
