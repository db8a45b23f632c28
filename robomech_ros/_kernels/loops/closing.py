"""Loops closed for new positions of the drives, from a posture near by, in the same mode.

Newton's steps move all joints and the platform at once.  By Kantorovich's theorem the first step of
an equation that has one solution near is followed by one of less than a quarter of its size (h at
most 1/2); where it is not, the way of the drives is divided, down to nothing at a singularity.
That is seen in one direction only, so that steps of more than a tenth of a radian are divided, too:
long ones jumped over singularities into other modes.
"""

import numpy as np

from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import IIN1, IN1, IN2, OUT1, f8, i8, inline, kernel
from robomech_ros._kernels.loops.factors import REGULAR, SINGULAR, factors, loop_errors, solve

__all__ = ["close"]

_CONTRACTION = 0.25
# Longest first step of a joint (rad; of the size).
_LONGEST = 0.1
# A step that changes nothing any more, and errors of loops that are closed (rad; of the size).
_SETTLED, _CLOSED = 1e-13, 1e-12
_ITERATIONS, _STEPS = 12, 1000
# Least part of the way, after which a singularity is in it.
_LEAST = 1e-5


@inline
def _newton(packed, starts, drives, scale, weights, trial, rates, J, T, R, Q, A, B, D, qd, t):
    """Move all joints in place by the rates of the drives (m, 1); return a status."""
    before = 0.0
    for turn in range(_ITERATIONS):
        status = factors(packed, starts, drives, trial, scale, J, T, R, Q)
        if status != REGULAR:
            return status
        loop_errors(T, scale, D)
        status = solve(starts, drives, scale, J, R, Q, rates, D, A, B, qd, t)
        if status != REGULAR:
            return status
        size = 0.0
        for j in range(trial.size):
            size = max(size, abs(qd[j, 0]) * weights[j])
        longest = _LONGEST if turn == 0 else max(_SETTLED, _CONTRACTION * before)
        if not size <= longest:
            return SINGULAR
        for j in range(trial.size):
            trial[j] += qd[j, 0]
        rates[:] = 0.0
        if size <= _SETTLED or (turn > 0 and size * size <= 0.01 * _SETTLED * before):
            break
        before = size
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        forward_body(packed[s + i : e + i + 1], trial[s:e], T[i])
    return REGULAR if loop_errors(T, scale, D) <= _CLOSED else SINGULAR


@kernel(i8(IN2, IIN1, IIN1, f8, IN1, IN1, OUT1, OUT1))
def close(packed, starts, drives, scale, weights, target, q, report):
    """Move all joints q (n,) in place until the drives are at their target (m,).

    ``weights`` are 1 for joints that turn and ``scale`` for those that slide.  Written to
    ``report`` (2,): the part of the way that was gone, and the largest error of a loop (rad; of the
    size).  Returns a status; where it is not regular, q is the last posture with closed loops.
    """
    limbs, n = starts.size - 1, 1
    for i in range(limbs):
        n = max(n, starts[i + 1] - starts[i])
    J, T = np.empty((limbs, 6, n)), np.empty((limbs, 4, 4))
    R, Q = np.empty((limbs, 6, n)), np.empty((limbs, 6, 6))
    A, B, D = np.empty((6 * limbs, 6)), np.empty((6 * limbs, 1)), np.empty((limbs, 6, 1))
    qd, t, rates = np.empty((q.size, 1)), np.empty((6, 1)), np.empty((target.size, 1))
    trial = np.empty(q.size)
    left, step, status = 1.0, 1.0, SINGULAR
    for _ in range(_STEPS):
        for j in range(q.size):
            trial[j] = q[j]
            if drives[j] >= 0:
                rates[drives[j], 0] = step * (target[drives[j]] - q[j])
        status = _newton(
            packed, starts, drives, scale, weights, trial, rates, J, T, R, Q, A, B, D, qd, t
        )
        if status == REGULAR:
            for j in range(q.size):
                q[j] = trial[j]
                if step == 1.0 and drives[j] >= 0:
                    q[j] = target[drives[j]]
            left -= step * left
            if step == 1.0:
                break
            # Of what is left, so that the same way again is a greater part of it.
            step = min(1.0, 2.0 * step / (1.0 - step))
        else:
            step *= 0.25
            if step * left < _LEAST:
                break
    report[0] = 1.0 - left
    for i in range(limbs):
        s, e = starts[i], starts[i + 1]
        forward_body(packed[s + i : e + i + 1], q[s:e], T[i])
    report[1] = loop_errors(T, scale, D)
    return SINGULAR if left > 0.0 else REGULAR
