"""Joints 1 to 3 along an arc of a self-motion: those of a spherical shoulder."""

import math

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import flat, inline, lean, scratch
from robomech_ros._kernels.inverse.decoupled import layout as wrist_at
from robomech_ros._kernels.inverse.decoupled.wrist import spherical_wrist
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arc_layout import (
    AXES,
    COSINES,
    EMPTY,
    FAR,
    RATE,
    REACH,
    REGULAR,
    SINES,
    SPREAD,
    TURN,
    TURN_CHANGE,
    TURNED,
    UNKNOWN,
    Q,
)
from robomech_ros._kernels.inverse.redundant.narrowing import is_beyond
from robomech_ros._kernels.inverse.redundant.vectors import about_z, back, cross, dot, norm, turned
from robomech_ros._kernels.tolerances import ACCEPTED, PARALLEL_AXES

__all__ = ["enter_first", "first_axes", "first_joints"]


@flat
def _upper_arm(arm, pose, arc, axes):
    """Write rotation base to upper arm, and axes 4 to 7 in the base, to ``axes`` (3, 7).

    The first three columns are the rotation.
    """
    packed, _ = arm
    for i in range(3):
        # The i-th axis of the base in those of the link before joint 7, and on to the upper arm.
        w = pose[TURNED + i], pose[TURNED + 3 + i], pose[TURNED + 6 + i]
        axes[i, 6] = w[2]
        for j in (6, 5, 4, 3):
            c, s = arc[COSINES + j - 3], arc[SINES + j - 3]
            w = turned(packed, j, about_z(c, s, w))
            axes[i, j - 1] = w[2]
        axes[i, 0], axes[i, 1] = w[0], w[1]
    return 0


@lean
def first_joints(arm, pose, status, h, arc, first):
    """Write joints 1 to 3 of both postures of the shoulder to ``first`` (2, 3).

    Also how the upper arm turns, to ``arc``.  Returns whether there are two postures.
    """
    packed, parts = arm
    axes, turn = scratch(3, 7), scratch(9)
    _upper_arm(arm, pose, arc, axes)
    for i in range(3):
        v = back(packed, 0, (axes[0, i], axes[1, i], axes[2, i]))
        turn[i], turn[3 + i], turn[6 + i] = v
        for j in range(5):
            arc[AXES + 3 * j + i] = axes[i, 2 + j]
    shoulder = parts[at.ARC_WRIST - wrist_at.ANGLES :]
    count, _ = spherical_wrist(shoulder, turn, 0.0, ACCEPTED, PARALLEL_AXES, first)
    d4, d5, d6 = arc[REACH + 3], arc[REACH + 4], arc[REACH + 5]
    if status == REGULAR:
        r4, r5, r6 = arc[RATE + 3], arc[RATE + 4], arc[RATE + 5]
        for i in range(3):
            known = axes[i, 6] + axes[i, 5] * r6 + axes[i, 4] * r5 + axes[i, 3] * r4
            arc[TURN + i] = -known
        change = arc[SPREAD + 3] + arc[SPREAD + 4] + arc[SPREAD + 5]
        arc[TURN_CHANGE] = change + abs(r6) * h + abs(r5) * (h + d6) + abs(r4) * (h + d6 + d5)
    else:
        arc[TURN_CHANGE] = d4 + d5 + d6 + h
    return count == 2


@lean
def enter_first(arm, status, h, first, box, arc):
    """Write joints 1 to 3 to ``arc``, as ``first`` (3,) has them, and what they do within h.

    Returns the status, EMPTY where a joint stays out of the box, or UNKNOWN where the shoulder is
    too nearly singular to tell.
    """
    packed, parts = arm
    for j in range(3):
        arc[Q + j] = wrapped(first[j] - parts[at.ARC_WRIST + j])
    turn = arc[TURN_CHANGE]
    if status == REGULAR:
        turn = h * (0.5 * turn + norm((arc[TURN], arc[TURN + 1], arc[TURN + 2])))
    arc[REACH] = arc[REACH + 1] = arc[REACH + 2] = FAR
    right = parts[at.ARC_RIGHT] == 0.0 and parts[at.ARC_RIGHT + 2] == 0.0
    if right:
        # Joint 2 turns no more than the arm, the others no more than what is seen along their axes.
        across = abs(math.sin(first[1]))
        arc[REACH + 1] = turn
        if turn < across:
            arc[REACH] = arc[REACH + 2] = math.asin(turn / across)
        for j in range(3):
            if is_beyond(j, arc, box):
                return EMPTY
        if status != REGULAR:
            return status
    z1, z2, z3 = first_axes(packed, arc)
    return status if _first_rates(z1, z2, z3, right, status, h, arc) else UNKNOWN


@inline
def first_axes(packed, arc):
    """Give axes 1 to 3 in the base."""
    z1 = packed[0, 3], packed[0, 6], packed[0, 9]
    w = packed[1, 3], packed[1, 6], packed[1, 9]
    z2 = turned(packed, 0, about_z(math.cos(arc[Q]), math.sin(arc[Q]), w))
    return z1, z2, (arc[AXES], arc[AXES + 1], arc[AXES + 2])


@flat
def _first_rates(z1, z2, z3, right, status, h, arc):
    """Write rates of joints 1 to 3 and how far they go; False where that has no bound."""
    turn = arc[TURN], arc[TURN + 1], arc[TURN + 2]
    change = arc[TURN_CHANGE]
    n12, n23, n31 = cross(z1, z2), cross(z2, z3), cross(z3, z1)
    s12, s23 = norm(n12), norm(n23)
    determinant = dot(z1, n23)
    size = abs(determinant)
    if status != REGULAR:
        # The whole turn, taken as a rate that lasts for one.
        room = size * size - 4.0 * change
        if room <= 0.0:
            return False
        d2 = 0.5 * (size - math.sqrt(room))
        arc[REACH + 1] = d2
        arc[REACH] = change * s23 / (size - d2)
        arc[REACH + 2] = change * s12 / (size - d2)
        return True
    if determinant == 0.0:
        return False
    r1 = dot(turn, n23) / determinant
    r2 = dot(turn, n31) / determinant
    r3 = dot(turn, n12) / determinant
    speed = norm(turn)
    d1, d2 = 1.2 * abs(r1) * h, 1.2 * abs(r2) * h
    for _ in range(5):
        room = size - d2
        if room <= 0.3 * size:
            return False
        x1 = (change * s23 + speed * (d1 + d2) * s23 + abs(r1) * d2) / room
        x2 = (change + speed * (speed + 0.5 * change) * h + abs(r2) * d2) / room
        if right:
            # Axis 2 is normal to both others.
            x2 = min(x2, change + speed * d1)
        x3 = (change * s12 + speed * d1 * s12 + abs(r3) * d2) / room
        e1, e2 = (abs(r1) + 0.5 * x1) * h, (abs(r2) + 0.5 * x2) * h
        if e1 <= d1 and e2 <= d2:
            arc[RATE], arc[SPREAD], arc[REACH] = r1, x1, e1
            arc[RATE + 1], arc[SPREAD + 1], arc[REACH + 1] = r2, x2, e2
            arc[RATE + 2], arc[SPREAD + 2], arc[REACH + 2] = r3, x3, (abs(r3) + 0.5 * x3) * h
            return True
        d1, d2 = 1.1 * max(d1, e1), 1.1 * max(d2, e2)
    return False
