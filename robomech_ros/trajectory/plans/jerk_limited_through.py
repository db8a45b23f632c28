"""Jerk-limited motion through via points, from pieces that Ruckig plans from state to state.

The velocities at the via points are chosen here: from those of stopping at each of them they are
improved one by one, as long as the two pieces that meet there become shorter.  Where there are many
points, the states in which the time-optimal motion along their spline passes them are tried, too.
"""

from dataclasses import dataclass

import numpy as np
import ruckig

from robomech_ros.errors import LimitExceededError, RobomechError
from robomech_ros.trajectory.curves.motion_to_rest import MotionThrough, check_positions
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial, joined
from robomech_ros.trajectory.curves.time_scaling import fitted
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.profiles.jerk_limited import JerkLimited, planned_between
from robomech_ros.trajectory.profiles.ruckig_phases import failure
from robomech_ros.trajectory.timing.time_optimal_motions import time_optimal_through
from robomech_ros.typing import Array

# Steps of the search, in parts of the velocity limits, and how often all points are tried.
_STEPS = (0.5, 0.25, 0.12, 0.06, 0.03, 0.015)
_SWEEPS = 4
# Of the durations that the joints alone would take: so much counts what the slowest one hides.
_HIDDEN = 1e-3
# A gain below this part of the duration is none.
_GAIN = 1e-6
# Pieces that are planned at most in a search, a second or two; then it keeps what it has found.
_PIECES = 40_000
# How often velocities are halved where a motion swings out of the position limits.
_HALVINGS = 6
# From so many points on the search alone stays behind the time-optimal motion.
_MANY = 8
# By how much states are slowed down, so that rounding does not take them out of the limits.
_SLOWER = 1.0 + 1e-7


@dataclass(frozen=True, eq=False)
class JerkLimitedThrough(MotionThrough):
    """Piecewise constant jerk through via points, without a stop where that is faster."""


def jerk_limited_through(
    points: Array, limits: Limits, duration: float | None = None
) -> JerkLimitedThrough:
    """Plan from rest to rest through via points (m, n), within limits of all rates.

    Without a wanted duration (s) the motion is the shortest that is found, never longer than
    stopping at every point.
    """
    # A point that repeats the one before is passed with it.
    distinct = np.append(True, np.any(np.diff(points, axis=0) != 0.0, axis=1))
    places = points[distinct]
    if len(places) == 1:
        still = JerkLimited.plan(places[0], places[0], limits, duration)
        return JerkLimitedThrough(
            places[0], still.pieces, np.linspace(0.0, still.duration, len(points))
        )
    pieces, knots = _searched(places, limits)
    if len(places) >= _MANY:
        pieces, knots = _shorter(places, limits, pieces, knots)
    exact = fitted(pieces, limits, duration)
    knots = knots * (exact.duration / pieces.duration)
    return JerkLimitedThrough(places[-1], exact, knots[np.cumsum(distinct) - 1])


def _searched(places: Array, limits: Limits) -> tuple[PiecewisePolynomial, Array]:
    """Plan with the velocities that a search finds; halve them where the motion swings out."""
    velocities = _Search(places, limits).velocities()
    still = np.zeros_like(velocities)
    for _ in range(_HALVINGS):
        pieces, knots = _joined(places, velocities, still, limits)
        try:
            check_positions(pieces, places[0], limits)
            return pieces, knots
        except LimitExceededError:
            velocities = velocities * 0.5
    pieces, knots = _joined(places, still, still, limits)
    check_positions(pieces, places[0], limits)
    return pieces, knots


def _shorter(
    places: Array, limits: Limits, pieces: PiecewisePolynomial, knots: Array
) -> tuple[PiecewisePolynomial, Array]:
    """Pass the points in the states of the time-optimal motion, if that takes less time."""
    try:
        motion = time_optimal_through(places, limits)
        sample = motion.sample(motion.knots)
        velocities = sample.velocity / _SLOWER
        accelerations = sample.acceleration / _SLOWER**2
        velocities[[0, -1]] = accelerations[[0, -1]] = 0.0
        found, passed = _joined(places, velocities, accelerations, limits)
        check_positions(found, places[0], limits)
    except RobomechError:
        return pieces, knots
    return (found, passed) if found.duration < pieces.duration else (pieces, knots)


class _Search:
    """Velocities at the via points that make the pieces short."""

    def __init__(self, places: Array, limits: Limits) -> None:
        self._places, self._limits = places, limits
        n = places.shape[1]
        self._solver = ruckig.Ruckig(n)
        self._request = ruckig.InputParameter(n)
        self._request.max_velocity = limits.velocity.tolist()
        self._request.max_acceleration = limits.acceleration.tolist()
        self._request.max_jerk = limits.jerk.tolist()
        self._motion = ruckig.Trajectory(n)
        self._v = np.zeros_like(places)
        self._planned = 0

    def velocities(self) -> Array:
        """Find the velocities (m, n); they are zero at both ends."""
        inner = range(1, len(self._places) - 1)
        costs = [self._cost(k, self._v[k], self._v[k + 1]) for k in range(len(self._places) - 1)]
        for step in _STEPS:
            for _ in range(_SWEEPS):
                before = sum(costs)
                for k in inner:
                    if self._planned > _PIECES:
                        return self._v
                    self._improve(k, step, costs)
                if not sum(costs) < before * (1.0 - _GAIN):
                    break
        return self._v

    def _improve(self, k: int, step: float, costs: list[float]) -> None:
        """Try other velocities at point k: along the way, and joint by joint."""
        for change in self._changes(k, step):
            trial = np.clip(self._v[k] + change, -self._limits.velocity, self._limits.velocity)
            front = self._cost(k - 1, self._v[k - 1], trial)
            back = self._cost(k, trial, self._v[k + 1])
            if front + back < (costs[k - 1] + costs[k]) * (1.0 - _GAIN):
                self._v[k], costs[k - 1], costs[k] = trial, front, back

    def _changes(self, k: int, step: float) -> list[Array]:
        limits = self._limits.velocity
        along = self._places[k + 1] - self._places[k - 1]
        fastest = np.abs(along / limits).max()
        changes = [] if not fastest > 0.0 else [step / fastest * along, -step / fastest * along]
        for j, limit in enumerate(limits):
            for sign in (1.0, -1.0):
                change = np.zeros(len(limits))
                change[j] = sign * step * limit
                changes.append(change)
        return changes

    def _cost(self, k: int, before: Array, after: Array) -> float:
        """Duration (s) of the piece behind point k, and a little of what each joint needs alone."""
        self._planned += 1
        request = self._request
        request.target_position = (self._places[k + 1] - self._places[k]).tolist()
        request.current_velocity = before.tolist()
        request.target_velocity = after.tolist()
        if failure(self._solver, request, self._motion):
            return np.inf
        alone = self._motion.independent_min_durations
        return float(self._motion.duration + _HIDDEN * sum(alone))


def _joined(
    places: Array, velocities: Array, accelerations: Array, limits: Limits
) -> tuple[PiecewisePolynomial, Array]:
    """Plan all pieces and put them one behind the other; give the knots (m,), too."""
    pieces = []
    for k in range(len(places) - 1):
        begin, end = (velocities[k], accelerations[k]), (velocities[k + 1], accelerations[k + 1])
        pieces.append(planned_between(places[k], places[k + 1], limits, 0.0, begin, end)[1])
    return joined(pieces), np.cumsum([0.0, *(piece.duration for piece in pieces)])
