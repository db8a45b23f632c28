"""Rates and accelerations of all joints for those of the drives."""

import numpy as np

from robomech_ros._kernels.chain.jacobian_rates import rate_body
from robomech_ros._kernels.chain.serial import OK, forward_body
from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import IIN1, IN2, IN3, OUT3, OUT4, f8, i8
from robomech_ros._kernels.loops.factors import (
    NOT_FINITE,
    REGULAR,
    Chains,
    factors,
    room_for_factors,
    solve,
    widest,
)


@kernel(i8(IN2, IIN1, IN2, OUT4))
def limb_poses(packed, starts, q, poses):
    """Write the pose of the end of each limb (b, limbs, 4, 4) for q (b, n)."""
    for b in range(q.shape[0]):
        for i in range(starts.size - 1):
            s, e = starts[i], starts[i + 1]
            if forward_body(packed[s + i : e + i + 1], q[b, s:e], poses[b, i]) != OK:
                return NOT_FINITE
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN3, OUT3, OUT3))
def rates(packed, starts, drives, scale, q, given, out, twists):
    """Write rates of all joints (b, n, c) and twists (b, 6, c) for rates of the drives (b, m, c).

    Returns a status; if it is not regular, rows from the first failure on are undefined.
    """
    width = given.shape[2]
    chains, found = Chains(packed, starts, drives, scale), room_for_factors(starts, width)
    D = np.empty((starts.size - 1, 6, width))
    for b in range(q.shape[0]):
        status = factors(chains, q[b], found)
        if status == REGULAR:
            D[:] = 0.0
            status = solve(chains, found, given[b], D, out[b], twists[b])
        if status != REGULAR:
            return status
    return REGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN2, IN2, IN3, OUT3, OUT3))
def accelerations(packed, starts, drives, scale, q, qd, given, out, twists):
    """Write accelerations of all joints (b, n, 1) and of the platform (b, 6, 1).

    ``qd`` (b, n) are the rates of all joints, and ``given`` (b, m, 1) the accelerations of the
    drives.  Returns a status as for :func:`rates`.
    """
    limbs, n = starts.size - 1, widest(starts)
    chains, found = Chains(packed, starts, drives, scale), room_for_factors(starts, 1)
    J, D = found.J, np.empty((limbs, 6, 1))
    changes, own = np.empty((6, n)), np.empty(n)
    for b in range(q.shape[0]):
        status = factors(chains, q[b], found)
        if status == REGULAR:
            for i in range(limbs):
                s, e = starts[i], starts[i + 1]
                for j in range(n):
                    own[j] = qd[b, s + j] if j < e - s else 0.0
                    # A limb with fewer joints does not use the last columns.
                    for r in range(6):
                        J[i, r, j] = J[i, r, j] if j < e - s else 0.0
                rate_body(J[i], own, changes)
                for r in range(6):
                    D[i, r, 0] = 0.0
                    for j in range(e - s):
                        D[i, r, 0] += changes[r, j] * qd[b, s + j]
                for r in range(3, 6):
                    D[i, r, 0] /= scale
            status = solve(chains, found, given[b], D, out[b], twists[b])
        if status != REGULAR:
            return status
    return REGULAR
