"""The plan to stop that a stream of joint positions has at every knot, within position limits.

It takes whole periods, in which all joints brake evenly and together.
"""

import math

import numpy as np

from robomech_ros.servo.limits import RATE_ROUNDING, ServoLimits
from robomech_ros.typing import Array

Numbers = list[float]

# Rounding of a number of periods over a whole one.
_PERIODS = 1e-9


class StopPlan:
    """Plan to stop n joints from the latest knot, and check which velocities leave such a plan.

    They need so many ``periods`` to stop, in each of which velocities can change by the ``steps``
    (rad/s or m/s).
    """

    def __init__(self, limits: ServoLimits, period: float) -> None:
        self._half = 0.5 * period
        self.steps: Numbers = (limits.acceleration * period * (1.0 - RATE_ROUNDING)).tolist()
        lower, upper = limits.inside
        self._lower: Numbers = lower.tolist()
        self._upper: Numbers = upper.tolist()
        self._low, self._high = self._lower, self._upper
        self.periods = 0
        self._shapes: dict[int, tuple[Array, Array]] = {}

    @property
    def shape(self) -> tuple[Array, Array]:
        """Remaining velocity fraction and travel per velocity (s) by period, shape (periods, 1)."""
        stop = self.periods
        if stop not in self._shapes:
            k = np.arange(1.0, stop + 1.0)[:, None]
            left = 1.0 - k / stop
            self._shapes[stop] = left, self._half * (k + k * left)
        return self._shapes[stop]

    def begin(self, position: Numbers, velocity: Numbers) -> None:
        """Plan from a first knot (rad or m, and per s), which may be outside the limits."""
        self.periods = self._needed(velocity)
        self._widen(position, velocity)

    def braked(self, velocity: Numbers) -> Numbers:
        """Return the velocity (rad/s or m/s) after one period of the plan."""
        if not self.periods:
            return velocity
        part = (self.periods - 1) / self.periods
        return [part * x for x in velocity]

    def follow(
        self, position: Numbers, before: Numbers, velocity: Numbers, periods: int
    ) -> Numbers:
        """Move from a knot to one that stops in some periods; return its position (rad or m)."""
        self.periods = periods
        values = zip(position, before, velocity, self._low, self._high, strict=True)
        moved = [min(max(q + self._half * (u + v), low), high) for q, u, v, low, high in values]
        self._widen(moved, velocity)
        return moved

    def allowed(
        self, position: Numbers, velocity: Numbers, least: Numbers, more: Numbers
    ) -> tuple[float, int, list[int]]:
        """Find the largest part of `more` that can be added to a velocity before braking.

        Position and velocity are those of the latest knot (rad or m, and per s), ``least`` is the
        velocity after one period of the plan. Returns the part, from 0 to 1, the periods that
        braking takes from there, and the joints that bound it.
        """
        half = self._half
        start = [q + half * v for q, v in zip(position, velocity, strict=True)]
        target = [x + y for x, y in zip(least, more, strict=True)]
        fewest = max(self.periods - 1, 0)
        most = max(fewest, self._needed(target))
        way = half * (1 + most)
        ends = zip(self._low, start, target, self._high, strict=True)
        if all(low <= q + way * v <= high for low, q, v, high in ends):
            return 1.0, most, []
        best, periods, bound = 0.0, fewest, []
        for count in range(fewest, most + 1):
            part, least_part, found = self._part(count, start, least, more)
            if part > best and (count == fewest or least_part <= part):
                best, periods, bound = part, count, found
        if not best:
            parts = self._parts(half * (1 + fewest), start, least, more)
            bound = [i for i, (_, high) in enumerate(parts) if high <= _PERIODS]
        return best, periods, bound

    def _part(
        self, count: int, start: Numbers, least: Numbers, more: Numbers
    ) -> tuple[float, float, list[int]]:
        """Return the largest part with which a stop takes so many periods, and the least one.

        With them come the joints whose position limits do not allow more.
        """
        parts = self._parts(self._half * (1 + count), start, least, more)
        part = min(1.0, min((high for _, high in parts), default=1.0))
        for x, y, step in zip(least, more, self.steps, strict=True):
            if y:
                part = min(part, (math.copysign(step, y) * count - x) / y + _PERIODS)
        bound = [i for i, (_, high) in enumerate(parts) if high <= part]
        return part, max((low for low, _ in parts), default=0.0), bound

    def _parts(
        self, way: float, start: Numbers, least: Numbers, more: Numbers
    ) -> list[tuple[float, float]]:
        """Return between which parts of `more` each joint ends inside its limits."""
        found = []
        for low, high, q, x, y in zip(self._low, self._high, start, least, more, strict=True):
            place, change = q + way * x, way * y
            if change > 0.0:
                found.append(((low - place) / change, (high - place) / change))
            elif change < 0.0:
                found.append(((high - place) / change, (low - place) / change))
            else:
                outside = place < low or place > high
                found.append((math.inf if outside else -math.inf, math.inf))
        return found

    def _needed(self, velocity: Numbers) -> int:
        """Return in how many periods all joints can stop."""
        times = [abs(v) / step for v, step in zip(velocity, self.steps, strict=True)]
        return math.ceil(max(times, default=0.0) - _PERIODS)

    def _widen(self, position: Numbers, velocity: Numbers) -> None:
        """Extend the limits to the plan while it is outside them."""
        way = self._half * self.periods
        ends = [q + way * v for q, v in zip(position, velocity, strict=True)]
        self._low = list(map(min, self._lower, position, ends))
        self._high = list(map(max, self._upper, position, ends))
