"""Guaranteed bounds of piecewise polynomials, between the samples as well.

On an interval a polynomial lies within the hull of its Bernstein coefficients, and the hull
shrinks onto it quadratically as the interval is divided.  So the pieces whose hull cannot go over
a bound are dropped at once, all pieces together, and the few others are divided until it is clear.

How large extremes and steps are is found by compiled code, for planners; where a bound is exceeded
first is found without, since a controller asks for that, too.

References
----------
R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective", Computer Aided
Geometric Design 29, 2012, sections 3.3 and 3.5.
"""

import math
from functools import cache

import numpy as np

from robomech_ros.trajectory.curves.compiled_sampling import compiled
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array, ArrayLike, BoolArray

# A piece is divided into so many: each time the hull becomes narrower by their square.
_PARTS = 16
# A hull still too wide after these divisions is rounding.
_DIVISIONS = 8


def hull(curve: PiecewisePolynomial, order: int) -> Array:
    """Return Bernstein coefficients (d + 1, max(s, 1), n) of a derivative of s pieces of n joints.

    d is the degree of the derivative of this order, 0 to 3.  The first and last coefficients are
    the values at the ends of the piece; all values in between lie between the smallest and the
    largest.
    """
    powers = _on_unit_spans(curve)
    size, segments, joints = powers.shape
    flat = _to_bernstein(size, order) @ powers.reshape(size, -1)
    coefficients: Array = flat.reshape(-1, segments, joints)
    if order:
        coefficients *= _rate_scales(curve, (order,))
    return coefficients


def steps(curve: PiecewisePolynomial, orders: tuple[int, ...]) -> Array:
    """Find by how much derivatives of k orders step from piece to piece, shape (k, s - 1, n)."""
    powers = _on_unit_spans(curve)
    size, segments, joints = powers.shape
    after = np.zeros((len(orders), max(segments - 1, 0), joints))
    for k, order in enumerate(orders):
        if order < size:
            after[k] = math.factorial(order) * curve.coefficients[order, 1:]
    flat = _at_end(size, orders) @ powers.reshape(size, -1)
    before = flat.reshape(len(orders), segments, joints)[:, :-1]
    return after - before * _rate_scales(curve, orders)[:, :-1]


def extremes(curve: PiecewisePolynomial) -> tuple[Array, Array]:
    """Find the smallest and the largest position and first three rates of each joint, (4, n) each.

    They are exact to a part in 1e11 of the largest coefficient of a piece.
    """
    low, high, _, _ = extremes_and_steps(curve)
    return low, high


def extremes_and_steps(curve: PiecewisePolynomial, slack: Array | None = None) -> Array:
    """Find extremes, largest steps between pieces, and values at the end, of position and rates.

    They are of shape (4, 4, n).  With `slack` (4, max(s, 1), n), by how much values may be wrong,
    they count only as far as they are certain.
    """
    if slack is None:
        slack = np.zeros((4, *curve.coefficients.shape[1:]))
    found = np.empty((4, 4, curve.joints))
    given = map(np.ascontiguousarray, (curve.breaks, curve.coefficients, slack))
    compiled("peaks", "piece_extremes")(*given, *found)
    return found


def first_above(coefficients: Array, bound: ArrayLike) -> tuple[int, int] | None:
    """Find the first piece, and its first joint, that goes over a bound, broadcastable to (s, n).

    The coefficients are those of `hull`.  Returns None where there is none.
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
def _to_bernstein(size: int, order: int) -> Array:
    """Build the matrix from powers on [0, 1] to the coefficients of a derivative."""
    degree = max(size - 1 - order, 0)
    matrix = np.zeros((degree + 1, size))
    for i in range(order, size):
        for k in range(i - order, degree + 1):
            share = math.comb(k, i - order) / math.comb(degree, i - order)
            matrix[k, i] = math.perm(i, order) * share
    return matrix


@cache
def _at_end(size: int, orders: tuple[int, ...]) -> Array:
    """Build the matrix from powers on [0, 1] to derivatives at 1."""
    return np.array([[math.perm(i, order) for i in range(size)] for order in orders], float)


def _on_unit_spans(curve: PiecewisePolynomial) -> Array:
    """Return the coefficients in powers of the part of each segment that is over."""
    if not len(curve.spans):
        return curve.coefficients
    return curve.coefficients * _powers(curve.spans, len(curve.coefficients) - 1)


def _rate_scales(curve: PiecewisePolynomial, orders: tuple[int, ...]) -> Array:
    """Return by what derivatives over parts of segments are multiplied, shape (k, max(s, 1), 1)."""
    spans = curve.spans if len(curve.spans) else np.ones(1)
    return 1.0 / _powers(spans, max(orders))[list(orders)]


def _powers(values: Array, highest: int) -> Array:
    """Return powers 0 to the highest of values (s,), shape (highest + 1, s, 1)."""
    table = np.empty((highest + 1, len(values), 1))
    table[0] = 1.0
    table[1:, :, 0] = values
    return np.multiply.accumulate(table, axis=0, out=table)


@cache
def _division(size: int) -> Array:
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


def _goes_above(pieces: Array, bounds: Array) -> BoolArray:
    """Find the pieces (d + 1, m) that exceed their bounds (m,)."""
    above = np.zeros(len(bounds), dtype=bool)
    owner = np.arange(len(bounds))
    for _ in range(_DIVISIONS):
        above[owner[np.maximum(pieces[0], pieces[-1]) > bounds[owner]]] = True
        kept = ~above[owner] & (pieces.max(axis=0) > bounds[owner])
        if not kept.any():
            break
        pieces = (_division(len(pieces)) @ pieces[:, kept]).reshape(len(pieces), -1)
        owner = np.concatenate([owner[kept]] * _PARTS)
    return above
