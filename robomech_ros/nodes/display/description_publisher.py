"""Publishes what describes a robot on a latched topic, where nobody else does."""

import random

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import String

from robomech_ros.nodes.common.robot_description import LATCHED
from robomech_ros.nodes.display.other_publishers import PERIOD, OtherPublishers

# So many looks nobody else may have published before this node does: after the start, and, by
# chance in between, after it yielded, so that of two nodes that yield to each other one is first.
_QUIET, _QUIET_AGAIN = 2, (3, 9)


class DescriptionPublisher:
    """Publishes a URDF or an SRDF while nobody else publishes one.

    Two latched publishers would leave it to chance which robot a late subscriber gets.

    Parameters
    ----------
    node : Node
        Owner of publisher, timer and log.
    text : str
        The document.
    topic : str
        Where it is published.
    what : str
        What it is, for the log.
    """

    def __init__(self, node: Node, text: str, topic: str, what: str) -> None:
        self._node, self._text, self._what = node, text, what
        self._topic = node.resolve_topic_name(topic)
        self._own_name = topic
        self._others = OtherPublishers(node, self._topic)
        self._publisher: Publisher[String] | None = None
        self._before: tuple[str, ...] = ()
        self._quiet, self._wanted = 0, _QUIET
        node.create_timer(PERIOD, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _look(self) -> None:
        others = self._others.look()
        self._quiet = 0 if others else self._quiet + 1
        if others:
            self._yield_to(others)
        elif self._publisher is None and self._quiet >= self._wanted:
            self._publish()
        self._before = others

    def _yield_to(self, others: tuple[str, ...]) -> None:
        self._wanted = random.randint(*_QUIET_AGAIN)
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)
            self._publisher = None
        if not self._before:
            text = f"'{self._topic}' comes from {', '.join(dict.fromkeys(others))}, not from here"
            self._node.get_logger().info(text)

    def _publish(self) -> None:
        self._publisher = self._node.create_publisher(String, self._own_name, LATCHED)
        self._publisher.publish(String(data=self._text))
        self._node.get_logger().info(f"'{self._topic}' comes from here: {self._what}")
