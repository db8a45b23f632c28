"""Guaranteed extremes of piecewise polynomials, between the samples as well.

On an interval a polynomial lies within the hull of its Bernstein coefficients, and the hull
shrinks onto it quadratically as the interval is divided.  So the pieces whose hull cannot hold an
extreme are dropped at once, those of all joints and derivatives together, and the few others are
divided until the hull is as narrow as wanted.

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

__all__ = ["extremes", "extremes_by_order", "first_above", "hull", "steps"]

# A piece is divided into so many: each time the hull becomes narrower by their square.
_PARTS = 16
# A hull still too wide after these divisions is rounding.
_DIVISIONS = 8
# Segments looked at together: their coefficients fit into the cache.
_BLOCK = 512


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
    coefficients: FloatArray = _hulls(curve, (order,))[0]
    return coefficients


def steps(curve: PiecewisePolynomial, orders: tuple[int, ...]) -> FloatArray:
    """Find by how much derivatives step from each segment to the next.

    Parameters
    ----------
    curve : PiecewisePolynomial
        s segments, n joints.
    orders : tuple of int
        k of them: 0 position, 1 velocity, 2 acceleration, 3 jerk.

    Returns
    -------
    ndarray, shape (k, s - 1, n)
        rad or m over s to the power of the order.
    """
    powers = _on_unit_spans(curve)
    size, segments, joints = powers.shape
    after = np.zeros((len(orders), max(segments - 1, 0), joints))
    for k, order in enumerate(orders):
        if order < size:
            after[k] = math.factorial(order) * curve.coefficients[order, 1:]
    flat = _at_end(size, orders) @ powers.reshape(size, -1)
    before = flat.reshape(len(orders), segments, joints)[:, :-1]
    return after - before * _rate_scales(curve, orders)[:, :-1]


def extremes(curve: PiecewisePolynomial, order: int) -> tuple[FloatArray, FloatArray]:
    """Find the smallest and the largest value (n,) of a derivative, as `extremes_by_order`."""
    low, high = extremes_by_order(curve, (order,))
    return low[0], high[0]


def extremes_by_order(
    curve: PiecewisePolynomial, orders: tuple[int, ...], slack: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Find the smallest and the largest value of some derivatives for every joint.

    Parameters
    ----------
    curve : PiecewisePolynomial
        Of n joints.
    orders : tuple of int
        k of them: 0 position, 1 velocity, 2 acceleration, 3 jerk.
    slack : ndarray, shape (k, s, n), optional
        By how much the values in each segment may be wrong; they count only as far as they are
        certain.

    Returns
    -------
    low, high : ndarray, shape (k, n)
        Over the whole curve, rad or m over s to the power of the order, exact to a part in 1e11
        of the largest coefficient.
    """
    best = np.full((2, len(orders), curve.joints), -np.inf)
    for first, block in _blocks(curve):
        coefficients = _hulls(block, orders)
        both = np.stack([coefficients, -coefficients])
        if slack is not None:
            both -= slack[:, None, first : first + _BLOCK]
        best = _maxima(both, best)
    return -best[1], best[0]


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
def _to_bernstein(size: int, orders: tuple[int, ...]) -> FloatArray:
    """Build the matrix from powers on [0, 1] to the coefficients of derivatives, of one degree."""
    degree = max(size - 1 - min(orders), 0)
    matrix = np.zeros((len(orders), degree + 1, size))
    for row, order in enumerate(orders):
        for i in range(order, size):
            for k in range(i - order, degree + 1):
                share = math.comb(k, i - order) / math.comb(degree, i - order)
                matrix[row, k, i] = math.perm(i, order) * share
    return matrix


def _hulls(curve: PiecewisePolynomial, orders: tuple[int, ...]) -> FloatArray:
    """Bernstein coefficients of k derivatives, all of the degree of the first of them.

    Of shape (k, d + 1, max(s, 1), n).
    """
    powers = _on_unit_spans(curve)
    size, segments, joints = powers.shape
    flat = _to_bernstein(size, orders).reshape(-1, size) @ powers.reshape(size, -1)
    values: FloatArray = flat.reshape(len(orders), -1, segments, joints)
    if any(orders):
        values *= _rate_scales(curve, orders)[:, None]
    return values


@cache
def _at_end(size: int, orders: tuple[int, ...]) -> FloatArray:
    """Build the matrix from powers on [0, 1] to derivatives at 1."""
    return np.array([[math.perm(i, order) for i in range(size)] for order in orders], float)


def _on_unit_spans(curve: PiecewisePolynomial) -> FloatArray:
    """Give the coefficients in powers of the part of each segment that is over."""
    if not len(curve.spans):
        return curve.coefficients
    powers: FloatArray = curve.coefficients * _powers(curve.spans, len(curve.coefficients) - 1)
    return powers


