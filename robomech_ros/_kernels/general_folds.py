"""Which solutions of a six-joint arm are simple, or two that have become one at a fold.

At a posture q where the Jacobian J has lost one rank, with J v = 0 and u J = 0, the pose goes on
along v as ``u . J(q + t v) v``, which is zero for t = 0.  If its slope there is not zero, two
solutions have become one and no more, and none is beside it.  Along a continuum the slope is zero,
as it is where three solutions or more have become one.
"""

import numpy as np

from robomech_ros._kernels import general_layout as at
from robomech_ros._kernels._jit import IN1, IN2, b1, f8, i8, inline, part
from robomech_ros._kernels.general_determinant import null_space
from robomech_ros._kernels.serial import jacobian_body
from robomech_ros._kernels.tolerances import FOLD_SHARP, FOLD_STEP, GENERAL_CORANK

__all__ = ["all_simple"]


@inline
def _jacobian(data, packed, q, J, pose):
    """Write the Jacobian with lengths over the size, those that slides move too."""
    jacobian_body(packed, q, J, pose)
    for j in range(6):
        for i in range(3, 6):
            if packed[j, 0] == 0.0:
                J[i, j] /= data[at.SIZE]


@inline
def _normalised(x):
    square = 0.0
    for j in range(6):
        square += x[j] * x[j]
    inverse = 1.0 / np.sqrt(square)
    for j in range(6):
        x[j] *= inverse


@inline
def _slope(data, packed, q, u, v, J, pose):
    """Give the slope of u . J v along v by central difference."""
    trial = np.empty(6)
    slope = 0.0
    for sign in (-1.0, 1.0):
        for j in range(6):
            unit = 1.0 if packed[j, 0] == 0.0 else data[at.SIZE]
            trial[j] = q[j] + sign * FOLD_STEP * v[j] * unit
        _jacobian(data, packed, trial, J, pose)
        for i in range(6):
            for j in range(6):
                slope += sign * u[i] * J[i, j] * v[j]
    return 0.5 * slope / FOLD_STEP


@part(b1(IN1, IN2, i8, f8))
def all_simple(data, q, count, least):
    """Tell whether each of the first solutions q (16, 6) is regular, or a fold.

    Regular are those whose Jacobian's last pivot is above ``least`` (of the first).
    """
    packed = data[at.PACKED : at.HEAD].reshape(7, 13)
    J, K = np.empty((6, 6)), np.empty((6, 6))
    pose = np.empty((4, 4))
    order = np.empty(6, np.int64)
    u, v, w, x = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    for k in range(count):
        _jacobian(data, packed, q[k], J, pose)
        for i in range(6):
            for j in range(6):
                K[j, i] = J[i, j]
        _, fifth, last = null_space(J, v, w, x, order)
        if last > least:
            continue
        if not fifth > GENERAL_CORANK:
            return False
        null_space(K, u, w, x, order)
        _normalised(u)
        _normalised(v)
        if not abs(_slope(data, packed, q[k], u, v, J, pose)) > FOLD_SHARP:
            return False
    return True
