"""Quality of solutions: errors, distance from the limits, conditioning."""

import math

import numpy as np

from robomech_ros._kernels.algebra.singular_values import (
    condition_of,
    make_rows_orthogonal,
    row_lengths,
)
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT2, ZERO, i8
from robomech_ros._kernels.inverse.polishing import pose_difference

# Rows of the result.
POSITION = 0
ORIENTATION = 1
MARGIN = 2
CONDITION = 3

# First index of the position's components; typed like ZERO.
_LINEAR = np.int64(3)


@inline
def _task_norm(T, weights, e, first):
    """Return the weighted norm of three components of e along the axes of T."""
    squares = 0.0
    for k in range(3):
        value = T[0, k] * e[first] + T[1, k] * e[first + 1] + T[2, k] * e[first + 2]
        squares += weights[first + k] * value * value
    return math.sqrt(squares)


@kernel(i8(IN2, IN2, IN1, IN1, IN1, IN2, OUT2))
def measure(packed, T, weights, lower, upper, q, out):
    """Write the quality of the solutions q (k, n) of the pose T (4, 4) to out (4, k).

    Row POSITION: error (m); ORIENTATION: error (rad); MARGIN: least distance of a joint from a
    limit; CONDITION: condition number of the Jacobian in SI units.  ``weights`` (6,) is 1 for the
    components of the error that count, about and then along the axes of T.
    """
    n = q.shape[1]
    current = np.empty((4, 4))
    e = np.empty(6)
    J = np.empty((6, n))
    wide = n >= 6
    W = np.empty((6, n)) if wide else np.empty((n, 6))
    values = np.empty(W.shape[0])
    for k in range(q.shape[0]):
        jacobian_body(packed, q[k], J, current)
        pose_difference(T, current, e)
        out[ORIENTATION, k] = _task_norm(T, weights, e, ZERO)
        out[POSITION, k] = _task_norm(T, weights, e, _LINEAR)
        margin = math.inf
        for i in range(n):
            margin = min(margin, q[k, i] - lower[i], upper[i] - q[k, i])
            for r in range(6):
                if wide:
                    W[r, i] = J[r, i]
                else:
                    W[i, r] = J[r, i]
        out[MARGIN, k] = margin
        make_rows_orthogonal(W, W.shape[1])
        row_lengths(W, W.shape[1], values)
        out[CONDITION, k] = condition_of(values) if n > 0 else math.inf
    return 0
