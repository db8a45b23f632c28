"""Requests that are sent again while no answer comes, where sending them twice does no harm.

A client can know a server before the server knows the client.  What it answers to a first request
is lost then, without a trace on either side: https://github.com/ros2/rmw_fastrtps/issues/842, open
in November 2026.  Look again in May 2027.
"""

import time
from typing import Any

from rclpy.client import Client
from rclpy.task import Future

# How long to wait before a request is sent again, s; each time twice as long as before.
_AGAIN = 2.0
# Services that only answer, by package.
_HARMLESS = {
    "robomech_interfaces": {
        "AnalyzeGrasp",
        "AnalyzeSingularity",
        "ContactForces",
        "ForwardDynamics",
        "GetJacobian",
        "InverseDynamics",
        "ListSamples",
        "MassMatrix",
        "QueryWorkspace",
        "SolveFK",
        "SolveGrasp",
        "SolveIK",
        "SolveIKBatch",
        "SummarizeTorques",
    },
    "control_msgs": {"QueryTrajectoryState"},
    "moveit_msgs": {
        "GetPlannerParams",
        "GetPlanningScene",
        "GetPositionFK",
        "GetPositionIK",
        "GetStateValidity",
        "QueryPlannerInterfaces",
    },
    "rcl_interfaces": {
        "DescribeParameters",
        "GetLoggerLevels",
        "GetParameterTypes",
        "GetParameters",
        "ListParameters",
    },
    "type_description_interfaces": {"GetTypeDescription"},
}


def changes_nothing(kind: Any) -> bool:
    """Return whether services of a type, such as ``SolveIK``, only answer."""
    package = kind.__module__.partition(".")[0]
    return kind.__name__ in _HARMLESS.get(package, ())


class RetriedRequest:
    """A request on its way; one that changes nothing may be sent several times.

    - ``client``: client of an available service.
    - ``kind``: the interface of the service.
    """

    def __init__(self, client: Client, kind: Any, request: Any) -> None:
        self._client, self._request = client, request
        self._sent: list[Future] = []
        self._pause = _AGAIN if changes_nothing(kind) else float("inf")
        #: Done as soon as the first answer is there; for waiting only, see :meth:`answer`.
        self.answered = Future()
        self._send()

    def _send(self) -> None:
        self._due = time.monotonic() + self._pause
        self._pause *= 2.0
        future = self._client.call_async(self._request)
        self._sent.append(future)
        future.add_done_callback(self._take)

    def _take(self, future: Future) -> None:
        if not self.answered.done():
            self.answered.set_result(future)

    def repeat_if_due(self) -> None:
        """Send the request again if that does no harm and the answer is late."""
        if not self.answered.done() and time.monotonic() > self._due:
            self._send()

    def answer(self) -> Any:
        """Return the first answer, which must be there; what comes later is dropped."""
        self.give_up()
        return self.answered.result().result()

    def give_up(self) -> None:
        """Wait for no more answers."""
        for future in self._sent:
            if not future.done():
                self._client.remove_pending_request(future)
