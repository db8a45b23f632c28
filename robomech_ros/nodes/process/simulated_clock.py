"""Simulated time that does not come: nothing moves, and no error says why."""

from collections.abc import Sequence

from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import steady_timer

# How long after a node's start to look, s, and again; every so many looks it is said.
PERIOD, EVERY = 3.0, 10


def missing_time(node: Node) -> str:
    """Say why a node with ``use_sim_time``, whose time is still 0, has none."""
    topic = node.resolve_topic_name("/clock")
    there = node.count_publishers(topic)
    why = f"the time on '{topic}' is still 0" if there else f"nobody publishes '{topic}'"
    return f"use_sim_time is true, but {why}"


def watch_for_simulated_time(nodes: Sequence[Node]) -> None:
    """Log, as long as it is so, that nodes with ``use_sim_time`` wait for ``/clock``."""
    waiting = [node for node in nodes if node.get_parameter("use_sim_time").value]
    if not waiting:
        return
    first, looks = waiting[0], 0

    def look() -> None:
        nonlocal looks
        if first.get_clock().now().nanoseconds:
            timer.cancel()
            return
        if looks % EVERY == 0:
            first.get_logger().warning(
                f"{missing_time(first)}: nothing moves, and no joint states come. Start the "
                "simulator, or leave use_sim_time out"
            )
        looks += 1

    timer = steady_timer(first, PERIOD, look)
