"""Progress of the present trajectory by the joint states: whether they arrive, whether it moves."""

import numpy as np

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.client.position_check import STILL
from robomech_ros.execution.joints import approached, at_rest
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# A trajectory that leads farther than this (rad, m) from where it was should be seen to move.
NOTICEABLE = 10.0 * STILL


class MotionMonitor:
    """Watches a robot that was sent a trajectory from a position (n,), rad or m.

    Its joints had been received ``update_count`` times. It should follow ``curve`` from where it
    was. It has ``moved`` at all; two joint states that came since the trajectory should have ended
    are ``compared``, and it ``stands`` if it was at the same place then.
    """

    def __init__(self, delivery: ExecutionRequest, position: Array, update_count: int) -> None:
        self.moved = self.stands = self.compared = False
        self.curve = curve_from(delivery.waypoints, position)
        self._delay, self._lasts, self._over = max(delivery.delay, 0.0), delivery.lasts, False
        self._sent_at = self._received_at = self._now = delivery.sent_at
        self._received = update_count
        self._last = self._anchor = position
        self._left_at = self._expected(delivery.sent_at)
        self._overdue_since: float | None = None

    @property
    def silent(self) -> float:
        """Time since the last state of the joints, s."""
        return self._now - self._received_at

    @property
    def stuck(self) -> float:
        """Time (s) for which the robot has stood still although the trajectory moves."""
        return 0.0 if self._overdue_since is None else self._received_at - self._overdue_since

    def look(self, now: float, position: Array | None, update_count: int) -> None:
        """Note the present positions (n,), None if unknown, and the number of received states."""
        self._now = now
        if position is None or update_count == self._received:
            return
        self._received, self._received_at = update_count, now
        self.compared = self._over
        self.stands = self._over and bool(np.max(np.abs(position - self._last)) <= STILL)
        self._last, self._over = position, now - self._sent_at >= self._lasts
        expected = self._expected(now)
        if np.max(np.abs(position - self._anchor)) > STILL:
            self.moved = True
            self._anchor, self._left_at, self._overdue_since = position, expected, None
        elif self._overdue_since is None and np.max(np.abs(expected - self._left_at)) > NOTICEABLE:
            self._overdue_since = now

    def _expected(self, now: float) -> Array:
        """Return the expected position on the trajectory at this time (rad or m)."""
        time = now - self._sent_at - self._delay
        last = float(self.curve.breaks[-1])
        return self.curve.sample(min(max(time, 0.0), last)).position


def curve_from(waypoints: Waypoints, position: Array) -> PiecewisePolynomial:
    """Make the curve through waypoints, from a position (rad or m) where they begin later."""
    if waypoints.times[0] <= 0.0:
        return waypoints.curve
    return approached(waypoints, waypoints.positions, at_rest(position))
