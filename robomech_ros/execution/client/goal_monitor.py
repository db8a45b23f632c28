"""Detects from the joint states whether the robot arrives at the end of a delivery."""

import numpy as np

from robomech_ros.execution.client.controller_interface import ControllerInterface
from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.client.motion_monitor import MotionMonitor
from robomech_ros.execution.client.position_check import joint_distance, off_goal
from robomech_ros.execution.joints import JointKinds
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

# How long the joint states may take to confirm what the controller says, and to come at all, s.
CONFIRMATION = 1.0
# A controller without signs of life has died after so long (s) without joint states: some
# middleware gives no signs of life inside one process.
SILENCE_LIMIT = 0.25
# The time between two looks counts for no more than this (s): a process that was held up
# receives the messages of that time before its next look.
_ONE_LOOK = 0.6 * SILENCE_LIMIT
# A loop is looked at in so many places; a way out of less than this (rad, m) counts for none.
_PLACES = 200
_NOTICEABLE = 0.01
# Least part of the planned way out that must be seen, since joint states come at intervals.
_SEEN = 0.5


class GoalMonitor:
    """Watches the robot during one delivery, sent where it was at ``positions`` (n,), rad or m.

    ``elapsed`` and ``late`` are, at the last look, the time since it was sent and since it should
    be over (s); ``off`` says how the robot was off its goal then, and is empty if it was there.
    """

    def __init__(
        self,
        delivery: ExecutionRequest,
        gateway: ControllerInterface,
        settings: DispatchSettings,
        positions: Array,
    ) -> None:
        self.elapsed = self.late = 0.0
        self.off = ""
        self._delivery, self._gateway, self._settings = delivery, gateway, settings
        self._now = delivery.sent_at
        # How long there were no joint states, of which each look counts a part (s).
        self._silence = 0.0
        self._missing_since: float | None = None
        self._watch_from(positions)

    @property
    def stands(self) -> bool:
        """True if the robot was seen to stand since the trajectory should be over."""
        return self._progress.stands

    @property
    def _behind(self) -> bool:
        """True if joint states may still be unread after a stall of this process."""
        return self._progress.silent > 0.0 and self._silence <= SILENCE_LIMIT

    def begin_anew(self) -> None:
        """Watch from now on what was sent instead, from where the robot is now."""
        positions = self._gateway.positions(self._delivery.names)
        if positions is not None:
            self._watch_from(positions)

    def _watch_from(self, positions: Array) -> None:
        """Watch the delivery from where the robot is now (n,), rad or m."""
        delivery, gateway = self._delivery, self._gateway
        self._progress = MotionMonitor(delivery, positions, gateway.update_count(delivery.names))
        kinds = gateway.kinds(delivery.names)
        self._excursion = Excursion(delivery, self._progress.curve, positions, kinds)

    def look(self, now: float) -> None:
        """Look where the robot is at a time (s)."""
        delivery, gateway = self._delivery, self._gateway
        since, self._now = now - self._now, now
        self.elapsed = now - delivery.sent_at
        self.late = self.elapsed - delivery.lasts
        positions = gateway.positions(delivery.names)
        self._progress.look(now, positions, gateway.update_count(delivery.names))
        self._silence = self._silence + min(since, _ONE_LOOK) if self._progress.silent else 0.0
        if positions is None:
            # The last observation says more.
            self.off = self.off or f"no joint states of {', '.join(delivery.names)}"
        else:
            kinds = gateway.kinds(delivery.names)
            tolerance, moved = self._settings.goal_tolerance, self._progress.moved
            self.off = off_goal(delivery, positions, kinds, tolerance, moved)
            self._excursion.look(positions)

    @property
    def left_out(self) -> str:
        """Part of a closed path that the robot skipped, once it is at the end; empty for none."""
        return self._excursion.missing(self._settings.goal_tolerance)

    def lost(self, patience: float) -> MotionResult | None:
        """Return the verdict where controller or joint states are gone for `patience` (s).

        Of a controller that shows no sign of life the joint states need not be missed for long.
        """
        gone = self._gone(patience)
        if not gone:
            return None
        last = f"; at last {self.off}" if self.off else ""
        return MotionResult(Code.REJECTED, f"{gone}; how the motion ended is not known{last}")

    def arrival(self) -> MotionResult | None:
        """Return the verdict once the robot has arrived, or will not, by the joint states."""
        settings = self._settings
        if self.late >= 0.0 and not self.off and self.stands:
            left_out = self.left_out
            return MotionResult(Code.PREEMPTED if left_out else Code.NONE, left_out)
        if self.off and self._progress.stuck > settings.standstill_timeout:
            return self._stopped()
        if self.late > settings.arrival_timeout and not self._behind:
            lost = self.lost(max(settings.arrival_timeout, CONFIRMATION))
            if lost is not None or not self._progress.compared:
                return lost
            return MotionResult(Code.GOAL_TOLERANCE, self.off or "the robot does not come to rest")
        return None

    def _gone(self, patience: float) -> str:
        """Say what was not there for longer than `patience` (s); empty if all is there."""
        delivery, silent = self._delivery, self._progress.silent
        if self._gateway.replaced or (self._gateway.died and self._silence > SILENCE_LIMIT):
            return "the controller has died: its process is gone, or stands still"
        missing = self._gateway.missing(delivery.transport)
        if not missing:
            self._missing_since = None
        elif self._missing_since is None:
            self._missing_since = self._now
        if self._missing_since is not None and self._now - self._missing_since > patience:
            return f"the controller is gone: {missing} disappeared"
        if silent > patience and not self._behind:
            joints = ", ".join(delivery.names)
            return f"the controller is gone: no joint states of {joints} for {silent:.1f} s"
        return ""

    def _stopped(self) -> MotionResult:
        """Say of a robot that stands off its goal that it was stopped, or never began to move."""
        stuck = self._progress.stuck
        since = f"for {stuck:.1f} s, in which the trajectory should have moved it"
        if self._progress.moved:
            how = "it was stopped, or something else moves it"
            return MotionResult(Code.PREEMPTED, f"the robot stands {since}: {how}; {self.off}")
        return MotionResult(Code.REJECTED, f"the robot does not move {since}; {self.off}")


