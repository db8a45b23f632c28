"""Guaranteed extremes of piecewise polynomials, between the samples as well.

On an interval a polynomial lies within the hull of its Bernstein coefficients, and the hull
shrinks onto it quadratically as the interval is halved.  So the pieces whose hull cannot hold an
extreme are dropped at once, all pieces together, and the few others are halved until the hull is
as narrow as wanted.

References
----------
R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective", Computer Aided
Geometric Design 29, 2012, sections 3.3 and 3.5.
"""

import math
from collections.abc import Iterator
from functools import cache

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels import tolerances
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["extremes", "first_above", "hull"]

# Each halving narrows the hull four times; a hull still too wide after these is rounding.
_HALVINGS = 30
# Segments looked at together: their coefficients fit into the cache.
_BLOCK = 2048


def hull(curve: PiecewisePolynomial, order: int) -> FloatArray:
    """Bernstein coefficients of a derivative of a curve, segment by segment.

    Parameters
    ----------
    curve : PiecewisePolynomial
        s segments, n joints.
    order : int
        0 position, 1 velocity, 2 acceleration, 3 jerk.

    Returns
    -------
    ndarray, shape (d + 1, max(s, 1), n)
        d is the degree of the derivative.  The first and last coefficients are the values at the
        ends of the segment; all values in between lie between the smallest and the largest.
    """
    powers = curve.derivative(order)
    degree = len(powers) - 1
    if len(curve.spans) and degree:
        scales = curve.spans ** np.arange(1.0, degree + 1.0)[:, None]
        powers = np.concatenate([powers[:1], powers[1:] * scales[:, :, None]])
    flat = _to_bernstein(degree) @ powers.reshape(degree + 1, -1)
    return flat.reshape(powers.shape)


def extremes(
    curve: PiecewisePolynomial, order: int, slack: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Find the smallest and the largest value of a derivative for every joint.

    Parameters
    ----------
    curve : PiecewisePolynomial
        Of n joints.
    order : int
        0 position, 1 velocity, 2 acceleration, 3 jerk.
    slack : ndarray, shape (s, n), optional
        By how much the values in each segment may be wrong; they count only as far as they are
        certain.

    Returns
    -------
    low, high : ndarray, shape (n,)
        Over the whole curve, rad or m over s to the power of `order`, exact to a part in 1e11 of
        the largest coefficient.
    """
    low, high = (np.full(curve.joints, sign * np.inf) for sign in (1.0, -1.0))
    for first, block in _blocks(curve):
        coefficients = hull(block, order)
        doubt = 0.0 if slack is None else slack[first : first + _BLOCK]
        upper, lower = coefficients.max(axis=0), coefficients.min(axis=0)
        largest = np.maximum(_over_segments(upper), _over_segments(-lower))
        scale = np.maximum(largest, 0.0) * tolerances.PEAK_ACCURACY
        high = _maxima(coefficients - doubt, upper - doubt, scale, high)
        low = -_maxima(-coefficients - doubt, -lower - doubt, scale, -low)
    return low, high


def first_above(coefficients: FloatArray, bound: npt.ArrayLike) -> tuple[int, int] | None:
    """Find the first segment in which a joint goes over a bound.

    Parameters
    ----------
    coefficients : ndarray, shape (d + 1, s, n)
        Bernstein coefficients as `hull` gives them.
    bound : array_like, broadcastable to (s, n)
        What is allowed, by segment and joint.

    Returns
    -------
    tuple of int or None
        Segment and joint, of several joints the lowest; None if there is none.
    """
    bounds = np.broadcast_to(np.asarray(bound, dtype=np.float64), coefficients.shape[1:])
    suspect = coefficients.max(axis=0) > bounds
    if not suspect.any():
        return None
    sure = (np.maximum(coefficients[0], coefficients[-1]) > bounds).any(axis=1)
    last = int(np.argmax(sure)) if sure.any() else len(sure) - 1
    segments, joints = np.nonzero(suspect[: last + 1])
    above = _goes_above(coefficients[:, segments, joints], bounds[segments, joints])
    found = np.flatnonzero(above)
    if not len(found):
        return None
    return int(segments[found[0]]), int(joints[found[0]])


@cache
def _to_bernstein(degree: int) -> FloatArray:
    return np.array(
        [
            [math.comb(k, i) / math.comb(degree, i) for i in range(degree + 1)]
            for k in range(degree + 1)
        ]
    )


@cache
def _halving(degree: int) -> FloatArray:
    """Build the matrix from an interval's coefficients to those of its two halves."""
    left = np.array(
        [[math.comb(k, i) / 2.0**k for i in range(degree + 1)] for k in range(degree + 1)]
    )
    return np.concatenate([left, left[::-1, ::-1]])


def _halved(pieces: FloatArray) -> FloatArray:
    """Halve pieces (d + 1, m): the left halves, then the right ones, (d + 1, 2 m)."""
    size = len(pieces)
    both = _halving(size - 1) @ pieces
    return np.concatenate([both[:size], both[size:]], axis=1)


def _blocks(curve: PiecewisePolynomial) -> Iterator[tuple[int, PiecewisePolynomial]]:
    """Cut a curve into parts that fit into a processor's cache; yield first segment and part."""
    segments = curve.coefficients.shape[1]
    for first in range(0, segments, _BLOCK):
        last = min(first + _BLOCK, segments)
        breaks = curve.breaks[first : last + 1]
        yield first, PiecewisePolynomial(breaks, curve.coefficients[:, first:last])


def _over_segments(values: FloatArray) -> FloatArray:
    """Largest of the values (s, n) of each joint; joint by joint in memory, which is faster."""
    largest: FloatArray = np.ascontiguousarray(values.T).max(axis=1)
    return largest


def _maxima(
    coefficients: FloatArray, upper: FloatArray, scale: FloatArray, known: FloatArray
) -> FloatArray:
    """Find the largest value over all segments, for each joint, or `known` (n,) if that is larger.

    `upper` (s, n) bounds each segment; below `scale` (n,) differences do not count.
    """
    best = np.maximum(known, _over_segments(np.maximum(coefficients[0], coefficients[-1])))
    segments, owner = np.nonzero(upper > best + scale)
    pieces = coefficients[:, segments, owner]
    for _ in range(_HALVINGS):
        if not len(owner):
            break
        pieces, owner = _halved(pieces), np.concatenate([owner, owner])
        np.maximum.at(best, owner, np.maximum(pieces[0], pieces[-1]))
        kept = pieces.max(axis=0) > best[owner] + scale[owner]
        pieces, owner = pieces[:, kept], owner[kept]
    np.maximum.at(best, owner, pieces.max(axis=0))
    return best


def _goes_above(pieces: FloatArray, bounds: FloatArray) -> npt.NDArray[np.bool_]:
    """Which of the pieces (d + 1, m) go over their bounds (m,)."""
    above = np.zeros(len(bounds), dtype=bool)
    owner = np.arange(len(bounds))
    for _ in range(_HALVINGS):
        above[owner[np.maximum(pieces[0], pieces[-1]) > bounds[owner]]] = True
        kept = ~above[owner] & (pieces.max(axis=0) > bounds[owner])
        if not kept.any():
            break
        pieces, owner = _halved(pieces[:, kept]), np.concatenate([owner[kept], owner[kept]])
    return above
