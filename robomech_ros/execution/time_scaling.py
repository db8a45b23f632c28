"""Executing a curve slower than planned, and changing the pace on the way without leaving its path.

The joints follow q(s(t)) with the pace p = ds/dt, so that they have the velocity q' p and the
acceleration q'' p^2 + q' dp/dt.
"""

from dataclasses import dataclass

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import Sample
from robomech_ros.typing import Array

# The pace never goes from 0 to 1 or back in less than this (s): a stop within one control cycle
# would be a step of velocity.
SHORTEST_CHANGE = 0.02
# Steps of the integration, s, and how many there are at most.
_STEP = 0.0025
_MAX_STEPS = 8000


@dataclass(frozen=True, eq=False)
class TimeScaling:
    """Curve time over execution time from ``begin`` (s) on: a change, then a constant pace.

    At m >= 1 instants (m,) it has the time since then (s), the place on the curve (s), the pace,
    and how fast the pace changes (1/s); after the last one the pace stays.
    """

    begin: float
    times: Array
    places: Array
    paces: Array
    rates: Array

    @property
    def pace(self) -> float:
        """The pace in the end."""
        return float(self.paces[-1])

    def place(self, now: float) -> float:
        """Return the place on the curve (s) at a time (s)."""
        return self.after(now - self.begin)[0]

    def pace_at(self, now: float) -> float:
        """Return the pace at a time (s)."""
        return self.after(now - self.begin)[1]

    def after(self, time: float) -> tuple[float, float, float]:
        """Return place, pace and its rate some time (s) after `begin`."""
        over = time - self.times[-1]
        if over >= 0.0:
            return float(self.places[-1] + self.pace * over), self.pace, 0.0
        k = max(int(np.searchsorted(self.times, time, side="right")) - 1, 0)
        since, rate = max(time - self.times[k], 0.0), float(self.rates[k])
        pace = float(self.paces[k])
        return (
            float(self.places[k] + (pace + 0.5 * rate * since) * since),
            pace + rate * since,
            rate,
        )


def constant_pace(begin: float, place: float, pace: float) -> TimeScaling:
    """Make the scaling that is at a place (s) at a time (s) and keeps its pace."""
    return TimeScaling(begin, np.zeros(1), np.array([place]), np.array([pace]), np.zeros(1))


def pace_change(
    curve: PiecewisePolynomial, begin: float, place: float, pace: float, target: float, limit: Array
) -> TimeScaling:
    """Change the pace to a target, 0 to 1, 0 = stop on the path, as fast as accelerations allow.

    The change begins at a time, at a place on the curve with a pace (s); the limits are (n,),
    rad/s^2 or m/s^2.
    """
    rows = [(0.0, place, pace, 0.0)]
    time, end = 0.0, float(curve.breaks[-1])
    while pace != target and place < end and len(rows) <= _MAX_STEPS:
        step = _STEP
        rate = _rate(curve, place, pace, target, step, limit)
        if rate and (target - pace) / rate < step:
            step = (target - pace) / rate
        rows[-1] = (*rows[-1][:3], rate)
        place += (pace + 0.5 * rate * step) * step
        pace = target if step < _STEP else pace + rate * step
        time += step
        rows.append((time, place, pace, 0.0))
    return TimeScaling(begin, *np.array(rows).T)


def paced_step(
    curve: PiecewisePolynomial, place: float, pace: float, target: float, span: float, limit: Array
) -> tuple[float, float, float]:
    """Let a time (s) pass while the pace goes to its target as fast as it may.

    Returns where on the curve it is then (s), the pace, and how fast that changes (1/s). Beyond the
    end of the curve time passes as it is.
    """
    left, end = span, float(curve.breaks[-1])
    changes = pace != target and place < end
    rate = _rate(curve, place, pace, target, 0.0, limit) if changes else 0.0
    while left > 0.0 and pace != target and place < end:
        step = min(left, max(_STEP, span / _MAX_STEPS))
        rate = _rate(curve, place, pace, target, step, limit)
        reached = bool(rate) and (target - pace) / rate <= step
        step = (target - pace) / rate if reached else step
        place += (pace + 0.5 * rate * step) * step
        pace = target if reached else pace + rate * step
        left -= step
    if place < end:
        inside = min(left, (end - place) / pace) if pace else left
        place, left = place + pace * inside, left - inside
    return place + max(left, 0.0) * (place >= end), pace, rate if pace != target else 0.0


def _rate(
    curve: PiecewisePolynomial, place: float, pace: float, target: float, step: float, limit: Array
) -> float:
    """Return how fast the pace changes (1/s) in the next step (s), by the midpoint rule."""
    way = -1.0 if target < pace else 1.0
    most = _most_change(curve.sample(place), pace, way, limit)
    halfway = pace + way * min(0.5 * most * step, abs(target - pace))
    middle = curve.sample(place + 0.25 * (pace + halfway) * step)
    return way * _most_change(middle, halfway, way, limit)


def _most_change(sample: Sample, pace: float, way: float, limit: Array) -> float:
    """Return how fast the pace may rise (1/s), or fall where `way` is -1.

    No joint exceeds its limit then; 0 where the curve itself already takes all of it.
    """
    speed = np.abs(sample.velocity)
    # Joints that stand still do not mind.
    moving = speed > 1e-12
    if not moving.any():
        return 1.0 / SHORTEST_CHANGE
    spare = limit - way * np.sign(sample.velocity) * sample.acceleration * pace * pace
    most = float(np.min(spare[moving] / speed[moving]))
    return min(max(most, 0.0), 1.0 / SHORTEST_CHANGE)
