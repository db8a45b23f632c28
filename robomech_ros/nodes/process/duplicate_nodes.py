"""Nodes of the same name in one domain: each request would be answered by either of them."""

from collections.abc import Sequence

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

# How often to look after a node's start, s, and how many times: discovery takes its time.
PERIOD, LOOKS = 1.0, 3


def watch_for_duplicate_nodes(nodes: Sequence[Node]) -> None:
    """Log once, soon after the start, which nodes were in this domain and namespace already."""
    if not nodes:
        return
    clock, said, first = Clock(clock_type=ClockType.STEADY_TIME), set[str](), nodes[0]
    looks = iter(range(LOOKS))

    def look() -> None:
        if next(looks) == LOOKS - 1:
            timer.cancel()
        found = [
            f"{namespace.rstrip('/')}/{name}"
            for name, namespace in first.get_node_names_and_namespaces()
        ]
        for node in nodes:
            name = node.get_fully_qualified_name()
            if found.count(name) > 1 and name not in said:
                said.add(name)
                text = (
                    f"another node '{name}' is in this domain: both answer the same services and "
                    "move the same topics. End one of them, or set ROS_DOMAIN_ID, or a namespace "
                    "(robomech bringup --namespace). One that was killed is seen for up to 20 s"
                )
                node.get_logger().error(text)

    timer = first.create_timer(PERIOD, look, clock=clock)
