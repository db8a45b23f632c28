"""Pairs of an arm with three parallel axes and one prismatic joint among the other axes.

The direction z alone determines the two angles, and the height, linear in the displacement,
determines the displacement.  Equations and rows are those of :mod:`.pairs`.
"""

import math

from robomech_ros._kernels.algebra.polynomials import order_one_roots
from robomech_ros._kernels.compiling.jit import lean, lean_part
from robomech_ros._kernels.compiling.types import F12, IN1, OUT2, i8
from robomech_ros._kernels.inverse.branch_bits import BOUNDARY, WRIST_SINGULAR
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.inverse.parallel.arm import (
    PARALLEL_FREE,
    in_frame_f,
    lack_of_reach,
    wrist_turns,
)
from robomech_ros._kernels.inverse.parallel.pairs import FREE, equations, z_in_frame_5, z_in_frame_6
from robomech_ros._kernels.tolerances import NEAR_DOUBLE

# Scan steps per length of the arm for a free slide if a rotation is also free.
SLIDE_STEPS = 32


@lean
def _search_slide(data, G, seed, start, pair):
    """Step away from a displacement until the pair is in reach; return the distance left (m).

    Axis 5 is free as well, so every displacement has its own nearest angle.
    """
    step = data[at.SIZE] / SLIDE_STEPS
    for k in range(2 * SLIDE_STEPS):
        for side in range(2):
            inside = start + (k * step if side == 0 else -k * step)
            pair[8] = inside
            if lack_of_reach(data, G, seed, pair) > 0.0:
                continue
            outside = inside - (step if side == 0 else -step)
            for _ in range(50 if k > 0 else 0):
                pair[8] = 0.5 * (outside + inside)
                if lack_of_reach(data, G, seed, pair) > 0.0:
                    outside = pair[8]
                else:
                    inside = pair[8]
            pair[8] = inside
            return 0.0
    return data[at.SIZE]


@lean
def _slide_in_reach(data, G, seed, pair):
    """Set a displacement that the height leaves free to the nearest one in reach.

    Returns the distance (m) of the planar arm from its target.
    """
    joint = at.JOINTS
    if data[at.SLIDING] == at.SLIDE_5:
        joint = at.JOINTS + 4
    elif data[at.SLIDING] == at.SLIDE_6:
        joint = at.JOINTS + 5
    start = seed[int(data[joint])]
    pair[8] = start + 1.0
    _, turns, _ = wrist_turns(data, G, seed, pair)
    ux, uy, _ = in_frame_f(data, G, at.POINT, 1.0, turns)
    pair[8] = start
    bits, turns, _ = wrist_turns(data, G, seed, pair)
    x, y, _ = in_frame_f(data, G, at.POINT, 1.0, turns)
    ux -= x
    uy -= y
    here = math.sqrt(x * x + y * y)
    most = data[at.LINK_1] + data[at.LINK_2]
    least = abs(data[at.LINK_1] - data[at.LINK_2])
    if bits >= 0 and least <= here <= most:
        return 0.0
    bound = most if here > most else least
    square = ux * ux + uy * uy
    if square < PARALLEL_FREE:
        return abs(here - bound)
    along = -(x * ux + y * uy) / square
    if bits < 0:
        far = abs(along) > 2.0 * data[at.SIZE]
        return _search_slide(data, G, seed, start + along if far else start, pair)
    nearest = abs(x * uy - y * ux) / math.sqrt(square)
    if nearest >= bound:
        pair[8] = start + along
        return nearest - bound
    half = math.sqrt((bound - nearest) * (bound + nearest) / square)
    low = along - half
    high = along + half
    pair[8] = start + (low if abs(low) <= abs(high) else high)
    return 0.0


