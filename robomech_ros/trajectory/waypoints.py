"""Waypoints, as a trajectory message carries them, and how a curve is turned into them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import positive_number, whole_number
from robomech_ros.trajectory.curves.compiled_sampling import compiled
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import Trajectory
from robomech_ros.typing import Array

_NANOSECONDS = 1e9
# Samples nearer to each other (s) could become one when they are rounded to whole nanoseconds.
_NEAREST = 2e-9
_EPSILON = float(np.finfo(np.float64).eps)


class PiecewiseTrajectory(Trajectory, Protocol):
    """A trajectory that is a piecewise polynomial and can say of which pieces."""

    @property
    def pieces(self) -> PiecewisePolynomial:
        """The curve; derivatives of any order may step at its breaks only."""


@dataclass(frozen=True, eq=False)
class Waypoints:
    """States of n joints at m instants.

    Attributes
    ----------
    times : ndarray, shape (m,)
        Instants in s, strictly increasing.
    positions : ndarray, shape (m, n)
        rad or m.
    velocities, accelerations : ndarray, shape (m, n), or None
        rad or m over s and s^2; None (or a row of NaN) where not given.
    """

    times: Array
    positions: Array
    velocities: Array | None = None
    accelerations: Array | None = None

    @cached_property
    def curve(self) -> PiecewisePolynomial:
        """The curve that a controller interpolates through these waypoints."""
        return interpolant(self.times, self.positions, self.velocities, self.accelerations)

    def part(self, rows: Any) -> Waypoints:
        """Return some of the waypoints, by an index of rows as numpy takes it."""
        rates = (
            None if rate is None else rate[rows] for rate in (self.velocities, self.accelerations)
        )
        return Waypoints(self.times[rows], self.positions[rows], *rates)


def discretise(
    trajectory: PiecewiseTrajectory, period: float, max_points: int, *, jerk_error: float = 1.0
) -> Waypoints:
    """Sample a trajectory so that its waypoints give back the same curve.

    The samples are at most `period` apart, at whole nanoseconds, and there is one at every break
    of the curve: between two breaks every joint follows one polynomial, so that the quintic
    through two samples of position, velocity and acceleration is that very polynomial.

    Parameters
    ----------
    trajectory : PiecewiseTrajectory
        From rest or moving, to rest; starting at t = 0.
    period : float
        Largest time between two samples in s.
    max_points : int
        The most samples there may be.
    jerk_error : float
        What the rounding of positions may do to the jerk between two samples, rad or m over s^3;
        breaks so near to each other that it would do more share one sample.

    Returns
    -------
    Waypoints
        First at t = 0, last at the end of the trajectory, at rest.

    Raises
    ------
    BadValueError
        If the trajectory has no pieces, or the period is no positive number or asks for more than
        `max_points` samples, or those are no number.
    """
    period = positive_number("sample_period", period, "a number of seconds above 0")
    pieces = getattr(trajectory, "pieces", None)
    if not isinstance(pieces, PiecewisePolynomial):
        raise BadValueError("trajectory", trajectory, "one with pieces")
    max_points = whole_number("max_points", max_points, "a whole number from 2 on", 2)
    jerk_error = positive_number("jerk_error", jerk_error, "rad or m over s^3, above 0")
    breaks = _distinct_breaks(pieces, jerk_error)
    spread = compiled("samples", "spread_instants")
    count = spread(breaks, period, np.empty(0))
    if count > max_points:
        spare = max(max_points - len(breaks), 1)
        least = math.ceil(trajectory.duration / spare * 1e6) / 1e6
        raise BadValueError(
            "sample_period",
            period,
            f"at least {least:g} s: the trajectory lasts {trajectory.duration:.6g} s and may have "
            f"{max_points} points",
        )
    instants = np.empty(int(count))
    spread(breaks, period, instants)
    instants[-1] = trajectory.duration
    times = instants.copy()
    times[-1] = math.ceil(trajectory.duration * _NANOSECONDS - 1e-3) / _NANOSECONDS
    sample = trajectory.sample(instants)
    return Waypoints(times, sample.position, sample.velocity, sample.acceleration)


def position_rounding(positions: Array) -> float:
    """Bound what the rounding of positions (m, n) does to the quintic through samples h apart.

    It multiplies errors of position by 60 / h^3 in its jerk, and by 60 / h^2 or less in its
    acceleration: this is 60 times the error, rad or m.
    """
    return 60.0 * _EPSILON * float(np.abs(positions).max(initial=1.0))


def _distinct_breaks(curve: PiecewisePolynomial, jerk_error: float) -> Array:
    """List the breaks, a middle one for those that nearly coincide; the two ends for sure."""
    if len(curve.breaks) == 2:
        return curve.breaks
    nearest = float(np.cbrt(position_rounding(curve.coefficients[0]) / jerk_error))
    nearest = max(nearest, _NEAREST)
    breaks = curve.breaks
    inner = breaks[(breaks > nearest) & (breaks < breaks[-1] - nearest)]
    distinct = [breaks[0]]
    while len(inner):
        near = int(np.searchsorted(inner, inner[0] + nearest, side="right"))
        distinct.append((inner[0] + inner[near - 1]) / 2.0)
        inner = inner[near:]
    return np.array([*distinct, breaks[-1]])
