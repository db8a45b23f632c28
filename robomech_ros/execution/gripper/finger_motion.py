"""Goal of a finger command, its outcome, and the curve of the fingers."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np

from robomech_ros.execution.controller.trajectory_goal import TrajectoryGoal
from robomech_ros.execution.joints import TIME_TO_ACCELERATION, TIME_TO_SPEED, USUAL_SPEED, State
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.profiles.state_to_state import state_to_state
from robomech_ros.trajectory.waypoints import Waypoints, discretise
from robomech_ros.typing import Array, BoolArray

# Time for the range of fingers of unknown speed, s.
_TIME_TO_CLOSE = 1.0
# A motion has a waypoint at each step of its jerk, and no others, s; and so many at the most.
_NO_OTHERS = 1e6
_MOST = 1000


class FingerEnd(Enum):
    """Outcome of a finger command."""

    REACHED = "reached"
    STALLED = "stalled"
    CANCELLED = "cancelled"
    ABORTED = "aborted"


@dataclass(frozen=True, eq=False)
class FingerCommand:
    """Target positions (n,) of the fingers, rad or m; NaN for a joint that is to stay where it is.

    The velocities (n,) are the largest speeds (rad/s or m/s), the efforts (n,) the most that the
    drives may exert (N m or N); NaN where that is not known.
    """

    position: Array
    velocity: Array
    effort: Array

    @property
    def moved(self) -> BoolArray:
        """Mask (n,) of its joints."""
        return np.isfinite(self.position)


@dataclass(eq=False)
class FingerMotion:
    """A command that was accepted, and the goal whose curve moves the fingers.

    A joint that it is about moved last at ``last_moved`` (s on the clock of the follower). It has
    ``arrived`` when the curve is over; ``end`` is None until it has ended. ``on_end`` is called
    once with what has become of it, and a text that says why.
    """

    command: FingerCommand
    last_moved: float
    on_end: Callable[[FingerEnd, str], None]
    goal: TrajectoryGoal | None = field(default=None, init=False)
    arrived: bool = field(default=False, init=False)
    end: FingerEnd | None = field(default=None, init=False)

    def finish(self, end: FingerEnd, text: str = "") -> None:
        """Tell what has become of it; a second call does nothing."""
        if self.end is None:
            self.end = end
            self.on_end(end, text)


def complete_limits(limits: Limits) -> Limits:
    """Estimate the velocities, accelerations and jerks of fingers for which none are known."""
    known = np.isfinite(limits.lower) & np.isfinite(limits.upper)
    spread = np.where(known, limits.upper, 1.0) - np.where(known, limits.lower, 0.0)
    usual = np.where(known & (spread > 0.0), spread / _TIME_TO_CLOSE, USUAL_SPEED)
    velocity = np.where(np.isfinite(limits.velocity), limits.velocity, usual)
    push = limits.acceleration
    acceleration = np.where(np.isfinite(push), push, velocity / TIME_TO_SPEED)
    estimated = acceleration / TIME_TO_ACCELERATION
    jerk = np.where(np.isfinite(limits.jerk), limits.jerk, estimated)
    return replace(limits, velocity=velocity, acceleration=acceleration, jerk=jerk)


def waypoints_to(command: FingerCommand, present: State, limits: Limits) -> Waypoints:
    """Plan the way from the present state to where a command wants the fingers, at rest there.

    The limits are of all kinds for every joint; a joint that is faster already may stay so fast.
    Raises RobomechError for a goal outside the limits.
    """
    goal = np.where(command.moved, command.position, present.position)
    speed = np.maximum(np.minimum(command.velocity, limits.velocity), np.abs(present.velocity))
    motion = state_to_state(
        present.position,
        goal,
        limits=replace(limits, velocity=speed),
        start_velocity=present.velocity,
        start_acceleration=present.acceleration,
    )
    return discretise(motion, _NO_OTHERS, _MOST)