def _rate_scales(curve: PiecewisePolynomial, orders: tuple[int, ...]) -> FloatArray:
    """Give by what derivatives over parts of segments are multiplied, shape (k, max(s, 1), 1)."""
    spans = curve.spans if len(curve.spans) else np.ones(1)
    scales: FloatArray = 1.0 / _powers(spans, max(orders))[list(orders)]
    return scales


def _powers(values: FloatArray, highest: int) -> FloatArray:
    """Give powers 0 to the highest of values (s,), shape (highest + 1, s, 1)."""
    table = np.empty((highest + 1, len(values), 1))
    table[0] = 1.0
    table[1:, :, 0] = values
    powers: FloatArray = np.multiply.accumulate(table, axis=0, out=table)
    return powers


@cache
def _division(size: int) -> FloatArray:
    """Build the matrix from an interval's coefficients to those of its parts.

    Row ``k * parts + p`` is for coefficient k of part p; see `_divided`.
    """
    degree = size - 1
    matrix = np.empty((size, _PARTS, size))
    for part in range(_PARTS):
        begin, end = part / _PARTS, (part + 1) / _PARTS
        for k in range(size):
            # The polar form, k of whose arguments are the end, the others the beginning.
            for i in range(size):
                matrix[k, part, i] = sum(
                    math.comb(k, a)
                    * math.comb(degree - k, i - a)
                    * end**a
                    * (1.0 - end) ** (k - a)
                    * begin ** (i - a)
                    * (1.0 - begin) ** (degree - k - i + a)
                    for a in range(max(0, i - degree + k), min(i, k) + 1)
                )
    return matrix.reshape(-1, size)


def _divided(pieces: FloatArray) -> FloatArray:
    """Divide m pieces (d + 1, m): the first parts of all, then the second ones, and so on."""
    parts: FloatArray = (_division(len(pieces)) @ pieces).reshape(len(pieces), -1)
    return parts


def _blocks(curve: PiecewisePolynomial) -> Iterator[tuple[int, PiecewisePolynomial]]:
    """Cut a curve into parts that fit into a processor's cache; yield first segment and part."""
    segments = curve.coefficients.shape[1]
    if segments <= _BLOCK:
        yield 0, curve
        return
    for first in range(0, segments, _BLOCK):
        last = min(first + _BLOCK, segments)
        breaks = curve.breaks[first : last + 1]
        yield first, PiecewisePolynomial(breaks, curve.coefficients[:, first:last])


def _maxima(coefficients: FloatArray, known: FloatArray) -> FloatArray:
    """Find the largest values over all segments, or the known ones where they are larger.

    Parameters
    ----------
    coefficients : ndarray, shape (2, k, d + 1, s, n)
        Those of k derivatives, and with the sign changed.
    known : ndarray, shape (2, k, n)
    """
    upper = coefficients.max(axis=2)
    ends = np.maximum(coefficients[:, :, 0], coefficients[:, :, -1])
    best = np.maximum(known, _over_segments(ends))
    scale = np.maximum(_over_segments(upper).max(axis=0), 0.0) * tolerances.PEAK_ACCURACY
    places = np.nonzero(upper > (best + scale)[:, :, None])
    sign, which, segments, joints = places
    owner = np.ravel_multi_index((sign, which, joints), best.shape)
    pieces = coefficients[sign, which, :, segments, joints].T
    flat, threshold = best.ravel(), np.broadcast_to(scale, best.shape).ravel()
    for _ in range(_DIVISIONS):
        if not len(owner):
            return best
        # Each part begins where the one before it ends, and the ends of the pieces are known.
        pieces, owner = _divided(pieces), np.concatenate([owner] * _PARTS)
        np.maximum.at(flat, owner, pieces[0])
        kept = pieces.max(axis=0) > (flat + threshold)[owner]
        pieces, owner = pieces[:, kept], owner[kept]
    np.maximum.at(flat, owner, pieces.max(axis=0))
    return best


def _over_segments(values: FloatArray) -> FloatArray:
    """Largest of the values (..., s, n) of each joint; joint by joint in memory, it is faster."""
    largest: FloatArray = np.ascontiguousarray(values.swapaxes(-1, -2)).max(axis=-1)
    return largest


def _goes_above(pieces: FloatArray, bounds: FloatArray) -> npt.NDArray[np.bool_]:
    """Which of the pieces (d + 1, m) go over their bounds (m,)."""
    above = np.zeros(len(bounds), dtype=bool)
    owner = np.arange(len(bounds))
    for _ in range(_DIVISIONS):
        above[owner[np.maximum(pieces[0], pieces[-1]) > bounds[owner]]] = True
        kept = ~above[owner] & (pieces.max(axis=0) > bounds[owner])
        if not kept.any():
            break
        pieces, owner = _divided(pieces[:, kept]), np.concatenate([owner[kept]] * _PARTS)
    return above
