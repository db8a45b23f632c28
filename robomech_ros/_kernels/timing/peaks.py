"""Extremes of piecewise polynomials and of their derivatives, also inside the pieces.

On an interval, a polynomial is within the range of its Bernstein coefficients, which converges to
the polynomial quadratically as the interval is halved.  So pieces whose range cannot contain an
extreme are skipped, and the few others are halved until the range is narrow enough.

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

# Accuracy of extremes inside pieces, relative to the largest Bernstein coefficient.
PEAK_ACCURACY = 1e-11

# Largest number of halvings; each narrows the range four times, so these exceed any accuracy.
_HALVINGS = 24
# Largest number of intervals in a piece; a polynomial with three extremes needs a hundred.
_MOST = 2000
# Derivative d of x^(i + d) is _FACTORS[d, i] x^i.
_FACTORS = np.array([[float(math.perm(i + d, d)) for i in range(10)] for d in range(4)])


@inline
def _highest(control, degree, floor, accuracy, stack):
    """Return the largest value on [0, 1] from Bernstein coefficients, but at least the floor."""
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
        # De Casteljau: the left half replaces the interval, the right half is pushed on top.
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

    Returns the sum of the magnitudes, which bounds all values.
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
    """Return the largest value of joint j in piece k, times a sign, but at least `best`."""
    degree = max(coefficients.shape[0] - order - 1, 0)
    total = _derivative(coefficients, k, j, order, span, sign, control)
    to_bernstein(control, degree)
    for i in range(degree + 1):
        control[i] -= slack[order, k, j]
    return _highest(control, degree, best, PEAK_ACCURACY * total, stack)


@lean
def _look_at_ends(spans, coefficients, slack, low, high, steps, ends, below, above, sums):
    """Write the extremes at the ends of all pieces, and the other results of `piece_extremes`.

    ``below`` and ``above`` (d, s, n) receive bounds of all values of a piece, since no power on
    [0, 1] exceeds 1.  ``sums`` (2, n) is working space.
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

    ``breaks`` (s + 1,) are the increasing ends of the pieces, and ``coefficients`` (c, max(s, 1),
    n) belong to powers of the time since the start of a piece, lowest first.  ``slack``
    (d, max(s, 1), n) bounds the errors of position, velocity and so on in each piece, which reduce
    the magnitudes; d is at most 4.

    ``low`` and ``high`` (d, n) receive extremes, to 1e-11 of the coefficients, ``steps`` (d, n)
    the largest magnitudes of steps between pieces, infinite if one is NaN, and ``ends`` (d, n) the
    values at the end of the last piece.
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
    """Return whether results of `piece_extremes` for position and three rates are within limits.

    Positions may be from ``lower`` to ``upper`` (n,), and outside by ``slack``.  ``ratios`` (3, n)
    receives the ratios of the rates to their ``limits`` (3, n), which may be up to ``tolerances``
    (3,); steps may be up to ``allowed`` (3, n).  The ratio of a limited jerk is infinite if the
    acceleration steps by more than the fraction ``step_slack`` of its limit.
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
