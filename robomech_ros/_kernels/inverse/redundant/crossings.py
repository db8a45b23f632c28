"""Crossings of self-motions: near a singular posture branches meet or pass closely.

There the plane of the self-motion and of the weakest other direction contains all branches.
Postures on a circle in that plane, corrected to the pose, are starts on each of them.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_again
from robomech_ros._kernels.compiling.jit import lean, scratch
from robomech_ros._kernels.inverse.ranking import nearest_winding
from robomech_ros._kernels.inverse.redundant.settling import copy, move_onto

# Branches cross, or pass closely, if a parabola through three squared smallest singular values
# (rad or m per rad) has a minimum below the square of this.
CROSSING = 0.02
# Number of postures on the circle, its radius (rad or m), and their largest distance from its
# centre after correction.
AROUND, RADIUS, OFF_CIRCLE = 8, 0.2, 0.4
# Inverse iterations for the weakest direction; each step continues from the last.
_ROUNDS = 2


@lean
def _normalise(v, n):
    """Divide v (n,) by its length; return the length."""
    squares = 0.0
    for i in range(n):
        squares += v[i] * v[i]
    size = math.sqrt(squares)
    for i in range(n):
        v[i] /= size
    return size


@lean
def weakest_direction(space, u, v):
    """Write the unit direction v (7,) of least tip motion; return the size of that motion.

    Self-motions are excluded.  The iteration starts from the tip motion u (6,) and updates it.
    """
    J, _, _, _, A, _ = space
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
    """Return whether three singular values on a self-motion show a crossing at the middle one.

    ``past`` is the step from the first to the second, ``length`` the next step (rad or m).
    """
    if here > before or here > ahead:
        return False
    low, high = before * before - here * here, ahead * ahead - here * here
    bent = (high / length + low / past) / (past + length)
    slope = high / length - bent * length
    least = here * here - (0.25 * slope * slope / bent if bent > 0.0 else 0.0)
    return least < CROSSING * CROSSING


@lean
def enter_crossing(packed, T, request, space, along, weak, centre, queue, queued):
    """Queue postures of the pose around ``centre`` (7,); return the number of queued postures.

    ``along`` (7,) is the direction of the self-motion, ``weak`` (7,) the weakest other one.
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
            q[i] = centre[i] + c * unit[i] + s * weak[i]
            g[i] = weak[i]
        if not move_onto(packed, T, space, g, q):
            continue
        off = 0.0
        for i in range(7):
            off = max(off, abs(q[i] - centre[i]))
        if off < OFF_CIRCLE:
            nearest_winding(turns, lower, upper, seed, False, q, queue[queued])
            queued += 1
    return queued
