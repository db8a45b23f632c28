"""Report on the Jacobian of a posture: singular values, lost and free directions, factors.

The Jacobian is that of a point of the tip link, with linear rows divided by a length.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.singular_values import (
    condition_of,
    make_rows_orthogonal,
    row_lengths,
)
from robomech_ros._kernels.chain.jacobian_points import move_jacobian
from robomech_ros._kernels.chain.serial import OK, jacobian_body
from robomech_ros._kernels.compiling.jit import inline, kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT2, OUT2, OUT3, OUT4, i8
from robomech_ros._kernels.kinetostatics.indices import fill_weighted
from robomech_ros._kernels.kinetostatics.posture_factors import MOST_FACTORS, named_factors
from robomech_ros._kernels.tolerances import RANK

# A factor of the determinant below this counts as zero in a singular posture.
FACTOR_ZERO = 1e-4

# Indices of numbers: first manipulability and condition number in SI units, and the latter with
# lengths over the length; then the factors, and the self-motion of each joint.
FACTORS = 3
MOVING = FACTORS + MOST_FACTORS


@lean
def _in_order(s, order):
    """Write the indices that sort s in descending order."""
    for i in range(s.size):
        k = i
        while k > 0 and s[order[k - 1]] < s[i]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i


@lean
def _subtract(A, i, B, k):
    """Subtract from row i of A its projection on row k of B, which has norm 1."""
    product = 0.0
    for j in range(A.shape[1]):
        product += A[i, j] * B[k, j]
    for j in range(A.shape[1]):
        A[i, j] -= product * B[k, j]


@lean
def _length(A, i):
    """Return the norm of row i of A."""
    square = 0.0
    for j in range(A.shape[1]):
        square += A[i, j] * A[i, j]
    return math.sqrt(square)


@lean
def _extend(basis, count, candidates, tolerance):
    """Extend the first `count` orthonormal rows of basis by the span of candidates.

    The candidates (k, c) are overwritten.  Returns the new number of rows.
    """
    for i in range(candidates.shape[0]):
        for k in range(count):
            _subtract(candidates, i, basis, k)
    while count < basis.shape[0]:
        longest, best = 0.0, 0
        for i in range(candidates.shape[0]):
            length = _length(candidates, i)
            if length > longest:
                longest, best = length, i
        if not longest > tolerance:
            break
        for j in range(basis.shape[1]):
            basis[count, j] = candidates[best, j] / longest
        for k in range(count):
            # Remove rounding errors.
            _subtract(basis, count, basis, k)
        length = _length(basis, count)
        for j in range(basis.shape[1]):
            basis[count, j] /= length
        for i in range(candidates.shape[0]):
            _subtract(candidates, i, basis, count)
        count += 1
    return count


@inline
def _complete(basis, count):
    """Extend orthonormal rows to a basis of the whole space."""
    if count < basis.shape[0]:
        _extend(basis, count, np.eye(basis.shape[1]), 0.0)


@inline
def _decompose(W, s, left, right, values):
    """Write singular values, and singular vectors of those above zero; return the rank."""
    small, six = W.shape[0], 6
    n = right.shape[0]
    order = np.empty(small, dtype=np.int64)
    _in_order(s, order)
    rank = 0
    for i in range(small):
        row = order[i]
        values[i] = s[row]
        if not s[row] > RANK * values[0]:
            continue
        rank += 1
        # Rows of the rotated matrix, times the singular value, then those of the rotation.
        large = n if n >= six else six
        for k in range(n):
            right[i, k] = W[row, k] / s[row] if n >= six else W[row, large + k]
        for k in range(six):
            left[i, k] = W[row, large + k] if n >= six else W[row, k] / s[row]
    return rank


@inline
def _write_lost(left, rank, motions, weights, lost):
    """Write twists possible in other postures only, of weighted norm 1, to lost (6, 6).

    Returns their number.
    """
    basis = left.copy()
    candidates = motions * weights
    square = 0.0
    for i in range(candidates.shape[0]):
        square += _length(candidates, i) ** 2
    count = _extend(basis, rank, candidates, FACTOR_ZERO * math.sqrt(square)) - rank
    for i in range(count):
        for k in range(6):
            lost[i, k] = basis[rank + i, k] / weights[k]
    return count


@lean
def _moving(free, rank, out):
    """Write the largest move of each joint (n,) in the rows of free (n, n) from `rank` on."""
    for k in range(free.shape[1]):
        out[k] = 0.0
        for i in range(rank, free.shape[0]):
            out[k] = max(out[k], abs(free[i, k]))


@inline
def _product_and_condition(s, order, regular):
    """Return product and condition number of the `regular` largest singular values.

    The others are 0 in every posture, as for a planar arm of four joints.
    """
    _in_order(s, order)
    kept = np.empty(min(s.size, regular))
    product = 1.0
    for i in range(kept.size):
        kept[i] = s[order[i]]
        product *= kept[i]
    return product, condition_of(kept)


@inline
def _report(J, pose, reference, parts, motions, regular, values, numbers, lost, idle, free):
    """Write the report on the Jacobian J (6, n); return rank and number of lost twists."""
    n, length = J.shape[1], reference[3]
    move_jacobian(J, pose, reference[:3])
    small, large = min(6, n), max(6, n)
    s, plain = np.empty(small), np.empty((small, large))
    order = np.empty(small, dtype=np.int64)
    for i in range(small):
        for k in range(large):
            plain[i, k] = J[i, k] if n >= 6 else J[k, i]
    make_rows_orthogonal(plain, large)
    row_lengths(plain, large, s)
    numbers[0], numbers[1] = _product_and_condition(s, order, regular)
    W, weights = np.empty((small, small + large)), np.ones(6)
    weights[3:] = 1.0 / length
    fill_weighted(J, weights, np.arange(6), W)
    make_rows_orthogonal(W, large)
    row_lengths(W, large, s)
    rank = _decompose(W, s, idle, free, values)
    numbers[2] = _product_and_condition(s, order, regular)[1]
    _complete(idle, rank)
    _complete(free, rank)
    count = _write_lost(idle, rank, motions, weights, lost) if rank < regular else 0
    for i in range(rank, 6):
        for k in range(3):
            idle[i, k] *= length
    named_factors(J, parts, reference[4], numbers[FACTORS:MOVING])
    _moving(free, rank, numbers[MOVING:])
    return rank, count


@kernel(i8(IN2, IN2, IN1, IIN1, IN2, i8, OUT2, OUT2, OUT4, OUT3, IOUT2))
def posture_reports(
    packed, q, reference, parts, motions, regular, values, numbers, twists, free, counts
):
    """Write reports on postures q (m, n); return the status.

    ``reference`` (5,) is the point, the length that divides linear rows, and the size for
    :func:`named_factors`, which also has ``parts``.  ``motions`` (r, 6) spans all twists of the
    arm; ``regular`` is its largest rank.  Results of posture k are singular ``values``
    (min(6, n),); ``numbers`` (MOVING + n,); lost twists in the first rows of twists[k, 0] (6, 6);
    from row ``rank`` on, wrenches that load no joint in twists[k, 1] (6, 6), and joint rates that
    do not move the tip in ``free`` (n, n); rank and number of lost twists in ``counts`` (2,).
    """
    n = q.shape[1]
    J, pose = np.empty((6, n)), np.empty((4, 4))
    status = OK
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], J, pose)
        if status != OK:
            return status
        counts[k, 0], counts[k, 1] = _report(
            J, pose, reference, parts, motions, regular,
            values[k], numbers[k], twists[k, 0], twists[k, 1], free[k],
        )  # fmt: skip
    return status
