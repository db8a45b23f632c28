"""A motion along the way for a twist, that can stop on it at any moment within all limits.

How far it has come along the way is a motion of one dimension: constant accelerations between
knots, and the mean over as many periods as jerks need.  The joints follow the way, so the tip
remains on its line however much the motion is slowed down.  At each knot there is a plan to stop on
the way whose cubics, joint by joint, were found inside all limits.  Another speed is taken only
with such a plan; where there is none, the motion goes on by the plan from before.
"""

import math
from collections.abc import Sequence
from copy import copy
from typing import NamedTuple

import numpy as np

from robomech_ros.servo.cubics import CubicCheck, end_of_cubic
from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.line_path import LinePath
from robomech_ros.servo.motion import Advance, Samples
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.typing import Array

# Parts of the acceleration limits with which the motion begins and brakes; the bends of the way
# need the rest.
_LEVELS = (0.95, 0.7, 0.45, 0.25, 0.1)
# After so many periods a higher one is tried again.
_RETRY = 10
# How often the change of speed is halved to find the largest that is allowed.
_HALVINGS = 5
# Rounding of a number of periods over a whole one.
_PERIODS = 1e-9
# Every so many knots of the plan to stop are shown, if cubics between them keep the limits.
_THIN = (4, 2)


class Deviation:
    """Transition of joints from elsewhere onto the path: their offset, and its decay.

    They have more than the motion along the way by three arrays (n,): positions, velocities and
    accelerations (rad or m, and per s and s^2). After a count of periods (s) they are on it.
    """

    def __init__(self, off: tuple[Array, Array, Array], period: float, count: int) -> None:
        ends = (np.vstack((rate, np.zeros_like(rate))) for rate in off)
        fading = interpolant([0.0, count * period], *ends)
        sample = fading.sample(period * np.arange(count + 1.0))
        self.q: Array = sample.position.copy()
        self.v: Array = sample.velocity.copy()
        # Exactly, not but for rounding.
        self.q[-1] = self.v[-1] = 0.0

    @property
    def left(self) -> int:
        """Number of periods that it takes."""
        return len(self.q) - 1

    def go_on(self) -> None:
        """Advance by a period."""
        self.q, self.v = self.q[1:], self.v[1:]


class _Plan(NamedTuple):
    """A motion from the latest knot to rest.

    The rates (k,) are those of the next knot and those after it, before the mean (1/s); q and v (m,
    n) those of the joints at all knots, that of now included (rad or m, and per s).
    """

    rates: Array
    q: Array
    v: Array


