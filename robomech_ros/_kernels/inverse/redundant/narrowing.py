"""What part of an interval of a self-motion's parameter the joints leave of an arc.

The rates of all joints along the arc are known to be within bounds, so that each joint leaves only
the part in which it may be near enough to the seed, and inside its limits.
"""

import math

from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.inverse.redundant.arc_layout import RATE, REACH, SPREAD, Q
from robomech_ros._kernels.tolerances import AT_LIMIT

__all__ = ["enclose", "is_beyond", "narrow_joints", "narrow_squares", "whole"]

_TURN = 2.0 * math.pi


@lean
def _narrow_side(x, slow, fast, low, high, side, k):
    """Leave of the interval in side[k : k + 2] where x + rate tau may be from low to high.

    tau counts from 0 on, rates are from ``slow`` to ``fast``.
    """
    if slow > 0.0:
        side[k + 1] = min(side[k + 1], (high - x) / slow)
    elif x > high:
        side[k] = max(side[k], (x - high) / -slow) if slow < 0.0 else math.inf
    if fast < 0.0:
        side[k + 1] = min(side[k + 1], (x - low) / -fast)
    elif x < low:
        side[k] = max(side[k], (low - x) / fast) if fast > 0.0 else math.inf


@lean
def _narrow(x, rate, spread, low, high, sides):
    """Narrow both sides of an interval, that after its middle and that before it."""
    _narrow_side(x, rate - spread, rate + spread, low, high, sides, 0)
    _narrow_side(x, -rate - spread, -rate + spread, low, high, sides, 2)


@lean
def _is_left(sides):
    return sides[0] <= sides[1] or sides[2] <= sides[3]


@lean
def narrow_joints(first, last, arc, regular, box, sides):
    """Narrow the sides by joints first to last - 1; False where nothing is left.

    ``box`` (14,) holds from where to where each joint may be.
    """
    for i in range(first, last):
        low, high, reach = box[i], box[7 + i], arc[REACH + i]
        if not high - low < _TURN:
            continue
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        if half + reach >= math.pi:
            continue
        x = arc[Q + i] - middle
        x -= _TURN * math.floor(x / _TURN + 0.5)
        if abs(x) > half + reach:
            return False
        if regular:
            _narrow(x, arc[RATE + i], arc[SPREAD + i], -half, half, sides)
            if not _is_left(sides):
                return False
    return True


@lean
def is_beyond(i, arc, box):
    """Tell whether a joint stays out of the box for as far as it goes."""
    low, high = box[i], box[7 + i]
    if not high - low < _TURN:
        return False
    x = arc[Q + i] - 0.5 * (low + high)
    x -= _TURN * math.floor(x / _TURN + 0.5)
    return abs(x) > 0.5 * (high - low) + arc[REACH + i]


@lean
def _narrow_below(constant, slope, square, sides, k):
    """Leave of the interval in sides[k : k + 2] where a polynomial may be 0 or less.

    It is constant + 2 slope tau + square tau^2; tau counts from 0 on.
    """
    root = slope * slope - square * constant
    if square > 0.0:
        if root < 0.0:
            sides[k] = math.inf
            return
        root = math.sqrt(root)
        sides[k] = max(sides[k], (-slope - root) / square)
        sides[k + 1] = min(sides[k + 1], (-slope + root) / square)
    elif constant > 0.0:
        if square < 0.0:
            sides[k] = max(sides[k], (-slope - math.sqrt(root)) / square)
        else:
            sides[k] = max(sides[k], -0.5 * constant / slope) if slope < 0.0 else math.inf


@lean
def narrow_squares(first, arc, regular, seed, distance, box, sides):
    """Narrow the sides to where the root of the sum of squares may be within a distance.

    Only joints from ``first`` on count.  Returns False where nothing is left.
    """
    squares = along = rates = spreads = 0.0
    for i in range(first, 7):
        low, high, reach = box[i], box[7 + i], arc[REACH + i]
        middle = 0.5 * (low + high) if high - low < _TURN else seed[i]
        x = arc[Q + i] - middle
        x -= _TURN * math.floor(x / _TURN + 0.5)
        if regular and abs(x) + reach < math.pi:
            x += middle - seed[i]
            rate, spread = arc[RATE + i], arc[SPREAD + i]
            along += x * rate
            rates += rate * rate
            spreads += spread * spread
        else:
            # No winding of it is nearer than this.
            x = arc[Q + i] - seed[i]
            x -= _TURN * math.floor(x / _TURN + 0.5)
            x = max(0.0, abs(x) - reach)
        squares += x * x
    constant, square = squares - distance * distance, rates - spreads
    back = distance * math.sqrt(spreads)
    _narrow_below(constant, along - back, square, sides, 0)
    _narrow_below(constant, -along - back, square, sides, 2)
    return _is_left(sides)


@lean
def enclose(request, distance, box):
    """Write where each joint must be in a posture within a distance of the seed."""
    _, lower, upper, seed, _, bounded = request
    for i in range(7):
        low, high = seed[i] - distance, seed[i] + distance
        if bounded:
            low, high = max(low, lower[i] - AT_LIMIT), min(high, upper[i] + AT_LIMIT)
        if low > high:
            return False
        box[i], box[7 + i] = low, high
    return True


@lean
def whole(h, sides):
    sides[0] = sides[2] = 0.0
    sides[1] = sides[3] = h
