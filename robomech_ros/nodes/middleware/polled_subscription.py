"""Subscriptions that are read on demand, and keep the executor idle until then.

Their messages are unpacked by hand, so that bytes which are none disturb nobody.
"""

from collections.abc import Callable, Iterator
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog


class ManualSubscription(CallbackGroup):
    """Keeps a subscription out of the executor: its messages are taken by hand."""

    def __init__(self, attended: bool = False) -> None:
        super().__init__()
        self.attended = attended  #: Whether the executor still takes care of it.

    def can_execute(self, entity: Any) -> bool:
        """Return whether the executor may call back."""
        return self.attended

    def beginning_execution(self, entity: Any) -> bool:
        """Say the same."""
        return self.attended

    def ending_execution(self, entity: Any) -> None:
        """Nothing was begun."""


class UnreadableMessageError(RobomechError):
    """Bytes from the middleware are no message of the type of their topic."""

    def __init__(self, data: bytes, kind: type) -> None:
        super().__init__(f"{len(data)} bytes are no message of the type {kind.__name__}")


def unpack(data: bytes, kind: type) -> Any:
    """Read a message from raw bytes; UnreadableMessageError if it has another type."""
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # which one depends on the middleware
        raise UnreadableMessageError(data, kind) from error


class Inbox:
    """The latest messages of a topic, however fast they come.

    While somebody reads it repeatedly it is read by hand; otherwise the executor says when there is
    a message.

    - ``depth``: how many are kept, the latest.
    - ``wake``: called when a message has come while the executor looks after it, as it does at
      first. Without it, the executor never does.
    """

    def __init__(
        self, node: Node, kind: type, topic: str, depth: int, wake: Callable[[], None] | None = None
    ) -> None:
        self._log = ThrottledLog(node.get_logger())
        self._kind, self._depth, self._wake = kind, depth, wake
        self._group = ManualSubscription(attended=wake is not None)
        self._early: list[bytes] = []
        best_effort = ReliabilityPolicy.BEST_EFFORT
        newest = QoSProfile(depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=best_effort)
        options: dict[str, Any] = {"callback_group": self._group, "raw": True}
        # The events of a subscription that the executor passes over would only be in its way.
        options["event_callbacks"] = SubscriptionEventCallbacks(use_default_callbacks=bool(wake))
        self._subscription = node.create_subscription(kind, topic, self._receive, newest, **options)

    def attend(self, attended: bool) -> None:
        """Switch its service by the executor on or off."""
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

    def take_packed(self) -> list[bytes]:
        """Return the serialised messages that have come since the last look, the oldest first."""
        packed, self._early = self._early, []
        handle = self._subscription.handle
        with handle:
            for _ in range(self._depth):
                taken = handle.take_message(self._kind, True)
                if taken is None:
                    break
                packed.append(taken[0])
        return packed

    def take(self) -> Iterator[Any]:
        """Yield the messages that have come since the last look, the oldest first."""
        for data in self.take_packed():
            try:
                message = unpack(data, self._kind)
            except UnreadableMessageError as error:
                self._log.warning(f"passed over on '{self.topic}': {error}")
            else:
                yield message
