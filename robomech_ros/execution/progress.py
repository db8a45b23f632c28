"""What the joint states tell of a trajectory under way: whether they come, whether it moves."""

import numpy as np

from robomech_ros.execution.comparison import STILL
from robomech_ros.execution.delivery import Delivery
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray
from robomech_ros.trajectory.waypoints import Waypoints

__all__ = ["Progress"]

# A trajectory that leads farther than this (rad, m) from where it was should be seen to move.
NOTICEABLE = 10.0 * STILL


class Progress:
    """Watches a robot that was sent a trajectory.

    Parameters
    ----------
    delivery : Delivery
        What was sent.
    position : ndarray, shape (n,)
        Where the robot was then, rad or m.
    heard : int
        How often its joints had been heard of.

    Attributes
    ----------
    moved : bool
        Whether the robot has moved at all.
    """

    def __init__(self, delivery: Delivery, position: FloatArray, heard: int) -> None:
        self.moved = False
        self._curve = _curve(delivery.waypoints, position)
        self._delay = max(delivery.delay, 0.0)
        self._sent_at = self._heard_at = self._now = delivery.sent_at
        self._heard = heard
        self._last = self._anchor = position
        self._due = self._expected(delivery.sent_at)
        self._overdue_since: float | None = None

    @property
    def silent(self) -> float:
        """How long the joints were not heard of, s."""
        return self._now - self._heard_at

    @property
    def stuck(self) -> float:
        """How long the robot stands although the trajectory should have moved it, s.

        It ends when the robot was heard of for the last time: of a robot that is silent nobody
        knows.
        """
        return 0.0 if self._overdue_since is None else self._heard_at - self._overdue_since

    @property
    def stands(self) -> bool:
        """Whether the robot did not move between the last two looks."""
        return self._still

    def look(self, now: float, position: FloatArray, heard: int) -> None:
        """Take note of the present positions.

        Parameters
        ----------
        now : float
            The time, s.
        position : ndarray, shape (n,)
            Where the joints are as far as known, rad or m.
        heard : int
            How often all of them were heard of.
        """
        self._now = now
        self._still = bool(np.max(np.abs(position - self._last)) <= STILL)
        self._last = position
        if heard == self._heard:
            return
        self._heard, self._heard_at = heard, now
        due = self._expected(now)
        if np.max(np.abs(position - self._anchor)) > STILL:
            self.moved = True
            self._anchor, self._due, self._overdue_since = position, due, None
        elif self._overdue_since is None and np.max(np.abs(due - self._due)) > NOTICEABLE:
            self._overdue_since = now

    _still = False

    def _expected(self, now: float) -> FloatArray:
        """Where the trajectory is by now, rad or m."""
        time = now - self._sent_at - self._delay
        last = float(self._curve.breaks[-1])
        return self._curve.sample(min(max(time, 0.0), last)).position


def _curve(waypoints: Waypoints, position: FloatArray) -> PiecewisePolynomial:
    """Make the curve through the waypoints, from the present position where they begin later."""
    if waypoints.times[0] <= 0.0:
        return waypoints.curve
    still = np.zeros(len(position))
    rates = (
        None if rate is None else np.vstack([still, rate])
        for rate in (waypoints.velocities, waypoints.accelerations)
    )
    times = np.concatenate([[0.0], waypoints.times])
    return Waypoints(times, np.vstack([position, waypoints.positions]), *rates).curve
