"""A stream of joint positions that can stop at any moment without exceeding a limit.

Between two knots, one period h apart, accelerations are constant.  From every knot on there is a
plan to stop: N periods in which all joints brake evenly and together, so that they keep their
direction.  A new velocity is taken only so far that the plan to stop from there ends inside the
limits; the plan from before is always left as a way out.  So no limit is ever exceeded, by
induction, whatever velocities are wanted.

Where jerks are limited, what is published is the mean over the last m periods: velocities,
accelerations and positions of a mean are inside the limits that its terms keep, and its
acceleration changes at a limited rate.
"""

from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros.servo.limits import RATE_ROUNDING, ServoLimits

__all__ = ["Advance", "Motion", "Samples"]

Array = NDArray[np.float64]

# What a number of periods may be over a whole one by rounding.
_PERIODS = 1e-9
# Changes of acceleration in a period that are the same but for this part of its limit are the same.
_SAME = 1e-9


class Advance(NamedTuple):
    """How far a wanted change of velocity was taken.

    Attributes
    ----------
    followed : float
        Part of the change that the limits of acceleration allow in one period.
    allowed : float
        Part of that, 0 to 1, that the limits of positions allow.
    bound : tuple of str
        The joints near whose limits it is less than 1.
    """

    followed: float
    allowed: float
    bound: tuple[str, ...]


class Samples(NamedTuple):
    """A stream from a knot to rest.

    Attributes
    ----------
    times : ndarray, shape (m,)
        Since the knot (s).
    positions, velocities : ndarray, shape (m, n)
        rad or m, and per s; a cubic between each two is exact.
    """

    times: Array
    positions: Array
    velocities: Array


class _Knot(NamedTuple):
    position: Array
    velocity: Array


