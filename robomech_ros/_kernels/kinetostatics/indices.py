"""Performance indices of the Jacobian and their gradients, from its singular values.

An index f of the k singular values s has the derivative ``sum df/ds_i u_i v_i^T`` with respect to
the Jacobian, with its singular vectors u and v.  The condition number in the Schatten norm of power
p is ``(sum s^p / k)^(1/p) (sum s^-p / k)^(1/p)``.  For p = 2 it is that in the weighted Frobenius
norm; for large p it tends to the ratio of the largest to the least singular value.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.singular_values import (
    condition_of,
    make_rows_orthogonal,
    row_lengths,
)
from robomech_ros._kernels.chain.jacobian_rates import chain_gradient
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import inline, kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, OUT1, OUT2, f8, i8

# Columns of the results.
MANIPULABILITY = 0
CONDITION = 1
SCHATTEN = 2
LEAST = 3
COUNT = 4

# First of the linear rows.
_LINEAR = 3


@lean
def fill_weighted(J, weights, rows, W):
    """Write weighted rows of J, transposed if there are fewer columns, and a unit matrix."""
    r, n = rows.size, J.shape[1]
    small, large = W.shape[0], W.shape[1] - W.shape[0]
    for i in range(small):
        for k in range(large):
            row, column = (i, k) if r <= n else (k, i)
            W[i, k] = J[rows[row], column] * weights[rows[row]]
        for k in range(small):
            W[i, large + k] = 1.0 if i == k else 0.0


@lean
def _power_means(s, low, high, power):
    """Return the means of (s / s_high)^p and of (s_low / s)^p, both from 1/k to 1."""
    up, down = 0.0, 0.0
    for value in s:
        up += (value / s[high]) ** power
        down += (s[low] / value) ** power
    return up / s.size, down / s.size


@lean
def _extremes(s):
    """Return the indices of the smallest and the largest entry of s."""
    low, high = 0, 0
    for i in range(s.size):
        low = i if s[i] < s[low] else low
        high = i if s[i] > s[high] else high
    return low, high


@lean
def _evaluate(s, power, out):
    """Write the four indices of the singular values s to out."""
    product = 1.0
    for value in s:
        product *= value
    low, high = _extremes(s)
    condition = condition_of(s)
    out[MANIPULABILITY] = product
    out[CONDITION] = condition
    out[LEAST] = s[low]
    out[SCHATTEN] = condition
    if condition < math.inf:
        up, down = _power_means(s, low, high, power)
        out[SCHATTEN] = condition * (up * down) ** (1.0 / power)


@lean
def _derivatives(s, index, f, power, out):
    """Write the derivatives of an index with value f with respect to the singular values s."""
    low, high = _extremes(s)
    up, down = _power_means(s, low, high, power)
    for i in range(s.size):
        if index == MANIPULABILITY:
            out[i] = f / s[i]
        elif index == SCHATTEN:
            rising, falling = (s[i] / s[high]) ** power / up, (s[low] / s[i]) ** power / down
            out[i] = f * (rising - falling) / (s[i] * s.size)
        else:
            out[i] = 0.0
    if index == CONDITION:
        out[high] += 1.0 / s[low]
        out[low] -= f / s[low]
    elif index == LEAST:
        out[low] = 1.0


@lean
def _by_jacobian(J, W, s, ds, weights, rows, G):
    """Write the derivative G (6, n) with respect to J, sum of ds u v^T, from orthogonal rows W.

    Returns the derivative with respect to the logarithm of the divisor of the linear rows.
    """
    r, n = rows.size, G.shape[1]
    small, large = W.shape[0], W.shape[1] - W.shape[0]
    G[:] = 0.0
    for j in range(small):
        factor = ds[j] / s[j] if ds[j] != 0.0 else 0.0
        for row in range(r):
            for column in range(n):
                i, k = (row, column) if r <= n else (column, row)
                value = factor * W[j, large + i] * W[j, k]
                G[rows[row], column] += weights[rows[row]] * value
    stretch = 0.0
    for row in range(_LINEAR, 6):
        for column in range(n):
            stretch -= G[row, column] * J[row, column]
    return stretch


@kernel(i8(IN2, IN2, IN1, IIN1, f8, OUT2))
def indices(packed, q, weights, rows, power, out):
    """Write four indices of some rows of the Jacobian at q (m, n) to out (m, 4).

    ``rows`` (r,) counts from 0; row i of the Jacobian is multiplied by ``weights[i]``.
    """
    n = q.shape[1]
    J, pose = np.empty((6, n)), np.empty((4, 4))
    small, large = min(rows.size, n), max(rows.size, n)
    W, s = np.empty((small, small + large)), np.empty(small)
    status = 0
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], J, pose)
        fill_weighted(J, weights, rows, W)
        make_rows_orthogonal(W, large)
        row_lengths(W, large, s)
        _evaluate(s, power, out[k])
    return status


@inline
def _gradient(packed, q, J, weights, rows, power, index, spaces, value, out):
    """Write the indices of J (6, n) at q to value (4,), and the gradient of one to out (n,).

    Returns the derivative with respect to the logarithm of the divisor of the linear rows.
    ``spaces`` from :func:`_spaces` is working space.
    """
    G, W, s, ds = spaces
    large = W.shape[1] - W.shape[0]
    fill_weighted(J, weights, rows, W)
    make_rows_orthogonal(W, large)
    row_lengths(W, large, s)
    _evaluate(s, power, value)
    _derivatives(s, index, value[index], power, ds)
    stretch = _by_jacobian(J, W, s, ds, weights, rows, G)
    chain_gradient(packed, q, J, G, out)
    return stretch


@inline
def _spaces(n, count):
    """Return working space for :func:`_gradient` of `count` rows: G, W, s and ds."""
    small, large = min(count, n), max(count, n)
    return np.empty((6, n)), np.empty((small, small + large)), np.empty(small), np.empty(small)


@kernel(i8(IN2, IN1, IN1, IIN1, f8, i8, OUT1))
def index_gradient_one(packed, q, weights, rows, power, index, out):
    """Write the gradient of one index at q (n,) to out (n,)."""
    J = np.empty((6, q.size))
    status = jacobian_body(packed, q, J, np.empty((4, 4)))
    spaces = _spaces(q.size, rows.size)
    _gradient(packed, q, J, weights, rows, power, index, spaces, np.empty(COUNT), out)
    return status


@kernel(i8(IN2, IN2, IN1, IIN1, f8, i8, OUT2, OUT2))
def index_gradients(packed, q, weights, rows, power, index, values, out):
    """Write all indices at q (m, n) to values (m, 4), and the gradient of one to out (m, n + 1).

    The last column is the derivative with respect to the logarithm of the length by which
    ``weights`` divide the linear rows.

    The gradient is NaN or infinite if a relevant singular value is zero.
    """
    n = q.shape[1]
    J, pose, spaces = np.empty((6, n)), np.empty((4, 4)), _spaces(n, rows.size)
    status = 0
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], J, pose)
        out[k, n] = _gradient(
            packed, q[k], J, weights, rows, power, index, spaces, values[k], out[k]
        )
    return status
