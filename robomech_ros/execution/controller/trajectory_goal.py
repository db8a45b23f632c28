"""One trajectory on its way: accepted, perhaps waiting for its time, moving, ended."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum, auto

import numpy as np

from robomech_ros.execution.controller.late_start import ScheduleShift
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array


class End(IntEnum):
    """Outcome of a trajectory."""

    REACHED = auto()
    ABORTED = auto()
    CANCELLED = auto()


@dataclass(frozen=True, eq=False)
class GoalResult:
    """The end of a motion: what became of it, one of `Code`, the reason, and the error (n,).

    The code is 0 if the goal was reached; the reason names joint and amount, and is empty if there
    is nothing to say. The error is the last point of the trajectory less the actual position (rad
    or m).
    """

    end: End
    code: int
    text: str
    error: Array


@dataclass(eq=False)
class TrajectoryGoal:
    """A trajectory that was accepted, its waypoints as they came, joints in the order of the robot.

    It begins or began at ``begin`` on the clock of the follower (s). The curve is that from the
    state expected then, replaced by the one from the state found; ``time`` is how far it has come
    on it, and ``braking`` how long before the end of the curve the trajectory is over and the robot
    brakes (s). It has ``arrived`` if the robot was where it should be then. ``on_end`` is called
    once with the result, which is None until it has ended; ``remark`` is what else it is to say.
    ``strain`` says by how much it is over the limits of acceleration. ``schedule`` is where a late
    trajectory is with which the robot catches up. It is ``streamed`` if it came by a topic, and may
    be one of a stream.
    """

    waypoints: Waypoints
    tolerances: Tolerances
    begin: float
    curve: PiecewisePolynomial
    late: float = 0.0
    on_end: Callable[[GoalResult], None] = field(default=lambda result: None)
    result: GoalResult | None = None
    time: float = 0.0
    braking: float = 0.0
    arrived: bool = False
    remark: str = ""
    strain: str = ""
    schedule: ScheduleShift | None = None
    streamed: bool = False

    @property
    def last_position(self) -> Array:
        """End of the trajectory (rad or m), shape (n,)."""
        return self.curve.sample(self.curve.breaks[-1]).position

    @property
    def arrival(self) -> float:
        """When the last point is to be reached, s on the curve."""
        return self.curve.duration - self.braking

    @property
    def progress(self) -> float:
        """Part of the duration that has passed, 0 to 1."""
        duration = self.arrival
        return min(self.time / duration, 1.0) if duration > 0.0 else 1.0

    def finish(self, end: End, code: int, text: str, actual: Array) -> None:
        """Set the result and tell it; a second call does nothing."""
        if self.result is None:
            text = "; ".join(part for part in (text, self.remark) if part)
            self.result = GoalResult(end, int(code), text, np.subtract(self.last_position, actual))
            self.on_end(self.result)
