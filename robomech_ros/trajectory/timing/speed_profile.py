"""Limits of the speed along a path, speeds cell by cell, and the resulting motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from robomech_ros._kernels.timing import pieces as time_pieces
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.compiled_sampling import PiecewiseMotion
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial, lasting_pieces
from robomech_ros.trajectory.timing.path_limits import SpeedLimit, TorqueLimits
from robomech_ros.typing import Array, IntArray

# Time-optimal motions are planned within the limits less this part; with TIMING_ACCURACY, by which
# their pieces in time may miss, it is less than LIMIT_SLACK.
TIMING_MARGIN = 2e-7
# Relative excess over a limit that counts as rounding.
_ROUNDING = 1e-10


Bound = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class PathLimits:
    """Limits along a path of n joints, (n,), rad or m over s and s^2, infinite for none.

    Besides, limits of other speeds, and of torques, or what else is linear in the acceleration
    along the path. ``square`` gives, at path coordinates (m + 1,) of the nodes, the largest squares
    of the speed, ``slowdown``, at those (m,) in the middle of the cells, the parts of all
    accelerations to use.
    """

    velocity: Array
    acceleration: Array
    speeds: list[SpeedLimit] = field(default_factory=list)
    torques: list[TorqueLimits] = field(default_factory=list)
    square: Bound | None = None
    slowdown: Bound | None = None

    @cached_property
    def velocity_scales(self) -> Array:
        """One over the velocity limits, with a margin for rounding, shape (n,)."""
        return (1.0 + TIMING_MARGIN) / self.velocity

    @cached_property
    def acceleration_scales(self) -> Array:
        """One over the acceleration limits, with a margin for rounding, shape (n,)."""
        return (1.0 + TIMING_MARGIN) / self.acceleration


@dataclass(frozen=True, eq=False)
class SpeedProfile:
    """Squares of the speed along a path, cell by cell.

    The nodes (m + 1,) are path coordinates where the cells begin and end, and the squares (m + 1,)
    those of the speed there. ``local`` (m, n, d + 1) is the path in each cell, in powers of the
    coordinate since its beginning; ``bends`` (m,) is by how much the square of the speed bends
    inside it, and ``binding`` (m,) which row of limits binds there.
    """

    nodes: Array
    local: Array
    bends: Array
    squares: Array
    binding: IntArray

    @cached_property
    def spans(self) -> Array:
        """Lengths of the cells, shape (m,)."""
        return np.diff(self.nodes)

    @cached_property
    def duration(self) -> float:
        """Duration in s."""
        return float(time_pieces.total_time(self.spans, self.bends, self.squares))

    def timed(self, scales: Array, accuracy: float) -> TimeOptimal:
        """Turn the profile into a motion whose accelerations are right within `accuracy`.

        It counts in parts of one over `scales` (n,); where that is 0 in those of the joint's peak.
        """
        given = self.local, self.spans, self.bends, self.squares
        counts = np.ones(len(self.spans), np.int64)
        if not scales.all():
            rough = self._in_pieces(counts).pieces
            peaks = 2.0 * np.abs(rough.coefficients[2]).max(axis=0)
            scales = np.where(scales > 0.0, scales, 1.0 / np.where(peaks > 0.0, peaks, np.inf))
        time_pieces.piece_counts(*given, scales, accuracy, counts)
        return self._in_pieces(counts)

    def _in_pieces(self, counts: IntArray) -> TimeOptimal:
        """Divide each cell into a number of pieces, shape (m,)."""
        total = int(counts.sum())
        times, coordinates, speeds = np.empty((3, total + 1))
        coefficients = np.empty((6, total, self.local.shape[1]))
        given = self.local, self.spans, self.bends, self.squares
        time_pieces.write_pieces(*given, counts, times, coordinates, speeds, coefficients)
        kept = np.ones(total + 1, bool)
        pieces, kept[:-1] = lasting_pieces(times, coefficients)
        return TimeOptimal(pieces, coordinates[kept] + self.nodes[0], speeds[kept])


@dataclass(frozen=True, eq=False)
class TimeOptimal(PiecewiseMotion):
    """A motion along a path.

    Attributes
    ----------
    pieces : PiecewisePolynomial
        The motion: quintic polynomials of time, which follow the path with an error far below its
        accelerations' share of `TIMING_ACCURACY`, and meet it where they meet.
    coordinates : ndarray, shape (p + 1,)
        Path coordinates where the p pieces begin and end.
    speeds : ndarray, shape (p + 1,)
        Rates of the path coordinate there, in path coordinate over s.
    """

    pieces: PiecewisePolynomial
    coordinates: Array
    speeds: Array

    def within(self, *limits: Array) -> TimeOptimal:
        """Stretch the time until velocity, acceleration (and jerk) keep to limits (n,) each.

        All peaks are found between the samples as well.
        """
        slower, (low, high) = 1.0, extremes(self.pieces)
        for order, limit in enumerate(limits, 1):
            peak = float((np.maximum(-low, high)[order] / limit).max())
            if peak > 1.0 + _ROUNDING:
                slower = max(slower, (peak + _ROUNDING) ** (1.0 / order))
        return self.stretched(slower)

    def stretched(self, factor: float) -> TimeOptimal:
        """Take longer by a factor, everywhere."""
        if factor == 1.0:
            return self
        kept = np.append(np.diff(self.pieces.breaks * factor) > 0.0, True)
        pieces = self.pieces.stretched(factor)
        return TimeOptimal(pieces, self.coordinates[kept], self.speeds[kept] / factor)
