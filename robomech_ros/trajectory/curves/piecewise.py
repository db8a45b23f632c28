"""Piecewise polynomials in time: the one form that every trajectory here can be brought into."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.trajectory.sample import Sample, checked_times, held_outside
from robomech_ros.typing import Array, ArrayLike, BoolArray

# Derivative d of x^i is _FACTORS[d, i] x^_POWERS[d, i], for d = 0..3 and i = 0..5.
_MAX_ORDER = 9
_FACTORS = np.array([[math.perm(i, d) for i in range(_MAX_ORDER + 1)] for d in range(4)], float)
_POWERS = np.array([[max(i - d, 0) for i in range(_MAX_ORDER + 1)] for d in range(4)])


@dataclass(frozen=True, eq=False)
class PiecewisePolynomial:
    r"""All joints as polynomials of the time since the beginning of a segment.

    In segment k, for ``breaks[k] <= t < breaks[k + 1]``, and for joint j

    .. math:: q_j(t) = \sum_i c_{ikj} (t - t_k)^i

    Attributes
    ----------
    breaks : ndarray, shape (s + 1,)
        Where the segments begin and the last one ends, in s, strictly increasing.  With a single
        entry (s = 0) the joints stand still at ``coefficients[0]``.
    coefficients : ndarray, shape (order + 1, max(s, 1), n)
        Power coefficients, lowest power first; rad or m over s to the power of the first index.
        The order is 9 at most.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.trajectory import PiecewisePolynomial
    >>> square = PiecewisePolynomial(np.array([0.0, 2.0]), np.array([[[1.0]], [[0.0]], [[1.0]]]))
    >>> square.sample(1.5).position, square.sample(1.5).velocity
    (array([3.25]), array([3.]))
    """

    breaks: Array
    coefficients: Array

    @property
    def duration(self) -> float:
        """Time from the first break to the last, in s."""
        return float(self.breaks[-1] - self.breaks[0])

    @property
    def joints(self) -> int:
        """Number of joints."""
        return int(self.coefficients.shape[2])

    @cached_property
    def spans(self) -> Array:
        """Durations of the segments (s), shape (s,)."""
        return self.breaks[1:] - self.breaks[:-1]

    def derivative(self, order: int) -> Array:
        """Power coefficients of a derivative.

        Parameters
        ----------
        order : int
            0 position, 1 velocity, 2 acceleration, 3 jerk.

        Returns
        -------
        ndarray, shape (d, max(s, 1), n)
            Lowest power first, at least one (zero) coefficient.
        """
        values = self.coefficients
        for _ in range(order):
            if len(values) == 1:
                return np.zeros_like(values)
            values = values[1:] * np.arange(1.0, len(values))[:, None, None]
        return values

    def of_joints(self, joints: Sequence[int]) -> PiecewisePolynomial:
        """Return the curve of some of the joints, in this order."""
        if list(joints) == list(range(self.joints)):
            return self
        kept = np.ascontiguousarray(self.coefficients[:, :, list(joints)])
        return PiecewisePolynomial(self.breaks, kept)

    def between(self, first: int, last: int) -> PiecewisePolynomial:
        """Return the pieces from one break to another."""
        kept = np.ascontiguousarray(self.coefficients[:, first:last])
        return PiecewisePolynomial(self.breaks[first : last + 1], kept)

    def after(self, t: float) -> PiecewisePolynomial:
        """Return the rest of the curve from a time (s) before its end."""
        last = max(self.coefficients.shape[1] - 1, 0)
        first = min(max(int(self.breaks.searchsorted(t, side="right")) - 1, 0), last)
        elapsed = max(t - float(self.breaks[first]), 0.0)
        coefficients, size = self.coefficients[:, first:].copy(), len(self.coefficients)
        shift = [
            [math.comb(k, i) * elapsed ** max(k - i, 0) for k in range(size)] for i in range(size)
        ]
        coefficients[:, 0] = np.array(shift) @ coefficients[:, 0]
        breaks = self.breaks[first:].copy()
        breaks[0] += elapsed
        return PiecewisePolynomial(breaks, coefficients)

    def stretched(self, factor: float) -> PiecewisePolynomial:
        """Return the same curve over a time longer by a factor, from the same instant on."""
        powers = factor ** np.arange(len(self.coefficients))
        breaks = self.breaks[0] + factor * (self.breaks - self.breaks[0])
        return lasting_pieces(breaks, self.coefficients / powers[:, None, None])[0]

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), () or (m,).

        On the clock of `breaks`.  Outside the breaks the joints rest at the position of the nearest
        end; at an inner break the later segment counts.
        """
        times = checked_times(t)
        if not times.ndim:
            return self._sample_one(float(times))
        inside = np.clip(times, self.breaks[0], self.breaks[-1])
        last = self.coefficients.shape[1] - 1
        segment = np.clip(np.searchsorted(self.breaks, inside, side="right") - 1, 0, last)
        # Instants last: long inner loops.
        coefficients = np.take(self.coefficients.transpose(0, 2, 1), segment, axis=2)
        rates = _horner(coefficients, inside - self.breaks[segment])
        return held_outside(Sample(*rates.transpose(0, 2, 1).copy()), inside != times)

    def _sample_one(self, t: float) -> Sample:
        """Sample at one instant, in one product of matrices."""
        inside = min(max(t, self.breaks[0]), self.breaks[-1])
        after = int(self.breaks.searchsorted(inside, side="right"))
        segment = min(after - 1, self.coefficients.shape[1] - 1)
        size = len(self.coefficients)
        elapsed = inside - self.breaks[segment]
        weights = _FACTORS[:, :size] * elapsed ** _POWERS[:, :size]
        rates = weights @ self.coefficients[:, segment]
        if inside != t:
            rates[1:] = 0.0
        return Sample(*rates)