@lean
def _enter_slide(data, G, seed, v1, v2, c, s, bits, pair):
    """Write a pair with the displacement for the required height.

    Returns the distance of the pair from a solution (units of the size).
    """
    gamma, g1, g2 = z_in_frame_5(data, c, s)
    _, _, _, k2, c2, s2 = equations(data, G)
    height = k2 + c2 * c + s2 * s - v2 * data[at.NORMAL_56] / data[at.SIZE]
    factor = data[at.COS_A]
    if data[at.SLIDING] == at.SLIDE_5:
        factor = gamma
    elif data[at.SLIDING] == at.SLIDE_6:
        factor = data[at.COS_56] * gamma + data[at.SIN_56] * v1
    pair[0] = c
    pair[1] = s
    pair[2] = gamma
    pair[3] = v1
    pair[4] = v2
    pair[5] = g1
    pair[6] = g2
    pair[7] = bits
    if abs(factor) > PARALLEL_FREE:
        pair[8] = height * data[at.SIZE] / factor
        return 0.0
    if abs(height) > data[at.SLACK]:
        return abs(height)
    pair[7] = (bits & ~BOUNDARY) | WRIST_SINGULAR
    return _slide_in_reach(data, G, seed, pair) / data[at.SIZE]


@lean
def sliding_equation(data, G):
    """Return (k, C, S) of the equation for q_a if axis 5 or 6 is prismatic."""
    sin56 = data[at.SIN_56]
    cos56 = data[at.COS_56]
    if data[at.SLIDING] == at.SLIDE_5:
        k, c, s, _, _, _ = equations(data, G)
        return (
            k - sin56 * data[at.FIRST],
            c - sin56 * data[at.FIRST + 1],
            s - sin56 * data[at.FIRST + 2],
        )
    # Component of z along axis 5 required by the target.
    _, y0, z0 = z_in_frame_6(data, G, 0.0, 0.0)
    _, yc, zc = z_in_frame_6(data, G, 1.0, 0.0)
    _, ys, zs = z_in_frame_6(data, G, 0.0, 1.0)
    k = sin56 * y0 + cos56 * z0
    return (
        data[at.GAMMA] - k,
        data[at.GAMMA + 1] - (sin56 * yc + cos56 * zc - k),
        data[at.GAMMA + 2] - (sin56 * ys + cos56 * zs - k),
    )


@lean
def write_sliding_pair(data, G, seed, c, s, wrist, bits, pair):
    """Write the pair of this q_a (and wrist, if axis a is prismatic); return its lack."""
    gamma, g1, g2 = z_in_frame_5(data, c, s)
    if data[at.SLIDING] == at.SLIDE_5:
        return _enter_slide(data, G, seed, g1, g2, c, s, bits, pair)
    if data[at.SLIDING] == at.SLIDE_6:
        v2, y, z = z_in_frame_6(data, G, c, s)
        v1 = data[at.SIN_56] * z - data[at.COS_56] * y
        return _enter_slide(data, G, seed, v1, v2, c, s, bits, pair)
    _, _, cosine = z_in_frame_6(data, G, c, s)
    known = (cosine - data[at.COS_56] * gamma) / data[at.SIN_56]
    radius = math.sqrt(g1 * g1 + g2 * g2)
    square = (radius - known) * (radius + known)
    lack = max(abs(known) - radius, 0.0)
    other = 0.0
    if square > 0.0:
        other = math.sqrt(square)
    else:
        known = max(-radius, min(radius, known))
    if other < NEAR_DOUBLE:
        bits |= BOUNDARY
    v2 = other if wrist == 1 else -other
    return lack + _enter_slide(data, G, seed, known, v2, c, s, bits, pair)


@lean_part(i8(IN1, F12, IN1, OUT2))
def sliding_pairs(data, G, seed, pairs):
    """Write all pairs of an arm with a prismatic joint; return their number or FREE."""
    if data[at.SLIDING] == at.SLIDE_A:
        found, x1, y1, x2, y2 = 2, 1.0, 0.0, 1.0, 0.0
        double = 0
    else:
        k, c, s = sliding_equation(data, G)
        found, x1, y1, x2, y2 = order_one_roots(k, c, s, data[at.SLACK])
        if found < 0:
            return FREE
        near = abs(x1 - x2) + abs(y1 - y2) < 2.0 * NEAR_DOUBLE
        double = BOUNDARY if found == 1 or near else 0
    count = 0
    for k in range(found):
        c, s = (x1, y1) if k == 0 else (x2, y2)
        lack = write_sliding_pair(data, G, seed, c, s, k, double, pairs[count])
        if lack <= data[at.SLACK]:
            count += 1
    return count
