"""What a dispatcher deals with: the way to the controller, its settings, what it counts."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from robomech_ros.execution.client.delivery import Delivery, Transport
from robomech_ros.execution.client.progress import Progress
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["DispatchSettings", "Gateway", "QueueFullError", "Tally", "stopped", "with_place"]


class QueueFullError(TrajectoryRefusedError):
    """As many trajectories wait as may."""

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        super().__init__(f"{capacity} trajectories are waiting already, no more can be accepted")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.capacity,)


class Gateway(Protocol):
    """The way to the controller and to the robot's state."""

    def missing(self, transport: Transport) -> str:
        """Say what is not there to send by; empty if all is."""

    def send(self, delivery: Delivery) -> None:
        """Send, instead of what was sent of this delivery before.

        By action, `Dispatcher.concluded` is called with the result of what was sent last.
        """

    def cancel(self, delivery: Delivery) -> None:
        """Ask the controller to give up a delivery sent by action."""

    def runs_before(self, delivery: Delivery) -> bool:
        """Say whether the controller still executes what was sent before of this delivery."""

    def positions(self, names: Sequence[str]) -> FloatArray | None:
        """Give the present positions, rad or m; None if not known."""

    def heard(self, names: Sequence[str]) -> int:
        """Give a number that has grown when all these joints were heard of anew."""

    def continuous(self, names: Sequence[str]) -> npt.NDArray[np.bool_]:
        """Say which joints turn without limits."""

    def acceleration(self, names: Sequence[str]) -> FloatArray | None:
        """Give the acceleration limits, rad/s^2 or m/s^2; None if the robot is not known."""


@dataclass(frozen=True)
class DispatchSettings:
    """What the owner decides.

    Attributes
    ----------
    capacity : int
        How many trajectories may wait.
    start_tolerance, goal_tolerance : float
        How far the joints may be from start and goal, rad or m.
    controller_timeout : float
        How long the controller may be away before those who wait are told, s.
    arrival_timeout : float
        How long after its end a motion may take to arrive, s.
    standstill_timeout : float
        How long the robot may stand away from the goal while a trajectory sent by topic should
        move it, s; then it was stopped.
    max_duration : float
        How long a trajectory may last at the speed at which it is executed, s.
    """

    capacity: int = 50
    start_tolerance: float = 0.01
    goal_tolerance: float = 0.01
    controller_timeout: float = 3.0
    arrival_timeout: float = 2.0
    standstill_timeout: float = 1.0
    max_duration: float = np.inf


@dataclass
class Tally:
    """What has happened so far, for the diagnostics."""

    sent: int = 0
    arrived: int = 0
    failed: int = 0
    last_failure: str = ""
    stalled: str = ""


def with_place(gone: str, off: str) -> str:
    """Add to what is gone where the robot was seen last."""
    last = f"; at last {off}" if off else ""
    return f"{gone}; how the motion ended is not known{last}"


def stopped(progress: Progress, off: str) -> tuple[int, str]:
    """Say of a robot that stands off its goal that it was stopped, or never began to move."""
    since = f"for {progress.stuck:.1f} s, in which the trajectory should have moved it"
    if progress.moved:
        how = "it was stopped, or something else moves it"
        return int(Code.PREEMPTED), f"the robot stands {since}: {how}; {off}"
    return int(Code.REJECTED), f"the robot does not move {since}; {off}"