class LineMotion:
    """Commanded joint motion along a path, one knot after the other, a period (s) apart.

    It begins at a place, which changes at a rate (1/s), while the joints are not yet on the way by
    a deviation. They come with the acceleration and jerk (2, n) ``reached``, per s^2 and s^3;
    default at rest.
    """

    def __init__(
        self,
        path: LinePath,
        limits: ServoLimits,
        period: float,
        place: float = 0.0,
        rate: float = 0.0,
        deviation: Deviation | None = None,
        reached: Array | None = None,
    ) -> None:
        self.path = path
        self._names, self._period = limits.joint_names, period
        self._acceleration = limits.acceleration
        self._check = CubicCheck(limits)
        self._window = limits.smoothing(period)
        # Places and rates of the last knots before the mean, the latest last.
        behind = np.arange(-self._window, 1.0) + 0.5 * self._window
        self._places: Array = place + period * rate * behind
        self._rates: Array = np.full(self._window + 1, rate)
        self._deviation = deviation
        self._level, self._since = 0, 0
        q, v = path.at(np.array([place]), np.array([rate]))
        if deviation is not None:
            q, v = q + deviation.q[:1], v + deviation.v[:1]
        self._plan = _Plan(np.zeros(0), q, v)
        self._reached = np.zeros((2, q.shape[1])) if reached is None else reached

    def copy(self) -> "LineMotion":
        """Return an independent copy on the same path."""
        other = copy(self)
        other._deviation = copy(self._deviation)
        return other

    @property
    def rate(self) -> float:
        """Speed on the path before the mean (1/s)."""
        return float(self._rates[-1])

    @property
    def at_rest(self) -> bool:
        """True if nothing moves any more."""
        return len(self._plan.q) == 1

    @property
    def knot(self) -> tuple[Array, Array]:
        """Position and velocity of the latest knot (rad or m, and per s)."""
        return self._plan.q[0], self._plan.v[0]

    @property
    def wanted(self) -> float:
        """The rate (1/s) of the whole twist."""
        return self.path.rate(self.place)

    @property
    def leaves(self) -> bool:
        """True if it is beyond the hard stop, where the path leads out."""
        return self.path.leaves(self.place)

    @property
    def place(self) -> float:
        """Path coordinate before averaging."""
        return float(self._places[-1])

    def ahead(self) -> tuple[Array, Array]:
        """Return posture and joint rates before the mean."""
        q, v = self.path.at(self._places[-1:], self._rates[-1:])
        return q[0], v[0]

    def advance(self, wanted: float) -> Advance:
        """Go on by one period, towards a rate (1/s) as fast as limits allow."""
        self._since += 1
        first = self._level - 1 if self._since >= _RETRY and self._level else self._level
        bound: Sequence[int] = ()
        for level in sorted(range(len(_LEVELS)), key=lambda i: i != first):
            step = self._step(level)
            rate = min(max(wanted, self.rate - step), self.rate + step)
            plan, out = self._planned(rate, step)
            if plan is not None:
                if level != self._level or level != first:
                    self._since = 0
                self._level = level
                self._take(plan)
                return Advance(min(1.0, rate / wanted) if wanted else 1.0, 1.0, ())
            bound = bound or out
            if self.path.unfinished:
                # Lower levels need more of the way.
                break
        self._since = 0
        allowed = self._take_part(wanted)
        return Advance(1.0, allowed, tuple(self._names[i] for i in bound))

    def stuck(self, advance: Advance) -> bool:
        """Return whether it stands still for a reason other than the posture."""
        ends = self.path.singular or self.path.unfinished or advance.bound
        return self.at_rest and advance.allowed == 0.0 and not ends

    def brake(self) -> None:
        """Go on by one period on the plan to stop."""
        if self.at_rest:
            self._reached = np.zeros_like(self._reached)
        else:
            self._take(self._plan)

    def samples(self) -> Samples:
        """Return the stream from the latest knot to rest."""
        q, v = self._plan.q, self._plan.v
        count = len(q)
        for thin in _THIN:
            shown = np.unique(np.r_[0, 1, 2:count:thin, count - 1].clip(0, count - 1))
            times: Array = self._period * shown.astype(np.float64)
            shown_q, shown_v = q[shown], v[shown]
            verdict = self._check.of(np.diff(times), shown_q, shown_v, self._reached)
            if count == 1 or verdict.inside:
                return Samples(times, shown_q, shown_v)
        return Samples(self._period * np.arange(float(count)), q, v)

    def _step(self, level: int) -> float:
        """Return by how much the rate can change in a period, at a level of acceleration."""
        slope = self.path.slope(self.place)
        most = 1.0 / float((np.abs(slope) / self._acceleration).max())
        return _LEVELS[level] * most * self._period

    def _take_part(self, wanted: float) -> float:
        """Take the largest part of a change of the rate that is allowed; gives the part."""
        rates = self._plan.rates
        least = float(rates[0]) if len(rates) else 0.0
        step = self._step(self._level)
        # With this step the plan from before is what none of the change leads to.
        braking = max(self.rate - least, 0.0) or step
        target = min(wanted, self.rate + step)
        low, high, best = 0.0, 1.0, self._plan
        for _ in range(_HALVINGS if target > least else 0):
            part = 0.5 * (low + high)
            plan, _ = self._planned(least + part * (target - least), braking)
            if plan is None:
                high = part
            else:
                low, best = part, plan
        if best is self._plan:
            self.brake()
        else:
            self._take(best)
        return low

    def _planned(self, rate: float, step: float) -> tuple[_Plan | None, Sequence[int]]:
        """Plan to take a rate, then to lose so much of it in each period.

        None where that is not inside the limits, with the joints that exceed their ranges.
        """
        h, m = self._period, self._window
        stop = math.ceil(rate / step - _PERIODS)
        rates = rate * np.arange(stop, -1.0, -1.0) / max(stop, 1)
        held = 0 if self._deviation is None else max(self._deviation.left - stop - m - 1, 0)
        speeds = np.concatenate((self._rates, rates, np.zeros(m + held)))
        places = np.empty_like(speeds)
        places[0] = 0.0
        np.cumsum(0.5 * h * (speeds[1:] + speeds[:-1]), out=places[1:])
        places += self._places[-1] - places[m]
        if not self.path.reach(float(places[-1])):
            return None, ()
        if m:
            sums = np.zeros_like(places)
            np.cumsum(places[:-1] + h / 6.0 * (2.0 * speeds[:-1] + speeds[1:]), out=sums[1:])
            speeds = (places[m:] - places[:-m]) / (m * h)
            places = (sums[m:] - sums[:-m]) / m
        speeds[-1] = 0.0
        q, v = self.path.at(places, speeds)
        if self._deviation is not None:
            count = len(self._deviation.q)
            q[:count] += self._deviation.q
            v[:count] += self._deviation.v
        q[0], v[0] = self.knot
        verdict = self._check.of(np.full(len(q) - 1, h), q, v, self._reached)
        return (_Plan(rates, q, v) if verdict.inside else None), verdict.bound

    def _take(self, plan: _Plan) -> None:
        h, rates = self._period, plan.rates
        rate = float(rates[0]) if len(rates) else 0.0
        self._places = np.append(
            self._places[1:], self._places[-1] + 0.5 * h * (self._rates[-1] + rate)
        )
        self._rates = np.append(self._rates[1:], rate)
        self._reached = end_of_cubic(h, plan.q[:2], plan.v[:2])
        self._plan = _Plan(rates[1:], plan.q[1:], plan.v[1:])
        if self._deviation is not None:
            self._deviation.go_on()
            if not self._deviation.left:
                self._deviation = None
        self.path.forget_before(float(self._places[0]))
