"""Choice of a posture inside the limits that represents a continuum."""

import math

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import lean

_TURN = 2.0 * math.pi
# Number of turns of joint 4 tried on either side of the seed.
_TURNS = 8


@lean
def settle_wrist(opposed, lower, upper, seed, q):
    """Turn a spherical wrist whose axes 4 and 6 are parallel into the limits of both joints.

    Joint 4 gets the value nearest to the seed for which joint 6, which compensates it, is inside
    its limits; without such a value, q (6,) is unchanged.  If ``opposed``, the axes point in
    opposite directions, and the difference of the two angles is constant instead of the sum.
    """
    if opposed:
        total = q[3] - q[5]
        low, high = total + lower[5], total + upper[5]
    else:
        total = q[3] + q[5]
        low, high = total - upper[5], total - lower[5]
    if not high - low < _TURN:
        return
    nearest = math.floor((seed[3] - 0.5 * (low + high)) / _TURN + 0.5)
    best = math.inf
    value = q[3]
    for k in range(-_TURNS, _TURNS + 1):
        first = max(low + _TURN * (nearest + k), lower[3])
        last = min(high + _TURN * (nearest + k), upper[3])
        candidate = min(max(seed[3], first), last)
        if first <= last and abs(candidate - seed[3]) < best:
            best = abs(candidate - seed[3])
            value = candidate
    if best < math.inf:
        q[3] = wrapped(value)
        q[5] = wrapped(value - total if opposed else total - value)


@lean
def free_value(lower, upper, seed, k, steps):
    """Return the k-th value, k = 1 .. steps, of a joint's range in order of distance from the seed.

    A range without limits counts as one turn; values beyond one end continue from the other.
    """
    low = lower if lower > -math.inf else (upper - _TURN if upper < math.inf else seed - math.pi)
    high = upper if upper < math.inf else low + _TURN
    away = (high - low) * ((k + 1) // 2) / steps
    value = seed + away if k % 2 == 1 else seed - away
    if value > high:
        value -= high - low
    if value < low:
        value += high - low
    return value
