"""Subscriptions that need reliable publishers, and say so to those that are not."""

from collections.abc import Callable
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo

from robomech_ros.nodes.middleware.throttled_log import ThrottledLog


def node_of(endpoint: TopicEndpointInfo) -> str:
    """Return the full name of the node of a publisher or subscription."""
    return f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"


def subscribe_reliably(
    node: Node, kind: Any, topic: str, callback: Callable[..., None], qos: QoSProfile | int
) -> Subscription:
    """Subscribe to messages that must not be lost; log best-effort publishers.

    - ``callback``: takes the messages.
    - ``qos``: reliable; a depth alone is that.
    """
    sparing = ThrottledLog(node.get_logger())

    def log(event: Any) -> None:
        name = node.resolve_topic_name(topic)
        found = node.get_publishers_info_by_topic(name)
        best_effort = ReliabilityPolicy.BEST_EFFORT
        senders = {node_of(one) for one in found if one.qos_profile.reliability == best_effort}
        by = f" by {', '.join(sorted(senders))}" if senders else ""
        text = (
            f"messages on '{name}'{by} do not arrive: they are published best effort, or volatile "
            "where a latched topic is needed; publish them reliably, as the default of ROS is "
            "(ros2 topic pub --qos-reliability reliable)"
        )
        sparing.error(text)

    events = SubscriptionEventCallbacks(incompatible_qos=log)
    return node.create_subscription(kind, topic, callback, qos, event_callbacks=events)
