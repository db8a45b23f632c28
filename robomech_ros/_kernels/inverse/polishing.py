"""Error of a pose, and final Newton steps that reduce it to rounding, for every family."""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import angle_of
from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.chain.coupling import drive_count
from robomech_ros._kernels.chain.serial import forward_body, jacobian_body
from robomech_ros._kernels.compiling.jit import kernel, lean, linked, scratch
from robomech_ros._kernels.compiling.types import IN2, OUT1, f8, i8

# Error (rad, m) at which polishing stops: about ten roundings of a pose of an arm of metre size.
POLISHED = 1e-14
# Least damping added to J^T J.  Its rounding is about 1e-16, so less would not protect the Cholesky
# factor at a singular posture; at a regular posture 1e-16 costs no digit of a step.
POLISH_DAMPING = 1e-16


@lean
def pose_difference(T, current, e):
    """Write the error of ``current`` (4, 4) against T: rotation vector (rad), position (m).

    The rotation vector turns ``current`` into T about an axis in base coordinates.  Its length is
    the angle, at most half a turn.
    """
    r00 = T[0, 0] * current[0, 0] + T[0, 1] * current[0, 1] + T[0, 2] * current[0, 2]
    r01 = T[0, 0] * current[1, 0] + T[0, 1] * current[1, 1] + T[0, 2] * current[1, 2]
    r02 = T[0, 0] * current[2, 0] + T[0, 1] * current[2, 1] + T[0, 2] * current[2, 2]
    r10 = T[1, 0] * current[0, 0] + T[1, 1] * current[0, 1] + T[1, 2] * current[0, 2]
    r11 = T[1, 0] * current[1, 0] + T[1, 1] * current[1, 1] + T[1, 2] * current[1, 2]
    r12 = T[1, 0] * current[2, 0] + T[1, 1] * current[2, 1] + T[1, 2] * current[2, 2]
    r20 = T[2, 0] * current[0, 0] + T[2, 1] * current[0, 1] + T[2, 2] * current[0, 2]
    r21 = T[2, 0] * current[1, 0] + T[2, 1] * current[1, 1] + T[2, 2] * current[1, 2]
    r22 = T[2, 0] * current[2, 0] + T[2, 1] * current[2, 1] + T[2, 2] * current[2, 2]
    x = 0.5 * (r21 - r12)
    y = 0.5 * (r02 - r20)
    z = 0.5 * (r10 - r01)
    s = math.sqrt(x * x + y * y + z * z)
    c = 0.5 * (r00 + r11 + r22 - 1.0)
    if c > -0.9:
        factor = 1.0 if s < 1e-9 else angle_of(s, c) / s
        e[0], e[1], e[2] = factor * x, factor * y, factor * z
    else:
        # Near half a turn the axis comes from the symmetric part, c 1 + (1 - c) u u^T.
        a00, a11, a22 = r00 - c, r11 - c, r22 - c
        a01, a02, a12 = 0.5 * (r01 + r10), 0.5 * (r02 + r20), 0.5 * (r12 + r21)
        if a00 >= a11 and a00 >= a22:
            u, v, w = a00, a01, a02
        elif a11 >= a22:
            u, v, w = a01, a11, a12
        else:
            u, v, w = a02, a12, a22
        factor = angle_of(s, c) / math.sqrt(u * u + v * v + w * w)
        if u * x + v * y + w * z < 0.0:
            factor = -factor
        e[0], e[1], e[2] = factor * u, factor * v, factor * w
    e[3] = T[0, 3] - current[0, 3]
    e[4] = T[1, 3] - current[1, 3]
    e[5] = T[2, 3] - current[2, 3]


@lean
def largest_error(e):
    """Return the larger of the orientation error (rad) and the position error (m)."""
    angular = math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
    linear = math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
    return max(angular, linear)


@lean
def pose_error(packed, T, q, e):
    """Write the error of the pose at q against T (4, 4) to e (6,), angular part first.

    The norm of e[:3] is the orientation error (rad), that of e[3:] the position error (m).
    """
    current = scratch(4, 4)
    forward_body(packed, q, current)
    pose_difference(T, current, e)


@kernel(f8(IN2, IN2, OUT1, i8))
def polish(packed, T, q, max_iterations):
    """Improve q (n,) in place by damped Newton steps on the pose, never making it worse.

    Any number of joints is allowed, and limits are ignored.  Joints of a continuum move as little
    as possible.  Returns the remaining error, the larger of rad and m.  Compiled once for all
    families, since a step takes much longer than a call.
    """
    n = drive_count(packed)
    J, other_J = np.empty((6, n)), np.empty((6, n))
    A = np.empty((n, n))
    step = np.empty(n)
    trial = np.empty(n)
    current = scratch(4, 4)
    e, other_e = scratch(6), scratch(6)
    jacobian_body(packed, q, J, current)
    pose_difference(T, current, e)
    residual = largest_error(e)
    damping = POLISH_DAMPING
    for _ in range(max_iterations):
        if residual <= POLISHED:
            break
        shift = damping + residual * residual
        for i in range(n):
            value = 0.0
            for k in range(6):
                value += J[k, i] * e[k]
            step[i] = value
            for j in range(i + 1):
                value = 0.0
                for k in range(6):
                    value += J[k, i] * J[k, j]
                A[i, j] = value
            A[i, i] += shift
        if cholesky_solve(A, step, n):
            for i in range(n):
                trial[i] = q[i] + step[i]
            jacobian_body(packed, trial, other_J, current)
            pose_difference(T, current, other_e)
            found = largest_error(other_e)
            if found < residual:
                slow = found > 0.5 * residual
                residual = found
                damping = max(1e-2 * damping, POLISH_DAMPING)
                for i in range(n):
                    q[i] = trial[i]
                if residual <= POLISHED or (slow and residual < 1e3 * POLISHED):
                    break
                J, other_J = other_J, J
                e, other_e = other_e, e
                continue
        if damping > 1e-2 or residual < 1e3 * POLISHED:
            break
        damping *= 1e2
    return residual


call_polish = linked(polish)
