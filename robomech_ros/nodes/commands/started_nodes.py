"""Topics, services and actions of nodes, found by starting them in a domain of their own."""

import os
import sys
import time
from collections.abc import Sequence
from contextlib import redirect_stdout
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.commands.bringup import node_class
from robomech_ros.nodes.commands.policy_xml import NodeRights, rights_of
from robomech_ros.nodes.common.robot.robot_description import TOPIC
from robomech_ros.nodes.common.robot.srdf_source import SEMANTIC_TOPIC
from robomech_ros.nodes.display.robot_display import AUTO
from robomech_ros.nodes.process.discovery_range import stay_on_this_machine
from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.nodes.process.run import Spinner
from robomech_ros.nodes.rvs.node import RvsNode

# Longest time until all nodes offer what they do, s, and between two looks.
_PATIENCE, _LOOK = 180.0, 0.1
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class NotUpError(RobomechError):
    """A node does not offer in time what it should."""


def rights_of_started(options: LaunchOptions) -> list[NodeRights]:
    """Start the nodes in a domain of their own, and look at all that they have there."""
    stay_on_this_machine()
    with free_domain() as domain, options.arguments_of_one_process() as arguments:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        rclpy.init(args=["robomech", *arguments], signal_handler_options=SignalHandlerOptions.NO)
        nodes: list[Node] = []
        try:
            # The policy alone is printed, not the address of a page that is gone soon.
            with redirect_stdout(sys.stderr):
                nodes += [node_class(node)() for node in options.nodes]
            return _looked_at(nodes)
        finally:
            for node in nodes:
                node.destroy_node()
            rclpy.try_shutdown()


def _looked_at(nodes: Sequence[Node]) -> list[NodeRights]:
    """Spin nodes until all their publishers and services exist."""
    spinner = Spinner(nodes)
    others = Node("other_publisher", start_parameter_services=False)
    spinner.start()
    try:
        awaited = []
        for node in nodes:
            awaited += _descriptions(node)
            if _shares_frames(node):
                awaited += _others_on_tf(others, node)
            if node.get_name() == "servo":
                awaited.append((node, "reply", f"{node.get_fully_qualified_name()}/pause_servo"))
            if isinstance(node, RvsNode):
                awaited += [(node, "subscribe", topic) for topic in node.listen_to_markers()]
        deadline = time.monotonic() + _PATIENCE
        for node, direction, name in awaited:
            while name not in _of(node).names[direction]:
                if time.monotonic() > deadline:
                    raise NotUpError(f"'{node.get_name()}' has no '{name}' after {_PATIENCE:g} s")
                time.sleep(_LOOK)
        return [_of(node) for node in nodes]
    finally:
        spinner.stop()
        others.destroy_node()


def _of(node: Node) -> NodeRights:
    return rights_of(node, node.get_name(), node.get_namespace())


def _value(node: Node, name: str) -> Any:
    """Return the value of a parameter; None where the node has none of this name."""
    return node.get_parameter(name).value if node.has_parameter(name) else None


def _descriptions(node: Node) -> list[tuple[Node, str, str]]:
    """List the documents that a node publishes once it has seen that nobody else does."""
    if not _value(node, "publish_description"):
        return []
    topics = [topic for topic in (TOPIC, SEMANTIC_TOPIC) if _value(node, topic)]
    return [(node, "publish", node.resolve_topic_name(topic)) for topic in topics]


def _shares_frames(node: Node) -> bool:
    """Return whether a node publishes those frames that nobody else does."""
    return _value(node, "publish_frames") == AUTO and _value(node, "enable_odom_tf") is not False


def _others_on_tf(others: Node, sharing: Node) -> list[tuple[Node, str, str]]:
    """Publish frames as others do: a node that shares frames listens only if there are others.

    Gives node, right and name of what it has then.
    """
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError:
        return []
    topics = [
        others.create_publisher(TFMessage, topic, _LATCHED).topic_name
        for topic in ("/tf", "/tf_static")
    ]
    return [(sharing, "subscribe", topic) for topic in topics]
