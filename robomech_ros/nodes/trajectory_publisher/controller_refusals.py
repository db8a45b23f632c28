"""Reasons on /diagnostics why the controller rejects trajectories sent by topic."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.nodes.common.messages.rejection_status import read_refusal, trajectory_label
from robomech_ros.nodes.common.status_report import TOPIC

_DEPTH = 10


class ControllerRefusals:
    """Finds the refusal of what was sent last; a controller that says nothing has none.

    - ``on_refused``: called with an execution request, the controller's code and its reason.
    """

    def __init__(
        self, node: Node, controller: str, on_refused: Callable[[ExecutionRequest, int, str], None]
    ) -> None:
        self._name = f"{node.resolve_service_name(controller).lstrip('/')}: motion"
        self._on_refused = on_refused
        self._run, self._count = "", 0
        self._sent: tuple[ExecutionRequest, str, tuple[str, int]] | None = None
        node.create_subscription(DiagnosticArray, TOPIC, self._take, _DEPTH)

    def expect(self, execution: ExecutionRequest, message: JointTrajectory) -> None:
        """Note the message that is sent now."""
        self._sent = execution, trajectory_label(message), (self._run, self._count)

    def _take(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if status.name != self._name:
                continue
            refusal = read_refusal({entry.key: entry.value for entry in status.values})
            if refusal is None:
                continue
            self._run, self._count = refusal.run, refusal.number
            if self._sent is None:
                continue
            execution, label, (run, count) = self._sent
            # A controller that was started again counts from the beginning.
            is_new = refusal.number > (count if refusal.run == run else 0)
            if refusal.label == label and is_new and refusal.code:
                self._sent = None
                self._on_refused(execution, refusal.code, refusal.text)
