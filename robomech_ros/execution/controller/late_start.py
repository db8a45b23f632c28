r"""Catching up with a trajectory that comes late: on its path, within all limits, never by a jump.

The trajectory q(x) has a schedule x = t, which may be behind its stamps by a lag.  The robot is
elsewhere on the path, at another pace.  It joins the schedule by x = t + f(t), in which the
quintic f fades out; its distance from the path fades out at the same time.  If the limits leave
no room to catch up fully, a lag remains.  Later messages are then in time for the robot, and the
next one that leaves room reduces the lag.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.curve_parts import (
    jerks_over,
    paced,
    peaks,
    prolonged_back,
    rebased,
    shifted,
    spliced,
)
from robomech_ros.execution.controller.joining import violation_of
from robomech_ros.execution.controller.transitions import SHORTEST_BLEND, with_braking, with_fading
from robomech_ros.execution.joints import Joints, State, paced_state
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# No robot follows a trajectory that is farther behind its stamps, s.
LONGEST_LAG = 0.5
# Lags and times of fading (s) that are tried, the smallest lag first.
_LAGS = np.concatenate([np.arange(0.0, 0.1, 0.01), np.arange(0.1, LONGEST_LAG + 1e-9, 0.025)])
_TIMES = np.array([SHORTEST_BLEND, 0.08, 0.12, 0.18, 0.25, 0.35, 0.5, 0.7])
# Plans to stop, which a stream ends with, may leave room for a few milliseconds only, s.
_NEARER = np.array([-0.005, -0.002, -0.001])
# The pace of a robot that catches up is no faster than this.
_FASTEST = 1.5
# So many of those that fit by samples are verified, and about as many of the others.
_VERIFIED = 6
# A state off by less than this (rad, m, per s and s^2; a pace by less) is on schedule.
_ON_IT = 1e-9
# A robot that is off its place by less (rad or m) has kept to it.
_NEAR = 1e-5
# A fading that is over in less than this (s) is as good as over.
_MOMENT = 5e-3
# Places (s) where the robot is looked for on a schedule, and how often the nearest one is improved.
_STEP, _IMPROVED = 0.005, 3
# A step of the acceleration is taken for a jerk of so long, as at 500 Hz, s.
_KINK = 2e-3
# The part of that which a cubic to the first point may begin with.
_OF_KINK = 0.02
_ON_THE_WAY = "on the way onto a trajectory that comes late, the"
# Rounding of rates, as their part.
_SLACK = 1e-6
# Where samples are taken, as parts of the time of fading, and the quintics that fade out a place, a
# pace and its rate of 1 in a time of 1, with their first three derivatives there, (4, 3, m).
_PARTS = np.linspace(0.0, 1.0, 9)
_QUINTICS = np.array(
    [
        (1.0, 0.0, 0.0, -10.0, 15.0, -6.0),
        (0.0, 1.0, 0.0, -6.0, 8.0, -3.0),
        (0.0, 0.0, 0.5, -1.5, 1.5, -0.5),
    ]
)
_FADING = np.array(
    [[np.polynomial.Polynomial(row).deriv(k)(_PARTS) for row in _QUINTICS] for k in range(4)]
)


@dataclass(frozen=True, eq=False)
class ScheduleShift:
    """A trajectory as it is followed by a robot that is on it, ``lag`` (s) behind its stamps.

    The curve is on the clock of the goal, some time before its begin included. The robot is on it
    from ``merged`` (s) on that clock. Until then its place on the curve is the time plus the
    polynomial ``ahead`` (6,) of the time on that clock, lowest power first (s).
    """

    curve: PiecewisePolynomial
    lag: float = 0.0
    merged: float = 0.0
    ahead: Array = field(default_factory=lambda: np.zeros(6))

    def since(self, time: float) -> "ScheduleShift":
        """Return the same on a clock that begins later by a time (s)."""
        ahead = rebased(self.ahead[:, None], time)[:, 0]
        return ScheduleShift(shifted(self.curve, -time), self.lag, self.merged - time, ahead)

    @property
    def in_time(self) -> bool:
        """True if the robot is on schedule at time 0."""
        return self.lag <= 0.0 and self.merged <= 0.0

    @property
    def place(self) -> Array:
        """Time on the curve (s) at time 0, its rate, and the derivative of the rate (1/s)."""
        if self.merged <= 0.0:
            return np.array([0.0, 1.0, 0.0])
        return np.array([0.0, 1.0, 0.0]) + self.ahead[:3] * (1.0, 1.0, 2.0)


def infeasibility(
    curve: PiecewisePolynomial, present: State, joints: Joints
) -> LimitExceededError | None:
    """Say where the way to the first point needs more than the limits, the plan and the present."""
    if len(curve.breaks) < 2 or _gentle(curve, present, joints):
        return None
    first = PiecewisePolynomial(curve.breaks[:2], curve.coefficients[:, :1])
    rest = PiecewisePolynomial(curve.breaks[1:], curve.coefficients[:, 1:])
    limits = np.maximum(joints.acceleration, np.abs(present.acceleration)), joints.limits.jerk
    kink = np.abs(curve.sample(0.0).acceleration - present.acceleration) / _KINK
    if (kink > _OF_KINK * joints.limits.jerk).any():
        worst = int(np.argmax(kink / joints.limits.jerk))
        numbers = float(kink[worst]), float(joints.limits.jerk[worst])
        return LimitExceededError(f"{_ON_THE_WAY} jerk", joints.names[worst], *numbers)
    for rate, what, limit in zip((2, 3), ("acceleration", "jerk"), limits, strict=True):
        found = peaks(first, rate)
        if (found <= limit * (1.0 + _SLACK)).all():
            continue
        allowed = np.maximum(limit, peaks(rest, rate)) * (1.0 + _SLACK)
        worst = int(np.argmax(found / allowed))
        if found[worst] > allowed[worst]:
            numbers = float(found[worst]), float(limit[worst])
            return LimitExceededError(f"{_ON_THE_WAY} {what}", joints.names[worst], *numbers)
    return None


def _gentle(curve: PiecewisePolynomial, present: State, joints: Joints) -> bool:
    """Return whether a cubic to the first point is within all limits, as in a punctual stream."""
    if len(curve.coefficients) != 4:
        return False
    (_, _, half, sixth), limit = curve.coefficients[:, 0], joints.acceleration
    begin, jerk = 2.0 * half, 6.0 * sixth
    end = begin + float(curve.breaks[1] - curve.breaks[0]) * jerk
    largest = joints.limits.jerk
    return bool(
        (np.maximum(np.abs(begin), np.abs(end)) <= limit).all()
        and (np.abs(jerk) <= largest).all()
        and (np.abs(begin - present.acceleration) <= _OF_KINK * _KINK * largest).all()
    )


def late_start(
    waypoints: Waypoints, present: State, joints: Joints, late: float, before: ScheduleShift | None
) -> tuple[PiecewisePolynomial, ScheduleShift] | None:
    """Find the way onto a late trajectory, all of whose points have velocities.

    It should have begun ``late`` (s) ago; ``before`` is what the robot follows, on a clock that is
    0 now. Returns what is to be followed from 0, now, on, to rest and within the limits (of
    acceleration and jerk unless the trajectory itself exceeds them); and its schedule. None without
    a path.
    """
    velocities = waypoints.velocities
    assert velocities is not None
    coming = _coming(waypoints, joints, late, 0.0 if before is None else before.lag)
    search = _Search(coming, present, joints, velocities[0])
    for curve in _candidate_curves(coming, before):
        for found in search.entry_paths(curve, before):
            return found
    return None


def extend_schedule(
    waypoints: Waypoints, joints: Joints, late: float, before: ScheduleShift
) -> ScheduleShift:
    """Add a late trajectory to a schedule if the robot cannot join yet, as `late_start`."""
    coming = _coming(waypoints, joints, late, before.lag)
    if not before.curve.breaks[0] < min(coming.breaks[0], 0.0):
        return before
    return replace(before, curve=spliced(before.curve, coming))


def _coming(waypoints: Waypoints, joints: Joints, late: float, lag: float) -> PiecewisePolynomial:
    """Return the curve of a late trajectory on a clock that is 0 now, later by a lag (s)."""
    velocities = waypoints.velocities
    assert velocities is not None
    since_first = waypoints.times - waypoints.times[0]
    coming = interpolant(since_first, waypoints.positions, velocities, waypoints.accelerations)
    coming = with_braking(coming, velocities[-1], joints)
    return shifted(coming, float(waypoints.times[0]) - late + lag)


def _candidate_curves(
    coming: PiecewisePolynomial, before: ScheduleShift | None
) -> Iterator[PiecewisePolynomial]:
    """Yield what comes after what is followed now, and then what comes alone."""
    if before is not None and before.curve.breaks[0] < min(coming.breaks[0], 0.0):
        yield spliced(before.curve, coming)
    yield prolonged_back(coming, 2.0 * LONGEST_LAG)


class _Search:
    """Search for entry paths onto schedules."""

    def __init__(
        self, coming: PiecewisePolynomial, present: State, joints: Joints, cruise: Array
    ) -> None:
        self._present, self._joints, self._cruise = present, joints, cruise
        limits = joints.limits
        here = np.maximum(joints.acceleration, np.abs(present.acceleration))
        self._acceleration = np.maximum(here, peaks(coming, 2)) * (1.0 + _SLACK)
        self._jerk = np.maximum(limits.jerk, peaks(coming, 3)) * (1.0 + _SLACK)
        self._change = np.maximum(limits.jerk, jerks_over(coming, _KINK)) * (1.0 + _SLACK)
        self._velocity = limits.velocity * (1.0 + _SLACK)

    def entry_paths(
        self, curve: PiecewisePolynomial, before: ScheduleShift | None
    ) -> Iterator[tuple[PiecewisePolynomial, ScheduleShift]]:
        """Find ways onto a curve that has the lag of what came before: the best ones first."""
        lag, going_on = 0.0, None
        if before is not None:
            lag = before.lag
            if self._off(curve, before.place) <= _NEAR:
                merged = max(before.merged, 0.0)
                going_on = self._verified(curve, lag, before.place, 0.0, merged)
            if going_on is not None and (not lag or before.merged > 0.0):
                yield going_on
        for place in self._places(curve, before):
            for delay, time in self._fitting(curve, lag, place):
                if going_on is not None and delay >= 0.0:
                    continue
                found = self._verified(curve, lag, place, delay, time)
                if found is not None:
                    yield found
            if going_on is not None:
                yield going_on

    def _places(self, curve: PiecewisePolynomial, before: ScheduleShift | None) -> Iterator[Array]:
        """Yield places on a curve where the robot may be (s), with paces and their rates."""
        if before is not None and self._off(curve, before.place) <= _NEAR:
            yield before.place
        yield self._nearest(curve)
        yield np.array([0.0, 1.0, 0.0])

    def _off(self, curve: PiecewisePolynomial, place: Array) -> float:
        """Return how far the robot is from a place on a curve (rad or m)."""
        return float(np.max(np.abs(self._present.position - curve.sample(place[0]).position)))

    def _nearest(self, curve: PiecewisePolynomial) -> Array:
        here, unit = self._present, 1.0 / self._joints.acceleration
        places = np.arange(max(curve.breaks[0], -2.0 * LONGEST_LAG), LONGEST_LAG, _STEP)
        off = np.sum(((curve.sample(places).position - here.position) * unit) ** 2, axis=1)
        x, least = float(places[int(np.argmin(off))]), 1e-12
        for _ in range(_IMPROVED):
            there = curve.sample(x)
            slope = there.velocity * unit
            square = max(float(slope @ slope), least)
            x += float(((here.position - there.position) * unit) @ slope) / square
            x = min(max(x, float(places[0])), float(places[-1]))
        there = curve.sample(x)
        slope = there.velocity * unit
        square = max(float(slope @ slope), least)
        pace = float((here.velocity * unit) @ slope) / square
        pace = min(max(pace, 0.0), _FASTEST)
        push = (here.acceleration - there.acceleration * pace * pace) * unit
        return np.array([x, pace, float(push @ slope) / square])

    def _verified(
        self, curve: PiecewisePolynomial, lag: float, place: Array, delay: float, time: float
    ) -> tuple[PiecewisePolynomial, ScheduleShift] | None:
        """Return the way onto a curve that is later by a delay (s), if it keeps the limits."""
        moved, here = shifted(curve, delay), self._present
        x, pace, rate = float(place[0]) + delay, float(place[1]), float(place[2])
        there = moved.sample(x)
        apart = here - paced_state(there, pace, rate)
        offset = apart.position, apart.velocity, apart.acceleration
        ahead = np.array([x, pace - 1.0, rate])
        off = max(float(np.max(np.abs(part))) for part in offset)
        if time < _MOMENT:
            merged = max(off, float(np.max(np.abs(ahead)))) <= _ON_IT
            time = 0.0 if merged else SHORTEST_BLEND
        powers = _faded(ahead, time) if time else np.zeros(6)
        way = paced(moved, powers, time)
        if way is None:
            return None
        if off > _ON_IT:
            way = with_fading(way, offset, time)
        return (
            None if self._violates(way) else (way, ScheduleShift(moved, lag + delay, time, powers))
        )

    def _violates(self, way: PiecewisePolynomial) -> bool:
        if (peaks(way, 2) > self._acceleration).any():
            return True
        if (peaks(way, 3) > self._jerk).any() or (jerks_over(way, _KINK) > self._change).any():
            return True
        return violation_of(way, self._joints) is not None

    def _fitting(
        self, curve: PiecewisePolynomial, lag: float, place: Array
    ) -> list[tuple[float, float]]:
        """Return delays and fading times (s) that keep limits at samples, the best ones first."""
        delays = np.concatenate((_NEARER[-lag <= _NEARER], _LAGS - lag))
        delays = delays[curve.breaks[0] <= -delays]
        if not len(delays):
            return []
        ahead = np.stack(
            [place[0] + delays, *np.repeat(place[1:, None] - ((1.0,), (0.0,)), len(delays), 1)]
        )
        # The place, its pace, and two more rates: delays, times, parts.
        f = [
            np.einsum("od,ot,op->dtp", ahead, _TIMES ** (np.arange(3)[:, None] - k), _FADING[k])
            for k in range(4)
        ]
        x = _TIMES[:, None] * _PARTS + f[0] - delays[:, None, None]
        p, r, c = 1.0 + f[1], f[2], f[3]
        there = curve.sample(x.reshape(-1))
        n = len(self._cruise)
        v, a, j = (part.reshape(*x.shape, n) for part in there[1:4])
        p, r, c = p[..., None], r[..., None], c[..., None]
        fits = ((p >= 0.0) & (p <= _FASTEST)).all(axis=(2, 3))
        fits &= (np.abs(v * p) <= self._velocity).all(axis=(2, 3))
        # The trajectory may go on as it begins.
        fits &= (np.abs(self._cruise * p) <= self._velocity).all(axis=(2, 3))
        fits &= (np.abs(a * p * p + v * r) <= self._acceleration).all(axis=(2, 3))
        jerk = j * p**3 + 3.0 * a * p * r + v * c
        fits &= (np.abs(jerk) <= self._jerk).all(axis=(2, 3))
        # As near to its time as possible, as soon as possible.
        found = [(float(delays[i]), float(_TIMES[k])) for i, k in np.argwhere(fits)]
        found.sort(key=sum)
        return found[:_VERIFIED] + found[_VERIFIED :: max(len(found) // _VERIFIED, 1)]


def _faded(ahead: Array, time: float) -> Array:
    """Return the quintic that begins with a place, a pace and a rate and fades out in a time."""
    powers = time ** np.arange(3.0)
    return (ahead * powers) @ _QUINTICS / time ** np.arange(6.0)
