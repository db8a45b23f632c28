"""Deliveries that wait for those before them, for the controller and for the joint states."""

from collections import deque
from collections.abc import Callable

from robomech_ros.execution.client.controller_interface import ControllerInterface
from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.execution_request import ExecutionReport, ExecutionRequest
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array


class QueueFullError(TrajectoryRefusedError):
    """The queue of waiting trajectories is full."""

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        super().__init__(f"the queue is full, with {capacity} waiting; send it again later")


# A delivery, and where the robot is (n,), rad or m, if it can be sent; or, if it has waited
# too long, its result.
Taken = tuple[ExecutionRequest, Array | MotionResult]


class ExecutionQueue:
    """Deliveries in the order in which they came.

    ``on_stall`` is called once with what is missing while deliveries wait for it; ``stalled`` says
    what they have waited for too long, and is empty if there is nothing.
    """

    def __init__(
        self,
        gateway: ControllerInterface,
        settings: DispatchSettings,
        on_stall: Callable[[str], None],
    ) -> None:
        self.stalled = ""
        self._gateway, self._settings, self._on_stall = gateway, settings, on_stall
        self._waiting: deque[ExecutionRequest] = deque()
        self._away_since: float | None = None
        self._silent_since: float | None = None

    def __len__(self) -> int:
        return len(self._waiting)

    def __contains__(self, delivery: ExecutionRequest) -> bool:
        return delivery in self._waiting

    def add(self, delivery: ExecutionRequest, now: float) -> None:
        """Put a delivery behind the others, at a time (s), or raise QueueFullError."""
        if len(self._waiting) >= self._settings.capacity:
            raise QueueFullError(self._settings.capacity)
        delivery.due = now + delivery.delay if delivery.delay else None
        self._waiting.append(delivery)

    def pop(self) -> ExecutionRequest:
        """Take the first one out, whatever it waits for."""
        return self._waiting.popleft()

    def clock_jumped(self, by: float) -> None:
        """Note that the time of stamps jumped by `by` (s)."""
        for each in self._waiting:
            each.clock_jumped(by)

    def take(self, now: float) -> list[Taken]:
        """Take out what need not wait any longer at a time (s).

        That is the first delivery and where the robot is (n,), rad or m, where it can be sent now;
        or those that have waited too long, each with its result.
        """
        delivery = self._waiting[0]
        missing = self._gateway.missing(delivery.transport)
        if missing:
            return self._wait_for_controller(missing, now)
        self._away_since, self.stalled = None, ""
        positions = self._gateway.positions(delivery.names)
        if positions is None:
            return self._wait_for_states(delivery, now)
        self._silent_since = None
        return [(self._waiting.popleft(), positions)]

    def _wait_for_states(self, delivery: ExecutionRequest, now: float) -> list[Taken]:
        """Drop the first one if states of its joints are missing for too long.

        The controller is there, so those behind it, which may name other joints, must not wait.
        """
        if self._silent_since is None:
            self._silent_since = now
        waited = now - self._silent_since
        if waited < self._settings.controller_timeout:
            return []
        self._silent_since = None
        joints = ", ".join(delivery.names)
        text = f"no joint states of {joints} within {waited:.1f} s"
        return [(self._waiting.popleft(), MotionResult(Code.NO_STATE, text))]

    def _wait_for_controller(self, missing: str, now: float) -> list[Taken]:
        """Nothing can be sent: after a while give up those whose senders wait for an answer."""
        self._silent_since = None
        if self._away_since is None:
            self._away_since = now
        waited = now - self._away_since
        if waited < self._settings.controller_timeout:
            return []
        text = f"{missing} not there after {waited:.1f} s"
        if not self.stalled:
            self._on_stall(text)
        self.stalled = text
        asked = [each for each in self._waiting if each.transport.answers]
        stay = [each for each in self._waiting if not each.transport.answers]
        self._waiting = deque(stay)
        for each in stay:
            report = ExecutionReport(Code.REJECTED, f"{text}; the trajectory stays queued", 0.0)
            each.tell(report)
        return [(each, MotionResult(Code.REJECTED, text)) for each in asked]
