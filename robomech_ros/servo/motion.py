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

from copy import copy
from typing import NamedTuple

import numpy as np

from robomech_ros.servo.braking import StopPlan
from robomech_ros.servo.limits import RATE_ROUNDING, ServoLimits
from robomech_ros.typing import Array

# Vectors of some numbers: Python's arithmetic is faster on them than numpy's.
Numbers = list[float]

# Changes of acceleration in a period that differ by less than this part of its limit count as
# equal.
_SAME = 1e-9


class Advance(NamedTuple):
    """Part of a desired change of velocity that was taken.

    The limits of acceleration allow the part ``followed`` of it in one period, and those of
    positions the part ``allowed`` of that, 0 to 1; where it is less, ``bound`` are the joints near
    their limits.
    """

    followed: float
    allowed: float
    bound: tuple[str, ...]


class Samples(NamedTuple):
    """A stream from a knot to rest, at times (m,) since the knot (s).

    Positions and velocities are (m, n), rad or m, and per s; a cubic between each two is exact.
    """

    times: Array
    positions: Array
    velocities: Array


class Motion:
    """Commanded joint positions, one knot after the other.

    Parameters
    ----------
    limits : ServoLimits
        Limits of the n joints.
    period : float
        Time between knots (s).
    position, velocity : ndarray, shape (n,)
        At first (rad or m, and per s).  A joint outside its limits can only move inwards.
    """

    def __init__(
        self, limits: ServoLimits, period: float, position: Array, velocity: Array
    ) -> None:
        self._names, self._period = limits.joint_names, period
        self._plan = StopPlan(limits, period)
        self._same = _SAME * limits.acceleration * period * (1.0 - RATE_ROUNDING)
        fastest = limits.velocity * (1.0 - RATE_ROUNDING)
        speed = np.clip(velocity, -fastest, fastest)
        self._fastest: Numbers = fastest.tolist()
        self._window = limits.smoothing(period)
        # The mean lags behind by half its window.
        ahead = position + 0.5 * self._window * period * speed
        before = period * np.arange(self._window, -1, -1.0)[:, None]
        # Positions and velocities of the last knots, the latest last.
        self._positions: Array = ahead - before * speed
        self._velocities: Array = np.repeat(speed[None], len(before), axis=0)
        self._position: Numbers = ahead.tolist()
        self._velocity: Numbers = speed.tolist()
        self._resting = 0 if speed.any() else len(before)
        self._plan.begin(self._position, self._velocity)

    @classmethod
    def joining(
        cls, limits: ServoLimits, period: float, knot: tuple[Array, Array], acceleration: Array
    ) -> "Motion | None":
        """Go on from a knot that was reached otherwise, if there is a plan to stop from there.

        Parameters
        ----------
        limits, period
            As above.
        knot : tuple of ndarray
            Position and velocity (rad or m, and per s).
        acceleration : ndarray, shape (n,)
            There (rad/s^2 or m/s^2).
        """
        (position, velocity), window = knot, limits.smoothing(period)
        # The motion of constant acceleration among those with this mean.
        times: Array = period * (np.arange(window + 1.0) - 0.5 * window)[:, None]
        middle = position - acceleration * (period * window) ** 2 / 24.0
        positions = middle + times * (velocity + 0.5 * times * acceleration)
        velocities = velocity + times * acceleration
        most = limits.acceleration * (1.0 - RATE_ROUNDING)
        fastest = limits.velocity * (1.0 - RATE_ROUNDING)
        harder = window > 0 and bool((np.abs(acceleration) > most).any())
        if harder or (np.abs(velocities) > fastest).any():
            return None
        motion = cls(limits, period, positions[-1], np.zeros_like(velocity))
        motion._positions, motion._velocities = positions, velocities
        motion._velocity = velocities[-1].tolist()
        motion._resting = 0 if velocities.any() else len(positions)
        motion._plan.begin(motion._position, motion._velocity)
        end = positions[-1] + 0.5 * period * motion._plan.periods * velocities[-1]
        lower, upper = limits.inside
        ways = np.vstack((positions, end))
        return motion if ((lower <= ways) & (ways <= upper)).all() else None

    def copy(self) -> "Motion":
        """Return an independent copy."""
        other = copy(self)
        other._positions, other._velocities = self._positions.copy(), self._velocities.copy()
        other._plan = copy(self._plan)
        return other

    @property
    def knot(self) -> tuple[Array, Array]:
        """Position and velocity of the latest knot (rad or m, and per s)."""
        samples = self.samples()
        return samples.positions[0], samples.velocities[0]

    @property
    def position(self) -> Array:
        """Position of the latest knot before averaging (rad or m)."""
        return np.array(self._position)

    @property
    def velocity(self) -> Array:
        """Velocity there (rad/s or m/s)."""
        return np.array(self._velocity)

    @property
    def at_rest(self) -> bool:
        """True if nothing moves any more."""
        return self._resting > self._window

    def advance(self, wanted: Array) -> Advance:
        """Go on by one period, towards a velocity (rad/s or m/s) as fast as limits allow.

        All joints take the same part of the change, so that the direction is kept of motions that
        begin, end, or are slowed down.
        """
        pairs = zip(wanted.tolist(), self._fastest, strict=True)
        target, followed = self._target([min(max(x, -most), most) for x, most in pairs])
        least = self._plan.braked(self._velocity)
        more = [x - y for x, y in zip(target, least, strict=True)]
        allowed, periods, bound = self._plan.allowed(self._position, self._velocity, least, more)
        if allowed != 1.0:
            target = [x + allowed * y for x, y in zip(least, more, strict=True)]
        self._go(target, periods)
        return Advance(followed, allowed, tuple(self._names[i] for i in bound))

    def _target(self, wanted: Numbers) -> tuple[Numbers, float]:
        """Return the velocity nearest to the wanted one that a period allows.

        That is a fraction of it where possible, which keeps the direction, otherwise a fraction of
        the change. The fraction comes with it.
        """
        before, followed, least, most = self._velocity, 1.0, 0.0, 1.0
        for now, then, step in zip(before, wanted, self._plan.steps, strict=True):
            change = abs(then - now)
            if change > step:
                followed = min(followed, step / change)
            if then > 0.0:
                least, most = max(least, (now - step) / then), min(most, (now + step) / then)
            elif then < 0.0:
                least, most = max(least, (now + step) / then), min(most, (now - step) / then)
            elif change > step:
                most = -1.0
        if followed == 1.0:
            return wanted, 1.0
        if least <= most:
            return [most * then for then in wanted], most
        return [
            now + followed * (then - now) for now, then in zip(before, wanted, strict=True)
        ], followed

    def brake(self) -> None:
        """Go on by one period on the plan to stop."""
        self._go(self._plan.braked(self._velocity), max(self._plan.periods - 1, 0))

    def _go(self, velocity: Numbers, periods: int) -> None:
        if not periods:
            velocity = [0.0] * len(velocity)
        self._position = self._plan.follow(self._position, self._velocity, velocity, periods)
        self._velocity = velocity
        self._resting = 0 if any(velocity) else self._resting + 1
        for rows, row in ((self._positions, self._position), (self._velocities, velocity)):
            rows[:-1] = rows[1:]
            rows[-1] = row

    def samples(self) -> Samples:
        """Return the stream from the latest knot to rest."""
        if self._window:
            return self._means()
        q, v, stop = self._positions.copy(), self._velocities.copy(), self._plan.periods
        if not stop:
            return Samples(np.zeros(1), q, v)
        time = self._period * stop
        end = q + 0.5 * time * v
        return Samples(np.array([0.0, time]), np.vstack((q, end)), np.vstack((v, 0.0 * end)))

    def _planned(self) -> tuple[Array, Array]:
        """Return positions and velocities of all knots known, as of the latest position.

        The last ones are at rest for as long as the window of the mean.
        """
        known, stop, window = len(self._positions), self._plan.periods, self._window
        shape = known + stop + window, len(self._position)
        q, v = np.empty(shape), np.zeros(shape)
        q[:known], v[:known] = self._positions - self._positions[-1], self._velocities
        if stop:
            left, way = self._plan.shape
            v[known : known + stop] = left * self._velocities[-1]
            q[known : known + stop] = way * self._velocities[-1]
        q[known + stop :] = q[known + stop - 1]
        return q, v

    def _means(self) -> Samples:
        """Return positions and velocities of the mean over the window that ends at each knot."""
        h, m = self._period, self._window
        q, v = self._planned()
        # The mean over one period, in which the acceleration is constant.
        sums = np.zeros_like(q)
        np.cumsum(q[:-1] + h / 6.0 * (2.0 * v[:-1] + v[1:]), axis=0, out=sums[1:])
        positions = (sums[m:] - sums[:-m]) * (1.0 / m)
        positions += self._positions[-1]
        velocities = (q[m:] - q[:-m]) * (1.0 / (m * h))
        velocities[-1] = 0.0
        # A cubic goes on where the jerk does not change.
        change = v[m:] - v[:-m]
        bends = change[2:] - 2.0 * change[1:-1] + change[:-2]
        told = np.ones(len(positions), dtype=bool)
        told[1:-1] = (np.abs(bends) > self._same).any(axis=1)
        shown = told.nonzero()[0]
        times: Array = h * shown.astype(np.float64)
        return Samples(times, positions[shown], velocities[shown])
