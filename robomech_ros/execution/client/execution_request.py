"""One trajectory on its way to a controller."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array


class Transport(Enum):
    """Transport of a trajectory to the controller."""

    TOPIC = "topic"
    ACTION = "action"
    FOLLOW = "follow_joint_trajectory"

    @property
    def answers(self) -> bool:
        """True if the controller says how the motion ended."""
        return self is not Transport.TOPIC


@dataclass(frozen=True)
class ExecutionReport:
    """End of a delivery: one of `Code`, the reason with joint and amount, and the duration.

    The code is 0 if the robot is where the trajectory ends. The duration is from sending to the end
    (s), 0 if it was never sent.
    """

    code: int
    text: str
    duration: float


@dataclass(eq=False)
class ExecutionRequest:
    """A trajectory that is to be executed: what is sent, its n joints, and its waypoints.

    It begins ``delay`` (s) after it was sent or, before, after it was made; 0 = at once. Once it is
    queued, ``due`` is when its stamp lets it begin (s), None without one. It is ``paced`` if it is
    sent at another pace than planned, by its waypoints instead of ``trajectory``, and
    ``paced_on_way`` if that changed after it had begun. It was sent first at ``begun_at`` (s), None
    before, and its pace was changed last at ``sent_at``. With ``ignore_collisions``
    no collisions are checked.
    """

    trajectory: Any
    names: Sequence[str]
    waypoints: Waypoints
    transport: Transport
    delay: float = 0.0
    ignore_collisions: bool = False
    paced: bool = False
    paced_on_way: bool = False
    due: float | None = None
    sent_at: float = 0.0
    begun_at: float | None = None
    report: ExecutionReport | None = None
    _listeners: list[Callable[[ExecutionReport], None]] = field(default_factory=list)

    @property
    def start(self) -> Array | None:
        """Start of the trajectory (rad or m); None if it starts from any position."""
        first: Array = self.waypoints.positions[0]
        return first if self.waypoints.times[0] <= 0.0 else None

    @property
    def goal(self) -> Array:
        """End of the trajectory (rad or m), shape (n,)."""
        return self.waypoints.positions[-1]

    @property
    def lasts(self) -> float:
        """From sending to the end of the motion, s."""
        return max(self.delay, 0.0) + float(self.waypoints.times[-1])

    def depart(self, now: float) -> None:
        """Be sent now (s)."""
        self.begun_at = now
        self.await_stamp(now)

    def await_stamp(self, now: float) -> None:
        """Count from now (s) the time left until the stamp."""
        self.sent_at = now
        if self.due is not None:
            self.delay = self.due - now

    def clock_jumped(self, by: float) -> None:
        """Note that the time of stamps jumped by this much (s)."""
        if self.due is not None:
            self.due -= by

    def waits(self, now: float) -> bool:
        """Return whether what was sent is to begin later than now (s)."""
        return now < self.sent_at + self.delay

    def listen(self, listener: Callable[[ExecutionReport], None]) -> None:
        """Report once, when it has ended."""
        if self.report is not None:
            listener(self.report)
        else:
            self._listeners.append(listener)

    def tell(self, report: ExecutionReport) -> None:
        """Tell all listeners, each of them once."""
        listeners, self._listeners = self._listeners, []
        for listener in listeners:
            listener(report)

    def end(self, report: ExecutionReport) -> None:
        """Set the report and tell it."""
        self.report = report
        self.tell(report)
