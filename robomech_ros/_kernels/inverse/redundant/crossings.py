"""Crossings of self-motions: near a singular posture one branch leads past others.

There the plane of the self-motion and of the weakest other direction holds all branches.  Postures
on a circle in it, put on the pose, are starts on each of them.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_again
from robomech_ros._kernels.compiling.jit import lean, scratch
from robomech_ros._kernels.inverse.ranking import place
from robomech_ros._kernels.inverse.redundant.settling import copy, put_on

# Branches cross, or pass each other closely, where a parabola through three squared least singular
# values (rad or m per rad) comes down to the square of this.
CROSSING = 0.02
# Number of postures on the circle, its radius (rad or m), and how far off it they may end.
AROUND, RADIUS, OFF_CIRCLE = 8, 0.2, 0.4
# Rounds of inverse iteration for the weakest direction; each step continues from the last.
_ROUNDS = 2


@lean
def _normalise(v, n):
    """Divide v (n,) by its length, and return that."""
    squares = 0.0
    for i in range(n):
        squares += v[i] * v[i]
    size = math.sqrt(squares)
    for i in range(n):
        v[i] /= size
    return size


@lean
def weakest_direction(bench, u, v):
    """Write the unit direction v (7,) of least tip motion, and return the size of that motion.

    The self-motion is left out.  The motion of the tip u (6,) starts from the one passed in.
    """
    J, _, _, _, A, _ = bench
    for _ in range(_ROUNDS):
        cholesky_again(A, u, 6)
        _normalise(u, 6)
    for k in range(7):
        v[k] = 0.0
        for i in range(6):
            v[k] += J[i, k] * u[i]
    return _normalise(v, 7)


@lean
def passes_crossing(before, here, ahead, past, length):
    """Return whether three singular values on a self-motion have a crossing at the middle one.

    The second is ``past`` the first, and the third a ``length`` from it (rad or m).
    """
    if here > before or here > ahead:
        return False
    low, high = before * before - here * here, ahead * ahead - here * here
    bent = (high / length + low / past) / (past + length)
    slope = high / length - bent * length
    least = here * here - (0.25 * slope * slope / bent if bent > 0.0 else 0.0)
    return least < CROSSING * CROSSING


@lean
def enter_crossing(packed, T, request, bench, along, beside, centre, queue, queued):
    """Queue postures around ``centre`` (7,) that have the pose; return how many are queued.

    ``along`` (7,) is the direction of the self-motion, ``beside`` (7,) the weakest other one.
    """
    turns, lower, upper, seed, _, _ = request
    q, g, unit = scratch(7), scratch(7), scratch(7)
    copy(along, unit)
    _normalise(unit, 7)
    for k in range(AROUND):
        if queued == queue.shape[0]:
            break
        angle = 2.0 * math.pi * (k + 0.5) / AROUND
        c, s = RADIUS * math.cos(angle), RADIUS * math.sin(angle)
        for i in range(7):
            q[i] = centre[i] + c * unit[i] + s * beside[i]
            g[i] = beside[i]
        if not put_on(packed, T, bench, g, q):
            continue
        off = 0.0
        for i in range(7):
            off = max(off, abs(q[i] - centre[i]))
        if off < OFF_CIRCLE:
            place(turns, lower, upper, seed, False, q, queue[queued])
            queued += 1
    return queued
