"""Extremes of piecewise polynomials and of their derivatives, between the ends of pieces as well.

On an interval a polynomial lies within the hull of its Bernstein coefficients, and the hull
shrinks onto it quadratically as the interval is halved.  So the pieces whose hull cannot hold an
extreme are passed over, and the few others are halved until the hull is as narrow as wanted.

References
----------
R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective", Computer Aided
Geometric Design 29, 2012, sections 3.3 and 3.5.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.bernstein import to_bernstein
from robomech_ros._kernels.compiling.jit import inline, kernel, lean
from robomech_ros._kernels.compiling.types import IN1, IN2, IN3, OUT2, b1, f8, i8

# Peaks between samples are located to this part of the largest Bernstein coefficient.
PEAK_ACCURACY = 1e-11

# Most halvings: each narrows the hull four times, far below any tolerance.
_HALVINGS = 24
# Most intervals in one piece; a polynomial with three extremes needs a hundred.
_MOST = 2000
# Derivative d of x^(i + d) is _FACTORS[d, i] x^i.
_FACTORS = np.array([[float(math.perm(i + d, d)) for i in range(10)] for d in range(4)])


@inline
def _highest(control, degree, floor, accuracy, stack):
    """Find the largest value on [0, 1] from Bernstein coefficients to an accuracy, or the floor."""
    for i in range(degree + 1):
        stack[0, i] = control[i]
    stack[0, degree + 1] = 0.0
    count = 1
    for step in range(_MOST):
        if count == 0:
            break
        count -= 1
        floor = max(floor, stack[count, 0], stack[count, degree])
        largest = stack[count, 0]
        for i in range(1, degree + 1):
            largest = max(largest, stack[count, i])
        if not largest > floor + accuracy:
            continue
        depth = stack[count, degree + 1]
        if depth >= _HALVINGS or step == _MOST - 1:
            floor = largest
            continue
        # De Casteljau: the left half replaces the whole, the right half goes on top of it.
        for i in range(degree + 1):
            control[i] = stack[count, i]
        for i in range(degree + 1):
            stack[count, i] = control[0]
            stack[count + 1, degree - i] = control[degree - i]
            for k in range(degree - i):
                control[k] = 0.5 * (control[k] + control[k + 1])
        stack[count, degree + 1] = depth + 1.0
        stack[count + 1, degree + 1] = depth + 1.0
        count += 2
    return floor


@inline
def _derivative(coefficients, k, j, order, span, scale, control):
    """Write a derivative of joint j in piece k, times a scale, in powers on [0, 1].

    Returns the sum of the magnitudes, which no value exceeds.
    """
    power, largest = scale, 0.0
    control[0] = 0.0
    for i in range(coefficients.shape[0] - order):
        control[i] = coefficients[i + order, k, j] * _FACTORS[order, i] * power
        power *= span
        largest += abs(control[i])
    return largest


@inline
def _raised(coefficients, slack, control, stack, k, j, order, span, sign, best):
    """Return the largest value of joint j in piece k, with a sign, or the best if it is less."""
    degree = max(coefficients.shape[0] - order - 1, 0)
    total = _derivative(coefficients, k, j, order, span, sign, control)
    to_bernstein(control, degree)
    for i in range(degree + 1):
        control[i] -= slack[order, k, j]
    return _highest(control, degree, best, PEAK_ACCURACY * total, stack)


@lean
def _look_at_ends(spans, coefficients, slack, low, high, steps, ends, below, above, sums):
    """Write the extremes at the ends of all pieces, and the other facts of `piece_extremes`.

    No value of a piece is outside `below` and `above`, (d, s, n): no power on [0, 1] is larger
    than 1.  The `sums` (2, n) are scratch.
    """
    size, pieces, joints = coefficients.shape
    total, largest = sums[0], sums[1]
    for k in range(pieces):
        for order in range(low.shape[0]):
            power = 1.0
            for j in range(joints):
                total[j] = largest[j] = 0.0
            for i in range(order + 1, size):
                power *= spans[k]
                factor, row = power * _FACTORS[order, i - order], coefficients[i, k]
                for j in range(joints):
                    total[j] += factor * row[j]
                    largest[j] += abs(factor * row[j])
            for j in range(joints):
                first, doubt = 0.0, slack[order, k, j]
                if order < size:
                    first = coefficients[order, k, j] * _FACTORS[order, 0]
                above[order, k, j] = first + 0.5 * (total[j] + largest[j]) - doubt
                below[order, k, j] = first + 0.5 * (total[j] - largest[j]) + doubt
                last = first + total[j]
                high[order, j] = max(high[order, j], max(first, last) - doubt)
                low[order, j] = min(low[order, j], min(first, last) + doubt)
                if k > 0:
                    step = abs(first - ends[order, j]) - max(doubt, slack[order, k - 1, j])
                    if not step <= steps[order, j]:
                        steps[order, j] = step if step == step else np.inf
                ends[order, j] = last


@kernel(i8(IN1, IN3, IN3, OUT2, OUT2, OUT2, OUT2))
def piece_extremes(breaks, coefficients, slack, low, high, steps, ends):
    """Find the extremes of the joints and of their first derivatives, and their largest steps.

    ``breaks`` (s + 1,) are where the pieces begin and the last one ends, increasing, and
    ``coefficients`` (c, max(s, 1), n) powers of the time since the beginning of the piece, lowest
    first.  By ``slack`` (d, max(s, 1), n) position, velocity and so on may be wrong in each piece;
    they count only as far as they are certain; d is 4 at most.

    ``low`` and ``high`` (d, n) are filled with extremes, to a part in 1e11 of the coefficients,
    ``steps`` (d, n) with the largest magnitudes of steps from one piece to the next; infinite
    where one is no number, and ``ends`` (d, n) with the values at the end of the last piece.
    """
    spans = np.ones(coefficients.shape[1])
    spans[: breaks.shape[0] - 1] = breaks[1:] - breaks[:-1]
    size = coefficients.shape[0]
    control, stack = np.empty(size + 1), np.empty((_HALVINGS + 3, size + 1))
    below, above = np.empty(slack.shape), np.empty(slack.shape)
    sums = np.empty((2, low.shape[1]))
    low[:], high[:], steps[:], ends[:] = np.inf, -np.inf, 0.0, 0.0
    _look_at_ends(spans, coefficients, slack, low, high, steps, ends, below, above, sums)
    arrays = coefficients, slack, control, stack
    for order in range(low.shape[0]):
        lows, highs = low[order], high[order]
        for k in range(coefficients.shape[1]):
            for j in range(low.shape[1]):
                if above[order, k, j] > highs[j]:
                    highs[j] = _raised(*arrays, k, j, order, spans[k], 1.0, highs[j])
                if below[order, k, j] < lows[j]:
                    lows[j] = -_raised(*arrays, k, j, order, spans[k], -1.0, -lows[j])
    return 0


@kernel(b1(IN2, IN2, IN2, IN1, IN1, IN2, IN1, IN2, f8, f8, OUT2))
def within_bounds(
    low, high, steps, lower, upper, limits, tolerances, allowed, slack, step_slack, ratios
):
    """Check the result of `piece_extremes` for position and three rates.

    Positions may be from ``lower`` to ``upper`` (n,), and outside by ``slack``.  Filled are
    ``ratios`` (3, n) of the rates to their ``limits`` (3, n), which may be as large as
    ``tolerances`` (3,), and steps as large as ``allowed`` (3, n).  Returned is whether all is well.
    The ratio of a limited jerk is infinite where the acceleration steps by more than a part,
    ``step_slack``, of its own limit.
    """
    good = True
    for j in range(lower.shape[0]):
        good = good and low[0, j] >= lower[j] - slack and high[0, j] <= upper[j] + slack
        for k in range(3):
            ratios[k, j] = max(-low[k + 1, j], high[k + 1, j], 0.0) / limits[k, j]
            good = good and ratios[k, j] <= tolerances[k] and steps[k, j] <= allowed[k, j]
        scale = limits[1, j] if limits[1, j] < np.inf else 1.0
        if limits[2, j] < np.inf and steps[2, j] > step_slack * scale:
            ratios[2, j] = np.inf
    return good
