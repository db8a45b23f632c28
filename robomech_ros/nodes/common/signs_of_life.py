"""A controller of this package shows that it lives, by the middleware's own threads.

One that is killed stays in the graph for 20 s; the lease of its liveliness ends sooner.
"""

from typing import Any

from action_msgs.msg import GoalStatusArray
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile

__all__ = ["LIVELY", "SHORTEST_LEASE", "SignsOfLife"]

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


class SignsOfLife:
    """Knows whether a server of an action lives that publishes its status as `LIVELY`.

    Of other servers, and of those in the same process, it knows nothing.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    action : str
        Name of the action.
    lease : float
        How long there may be no sign of life, s.

    Attributes
    ----------
    ended : bool
        Whether it was there, and has gone or shows no sign of life any more.
    """

    def __init__(self, node: Node, action: str, lease: float) -> None:
        self.ended = False
        self._node = node
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

    def _take(self, change: Any) -> None:
        # The counts themselves miss a server that was alive before this subscription.
        if change.alive_count_change:
            self.ended = change.alive_count_change < 0 and not self._in_this_process()

    def _in_this_process(self) -> bool:
        """Whether a server belongs to our own participant, of which no signs of life come."""
        node, topic = self._node, self._subscription.topic_name
        own = {
            bytes(info.endpoint_gid[:_PREFIX])
            for info in node.get_subscriptions_info_by_topic(topic)
            if (info.node_name, info.node_namespace) == (node.get_name(), node.get_namespace())
        }
        servers = node.get_publishers_info_by_topic(topic)
        return any(bytes(info.endpoint_gid[:_PREFIX]) in own for info in servers)
