"""A controller of this package shows that it lives, by the middleware's own threads.

One that is killed stays in the graph for 20 s; the lease of its liveliness ends sooner.
"""

from collections.abc import Callable, Iterable
from typing import Any

from action_msgs.msg import GoalStatusArray
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile

# The shortest lease that may be asked for, and the one that is offered, s.
SHORTEST_LEASE, _OFFERED = 0.5, 0.4
# Bytes of a global identifier that name the participant.
_PREFIX = 12


def _lively(lease: float) -> QoSProfile:
    return QoSProfile(
        depth=1,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        liveliness=LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(seconds=lease),
    )


# For the status of an action: as its default, and with the lease.
LIVELY = _lively(_OFFERED)


class LivelinessMonitor:
    """Knows whether a server of an action lives that publishes its status as `LIVELY`.

    Of other servers, and of those in the same process, it knows nothing.

    - ``action``: name of the action.
    - ``lease``: how long there may be no sign of life, s.
    - ``on_end``: called when a server has gone or shows no sign of life any more.
    """

    def __init__(
        self, node: Node, action: str, lease: float, on_end: Callable[[], None] = lambda: None
    ) -> None:
        self._node, self._on_end = node, on_end
        # Whether each server lives, by its participant, in the order in which they came.
        self._lives: dict[bytes, bool] = {}
        # Who died, in that order, and whether the last change was that somebody came or came back.
        self._died: list[bytes] = []
        self._gained = False
        self._subscription = node.create_subscription(
            GoalStatusArray,
            f"{action}/_action/status",
            lambda status: None,
            _lively(lease),
            # Others offer no lease: that is nothing to be logged.
            event_callbacks=SubscriptionEventCallbacks(
                liveliness=self._take, incompatible_qos=lambda event: None
            ),
        )

    @property
    def ended(self) -> bool:
        """True if a server was there, and has gone or shows no sign of life any more."""
        return bool(self._lives) and not self._living()

    @property
    def server(self) -> bytes | None:
        """The participant of the server that came last of those that live; None if not known."""
        return next((each for each in reversed(self._lives) if self._lives[each]), None)

    def has_successor(self, server: bytes | None) -> bool:
        """Return whether a server has died and another one lives; False where it is not known."""
        if server is None or self._lives.get(server, True):
            return False
        return bool(self._living() - {server})

    def reads(self, topic: str, *, no_mangle: bool = False) -> bool:
        """Return whether a server that lives subscribes to a topic; True where that is not known.

        The subscriptions of a killed one stay in the graph, and what is sent to them is lost.

        - ``topic``: full name of the topic; the middleware's own name with ``no_mangle``.
        - ``no_mangle``: as `Node.get_subscriptions_info_by_topic` has it.
        """
        if not self._lives:
            return True
        readers = _participants(self._node.get_subscriptions_info_by_topic(topic, no_mangle))
        return not readers or not self._living().isdisjoint(readers)

    def _take(self, change: Any) -> None:
        # The counts themselves miss a server that was alive before this subscription.
        count = change.alive_count_change
        if not count or self._in_this_process():
            return
        there = self._servers()
        for each in there:
            self._lives.setdefault(each, True)
        living = [each for each, lives in self._lives.items() if lives]
        if count < 0:
            # Those that have left, then those that came first: they were restarted.
            living.sort(key=there.__contains__)
            self._died += living[:-count]
            self._lives.update(dict.fromkeys(living[:-count], False))
            self._on_end()
        elif not any(self._lives[each] for each in there):
            # None of them is new: it stood still for a while, most likely the last one that died.
            back = [each for each in reversed(self._died) if each in there][:count]
            self._died = [each for each in self._died if each not in back]
            self._lives.update(dict.fromkeys(back, True))
        self._gained = count > 0

    def _living(self) -> set[bytes]:
        """Return the participants of those servers that are there and live."""
        there = self._servers()
        living = {each for each in there if self._lives.get(each, True)}
        # If another server than expected came back, the remaining ones may be it.
        return living or set(there if self._gained else ())

    def _servers(self) -> list[bytes]:
        """Return the participants of all servers in the graph, also of those that were killed."""
        topic = self._subscription.topic_name
        return _participants(self._node.get_publishers_info_by_topic(topic))

    def _in_this_process(self) -> bool:
        """Tell whether a server belongs to our own participant, of which no signs of life come."""
        node, topic = self._node, self._subscription.topic_name
        own = _participants(
            info
            for info in node.get_subscriptions_info_by_topic(topic)
            if (info.node_name, info.node_namespace) == (node.get_name(), node.get_namespace())
        )
        return not set(own).isdisjoint(self._servers())


def _participants(endpoints: Iterable[Any]) -> list[bytes]:
    return [bytes(info.endpoint_gid[:_PREFIX]) for info in endpoints]
