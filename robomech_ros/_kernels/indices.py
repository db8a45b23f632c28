"""Performance indices of the Jacobian and their gradients, from its singular values.

An index f of the singular values s has the derivative ``sum df/ds_i u_i v_i^T`` by the Jacobian,
with its singular vectors u and v.
"""

import math

import numpy as np

from robomech_ros._kernels._jit import IIN1, IN1, IN2, OUT2, i8, kernel, lean
from robomech_ros._kernels.jacobian_rates import gradient_body
from robomech_ros._kernels.serial import jacobian_body
from robomech_ros._kernels.singular_values import condition_of, make_rows_orthogonal, row_lengths

__all__ = [
    "CONDITION",
    "COUNT",
    "FROBENIUS",
    "LEAST",
    "MANIPULABILITY",
    "index_gradients",
    "indices",
]

# Columns of the answer.
MANIPULABILITY = 0
CONDITION = 1
FROBENIUS = 2
LEAST = 3
COUNT = 4


@lean
def _fill(J, weights, rows, W):
    """Write these weighted rows of J, or its columns where they are fewer, and a unit."""
    r, n = rows.size, J.shape[1]
    small, large = W.shape[0], W.shape[1] - W.shape[0]
    for i in range(small):
        for k in range(large):
            row, column = (i, k) if r <= n else (k, i)
            W[i, k] = J[rows[row], column] * weights[rows[row]]
        for k in range(small):
            W[i, large + k] = 1.0 if i == k else 0.0


@lean
def _evaluate(s, out):
    """Write the four indices of the singular values s to out."""
    product, squares, inverses, least = 1.0, 0.0, 0.0, math.inf
    for value in s:
        product *= value
        squares += value * value
        inverses += 1.0 / (value * value)
        least = min(least, value)
    condition = condition_of(s)
    out[MANIPULABILITY] = product
    out[CONDITION] = condition
    singular = condition == math.inf
    out[FROBENIUS] = math.inf if singular else math.sqrt(squares * inverses) / s.size
    out[LEAST] = least


@lean
def _derivatives(s, index, f, out):
    """Write the derivatives of an index, of value f, by the singular values s to out."""
    k = s.size
    low, high = 0, 0
    squares, inverses = 0.0, 0.0
    for i in range(k):
        low = i if s[i] < s[low] else low
        high = i if s[i] > s[high] else high
        squares += s[i] * s[i]
        inverses += 1.0 / (s[i] * s[i])
    for i in range(k):
        if index == MANIPULABILITY:
            out[i] = f / s[i]
        elif index == FROBENIUS:
            out[i] = (s[i] * inverses - squares / (s[i] * s[i] * s[i])) / (f * k * k)
        else:
            out[i] = 0.0
    if index == CONDITION:
        out[high] += 1.0 / s[low]
        out[low] -= f / s[low]
    elif index == LEAST:
        out[low] = 1.0


@lean
def _by_jacobian(W, s, ds, weights, rows, G):
    """Write the derivative by J, sum of ds u v^T, from the orthogonal rows W to G (6, n)."""
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


@kernel(i8(IN2, IN2, IN1, IIN1, OUT2))
def indices(packed, q, weights, rows, out):
    """Four indices of some rows of the Jacobian at q (m, n) into out (m, 4).

    ``rows`` (r,) counts from 0; row i of the Jacobian is multiplied by ``weights[i]``.
    """
    n = q.shape[1]
    J, pose = np.empty((6, n)), np.empty((4, 4))
    small, large = min(rows.size, n), max(rows.size, n)
    W, s = np.empty((small, small + large)), np.empty(small)
    status = 0
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], J, pose)
        _fill(J, weights, rows, W)
        make_rows_orthogonal(W, large)
        row_lengths(W, large, s)
        _evaluate(s, out[k])
    return status


@kernel(i8(IN2, IN2, IN1, IIN1, i8, OUT2, OUT2))
def index_gradients(packed, q, weights, rows, index, values, out):
    """One index at q (m, n), its value in values (m, 4) and its gradient in out (m, n).

    The gradient is NaN or infinite where a singular value that counts is zero.
    """
    n = q.shape[1]
    J, pose, G = np.empty((6, n)), np.empty((4, 4)), np.empty((6, n))
    small, large = min(rows.size, n), max(rows.size, n)
    W, s, ds = np.empty((small, small + large)), np.empty(small), np.empty(small)
    status = 0
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], J, pose)
        _fill(J, weights, rows, W)
        make_rows_orthogonal(W, large)
        row_lengths(W, large, s)
        _evaluate(s, values[k])
        _derivatives(s, index, values[k, index], ds)
        _by_jacobian(W, s, ds, weights, rows, G)
        gradient_body(J, G, out[k])
    return status
