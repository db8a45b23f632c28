"""Fingers that commands and trajectories move, and what stops them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.gripper.finger_motion import (
    FingerCommand,
    FingerEnd,
    FingerMotion,
    waypoints_to,
)
from robomech_ros.execution.gripper.finger_plant import FingerPlant
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.limits import Limits


@dataclass(frozen=True)
class GripSettings:
    """When a command to fingers is over.

    A joint that is off its goal by ``goal_tolerance`` (rad or m) has reached it; up to
    ``stall_velocity`` (rad/s or m/s) a joint stands. Fingers stand for ``stall_timeout`` (s) before
    they are stalled.
    """

    goal_tolerance: float = 0.01
    stall_velocity: float = 0.001
    stall_timeout: float = 1.0


class Fingers:
    """Moves the joints of fingers, the plant of a follower, where commands want them.

    The limits are of all kinds, for every joint. The settings may be replaced at any time;
    ``motion`` is the command under way.
    """

    def __init__(
        self,
        follower: TrajectoryFollower,
        plant: FingerPlant,
        limits: Limits,
        settings: GripSettings,
    ) -> None:
        self.settings = settings
        self.motion: FingerMotion | None = None
        self._follower, self._plant, self._limits = follower, plant, limits
        self._strongest = plant.effort
        anything = np.full(len(limits.joint_names), np.inf)
        self._any = Tolerances(anything, anything, anything, np.inf)

    def move(
        self, command: FingerCommand, now: float, on_end: Callable[[FingerEnd, str], None]
    ) -> FingerMotion:
        """Move to where a command wants the joints, instead of whatever they are doing.

        ``on_end`` is called once, with what has become of it and why. Raises RobomechError, with
        nothing changed, where it is refused.
        """
        self._follower.advance(now)
        motion = FingerMotion(command, now, on_end)
        with self._from_where_they_are():
            waypoints = waypoints_to(command, self._follower.desired, self._limits)

            def over(result: GoalResult) -> None:
                self._curve_over(motion, result)

            by = "a newer command to the gripper"
            motion.goal = self._follower.start(waypoints, self._any, now, 0.0, over, by)
        self._replace(motion, f"preempted by {by}")
        self._plant.effort = command.effort
        return motion

    def follow(self, start: Callable[[], TrajectoryGoal], by: str) -> TrajectoryGoal:
        """Start a trajectory in the follower, in place of the present motion.

        ``start`` starts it; it may raise RobomechError, then nothing has changed. ``by`` says who
        sends it, for the text of the command that it replaces.
        """
        with self._from_where_they_are():
            goal = start()
        if goal is not self._follower.waiting:
            self._replace(None, f"preempted by {by}")
            self._plant.effort = self._strongest
        return goal

    def look(self) -> None:
        """Judge the command under way; to be called when the follower has moved on."""
        motion, settings = self.motion, self.settings
        if motion is None:
            return
        if motion.arrived and self._follower.active is not None:
            self._replace(None, "preempted by a trajectory that was to begin now")
            self._plant.effort = self._strongest
            return
        now, actual, moved = self._follower.now, self._follower.actual, motion.command.moved
        off = np.abs(actual.position - motion.command.position)[moved]
        pressing = bool(self._plant.pressing[moved].any())
        if np.any(np.abs(actual.velocity)[moved] > settings.stall_velocity):
            motion.last_moved = now
        if motion.arrived and bool(np.all(off <= settings.goal_tolerance)):
            self._end(FingerEnd.REACHED)
        elif (motion.arrived or pressing) and now - motion.last_moved >= settings.stall_timeout:
            self._end(FingerEnd.STALLED, self._stalled_text(motion))

    def cancel(self, motion: FingerMotion, text: str) -> None:
        """Slow down and hold, and end a command when the fingers stand; nothing if it has ended."""
        if motion is not self.motion:
            return
        if not self._follower.stop(End.CANCELLED, Code.PREEMPTED, text, motion.goal):
            self._follower.motion.stand()
            self._end(FingerEnd.CANCELLED, text)

    def close(self, text: str) -> None:
        """End a command of which the motion is over: what the fingers hold they go on holding."""
        if self._follower.active is None:
            self._end(FingerEnd.ABORTED, text)

    def reset(self, text: str) -> None:
        """End the command under way: the joints were put elsewhere."""
        self._end(FingerEnd.ABORTED, text)

    def _curve_over(self, motion: FingerMotion, result: GoalResult) -> None:
        if result.end is End.REACHED:
            motion.arrived = True
            return
        if motion is self.motion:
            self.motion = None
        cancelled = result.end is End.CANCELLED
        motion.finish(FingerEnd.CANCELLED if cancelled else FingerEnd.ABORTED, result.text)

    def _replace(self, motion: FingerMotion | None, text: str) -> None:
        self._end(FingerEnd.ABORTED, text)
        self.motion = motion

    def _end(self, end: FingerEnd, text: str = "") -> None:
        motion, self.motion = self.motion, None
        if motion is not None:
            motion.finish(end, text)

    @contextmanager
    def _from_where_they_are(self) -> Iterator[None]:
        """Begin a motion where the joints are stopped, not where they would be; or change nothing.

        What moves on a trajectory meanwhile goes on from where that is.
        """
        motion = self._follower.motion
        pressed = motion.desired
        if self._plant.pressing.any():
            motion.stand()
        try:
            yield
        except RobomechError:
            motion.desired = pressed
            raise

    def _stalled_text(self, motion: FingerMotion) -> str:
        command, at = motion.command, self._follower.actual.position
        worst = int(np.nanargmax(np.abs(at - command.position)))
        name, unit = self._limits.joint_names[worst], self._limits.units[worst]
        return (
            f"joint '{name}' stands at {at[worst]:.4g} {unit}, "
            f"its goal is {command.position[worst]:.4g} {unit}"
        )
