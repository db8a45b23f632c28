r"""Motions along a path with limited jerk, from the time-optimal ones by a moving average.

The path coordinate s(t) of the time-optimal motion has an acceleration that steps.  Its mean over
a window of the duration w,

.. math:: \tilde s(t) = \frac 1 w \int_{t - w}^{t} s(\tau)\, d\tau

is w longer, stays on the path, has a continuous acceleration that is zero at both ends, and a jerk
that is bounded by the steps over w.  Where velocities, accelerations or
jerks of the joints are over their limits, the path is slowed down there, and all is done again;
what little is left in the end is taken off by stretching the time.

On a straight line in joint space, where the limits are the same all along, the double-S profile of
the path coordinate is the fastest motion of all, and is taken instead.

References
----------
L. Biagiotti and C. Melchiorri, "Trajectory Planning for Automatic Machines and Robots", Springer
2008, sections 3.4: double-S, and 4.6: trajectories as responses of moving-average filters.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from robomech_ros.trajectory.curves.bounds import hull
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.profiles.velocity_profiles import DoubleS, along_line
from robomech_ros.trajectory.timing.path_limits import PathFunction, largest_parts
from robomech_ros.trajectory.timing.path_sections import check_no_step, jump
from robomech_ros.trajectory.timing.path_speed import fastest
from robomech_ros.trajectory.timing.speed_profile import PathLimits, SpeedProfile, TimeOptimal
from robomech_ros.typing import Array

# Windows that are tried, as multiples of the largest ratio of acceleration to jerk limit; in each
# the accelerations are limited to what the jerk reaches within it.
_WINDOWS = (2.0, 1.4, 1.0, 0.65, 0.4, 0.2, 0.1, 0.05, 0.02, 0.005, 0.001)
# Shorter windows are not tried after so many that brought no gain.
_WORSE = 3
# Slowing the path down where limits are exceeded, at most so many times; an excess of the speed
# that is smaller is taken off by stretching the time.
_ROUNDS = 12
_SMALL_EXCESS = 1e-3
# The jerk is a step of the acceleration over the window: where it is too high, the accelerations
# are lowered by this power of the factor, and to this part of their limits at the least.
_POWER, _LEAST_PART = 1.5, 1e-3
# Samples in a window and in the whole motion, at least; at most in the whole motion.
_IN_WINDOW, _IN_ALL, _MOST = 12, 300, 20_000


def smoothed(path: PiecewisePolynomial, limits: PathLimits, jerk: Array) -> TimeOptimal:
    """Pass a path from rest to rest in nearly the shortest time within limits of jerk (n,) as well.

    The path has a continuous second derivative; the limits are without torques.
    """
    check_no_step(path, 2, "the path's second derivative", "none, for a limited jerk")
    if _is_straight(path) and not limits.speeds:
        return _double_s(path, limits, jerk)
    bounded = replace(limits, square=_jerk_bound(path, jerk))
    longest = float((limits.acceleration / jerk).max())
    best: TimeOptimal | None = None
    worse = 0
    for part in _WINDOWS:
        window = part * longest
        duration = np.inf if best is None else best.pieces.duration
        gentle = replace(bounded, acceleration=np.minimum(limits.acceleration, jerk * window))
        attempt = _best_of_rounds(path, gentle, jerk, window, duration)
        timed = None if attempt is None else _kept(path, limits, jerk, attempt)
        if timed is not None and timed.pieces.duration < duration:
            best, worse = timed, 0
        else:
            worse += 1
        if worse == _WORSE:
            break
    assert best is not None
    return best


def _is_straight(path: PiecewisePolynomial) -> bool:
    """Tell whether all joints are linear in the path coordinate, with the same slopes all along."""
    bent = len(path.coefficients) > 2 and bool(path.coefficients[2:].any())
    return not bent and not jump(path, 1).any()


def _double_s(path: PiecewisePolynomial, limits: PathLimits, jerk: Array) -> TimeOptimal:
    """Pass a straight path by the double-S profile, exactly."""
    start, slope = path.coefficients[:2, 0]
    way = np.abs(slope) * path.duration
    kinds = (limits.velocity, limits.acceleration, jerk)
    ramp, duration, _ = DoubleS.shape(*(1.0 / float((way / limit).max()) for limit in kinds))
    law = along_line(path.breaks[:1], path.breaks[-1:] - path.breaks[:1], ramp, duration)
    coefficients = np.zeros((6, len(law.spans), path.joints))
    coefficients[:4] = law.coefficients * slope
    coefficients[0] += start - path.breaks[0] * slope
    ends = law.sample(law.breaks)
    speeds = np.maximum(ends.velocity[:, 0], 0.0)
    timed = TimeOptimal(PiecewisePolynomial(law.breaks, coefficients), ends.position[:, 0], speeds)
    return timed.within(limits.velocity, limits.acceleration, jerk)


def _kept(
    path: PiecewisePolynomial, limits: PathLimits, jerk: Array, attempt: "_Attempt"
) -> TimeOptimal:
    """Turn an attempt into a motion that keeps to all limits."""
    mean = attempt.clock.mean(attempt.instants)
    timed = _along(path, attempt.instants, mean)
    slower = max(1.0, float(largest_parts(limits.speeds, timed.coordinates, timed.speeds).max()))
    return timed.stretched(slower).within(limits.velocity, limits.acceleration, jerk)


def _jerk_bound(path: PiecewisePolynomial, jerk: Array) -> PathFunction:
    """Bound the speed by the jerk q''' s'^3 of the path itself, piece by piece."""
    third = np.abs(hull(path, 3)).max(axis=0) / jerk
    with np.errstate(divide="ignore"):
        pieces = third.max(axis=1) ** (-2.0 / 3.0)
    most = (path.duration / 1e-9) ** 2
    pieces = np.minimum(pieces, most)
    both = np.repeat(path.breaks, 2)[1:-1]
    return PathFunction(both, np.repeat(pieces, 2))


@dataclass(frozen=True, eq=False)
class _Clock:
    """The path coordinate over time, its mean over a window (s), and the integral that gives it.

    The curve is the coordinate over time, from rest to rest, as one "joint".
    """

    curve: PiecewisePolynomial
    window: float

    @cached_property
    def integral(self) -> PiecewisePolynomial:
        """The curve's integral over time, less that of its first value."""
        powers = self.curve.coefficients.copy()
        powers[0] -= self.start
        orders = np.arange(1.0, len(powers) + 1.0)[:, None, None]
        rising = np.concatenate([np.zeros_like(powers[:1]), powers / orders])
        spans = self.curve.spans[:, None] ** np.arange(len(rising))
        total = (rising[:, :, 0].T * spans).sum(axis=1)
        rising[0, 1:, 0] = np.cumsum(total)[:-1]
        return PiecewisePolynomial(self.curve.breaks, rising)

    def mean(self, t: Array) -> Array:
        """Sample the mean and its first three derivatives, shape (4, m)."""
        now, before = self._integrals(t), self._integrals(t - self.window)
        mean: Array = (now - before) / self.window
        mean[0] += self.start
        return mean

    def _integrals(self, t: Array) -> Array:
        """Sample the integral, the coordinate since the start, and two rates, shape (4, m)."""
        inside = np.clip(t, 0.0, self.curve.duration)
        values = np.stack(self.integral.sample(inside))[:, :, 0]
        late = t > self.curve.duration
        values[0, late] += self.way * (t[late] - self.curve.duration)
        values[2:, late | (t < 0.0)] = 0.0
        return values

    @cached_property
    def way(self) -> float:
        """Length of the path."""
        return float(self.curve.sample(self.curve.breaks[-1:]).position[0, 0] - self.start)

    @property
    def start(self) -> float:
        """Path coordinate of the start."""
        return float(self.curve.coefficients[0, 0, 0])


def _clock(profile: SpeedProfile, window: float) -> _Clock:
    """Return the path coordinate of a profile over time."""
    local = np.stack([profile.nodes[:-1], np.ones(len(profile.spans))], axis=1)[:, None, :]
    line = replace(profile, local=local)
    rates = np.abs(np.diff(profile.squares)) / profile.spans
    return _Clock(line.timed(2.0 / rates.max(keepdims=True), 1e-6).pieces, window)


def _instants(clock: _Clock) -> Array:
    """Choose when to sample the mean: evenly, and where its jerk steps."""
    duration = clock.curve.duration + clock.window
    count = max(_IN_ALL, int(_IN_WINDOW * duration / clock.window))
    even = np.linspace(0.0, duration, min(count, _MOST) + 1)
    rates = clock.curve.derivative(2)[:, :, 0]
    ends = (rates.T * clock.curve.spans[:, None] ** np.arange(len(rates))).sum(axis=1)
    steps = np.abs(rates[0, 1:] - ends[:-1])
    sharp = steps > 0.02 * np.abs(rates[0]).max()
    at = clock.curve.breaks[1:-1][sharp]
    ends = [0.0, clock.window, clock.curve.duration, duration]
    wanted = np.concatenate([at, at + clock.window, ends])
    wanted = np.unique(wanted[(wanted >= 0.0) & (wanted <= duration)])
    apart = 0.2 * even[1]
    wanted = wanted[np.append(True, np.diff(wanted) > apart)]
    near = np.abs(even - wanted[np.searchsorted(0.5 * (wanted[1:] + wanted[:-1]), even)])
    inner = (even > apart) & (even < duration - apart) & (near > apart)
    last = wanted[wanted < duration - apart]
    return np.unique(np.concatenate([last, even[inner], [duration]]))


def _along(path: PiecewisePolynomial, instants: Array, mean: Array) -> TimeOptimal:
    """Lay quintic pieces through the motion of the joints at the given instants."""
    place = path.sample(np.clip(mean[0], path.breaks[0], path.breaks[-1]))
    rate, bow = mean[1][:, None], mean[2][:, None]
    velocity = place.velocity * rate
    acceleration = place.acceleration * rate * rate + place.velocity * bow
    pieces = interpolant(instants, place.position, velocity, acceleration)
    return TimeOptimal(pieces, mean[0], mean[1])


@dataclass(frozen=True, eq=False)
class _Attempt:
    """One time law, before its mean is taken, and by which factor it is too fast.

    The factors (2, m) are those of the speed over what the limits allow between its instants (m +
    1,), in s.
    """

    clock: _Clock
    instants: Array
    factors: Array

    @property
    def duration(self) -> float:
        """Duration in s once it is stretched until the limits hold."""
        return float(self.instants[-1]) * max(float(self.factors.max()), 1.0)


def _factors(path: PiecewisePolynomial, limits: PathLimits, jerk: Array, mean: Array) -> Array:
    """Return by which factor the speed is too high at samples (4, m) of the mean, shape (2, m).

    First for all that depends on speed and acceleration along the path, then for all jerk.
    """
    place = path.sample(np.clip(mean[0], path.breaks[0], path.breaks[-1]))
    v, a, j = (row[:, None] for row in mean[1:])
    velocity = place.velocity * v / limits.velocity
    acceleration = (place.acceleration * v * v + place.velocity * a) / limits.acceleration
    bowed = (place.jerk * v**3 + 3.0 * place.acceleration * v * a) / jerk
    total = bowed + place.velocity * j / jerk
    factors = np.zeros((2, mean.shape[1]))
    factors[0] = largest_parts(limits.speeds, *mean[:2])
    for order, rate in enumerate((velocity, acceleration, bowed), 1):
        factors[0] = np.maximum(factors[0], np.abs(rate).max(axis=1) ** (1.0 / order))
    factors[1] = np.cbrt(np.abs(total).max(axis=1))
    return factors


def _best_of_rounds(
    path: PiecewisePolynomial, limits: PathLimits, jerk: Array, window: float, duration: float
) -> _Attempt | None:
    """Smooth with one window, slowing down where needed; give the best attempt of all rounds.

    None if no round promises less than `duration`.
    """
    best: _Attempt | None = None
    for _ in range(_ROUNDS):
        profile = fastest(path, limits)
        clock = _clock(profile, window)
        if clock.curve.duration + window >= duration:
            break
        instants = _instants(clock)
        middle = 0.5 * (instants[1:] + instants[:-1])
        attempt = _Attempt(clock, instants, _factors(path, limits, jerk, clock.mean(middle)))
        if attempt.duration < duration:
            best, duration = attempt, attempt.duration
        if attempt.factors.max() < 1.0 + _SMALL_EXCESS:
            break
        limits = _slowed(limits, profile, attempt)
    return best


def _slowed(limits: PathLimits, profile: SpeedProfile, attempt: _Attempt) -> PathLimits:
    """Lower speed and accelerations where they were too high: half a window before it showed."""
    clock, window = attempt.clock, attempt.clock.window
    count = min(int(np.ceil(_IN_WINDOW * attempt.instants[-1] / window)), _MOST)
    even = np.linspace(0.0, attempt.instants[-1], count + 1)
    at = np.clip(np.searchsorted(attempt.instants, even) - 1, 0, attempt.factors.shape[1] - 1)
    reach = max(round(0.5 * window / even[1]), 1)
    then = np.clip(even - 0.5 * window, 0.0, clock.curve.duration)
    places = clock.curve.sample(then).position[:, 0]
    caps, slowdown = limits.square, limits.slowdown
    assert isinstance(caps, PathFunction)
    here = np.union1d(caps.places, profile.nodes)
    speed, jerk = (
        np.interp(here, places, _spread(factors[at], reach)) for factors in attempt.factors
    )
    known = caps(here)
    present = np.interp(here, profile.nodes, profile.squares)
    fast = (speed > 1.0 + 0.1 * _SMALL_EXCESS) & (present > 0.0)
    lower = np.where(fast, present / speed**2, np.inf)
    used = 1.0 if slowdown is None else slowdown(here)
    part = np.maximum(used / jerk**_POWER, _LEAST_PART)
    square = PathFunction(here, np.minimum(known, lower))
    return replace(limits, square=square, slowdown=PathFunction(here, part))


def _spread(factors: Array, reach: int) -> Array:
    """Take the largest factor nearby, then the mean nearby: the motion must change gently."""
    padded = np.pad(factors, 2 * reach, constant_values=1.0)
    largest = sliding_window_view(np.maximum(padded, 1.0), 2 * reach + 1).max(axis=1)
    return sliding_window_view(largest, 2 * reach + 1).mean(axis=1)
