"""Status of a node on /diagnostics, once a second."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

TOPIC = "/diagnostics"
PERIOD = 1.0
_DEPTH = 10


@dataclass(frozen=True)
class NodeHealth:
    """Health of a node."""

    summary: str  #: The health in one line.
    warning: bool  #: Whether it needs attention.
    values: Mapping[str, object]  #: Further facts by name.


class StatusReport:
    """Publishes one status a second.

    - ``part``: name of the reported part of the node.
    - ``hardware``: name of the robot or device that the part belongs to.
    - ``describe``: returns the present health.
    """

    def __init__(
        self, node: Node, part: str, hardware: str, describe: Callable[[], NodeHealth]
    ) -> None:
        self._clock = node.get_clock()
        self._describe = describe
        self._name = f"{node.get_fully_qualified_name().lstrip('/')}: {part}"
        self._hardware = hardware
        self._publisher = node.create_publisher(DiagnosticArray, TOPIC, _DEPTH)
        node.create_timer(PERIOD, self.publish)

    def publish(self) -> None:
        """Publish the present condition."""
        condition = self._describe()
        status = DiagnosticStatus(
            level=DiagnosticStatus.WARN if condition.warning else DiagnosticStatus.OK,
            name=self._name,
            hardware_id=self._hardware,
            message=condition.summary,
            values=[KeyValue(key=k, value=str(v)) for k, v in condition.values.items()],
        )
        message = DiagnosticArray(status=[status])
        message.header.stamp = self._clock.now().to_msg()
        self._publisher.publish(message)