class Motion:
    """Where the joints are told to be, one knot after the other.

    Parameters
    ----------
    limits : ServoLimits
        Of the n joints.
    period : float
        Time between knots (s).
    position, velocity : ndarray, shape (n,)
        At first (rad or m, and per s).  A joint outside its limits can only move inwards.
    """

    def __init__(
        self, limits: ServoLimits, period: float, position: Array, velocity: Array
    ) -> None:
        self._names, self._period = limits.names, period
        self._velocity_limit = limits.velocity * (1.0 - RATE_ROUNDING)
        self._step = limits.acceleration * period * (1.0 - RATE_ROUNDING)
        self._lower, self._upper = limits.inside
        speed = np.clip(velocity, -self._velocity_limit, self._velocity_limit)
        self._window = limits.smoothing(period)
        # The mean lags behind by half its window.
        ahead = position + 0.5 * self._window * period * speed
        self._knots = deque(
            [_Knot(ahead - k * period * speed, speed) for k in range(self._window, 0, -1)]
            + [_Knot(ahead, speed)],
            maxlen=self._window + 1,
        )
        self._stop_periods = self._needed(speed)
        end = ahead + 0.5 * period * self._stop_periods * speed
        self._low = np.minimum(self._lower, np.minimum(ahead, end))
        self._high = np.maximum(self._upper, np.maximum(ahead, end))

    @property
    def position(self) -> Array:
        """Where the latest knot is, before any mean (rad or m)."""
        return self._knots[-1].position

    @property
    def velocity(self) -> Array:
        """Velocity there (rad/s or m/s)."""
        return self._knots[-1].velocity

    @property
    def at_rest(self) -> bool:
        """Whether nothing moves any more."""
        return not any(knot.velocity.any() for knot in self._knots)

    def advance(self, wanted: Array) -> Advance:
        """Go on by one period, towards a velocity (rad/s or m/s) as fast as limits allow.

        All joints take the same part of the change, so that the direction is kept of motions that
        begin, end, or are slowed down.
        """
        wanted = np.clip(wanted, -self._velocity_limit, self._velocity_limit)
        target, followed = self._target(wanted)
        least = self._braked()
        allowed, periods, bound = self._allowed(least, target - least)
        velocity = target if allowed == 1.0 else least + allowed * (target - least)
        self._go(velocity, periods)
        return Advance(followed, allowed, bound)

    def _target(self, wanted: Array) -> tuple[Array, float]:
        """Give the velocity next to the wanted one that can be had in a period.

        That is a part of it where one can be had, which keeps the direction; else a part of the
        change.  The part comes with it.
        """
        before, change = self.velocity, wanted - self.velocity
        if (np.abs(change) <= self._step).all():
            return wanted, 1.0
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (before - self._step) / wanted, (before + self._step) / wanted
            followed = float(np.fmin.reduce(self._step / np.abs(change)))
        moved = wanted != 0.0
        least = np.max(np.minimum(one, other)[moved], initial=0.0)
        most = float(np.min(np.maximum(one, other)[moved], initial=1.0))
        if least <= most and (np.abs(before[~moved]) <= self._step[~moved]).all():
            return most * wanted, most
        return before + followed * change, followed

    def brake(self) -> None:
        """Go on by one period on the plan to stop."""
        self._go(self._braked(), max(self._stop_periods - 1, 0))

    def samples(self) -> Samples:
        """Give the stream from the knot before the latest on, at rest at the end."""
        knots = [*self._knots]
        position, velocity = knots[-1]
        period, stop = self._period, self._stop_periods
        if not self._window:
            end = _Knot(position + 0.5 * period * stop * velocity, np.zeros_like(velocity))
            times = [0.0, period, period * (1 + stop)][: 2 + bool(stop)]
            shown = [self._previous, knots[-1], end][: len(times)]
            return Samples(np.array(times), *(np.array(rows) for rows in zip(*shown, strict=True)))
        for k in range(1, stop + 1):
            left = 1.0 - k / stop
            way = 0.5 * period * velocity * (k + k * left)
            knots.append(_Knot(position + way, left * velocity))
        knots += [_Knot(knots[-1].position, np.zeros_like(velocity))] * self._window
        knots.insert(0, self._previous)
        return self._means(knots)

    def _braked(self) -> Array:
        """Give the velocity after one period on the plan to stop."""
        periods = self._stop_periods
        return self.velocity * ((periods - 1) / periods) if periods else self.velocity

    def _needed(self, velocity: Array) -> int:
        """Give in how many periods all joints can stop."""
        return int(np.ceil(np.max(np.abs(velocity) / self._step, initial=0.0) - _PERIODS))

    def _allowed(self, least: Array, more: Array) -> tuple[float, int, tuple[str, ...]]:
        """Find the largest part of `more` that can be added to a velocity before braking.

        Returns it with the periods that braking takes from there, and the joints that bound it.
        """
        half, start = 0.5 * self._period, self.position + 0.5 * self._period * self.velocity
        fewest = max(self._stop_periods - 1, 0)
        most = max(fewest, self._needed(least + more))
        end = start + half * (1 + most) * (least + more)
        if ((end >= self._low) & (end <= self._high)).all():
            return 1.0, most, ()
        best, periods, bound = 0.0, fewest, np.ones(len(least), dtype=bool)
        for count in range(fewest, most + 1):
            way = half * (1 + count)
            low, high = self._parts(start + way * least, way * more)
            with np.errstate(divide="ignore", invalid="ignore"):
                speed = (np.copysign(self._step, more) * count - least) / more
            part = min(float(high.min()), float(np.fmin.reduce(speed)) + _PERIODS, 1.0)
            if part > best and (count == fewest or low.max() <= part):
                best, periods, bound = part, count, high <= part
        if not best:
            bound = self._parts(start + half * (1 + fewest) * least, more)[1] <= _PERIODS
        return best, periods, tuple(self._names[i] for i in np.flatnonzero(bound))

    def _parts(self, place: Array, more: Array) -> tuple[Array, Array]:
        """Give between which parts of `more` each joint ends inside its limits."""
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (self._low - place) / more, (self._high - place) / more
        still = more == 0.0
        outside = still & ((place < self._low) | (place > self._high))
        low = np.where(still, np.where(outside, np.inf, -np.inf), np.minimum(one, other))
        return low, np.where(still, np.inf, np.maximum(one, other))

    def _go(self, velocity: Array, periods: int) -> None:
        if not periods:
            velocity = np.zeros_like(velocity)
        position = self.position + 0.5 * self._period * (self.velocity + velocity)
        position = np.clip(position, self._low, self._high)
        self._previous = self._knots[0]
        self._knots.append(_Knot(position, velocity))
        self._stop_periods = periods
        end = position + 0.5 * self._period * periods * velocity
        self._low = np.minimum(self._lower, np.minimum(position, end))
        self._high = np.maximum(self._upper, np.maximum(position, end))

    def _means(self, knots: list[_Knot]) -> Samples:
        """Give positions and velocities of the mean over the window that ends at each knot."""
        h, m = self._period, self._window
        q, v = (np.array(rows) for rows in zip(*knots, strict=True))
        # The mean over one period, in which the acceleration is constant.
        inside = q[:-1] + h * (v[:-1] / 3.0 + v[1:] / 6.0)
        count = len(q) - m
        positions: Array = np.stack([inside[k : k + m].mean(axis=0) for k in range(count)])
        velocities: Array = (q[m:] - q[:-m]) / (m * h)
        velocities[-1] = 0.0
        jerks = np.diff(v[m:] - v[:-m], axis=0)
        told = np.ones(count, dtype=bool)
        # A cubic goes on where the jerk does not change.
        told[2:-1] = (np.abs(np.diff(jerks[1:], axis=0)) > _SAME * self._step).any(axis=1)
        times = np.flatnonzero(told).astype(np.float64) * h
        return Samples(times, positions[told], velocities[told])
