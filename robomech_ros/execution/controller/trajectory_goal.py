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
    """The end of a motion.

    Attributes
    ----------
    end : End
        What became of it.
    code : int
        One of `Code`; 0 if the goal was reached.
    text : str
        The reason with joint and amount; empty if there is nothing to say.
    error : ndarray, shape (n,)
        Last point of the trajectory less actual position at that moment, rad or m.
    """

    end: End
    code: int
    text: str
    error: Array


@dataclass(eq=False)
class TrajectoryGoal:
    """A trajectory that was accepted.

    Attributes
    ----------
    waypoints : Waypoints
        As they came, joints in the order of the robot.
    tolerances : Tolerances
        What the motion is held to.
    begin : float
        When it begins or began, on the clock of the follower (s).
    curve : PiecewisePolynomial
        From the state expected at `begin`, replaced by the one from the state found then.
    on_end : callable
        Called once with the result.
    result : GoalResult or None
        None until it has ended.
    time : float
        How far it has come on its curve, s.
    braking : float
        How long before the end of the curve the trajectory is over and the robot brakes, s.
    arrived : bool
        Whether it was where it should be when the trajectory was over.
    remark : str
        What else the result is to say.
    strain : str
        By how much it is over the limits of acceleration; empty if it is not.
    schedule : ScheduleShift or None
        Where the trajectory is, if it came late and the robot catches up with it.
    streamed : bool
        Whether it came by a topic, and may be one of a stream.
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
