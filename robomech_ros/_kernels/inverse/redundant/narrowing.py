"""What part of an interval of a self-motion's parameter the joints leave of an arc.

The rates of all joints along the arc are known to be within bounds, so that each joint leaves only
the part in which it may be near enough to the seed, and inside its limits.
"""

import math

from robomech_ros._kernels.compiling.jit import flat, lean
from robomech_ros._kernels.inverse.redundant.arc_layout import (
    BENT,
    RATE,
    REACH,
    SPREAD,
    UNBENT,
    Q,
)
from robomech_ros._kernels.tolerances import AT_LIMIT

__all__ = [
    "NEARER_BY",
    "enclose",
    "is_beyond",
    "narrow_bent_squares",
    "narrow_joints",
    "narrow_squares",
    "narrow_to",
    "whole",
]

# What is proved is that no posture is nearer by more than this (rad).
NEARER_BY = 1e-6

_TURN = 2.0 * math.pi


@flat
def _narrow_side(away, rate, bow, side, k):
    """Leave of the interval in side[k : k + 2] where away + rate tau - bow tau^2 may be 0 or less.

    tau counts from 0 on.
    """
    root = rate * rate + 4.0 * bow * away
    if away > 0.0:
        root = math.sqrt(root)
        if rate < 0.0:
            side[k] = max(side[k], 2.0 * away / (root - rate))
        elif bow > 0.0:
            side[k] = max(side[k], (rate + root) / (2.0 * bow))
        else:
            side[k] = math.inf
    elif rate > 0.0 and root > 0.0:
        # Between two values of tau it is beyond, and from the larger one on not surely.
        root = math.sqrt(root)
        if rate + root >= 2.0 * bow * side[k + 1]:
            side[k + 1] = min(side[k + 1], -2.0 * away / (rate + root))


@flat
def _narrow(x, rate, bow, half, sides):
    """Narrow both sides of an interval, that after its middle and that before it."""
    _narrow_side(x - half, rate, bow, sides, 0)
    _narrow_side(-x - half, -rate, bow, sides, 0)
    _narrow_side(x - half, -rate, bow, sides, 2)
    _narrow_side(-x - half, rate, bow, sides, 2)


@flat
def narrow_to(away, rate, bow, sides):
    """Leave of both sides where away + rate tau - bow tau^2 may be 0 or less; False if nothing."""
    _narrow_side(away, rate, bow, sides, 0)
    _narrow_side(away, -rate, bow, sides, 2)
    return _is_left(sides)


@flat
def _is_left(sides):
    return sides[0] <= sides[1] or sides[2] <= sides[3]


@flat
def narrow_joints(first, last, arc, regular, h, box, sides):
    """Narrow the sides by joints first to last - 1; False where nothing is left.

    ``box`` (14,) holds from where to where each joint may be, and h is half the whole interval.
    """
    bow = 0.5 / h if h > 0.0 else 0.0
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
            _narrow(x, arc[RATE + i], bow * arc[SPREAD + i], half, sides)
            if not _is_left(sides):
                return False
    return True


@flat
def is_beyond(i, arc, box):
    """Tell whether a joint stays out of the box for as far as it goes."""
    low, high = box[i], box[7 + i]
    if not high - low < _TURN:
        return False
    x = arc[Q + i] - 0.5 * (low + high)
    x -= _TURN * math.floor(x / _TURN + 0.5)
    return abs(x) > 0.5 * (high - low) + arc[REACH + i]


@flat
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


@flat
def narrow_squares(first, arc, regular, h, seed, distance, box, sides):
    """Narrow the sides to where the root of the sum of squares may be within a distance.

    Only joints from ``first`` on count.  Returns False where nothing is left.
    """
    squares = along = rates = bows = inward = 0.0
    bow = 0.5 / h if h > 0.0 else 0.0
    for i in range(first, 7):
        low, high, reach = box[i], box[7 + i], arc[REACH + i]
        middle = 0.5 * (low + high) if high - low < _TURN else seed[i]
        x = arc[Q + i] - middle
        x -= _TURN * math.floor(x / _TURN + 0.5)
        if regular and abs(x) + reach < math.pi:
            x += middle - seed[i]
            rate, bend = arc[RATE + i], bow * arc[SPREAD + i]
            along += x * rate
            rates += rate * rate
            bows += bend * bend
            inward += (abs(x) + abs(rate) * h) * bend
        else:
            # No winding of it is nearer than this.
            x = arc[Q + i] - seed[i]
            x -= _TURN * math.floor(x / _TURN + 0.5)
            x = max(0.0, abs(x) - reach)
        squares += x * x
    # A joint is off its line by bend tau^2 at most; by all of them it may come nearer by so much.
    inward = min(2.0 * inward, 2.0 * distance * math.sqrt(bows) + bows * h * h)
    constant, square = squares - distance * distance, rates - inward
    _narrow_below(constant, along, square, sides, 0)
    _narrow_below(constant, -along, square, sides, 2)
    return _is_left(sides)


@flat
def narrow_bent_squares(arc, h, seed, distance, box, sides):
    """Do what :func:`narrow_squares` does, of all joints, with their second derivatives."""
    squares = along = square = cube = off = 0.0
    for i in range(7):
        low, high = box[i], box[7 + i]
        middle = 0.5 * (low + high) if high - low < _TURN else seed[i]
        x = arc[Q + i] - middle
        x -= _TURN * math.floor(x / _TURN + 0.5)
        if abs(x) + arc[REACH + i] >= math.pi:
            return True
        x += middle - seed[i]
        rate, bent = arc[RATE + i], arc[BENT + i]
        squares += x * x
        along += x * rate
        square += rate * rate + x * bent
        cube += rate * bent
        off += (abs(x) + h * (abs(rate) + 0.5 * h * abs(bent))) * arc[UNBENT + i]
    constant, square = squares - distance * distance, square - off
    _narrow_below(constant, along, square + min(0.0, cube) * h, sides, 0)
    _narrow_below(constant, -along, square - max(0.0, cube) * h, sides, 2)
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


@flat
def whole(h, sides):
    sides[0] = sides[2] = 0.0
    sides[1] = sides[3] = h