def lasting_pieces(breaks: Array, coefficients: Array) -> tuple[PiecewisePolynomial, BoolArray]:
    """Leave out pieces that begin and end at the same instant, since rounding has joined these.

    Returns also which pieces are left, shape (s,).
    """
    lasting = breaks[1:] > breaks[:-1]
    if lasting.all():
        return PiecewisePolynomial(breaks, coefficients), lasting
    kept = np.append(breaks[:-1][lasting], breaks[-1])
    return PiecewisePolynomial(kept, coefficients[:, lasting]), lasting


def chained(curves: Sequence[PiecewisePolynomial]) -> PiecewisePolynomial:
    """Put curves together, each of which begins at the last break of the one before it."""
    breaks = np.concatenate([*(curve.breaks[:-1] for curve in curves), curves[-1].breaks[-1:]])
    coefficients = np.concatenate([curve.coefficients for curve in curves], axis=1)
    return PiecewisePolynomial(breaks, coefficients)


def joined(curves: Sequence[PiecewisePolynomial]) -> PiecewisePolynomial:
    """Concatenate curves of the same joints, each from t = 0 on; drop pieces without length."""
    starts = np.cumsum([0.0, *(curve.breaks[-1] for curve in curves)])
    breaks = [curve.breaks[:-1] + start for curve, start in zip(curves, starts, strict=False)]
    size = max(len(curve.coefficients) for curve in curves)
    padded = [
        np.pad(curve.coefficients, ((0, size - len(curve.coefficients)), (0, 0), (0, 0)))
        for curve in curves
    ]
    pieces, _ = lasting_pieces(
        np.append(np.concatenate(breaks), starts[-1]), np.concatenate(padded, axis=1)
    )
    return pieces


def _horner(coefficients: Array, elapsed: Array) -> Array:
    """Value and first three derivatives of (n, m) polynomials at m places, shape (4, n, m)."""
    rates = np.zeros((4, *coefficients.shape[1:]))
    rates[0] = coefficients[-1]
    for lower in coefficients[-2::-1]:
        for order in (3, 2, 1):
            rates[order] *= elapsed
            rates[order] += rates[order - 1]
        rates[0] *= elapsed
        rates[0] += lower
    rates[2] *= 2.0
    rates[3] *= 6.0
    return rates
