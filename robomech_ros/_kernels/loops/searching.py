"""Search for closed loops from distant postures by limited Newton steps with fixed drives."""

import numpy as np

from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT1, OUT2, f8, i8
from robomech_ros._kernels.loops.factors import (
    REGULAR,
    Chains,
    factors,
    loop_errors,
    room_for_factors,
    solve,
)

# Largest step of a joint (rad; of the size), and number of steps.
_LARGEST, _ITERATIONS = 0.6, 60
# A negligible step, and loop errors of a closed posture (rad; of the size).
_SETTLED, _CLOSED = 1e-12, 1e-10


@kernel(i8(IN2, IIN1, IIN1, f8, IN1, OUT2, IOUT1))
def search(packed, starts, drives, scale, weights, q, closed):
    """Move passive joints of postures q (k, n) in place until the loops are closed.

    ``closed`` (k,) receives 1 for closed loops, also if an angle is wrong by half a turn, else 0.
    Returns the number of closed postures.
    """
    limbs, m = starts.size - 1, 0
    for j in range(drives.size):
        m = max(m, drives[j] + 1)
    chains, found = Chains(packed, starts, drives, scale), room_for_factors(starts, 1)
    T, D = found.T, np.empty((limbs, 6, 1))
    qd, t, rates = np.empty((drives.size, 1)), np.empty((6, 1)), np.zeros((m, 1))
    count = 0
    for k in range(q.shape[0]):
        closed[k] = 0
        for _ in range(_ITERATIONS):
            if factors(chains, q[k], found) != REGULAR:
                break
            loop_errors(T, scale, D)
            if solve(chains, found, rates, D, qd, t) != REGULAR:
                break
            size = 0.0
            for j in range(drives.size):
                size = max(size, abs(qd[j, 0]) * weights[j])
            part = _LARGEST / size if size > _LARGEST else 1.0
            for j in range(drives.size):
                if drives[j] < 0:
                    q[k, j] += part * qd[j, 0]
            if size <= _SETTLED:
                closed[k] = 1
                break
        if closed[k] == 1:
            for i in range(limbs):
                s, e = starts[i], starts[i + 1]
                forward_body(packed[s + i : e + i + 1], q[k, s:e], T[i])
            closed[k] = 1 if loop_errors(T, scale, D) <= _CLOSED else 0
            count += closed[k]
    return count