class Excursion:
    """Watches how far a robot goes away from a position (n,) from which it follows a curve."""

    def __init__(
        self,
        delivery: ExecutionRequest,
        curve: PiecewisePolynomial,
        position: Array,
        kinds: JointKinds,
    ) -> None:
        self._names, self._kinds, self._start = delivery.names, kinds, position
        places = curve.sample(np.linspace(0.0, float(curve.breaks[-1]), _PLACES)).position
        self._planned = np.max(joint_distance(places, position, kinds.continuous), axis=0)
        self._back = joint_distance(delivery.goal, position, kinds.continuous)
        self._seen = np.zeros(len(position))

    def look(self, position: Array) -> None:
        """Note where the robot is, rad or m."""
        away = joint_distance(position, self._start, self._kinds.continuous)
        self._seen = np.maximum(self._seen, away)

    def missing(self, tolerance: float) -> str:
        """Say what a robot at the end of a loop, to a tolerance (rad or m), has left out."""
        joint = int(np.argmax(self._planned))
        planned, seen = float(self._planned[joint]), float(self._seen[joint])
        if planned <= _NOTICEABLE or seen >= _SEEN * planned or np.max(self._back) > tolerance:
            return ""
        unit = f" {self._kinds.units[joint]}" if self._kinds.units[joint] else ""
        return (
            "the robot is where the trajectory begins and ends, but has not gone along it: joint "
            f"'{self._names[joint]}' was at most {seen:.3g}{unit} away, planned are "
            f"{planned:.3g}{unit}"
        )
