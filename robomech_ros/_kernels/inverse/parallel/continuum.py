"""Representatives of a continuum with axis a free, for an arm with three parallel axes."""

import math

from robomech_ros._kernels.compiling.jit import lean, lean_part
from robomech_ros._kernels.compiling.types import F12, IN1, OUT1, OUT2, f8, i8
from robomech_ros._kernels.inverse.branch_bits import SHOULDER_SINGULAR, WRIST_FLIP
from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros._kernels.inverse.parallel.arm import PARALLEL_FREE, lack_of_reach
from robomech_ros._kernels.inverse.parallel.pairs import (
    equations,
    open_component,
    separated,
    write_pair,
)
from robomech_ros._kernels.inverse.parallel.slides import write_sliding_pair

# Scan steps to either side of a free shoulder for the nearest angle in reach.  Narrower ranges are
# found by the minimum between three steps.
CONTINUUM_STEPS = 48


@lean_part(f8(IN1, F12, IN1, f8, i8, OUT1))
def _lack(data, G, seed, qa, wrist, pair):
    """Write the pair of this q_a and wrist; return its distance from a solution."""
    c = math.cos(qa)
    s = math.sin(qa)
    bits = SHOULDER_SINGULAR | wrist * WRIST_FLIP
    if data[at.SLIDING] != at.SLIDE_NONE:
        lack = write_sliding_pair(data, G, seed, c, s, wrist, bits, pair)
        return lack + lack_of_reach(data, G, seed, pair) / data[at.SIZE]
    if data[at.KIND] == at.SKEW:
        k1, c1, s1, k2, c2, s2 = equations(data, G)
        # As for intersecting axes, the first component is known and the sign of the second open;
        # here the second equation holds for one sign.
        factor = data[at.SIN_56]
    else:
        factor, k1, c1, s1, k2, c2, s2 = separated(data, G)
    known = (k1 + c1 * c + s1 * s) / factor
    known, other, lack = open_component(data, G, c, s, known)
    write_pair(data, c, s, known, other if wrist == 1 else -other, bits, pair)
    if data[at.KIND] == at.SKEW:
        pair[3], pair[4] = known, pair[3]
        second = (k2 + c2 * c + s2 * s) * data[at.SIZE] / data[at.NORMAL_56]
        lack += abs(pair[4] - second)
    return lack + lack_of_reach(data, G, seed, pair) / data[at.SIZE]


@lean
def _refined(data, G, seed, wrist, low, high, pair):
    """Return the angle of the smallest lack between two angles, by golden section."""
    ratio = 0.6180339887498949
    x = high - ratio * (high - low)
    y = low + ratio * (high - low)
    fx = _lack(data, G, seed, x, wrist, pair)
    fy = _lack(data, G, seed, y, wrist, pair)
    for _ in range(60):
        if fx < fy:
            high, y, fy = y, x, fx
            x = high - ratio * (high - low)
            fx = _lack(data, G, seed, x, wrist, pair)
        else:
            low, x, fx = x, y, fy
            y = low + ratio * (high - low)
            fy = _lack(data, G, seed, y, wrist, pair)
    return x if fx < fy else y


@lean
def _edge(data, G, seed, wrist, outside, inside, pair):
    """Return the edge of the range in reach, on its inner side, by bisection."""
    for _ in range(50):
        middle = 0.5 * (outside + inside)
        if _lack(data, G, seed, middle, wrist, pair) <= PARALLEL_FREE:
            inside = middle
        else:
            outside = middle
    return inside


@lean
def _nearest(data, G, seed, wrist, pair):
    """Write the pair of the q_a nearest to its seed with a solution; return whether it exists."""
    start = seed[int(data[at.JOINTS])]
    if _lack(data, G, seed, start, wrist, pair) <= PARALLEL_FREE:
        return True
    step = math.pi / CONTINUUM_STEPS
    here = _lack(data, G, seed, start, wrist, pair)
    before_up, last_up, before_down, last_down = math.inf, here, math.inf, here
    for k in range(1, CONTINUUM_STEPS + 2):
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            x = start + sign * k * step
            value = _lack(data, G, seed, x, wrist, pair)
            before, last = (before_up, last_up) if side == 0 else (before_down, last_down)
            found = value <= PARALLEL_FREE
            if found:
                x = _edge(data, G, seed, wrist, x - sign * step, x, pair)
            elif last <= before and last <= value:
                x = (
                    _refined(data, G, seed, wrist, x - 2.0 * step, x, pair)
                    if side == 0
                    else (_refined(data, G, seed, wrist, x, x + 2.0 * step, pair))
                )
                found = _lack(data, G, seed, x, wrist, pair) <= PARALLEL_FREE
            if found:
                _lack(data, G, seed, x, wrist, pair)
                return True
            if side == 0:
                before_up, last_up = last, value
            else:
                before_down, last_down = last, value
    return False


@lean_part(i8(IN1, F12, IN1, OUT2))
def free_pairs(data, G, seed, pairs):
    """Write one pair for each wrist that has a solution; return their number."""
    count = 0
    for wrist in range(2):
        if _nearest(data, G, seed, wrist, pairs[count]):
            count += 1
    return count
