"""One trajectory on its way to a controller."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array


class Transport(Enum):
    """How a trajectory reaches the controller."""

    TOPIC = "topic"
    ACTION = "action"
    FOLLOW = "follow_joint_trajectory"

    @property
    def answers(self) -> bool:
        """Whether the controller says how the motion ended."""
        return self is not Transport.TOPIC


@dataclass(frozen=True)
class ExecutionReport:
    """How a delivery ended.

    Attributes
    ----------
    code : int
        One of `Code`; 0 if the robot is where the trajectory ends.
    text : str
        The reason, with joint and amount.
    duration : float
        From sending to the end, s; 0 if it was never sent.
    """

    code: int
    text: str
    duration: float


@dataclass(eq=False)
class ExecutionRequest:
    """A trajectory that is to be executed.

    Attributes
    ----------
    trajectory : object
        What is sent.
    names : sequence of str
        Its n joints.
    waypoints : Waypoints
        Its numbers, joints in the order of `names`.
    transport : Transport
        How it is sent.
    delay : float
        When it is to begin after it was sent or, before, after it was made, s; 0 = at once.
    due : float or None
        When its stamp lets it begin, s, once it is queued; None without a stamp.
    paced : bool
        Whether it is sent at another pace than planned, by its waypoints instead of `trajectory`.
    paced_on_way : bool
        Whether its pace was changed after it had begun.
    begun_at : float or None
        When it was sent first, s; None before; `sent_at` is when its pace was changed last.
    """

    trajectory: Any
    names: Sequence[str]
    waypoints: Waypoints
    transport: Transport
    delay: float = 0.0
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
        last: Array = self.waypoints.positions[-1]
        return last

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
        """Whether what was sent is to begin later than now (s)."""
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
