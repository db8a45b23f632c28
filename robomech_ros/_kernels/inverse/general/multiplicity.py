"""Test whether solutions of a six-joint arm are simple, or folds of exactly two solutions.

At a posture q where the Jacobian J has rank five, with J v = 0 and u J = 0, the pose moves along v
by ``u . J(q + t v) v``, which is zero for t = 0.  If its slope there is not zero, exactly two
solutions have become one, with no other nearby.  The slope is zero along a continuum and where
three or more solutions have become one.
"""

import numpy as np

from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import IIN1, IN2, b1, f8, i8
from robomech_ros._kernels.inverse.general.determinant import null_space
from robomech_ros._kernels.tolerances import GENERAL_CORANK

# Least slope (lengths over the size) at which exactly two solutions have become one: above the
# rounding of zero.
MIN_FOLD_SLOPE = 1e-7
# Step (rad) of the difference quotient.
FOLD_STEP = 1e-4
# Least last pivot but one at a fold, relative to the least last pivot elsewhere.
FOLD_RANK = 0.1


@inline
def _jacobian(packed, size, q, J, pose):
    """Write the Jacobian with lengths over the size, including displacements of slides."""
    jacobian_body(packed, q, J, pose)
    for j in range(6):
        for i in range(3, 6):
            if packed[j, 0] == 0.0:
                J[i, j] /= size


@inline
def _normalised(x):
    square = 0.0
    for j in range(6):
        square += x[j] * x[j]
    inverse = 1.0 / np.sqrt(square)
    for j in range(6):
        x[j] *= inverse


@inline
def _slope(packed, size, q, u, v, J, pose):
    """Return the slope of u . J v along v by central difference."""
    trial = np.empty(6)
    slope = 0.0
    for sign in (-1.0, 1.0):
        for j in range(6):
            unit = 1.0 if packed[j, 0] == 0.0 else size
            trial[j] = q[j] + sign * FOLD_STEP * v[j] * unit
        _jacobian(packed, size, trial, J, pose)
        for i in range(6):
            for j in range(6):
                slope += sign * u[i] * J[i, j] * v[j]
    return 0.5 * slope / FOLD_STEP


@part(b1(IN2, f8, IN2, IIN1, i8, i8, f8, f8))
def all_simple(packed, size, q, marks, mask, count, least, sharp):
    """Return whether each of the first ``count`` solutions q (16, 6) is regular, or a fold.

    A solution is regular if the last pivot of its Jacobian is above ``least`` (of the first), with
    lengths over the size (m).  At a fold the slope is above ``sharp``.  Only solutions with a bit
    of ``mask`` in ``marks`` (16,) are tested; all if it is 0.
    """
    J, K = np.empty((6, 6)), np.empty((6, 6))
    pose = np.empty((4, 4))
    order = np.empty(6, np.int64)
    u, v, w, x = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    for k in range(count):
        if mask != 0 and marks[k] & mask == 0:
            continue
        _jacobian(packed, size, q[k], J, pose)
        for i in range(6):
            for j in range(6):
                K[j, i] = J[i, j]
        _, fifth, last = null_space(J, v, w, x, order)
        if last > least:
            continue
        if not fifth > max(GENERAL_CORANK, FOLD_RANK * least):
            return False
        null_space(K, u, w, x, order)
        _normalised(u)
        _normalised(v)
        if not abs(_slope(packed, size, q[k], u, v, J, pose)) > sharp:
            return False
    return True
