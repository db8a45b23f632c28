"""Time-optimal motions along joint paths, with the continuous acceleration that samples need."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from robomech_ros.errors import LimitExceededError
from robomech_ros.trajectory.curves.bounded_spline import bounded_spline
from robomech_ros.trajectory.curves.compiled_sampling import divided
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline
from robomech_ros.trajectory.curves.fewer_pieces import with_fewer_pieces
from robomech_ros.trajectory.curves.knots import spaced_knots
from robomech_ros.trajectory.curves.motion_to_rest import (
    MotionThrough,
    MotionToRest,
    check_positions,
)
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.time_scaling import fitted
from robomech_ros.trajectory.limits import Limits, Rate
from robomech_ros.trajectory.profiles.velocity_profiles import DoubleS
from robomech_ros.trajectory.timing.path_timing import time_optimal
from robomech_ros.trajectory.timing.speed_profile import TimeOptimal
from robomech_ros.typing import Array

# Shortest time (s) in which an acceleration rises from zero to its limit, where no jerk limit says
# so, and along curved paths, of which shorter ramps would need thousands of samples per second.
_RAMP = 0.02
# Points nearer to each other than this (rad or m, and in parts of the largest) are one: rounding
# would take the way between them for a zigzag.
_SAME = 1e-9
# A segment of the path's parameter is at least this part of its neighbours: the spline would take a
# bend between them in no time otherwise.
_SHORTEST_BESIDE = 0.03
# Rounding of via points (rad, m), which is not corrected.
_MISSED = 1e-12
# Corrections of the instants at which via points are passed; convergence is quadratic.
_CORRECTIONS = 4


def with_ramps(limits: Limits, *, everywhere: bool) -> Limits:
    """Set jerk limits of all joints for a rise of acceleration within 20 ms.

    `everywhere` tells whether joints whose own jerk limits are higher get it, or only those
    without.
    """
    ramps = limits.acceleration / _RAMP
    own = limits.jerk
    jerk = np.minimum(own, ramps) if everywhere else np.where(np.isfinite(own), own, ramps)
    return replace(limits, jerk=jerk)


class TimeOptimalMotion(MotionToRest):
    """Along the straight line in joint space: a double-S profile, the fastest one there is.

    A joint without a jerk limit raises its acceleration within 20 ms.
    """

    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration")
    STARTS_MOVING: ClassVar[bool] = False
    ACCELERATION_STEPS: ClassVar[bool] = False

    @classmethod
    def plan(
        cls, start: Array, goal: Array, limits: Limits, duration: float | None = None
    ) -> TimeOptimalMotion:
        """Compute the fastest motion, slowed down as a whole where wanted.

        Parameters
        ----------
        start, goal : ndarray, shape (n,)
            Joint values in rad or m.
        limits : Limits
            Velocity and acceleration limits count, and those jerk limits that are finite.
        duration : float, optional
            Wanted duration in s; None for the shortest.
        start_velocity, start_acceleration : None
            The motion starts from rest.

        Raises
        ------
        DurationTooShortError
            If the wanted duration would break a limit.
        """
        motion = DoubleS.plan(start, goal, with_ramps(limits, everywhere=False), duration)
        return cls(goal, motion.pieces)


@dataclass(frozen=True, eq=False)
class TimeOptimalThrough(MotionThrough):
    """Along the natural cubic spline through via points, nearly as fast as the limits allow."""


def time_optimal_through(
    points: Array, limits: Limits, duration: float | None = None
) -> TimeOptimalThrough:
    """Plan from rest to rest along the natural cubic spline through all points (m, n), rad or m.

    Its knots are centripetal, in distances over the velocity limits; there are more of them where
    it would leave the position limits between the points. Accelerations take 20 ms at least to rise
    to their limits, longer where jerk limits say so. All points are passed exactly, but for those
    nearer than 1e-9 (rad or m, and in parts of the largest) to the one before, which are passed
    with it. Raises DurationTooShortError if the limits do not allow a wanted duration (s),
    SeedOutsideLimitsError or LimitExceededError if the first point, or another part of the spline,
    is outside the position limits.
    """
    limits.check_start(points[0])
    kept, owners = _distinct(points)
    places = points[kept]
    smooth = with_ramps(limits, everywhere=True)
    if len(places) == 2:
        straight = TimeOptimalMotion.plan(places[0], places[1], smooth, duration)
        check_positions(straight.pieces, places[0], limits)
        knots = np.array([0.0, straight.duration])
        return TimeOptimalThrough(places[1], straight.pieces, knots[owners])
    parameters, path = _path_through(places, limits)
    timed = time_optimal(path, smooth, jerk_smoothing=True)
    knots = _passed(timed, parameters, places)
    pieces = with_fewer_pieces(timed.pieces, smooth)
    missed = places - pieces.sample(knots).position
    if np.abs(missed).max() > _MISSED and (np.diff(knots) > 0.0).all():
        pieces = _summed(pieces, cubic_spline(knots, missed, "rest"))
    exact = fitted(pieces, smooth, duration)
    check_positions(exact, places[0], limits)
    knots = knots * (exact.duration / pieces.duration)
    return TimeOptimalThrough(places[-1], exact, knots[owners])


def _distinct(points: Array) -> tuple[list[int], list[int]]:
    """List start, goal, and the points between that are not where the one before is.

    Returns which points these are, and for every point the number of the one that it is passed
    with.
    """
    same = _SAME * (1.0 + float(np.abs(points).max()))
    last = len(points) - 1
    kept, owners = [0], [0]
    for k in range(1, last):
        if np.abs(points[k] - points[kept[-1]]).max() > same:
            kept.append(k)
        owners.append(len(kept) - 1)
    if len(kept) > 1 and np.abs(points[last] - points[kept[-1]]).max() <= same:
        kept[-1] = last
    else:
        kept.append(last)
    return kept, [*owners, len(kept) - 1]


def _path_through(places: Array, limits: Limits) -> tuple[Array, PiecewisePolynomial]:
    """Lay the natural spline; give its parameters (m,) at the places (m, n), too.

    A kink takes time, but swings out less; with more knots nothing swings out.
    """
    centripetal = spaced_knots(places, "centripetal", limits.velocity)
    for parameters in (_without_kinks(centripetal), centripetal):
        path = cubic_spline(parameters, places, "natural")
        try:
            check_positions(path, places[0], limits)
        except LimitExceededError:
            continue
        return parameters, path
    # A start outside, within the slack, may stay there.
    lower, upper = np.minimum(limits.lower, places[0]), np.maximum(limits.upper, places[0])
    inside = bounded_spline(centripetal, places, lower, upper, "natural")
    return centripetal, path if inside is None else inside


def _without_kinks(knots: Array) -> Array:
    """Lengthen segments that are short beside a neighbour; knots go from 0 to 1 again."""
    spans = np.diff(knots)
    if (
        not (spans[1:] < _SHORTEST_BESIDE * spans[:-1]).any()
        and not (spans[:-1] < _SHORTEST_BESIDE * spans[1:]).any()
    ):
        return knots
    for order in (range(1, len(spans)), range(len(spans) - 1, 0, -1)):
        for k in order:
            a, b = spans[k - 1], spans[k]
            spans[k - 1 : k + 1] = max(a, _SHORTEST_BESIDE * b), max(b, _SHORTEST_BESIDE * a)
    return np.concatenate([[0.0], np.cumsum(spans)]) / spans.sum()


def _passed(timed: TimeOptimal, parameters: Array, places: Array) -> Array:
    """Find when places (m, n) at path coordinates (m,) are passed, in s."""
    # Rounding may let the coordinates step back by a little; they never do.
    coordinates = np.maximum.accumulate(timed.coordinates)
    breaks = timed.pieces.breaks
    instants = np.interp(parameters, coordinates, breaks)
    earliest = breaks[np.maximum(np.searchsorted(coordinates, parameters, side="left") - 1, 0)]
    after = np.searchsorted(coordinates, parameters, side="right")
    latest = breaks[np.minimum(after, len(breaks) - 1)]
    for _ in range(_CORRECTIONS):
        sample = timed.sample(instants)
        speed = (sample.velocity**2).sum(axis=1)
        away = ((places - sample.position) * sample.velocity).sum(axis=1)
        moving = speed > 0.0
        instants[moving] += away[moving] / speed[moving]
        instants = np.clip(instants, earliest, latest)
    instants[[0, -1]] = 0.0, timed.duration
    return instants


def _summed(one: PiecewisePolynomial, other: PiecewisePolynomial) -> PiecewisePolynomial:
    """Add two curves of the same joints over the same time, with the breaks of both."""
    breaks = np.union1d(one.breaks, other.breaks)
    parts = [divided(curve, breaks).coefficients for curve in (one, other)]
    size = max(len(part) for part in parts)
    total = np.zeros((size, *parts[0].shape[1:]))
    for part in parts:
        total[: len(part)] += part
    return PiecewisePolynomial(breaks, total)
