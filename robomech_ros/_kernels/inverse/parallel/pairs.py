"""The angles of axes a and 5 of an arm with three parallel axes.

The three parallel axes change neither their common direction z nor the height along it.  For the
motion that remains for them, without the other axes, that gives two equations

    sin(alpha) v_1 = d_1(q_a),    a_5 v_2 = d_2(q_a),    v_1^2 + v_2^2 = 1 - gamma(q_a)^2

where (gamma, v_1, v_2) is z in the frame of axis 5 after its turn, and gamma, d_1, d_2 are linear
in the cosine and sine of q_a.  They separate if axes 5 and 6 intersect (a_5 = 0) or are parallel
(alpha = 0); else q_a is a root of a trigonometric polynomial of order two (:mod:`.skew_pairs`).

A pair is a row [cos q_a, sin q_a, gamma, v_1, v_2, g_1, g_2, bits, slide], with (g_1, g_2) the
same components of z before the turn of axis 5, and the displacement (m) of a prismatic axis.
"""

import math

from robomech_ros._kernels.algebra.polynomials import order_one_roots
from robomech_ros._kernels.compiling.jit import lean, lean_part
from robomech_ros._kernels.compiling.types import F12, IN1, OUT2, i8
from robomech_ros._kernels.inverse.branch_bits import BOUNDARY, SHOULDER_RIGHT, WRIST_FLIP
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.spatial.vectors import mixed
from robomech_ros._kernels.tolerances import NEAR_DOUBLE

MAX_PAIRS = 16
PAIR_WIDTH = 9
FREE = -1  # every q_a satisfies its equation


@lean
def equations(data, G):
    """Return (k, C, S) of d_1 and d_2 = k + C cos q_a + S sin q_a, lengths in units of the size."""
    cos56 = data[at.COS_56]
    unit = 1.0 / data[at.SIZE]
    if data[at.ORDER] == at.AXIS_BEFORE:
        sin_a = data[at.SIN_A]
        cos_a = data[at.COS_A]
        k1 = cos_a * G[8] - cos56 * data[at.GAMMA]
        c1 = sin_a * G[2]
        s1 = sin_a * G[5]
        k2 = (cos_a * G[11] + data[at.HEIGHT]) * unit
        c2 = sin_a * G[9] * unit
        s2 = sin_a * G[10] * unit
    else:
        k1 = G[8] - cos56 * data[at.GAMMA]
        c1 = -cos56 * data[at.GAMMA + 1]
        s1 = -cos56 * data[at.GAMMA + 2]
        k2 = (G[11] + data[at.HEIGHT]) * unit
        c2 = data[at.HEIGHT + 1] * unit
        s2 = data[at.HEIGHT + 2] * unit
    return k1, c1, s1, k2, c2, s2


@lean
def z_in_frame_5(data, c, s):
    """Return (gamma, g_1, g_2), the components of z in frame 5 before its turn."""
    return (
        data[at.GAMMA] + data[at.GAMMA + 1] * c + data[at.GAMMA + 2] * s,
        data[at.FIRST] + data[at.FIRST + 1] * c + data[at.FIRST + 2] * s,
        data[at.SECOND] + data[at.SECOND + 1] * c + data[at.SECOND + 2] * s,
    )


@lean
def z_in_frame_6(data, G, c, s):
    """Return z in frame 6 as required by the target, for this q_a."""
    if data[at.ORDER] == at.AXIS_BEFORE:
        axis = data[at.SIN_A] * c, data[at.SIN_A] * s, data[at.COS_A]
        return mixed(axis, G[:3], G[3:6], G[6:9])
    return G[6], G[7], G[8]


