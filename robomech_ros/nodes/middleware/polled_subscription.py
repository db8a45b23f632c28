"""Subscriptions that are read on demand, and keep the executor idle until then."""

from collections.abc import Callable, Iterator
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from robomech_ros.nodes.middleware.raw_messages import UnreadableMessageError, unpack
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog


class ManualSubscription(CallbackGroup):
    """Keeps a subscription out of the executor: its messages are taken by hand.

    Attributes
    ----------
    attended : bool
        Whether the executor still takes care of it.
    """

    def __init__(self, attended: bool = False) -> None:
        super().__init__()
        self.attended = attended

    def can_execute(self, entity: Any) -> bool:
        """Say whether the executor may call back."""
        return self.attended

    def beginning_execution(self, entity: Any) -> bool:
        """Say the same."""
        return self.attended

    def ending_execution(self, entity: Any) -> None:
        """Nothing was begun."""


def latest(depth: int) -> QoSProfile:
    """Make the profile of a subscription to the latest messages of every sender."""
    best_effort = ReliabilityPolicy.BEST_EFFORT
    return QoSProfile(depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=best_effort)


def take_waiting(subscription: Subscription, kind: type, depth: int) -> Iterator[bytes]:
    """Yield the serialised messages that wait in a raw subscription, at most so many."""
    with subscription.handle:
        for _ in range(depth):
            taken = subscription.handle.take_message(kind, True)
            if taken is None:
                return
            yield taken[0]


class Inbox:
    """The latest messages of a topic, however fast they come.

    While somebody reads it repeatedly it is read by hand; otherwise the executor says when there is
    a message.

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
    wake : callable, optional
        Called when a message has come while the executor looks after it, as it does at first.
        Without it, the executor never does.
    """

    def __init__(
        self, node: Node, kind: type, topic: str, depth: int, wake: Callable[[], None] | None = None
    ) -> None:
        self._log = ThrottledLog(node.get_logger())
        self._kind, self._depth, self._wake = kind, depth, wake
        self._group = ManualSubscription(attended=wake is not None)
        self._early: list[bytes] = []
        self._subscription = node.create_subscription(
            kind, topic, self._receive, latest(depth), callback_group=self._group, raw=True
        )

    def attend(self, attended: bool) -> None:
        """Have the executor look after it, or not."""
        self._group.attended = attended

    def _receive(self, data: bytes) -> None:
        # Some executors do not honour callback groups.
        self._early.append(data)
        del self._early[: -self._depth]
        if self._group.attended and self._wake is not None:
            self._wake()

    @property
    def topic(self) -> str:
        """The full name of the topic."""
        return str(self._subscription.topic_name)

    def take(self) -> Iterator[Any]:
        """Yield the messages that have come since the last look, the oldest first."""
        early, self._early = self._early, []
        for data in (*early, *take_waiting(self._subscription, self._kind, self._depth)):
            try:
                message = unpack(data, self._kind)
            except UnreadableMessageError as error:
                self._log.warning(f"passed over on '{self.topic}': {error}")
            else:
                yield message
