"""Subscriptions that are read when somebody looks, and keep the executor idle until then."""

from collections.abc import Callable, Iterator
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy

__all__ = ["Inbox", "Unattended"]


class Unattended(CallbackGroup):
    """Keeps a subscription out of the executor: its messages are taken by hand."""

    def can_execute(self, entity: Any) -> bool:
        """Nothing is executed."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Nothing is begun."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing was begun."""


class Inbox:
    """The latest messages of a topic, however fast they come.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    kind : type
        Of the messages.
    topic : str
        Its name.
    depth : int
        How many are kept, the latest.
    """

    def __init__(self, node: Node, kind: type, topic: str, depth: int) -> None:
        self._kind, self._depth = kind, depth
        self._early: list[Any] = []
        qos = QoSProfile(
            depth=depth,
            history=HistoryPolicy.KEEP_LAST,
            reliability=ReliabilityPolicy.BEST_EFFORT,
        )
        # The callback serves executors that do not honour callback groups.
        callback: Callable[[Any], None] = self._early.append
        self._subscription = node.create_subscription(
            kind, topic, callback, qos, callback_group=Unattended()
        )

    @property
    def topic(self) -> str:
        """The full name of the topic."""
        return str(self._subscription.topic_name)

    def take(self) -> Iterator[Any]:
        """Give what has come since the last look, the oldest first."""
        early = self._early[-self._depth :]
        self._early.clear()
        yield from early
        subscription = self._subscription
        with subscription.handle:
            for _ in range(self._depth):
                taken = subscription.handle.take_message(self._kind, False)
                if taken is None:
                    return
                yield taken[0]
