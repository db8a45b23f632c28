"""Second derivatives of the joints along an arc of a self-motion, and how much they change.

The equations that give the rates, differentiated once more.  Of each quantity in them it is known
how much it changes within h, so that the same sums and products bound the change of the result.
"""

import math

from robomech_ros._kernels.compiling.jit import flat, inline, lean
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arc_layout import (
    ACROSS,
    AXES,
    BEND,
    BENT,
    COSINE,
    COSINES,
    DU,
    DV,
    DV_ACROSS,
    MOVED,
    RADIUS,
    RATE,
    REACH,
    SHOULDER,
    SINE,
    SINES,
    SPREAD,
    SQUARE,
    TURN,
    TURN_CHANGE,
    UNBENT,
    U,
    V,
)
from robomech_ros._kernels.inverse.redundant.arc_shoulder import first_axes
from robomech_ros._kernels.inverse.redundant.vectors import (
    about_z,
    back,
    cross,
    dot,
    norm,
    turned,
)

__all__ = ["bend_arc"]


@inline
def _spread(a, da, b, db):
    """How much a product changes, of factors of sizes a and b that change by da and db."""
    return da * (abs(b) + db) + abs(a) * db


@inline
def _sum(u, a, v):
    """U + a v."""
    return u[0] + a * v[0], u[1] + a * v[1], u[2] + a * v[2]


@lean
def bend_arc(arm, pose, level, h, fold, arc):
    """Write second derivatives of all joints, and by how much they change within h, to ``arc``."""
    _bend_fourth(arm, pose, level, h, fold, arc)
    _bend_last(arm, pose, level, h, fold, arc)
    _bend_first(arm, h, arc)
    arc[BENT + 6] = arc[UNBENT + 6] = 0.0


@flat
def _bend_fourth(arm, pose, level, h, fold, arc):
    """From the length of v: slope r_4 = v . dv/dt."""
    _, parts = arm
    half = 0.5 * parts[at.ARC_AMPLITUDE]
    slope = fold[U] * fold[DU] + fold[U + 1] * fold[DU + 1] + fold[U + 2] * fold[DU + 2]
    rate, spread, reach = arc[RATE + 3], arc[SPREAD + 3], arc[REACH + 3]
    steeper = -half * math.cos(level[BEND])
    cosine, sine = pose[SQUARE + 1], pose[SQUARE + 2]
    faster = -0.5 * (cosine * level[COSINE] + sine * level[SINE])
    bent = (faster - steeper * rate * rate) / slope
    squares = (2.0 * abs(rate) + spread) * spread
    change = 0.5 * math.sqrt(cosine * cosine + sine * sine) * h
    change += _spread(steeper, half * reach, rate * rate, squares) + abs(bent) * half * reach
    arc[BENT + 3], arc[UNBENT + 3] = bent, change / (abs(slope) - half * reach)


@flat
def _bend_last(arm, pose, level, h, fold, arc):
    """From Rz(q_5) R_5 Rz(q_6) v = u."""
    packed, parts = arm
    r4, r5, r6 = arc[RATE + 3], arc[RATE + 4], arc[RATE + 5]
    s4, s5, s6 = arc[SPREAD + 3], arc[SPREAD + 4], arc[SPREAD + 5]
    d4, d5, d6 = arc[REACH + 3], arc[REACH + 4], arc[REACH + 5]
    bent4, unbent4 = arc[BENT + 3], arc[UNBENT + 3]
    radius, circle = parts[at.ARC_RADIUS], pose[RADIUS]
    m = -pose[SHOULDER], -pose[SHOULDER + 1], 0.0
    a = turned(packed, 6, about_z(level[COSINE], level[SINE], m))
    v = level[V], level[V + 1], level[V + 2]
    e = level[DV], level[DV + 1], level[DV + 2]
    f = fold[DU], fold[DU + 1], fold[DU + 2]
    k = parts[at.ARC_ELBOW], parts[at.ARC_ELBOW + 1], 0.0
    x4 = about_z(arc[COSINES], -arc[SINES], k)
    f2 = back(packed, 4, (-x4[0], -x4[1], 0.0))
    c, s = arc[COSINES + 2], arc[SINES + 2]
    z5 = about_z(c, -s, (packed[5, 7], packed[5, 8], packed[5, 9]))
    c, s = arc[COSINES + 1], arc[SINES + 1]
    z6 = about_z(c, s, (packed[5, 3], packed[5, 6], packed[5, 9]))
    sine = math.sqrt(z5[0] * z5[0] + z5[1] * z5[1])
    determinant = z5[1] * v[0] - z5[0] * v[1]
    change = sine * (level[ACROSS] * d6 + fold[MOVED])
    room = abs(determinant) - change
    # Joint 6: determinant r_6 = r_4 f_z - z_5 . e.
    p, w = z5[1] * e[0] - z5[0] * e[1], z5[0] * v[0] + z5[1] * v[1]
    dp = sine * (circle * h + level[DV_ACROSS] * d6)
    squares4, squares6 = (2.0 * abs(r4) + s4) * s4, (2.0 * abs(r6) + s6) * s6
    bent6 = bent4 * f[2] + r4 * r4 * f2[2] - 2.0 * r6 * p - dot(z5, a) + r6 * r6 * w
    bent6 /= determinant
    unbent6 = _spread(bent4, unbent4, f[2], radius * d4)
    unbent6 += _spread(r4 * r4, squares4, f2[2], radius * d4)
    unbent6 += 2.0 * _spread(r6, s6, p, dp) + circle * (h + d6)
    unbent6 += _spread(r6 * r6, squares6, w, change) + abs(bent6) * change
    arc[BENT + 5], arc[UNBENT + 5] = bent6, unbent6 / room
    # Joint 5: determinant r_5 = e_z - r_4 (z_6 . f).
    off = radius * (d4 + d5)
    along, x, y = dot(z6, f), z6[0] * f[1] - z6[1] * f[0], dot(z6, f2)
    slope = r5 * x + r4 * y
    unsloped = _spread(r5, s5, x, off) + _spread(r4, s4, y, off)
    drop = p - r6 * w
    undropped = dp + _spread(r6, s6, w, change)
    bent5 = (a[2] - bent4 * along - r4 * slope - drop * r5) / determinant
    unbent5 = circle * h + _spread(bent4, unbent4, along, off) + _spread(r4, s4, slope, unsloped)
    unbent5 += _spread(drop, undropped, r5, s5) + abs(bent5) * change
    arc[BENT + 4], arc[UNBENT + 4] = bent5, unbent5 / room


