"""Speed scale of the present trajectory, and the messages that change it."""

from dataclasses import replace

import numpy as np

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.client.motion_monitor import curve_from
from robomech_ros.execution.client.paced_waypoints import paced_waypoints, slowed_waypoints
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.execution.time_scaling import TimeScaling, constant_pace, pace_change
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# What changes the pace takes over this long after it is sent (s), for it to arrive in time.  The
# pace stays for a while after that (s), in which the controller moves to the first point
# from where the robot really is.
LEAD = 0.2
APPROACH = 0.05
# A change that was too late for the controller is sent so often, each time with twice the lead.
_TRIES = 4
# Where acceleration limits are not known, the largest speed of a trajectory may be braked in this
# time, s, or as fast as the trajectory itself brakes.
_TIME_TO_STOP = 0.5
_SAMPLES = 500


def too_slow(delivery: ExecutionRequest, pace: float, longest: float) -> str:
    """Say that a delivery would last longer than `longest` (s) at a pace; empty if it would not."""
    lasts = float(delivery.waypoints.times[-1]) / pace
    return "" if lasts <= longest else _too_long(pace, lasts, longest)


class SpeedScaler:
    """Keeps a delivery at a pace above 0 up to 1, from a position (n,), rad or m.

    The delivery is sent now, slowed down if that is wanted, and may last at most ``longest`` (s).
    """

    def __init__(
        self, delivery: ExecutionRequest, position: Array, pace: float, longest: float = np.inf
    ) -> None:
        self._delivery, self._longest = delivery, longest
        self._waypoints = delivery.waypoints
        self._curve = curve_from(delivery.waypoints, position)
        starts = delivery.sent_at + max(delivery.delay, 0.0)
        self._scaling = constant_pace(starts, 0.0, pace)
        self._before: tuple[TimeScaling, Waypoints, float, float] | None = None
        self._lead = LEAD
        self._tries = 0
        if pace != 1.0:
            delivery.waypoints = slowed_waypoints(delivery.waypoints, pace)
            delivery.paced = True

    @property
    def stops(self) -> bool:
        """True if the delivery was stopped before its end."""
        return not self._scaling.pace

    def postpone(self, begin: float) -> None:
        """Note that what has not begun begins at another time (s)."""
        self._scaling = replace(self._scaling, begin=begin)

    def change(self, now: float, target: float, limit: Array | None) -> bool:
        """Make the rest of the delivery go at another pace, by other waypoints to be sent now.

        The pace wanted is 0 to 1, 0 = stop on the path, the limits (n,) are those of acceleration
        where they are known (rad/s^2 or m/s^2). Returns whether there was anything to change;
        raises TrajectoryRefusedError where the delivery waits for its stamp, or its rest would last
        too long.
        """
        delivery = self._delivery
        self._before = self._scaling, delivery.waypoints, delivery.sent_at, delivery.delay
        self._lead, self._tries = LEAD, 1
        return self._change(now, target, limit, self._longest)

    def change_again(self, now: float, limit: Array | None) -> bool:
        """Make the change of pace anew that the controller did not take, since it came too late.

        Parameters are those of `change`; returns whether there is something to send.  Where there
        is not, since the end is too near, the delivery is again what the controller executes.
        """
        if self._before is None or self._tries >= _TRIES:
            return False
        target, delivery = self._scaling.pace, self._delivery
        self._scaling, delivery.waypoints, delivery.sent_at, delivery.delay = self._before
        self._lead, self._tries = 2.0 * self._lead, self._tries + 1
        return self._change(now, target, limit, np.inf)

    def _change(self, now: float, target: float, limit: Array | None, longest: float) -> bool:
        delivery, scaling, curve = self._delivery, self._scaling, self._curve
        if now < scaling.begin and not delivery.paced_on_way:
            wait = scaling.begin - now
            raise TrajectoryRefusedError(f"the trajectory under way only begins in {wait:.3g} s")
        moves = scaling.pace_at(now + self._lead) > 0.0
        lead, approach = (self._lead, APPROACH) if moves else (0.0, 0.0)
        takes_over = max(now + lead, scaling.begin)
        begin = takes_over + approach
        place, pace = scaling.place(begin), scaling.pace_at(begin)
        if pace == target == scaling.pace or place >= curve.breaks[-1]:
            return False
        limit = _usual_limit(curve) if limit is None else limit
        changed = pace_change(curve, begin, place, pace, target, limit)
        rest = paced_waypoints(curve, self._waypoints, changed, approach)
        if rest.times[-1] > longest:
            raise TrajectoryRefusedError(_too_long(target, float(rest.times[-1]), longest))
        self._scaling, delivery.waypoints = changed, rest
        delivery.sent_at, delivery.delay = now, takes_over - now
        delivery.paced = delivery.paced_on_way = True
        return True


def _too_long(pace: float, lasts: float, longest: float) -> str:
    most = f"at most {longest:g} s may be"
    return f"at speed {pace:g} the trajectory would last {lasts:.6g} s, {most}"


def _usual_limit(curve: PiecewisePolynomial) -> Array:
    """Guess acceleration limits (n,) from what a trajectory asks of the joints."""
    sample = curve.sample(np.linspace(curve.breaks[0], curve.breaks[-1], _SAMPLES))
    peak: Array = np.abs(sample.acceleration).max(axis=0)
    braking: Array = np.abs(sample.velocity).max(axis=0) / _TIME_TO_STOP
    return np.where(peak > braking, peak, braking)