@lean
def _other_component(data, G, c, s, known, radius):
    """Return the square of the component of z whose sign the equations leave open."""
    square = (radius - known) * (radius + known)
    if data[at.KIND] == at.INTERSECTING and data[at.ORDER] == at.AXIS_BEFORE:
        # With axis 6 near z the difference above has no digits left; 1 -+ the cosine of their
        # angle, computed from its sine, has all.
        x, y, cosine = z_in_frame_6(data, G, c, s)
        sine2 = x * x + y * y
        cos56 = data[at.COS_56]
        sin56 = data[at.SIN_56]
        turn = cos56 * data[at.GAMMA]
        if cosine > 0.5:
            first = sine2 / (1.0 + cosine) - data[at.DEFECT_SAME]
            square = first * (cosine - turn + sin56 * radius) / (sin56 * sin56)
        elif cosine < -0.5:
            second = sine2 / (1.0 - cosine) - data[at.DEFECT_MIRROR]
            square = second * (turn + sin56 * radius - cosine) / (sin56 * sin56)
    return square


@lean
def separated(data, G):
    """Return both equations if they separate.

    First the factor and (k, C, S) of the equation with q_5, then (k, C, S) of that for q_a alone.
    """
    k1, c1, s1, k2, c2, s2 = equations(data, G)
    if data[at.KIND] == at.INTERSECTING:
        return data[at.SIN_56], k1, c1, s1, k2, c2, s2
    return data[at.NORMAL_56] / data[at.SIZE], k2, c2, s2, k1, c1, s1


@lean
def write_pair(data, c, s, known, other, bits, pair):
    """Write a pair from the known component of z and the open one."""
    gamma, g1, g2 = z_in_frame_5(data, c, s)
    meeting = data[at.KIND] == at.INTERSECTING
    pair[0] = c
    pair[1] = s
    pair[2] = gamma
    pair[3] = known if meeting else other
    pair[4] = other if meeting else known
    pair[5] = g1
    pair[6] = g2
    pair[7] = bits


@lean
def open_component(data, G, c, s, known):
    """Return both components of z perpendicular to axis 5 (open one >= 0) and their lack.

    The lack is the excess of the known component over the length of both.
    """
    _, g1, g2 = z_in_frame_5(data, c, s)
    radius = math.sqrt(g1 * g1 + g2 * g2)
    square = _other_component(data, G, c, s, known, radius)
    if square > 0.0:
        return known, math.sqrt(square), 0.0
    return max(-radius, min(radius, known)), 0.0, max(abs(known) - radius, 0.0)


@lean
def moved_apart(x1, y1, x2, y2, least):
    """Move two angles, given by cosine and sine, apart to at least twice ``least``."""
    half = 0.5 * math.atan2(x1 * y2 - y1 * x2, x1 * x2 + y1 * y2)
    if abs(half) >= least:
        return x1, y1, x2, y2
    c = math.cos(least - abs(half))
    s = math.copysign(math.sin(least - abs(half)), half)
    return c * x1 + s * y1, c * y1 - s * x1, c * x2 - s * y2, c * y2 + s * x2


@lean_part(i8(IN1, F12, OUT2))
def separate_pairs(data, G, pairs):
    """Write all pairs for intersecting or parallel axes 5 and 6; return their number or FREE."""
    factor, k1, c1, s1, k2, c2, s2 = separated(data, G)
    slack = data[at.SLACK]
    root_split = data[at.ROOT_SPLIT]
    found, x1, y1, x2, y2 = order_one_roots(k2, c2, s2, slack)
    if found < 0:
        return FREE
    near = 0
    if found == 1 or abs(x1 - x2) + abs(y1 - y2) < 2.0 * NEAR_DOUBLE:
        near = BOUNDARY
    if found > 0 and root_split > 0.0:
        if found == 1:
            x2, y2 = x1, y1
        found = 2
        x1, y1, x2, y2 = moved_apart(x1, y1, x2, y2, root_split)
    count = 0
    for shoulder in range(found):
        c, s = (x1, y1) if shoulder == 0 else (x2, y2)
        known = (k1 + c1 * c + s1 * s) / factor
        known, other, lack = open_component(data, G, c, s, known)
        if lack > slack:
            continue
        bits = near | (SHOULDER_RIGHT if shoulder == 1 else 0)
        if other < NEAR_DOUBLE:
            bits |= BOUNDARY
        other = max(other, root_split)
        for wrist in range(2 if other > 0.0 else 1):
            value = -other if wrist == 0 else other
            write_pair(data, c, s, known, value, bits | wrist * WRIST_FLIP, pairs[count])
            count += 1
    return count