@flat
def _bend_first(arm, h, arc):
    """From the angular velocity of the upper arm, of which the tip stands still."""
    packed, parts = arm
    known = 0.0, 0.0, 0.0
    # Angular velocity of the link behind each axis, by how much it changes, and the axis turns.
    spin = -arc[AXES + 12], -arc[AXES + 13], -arc[AXES + 14]
    unspun, away, change = 0.0, h, 0.0
    for j in (5, 4, 3):
        i = AXES + 3 * (j - 2)
        z = arc[i], arc[i + 1], arc[i + 2]
        rate, spread, bent = arc[RATE + j], arc[SPREAD + j], arc[BENT + j]
        moved = cross(spin, z)
        size = norm(spin)
        known = _sum(_sum(known, -bent, z), -rate, moved)
        change += arc[UNBENT + j] + abs(bent) * away
        change += _spread(rate, spread, size, unspun + size * away)
        spin = _sum(spin, -rate, z)
        unspun += spread + abs(rate) * away
        away += arc[REACH + j]
    z1, z2, z3 = first_axes(packed, arc)
    r1, r2, r3 = arc[RATE], arc[RATE + 1], arc[RATE + 2]
    s1, s2, s3 = arc[SPREAD], arc[SPREAD + 1], arc[SPREAD + 2]
    d1, d2 = arc[REACH], arc[REACH + 1]
    turn = arc[TURN], arc[TURN + 1], arc[TURN + 2]
    speed, faster = norm(turn), arc[TURN_CHANGE]
    turned_by = (speed + 0.5 * faster) * h
    n12, n23, n31 = cross(z1, z2), cross(z2, z3), cross(z3, z1)
    s12, s23 = norm(n12), norm(n23)
    known = _sum(_sum(known, -r1 * r2, n12), -r3, cross(turn, z3))
    change += _spread(r1 * r2, _spread(r1, s1, r2, s2), s12, s12 * d1)
    change += _spread(r3, s3, speed, faster + speed * turned_by)
    size, determinant = norm(known), dot(z1, n23)
    room = abs(determinant) - d2
    b1, b2, b3 = (
        dot(known, n23) / determinant,
        dot(known, n31) / determinant,
        dot(known, n12) / determinant,
    )
    arc[BENT], arc[BENT + 1], arc[BENT + 2] = b1, b2, b3
    arc[UNBENT] = (change * s23 + size * (d1 + d2) * s23 + abs(b1) * d2) / room
    arc[UNBENT + 1] = (change + size * turned_by + abs(b2) * d2) / room
    if parts[at.ARC_RIGHT] == 0.0 and parts[at.ARC_RIGHT + 2] == 0.0:
        arc[UNBENT + 1] = min(arc[UNBENT + 1], change + size * d1)
    arc[UNBENT + 2] = (change * s12 + size * d1 * s12 + abs(b3) * d2) / room
