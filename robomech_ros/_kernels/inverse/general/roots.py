"""All real zeros of the determinant of a general arm, as intervals of the hidden angle.

Seventeen determinants give the trigonometric polynomial.  On eight arcs its Bernstein
coefficients bound it from both sides.  An interval is dropped only if all of them are beyond the
rounding on one side of zero.  It has exactly one zero if they change sign once and none of them is
rounding; every other interval is halved.  If rounding prevents a decision, the polynomial is
resampled on the interval, with the accuracy of the determinant there, however small it is relative
to its largest value.  An interval of mere rounding, or undecided at the least width, is a cluster:
a multiple zero, or several zeros too near to each other.

References
----------
Lane and Riesenfeld, Bounds on a polynomial, BIT 21 (1981), pp. 112-117.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.compiling.jit import inline, lean, part
from robomech_ros._kernels.compiling.types import IN2, OUT2, b1, f8, i8
from robomech_ros._kernels.inverse.general.circle_tables import (
    ARC_COSINES,
    ARC_SINES,
    ARC_TANGENT,
    ARCS,
    BINOMIALS,
    CENTRES,
    FROM_COSINES,
    FROM_NODES,
    FROM_SINES,
    NODES,
    SAMPLE_COSINES,
    SAMPLE_SINES,
    SAMPLES,
    TO_COSINES,
    TO_LAST,
    TO_SINES,
)
from robomech_ros._kernels.inverse.general.determinant import determinant

# Rounding of the determinant, over the product of all pivots but the least: a dozen eliminations
# of rounded entries of order one.
DETERMINANT_NOISE = 1e-14
# An interval is resampled if no coefficient exceeds this many roundings.
GENERAL_RESAMPLE = 1e4
# Least width of an interval (of half an arc): the square root of the rounding.
GENERAL_WIDTH = 1e-6
# An interval this short is not halved if all coefficients are within so many roundings: a zero of
# multiplicity eight has no better accuracy.  A longer one may have after resampling.
GENERAL_ROUGH_WIDTH = 5e-2
GENERAL_ROUNDING = 4.0
# Largest distance (rad) from the real line of complex zeros that a nudge of the pose may have made
# from a singular posture: some square roots of the nudge.
GENERAL_NEAR_ZERO = 0.2
# Largest number of halvings for one determinant: ten times the need of any regular pose of the
# tested arms.
GENERAL_HALVINGS = 600

MAX_ROOTS = 48
_DEPTH = 64
# Effect of one rounding of a value on a Bernstein coefficient, for samples on the whole circle and
# for samples on an interval after 0, 1, 2 ... halvings.
_FROM_CIRCLE = 15.0
_FROM_INTERVAL = (4.7e4, 102.0, 8.0, 3.1, 2.8)
_LAST = len(_FROM_INTERVAL) - 1
# Number of values on the circle among which minima near zero are sought.
_GRID = 96
_STEP = 2.0 * math.pi / _GRID
_GRID_COSINES = np.cos(_STEP * np.arange(_GRID))

# Columns of an interval on the stack.
_LOW = 0
_HIGH = 1
_NOISE = 2
_LEVEL = 3  # halvings since it was sampled, -1 for samples on the whole circle


@part(types.UniTuple(f8, 2)(IN2, OUT2, OUT2, OUT2, OUT2))
def sample(E, form, A, B, K):
    """Write the harmonics of the determinant to form (2, 9); return largest value and rounding."""
    values = np.empty(SAMPLES)
    largest = 0.0
    noise = 0.0
    for j in range(SAMPLES):
        values[j], others, _ = determinant(E, SAMPLE_COSINES[j], SAMPLE_SINES[j], A, B, K)
        largest = max(largest, abs(values[j]))
        noise = max(noise, others)
    for k in range(9):
        a = 0.0
        b = 0.0
        for j in range(SAMPLES):
            a += TO_COSINES[k, j] * values[j]
            b += TO_SINES[k, j] * values[j]
        form[0, k] = a
        form[1, k] = b
    return largest, DETERMINANT_NOISE * noise


@inline
def _arc_coefficients(form, arc, turned, b):
    """Write the Bernstein coefficients b (17,) on an arc."""
    for k in range(9):
        c, s = ARC_COSINES[arc, k], ARC_SINES[arc, k]
        turned[0, k] = form[0, k] * c + form[1, k] * s
        turned[1, k] = form[1, k] * c - form[0, k] * s
    for i in range(9):
        even = 0.0
        odd = 0.0
        for k in range(9):
            even += FROM_COSINES[i, k] * turned[0, k]
            odd += FROM_SINES[i, k] * turned[1, k]
        b[i] = even + odd
        b[16 - i] = even - odd


@inline
def _resample(E, arc, low, high, A, B, K, values, b):
    """Write the Bernstein coefficients of new samples on a part of an arc; return the rounding."""
    middle = 0.5 * (low + high)
    half = 0.5 * (high - low)
    cosine, sine = math.cos(CENTRES[arc]), math.sin(CENTRES[arc])
    noise = 0.0
    for j in range(17):
        t = ARC_TANGENT * (middle + half * NODES[j])
        weight = 1.0 + t * t
        c = (1.0 - t * t) / weight
        s = 2.0 * t / weight
        value, others, early = determinant(E, c * cosine - s * sine, s * cosine + c * sine, A, B, K)
        weight *= weight
        weight *= weight
        weight *= weight
        values[j] = value * weight
        noise = max(noise, others * weight / early)
    for i in range(17):
        total = 0.0
        for j in range(17):
            total += FROM_NODES[i, j] * values[j]
        b[i] = total
    noise *= DETERMINANT_NOISE
    # On a short interval the last Chebyshev coefficients are nothing but rounding.
    for i in range(3):
        total = 0.0
        for j in range(17):
            total += TO_LAST[i, j] * values[j]
        noise = max(noise, 4.0 * abs(total))
    return noise


@inline
def _value(b, x):
    """Return value and slope at x in [0, 1], both without the same positive factor."""
    y = 1.0 - x
    if x <= 0.5:
        r = x / y
        p = b[16]
        d = 16.0 * p
        for i in range(15, 0, -1):
            term = BINOMIALS[i] * b[i]
            p = p * r + term
            d = d * r + i * term
        p = p * r + b[0]
        return p, (d - 16.0 * y * p) / (y * y)
    r = y / x
    p = b[0]
    d = 16.0 * p
    for i in range(1, 16):
        term = BINOMIALS[i] * b[i]
        p = p * r + term
        d = d * r + (16 - i) * term
    p = p * r + b[16]
    return p, (16.0 * x * p - d) / (x * x)


@inline
def _only_root(b):
    """Return the root in [0, 1] of Bernstein coefficients that change sign once."""
    rising = b[16] > 0.0
    low, high = 0.0, 1.0
    x = b[0] / (b[0] - b[16])
    for _ in range(100):
        value, slope = _value(b, x)
        if (value > 0.0) == rising:
            high = x
        else:
            low = x
        following = x - value / slope if slope != 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - x) <= 1e-9:
            # Newton's next step would be below the rounding.
            return following
        x = following
    return x


@inline
def _signs(b, tolerance):
    """Return the number of sign changes, whether a coefficient is rounding, least and largest."""
    changes = 0
    vague = False
    last = 0
    highest, lowest = b[0], b[0]
    for i in range(17):
        value = b[i]
        highest = max(highest, value)
        lowest = min(lowest, value)
        if value > tolerance:
            changes += last < 0
            last = 1
        elif value < -tolerance:
            changes += last > 0
            last = -1
        else:
            vague = True
    return changes, vague, lowest, highest


@inline
def _halve(stack, spans, top):
    """Replace the interval ``top`` by its right half, and put the left one above it."""
    c = stack[top]
    d = stack[top + 1]
    d[0] = c[0]
    for r in range(1, 17):
        for i in range(17 - r):
            c[i] = 0.5 * (c[i] + c[i + 1])
        d[r] = c[0]
    middle = 0.5 * (spans[top, _LOW] + spans[top, _HIGH])
    if spans[top, _LEVEL] >= 0.0:
        spans[top, _LEVEL] += 1.0
    spans[top + 1, _LOW] = spans[top, _LOW]
    spans[top + 1, _HIGH] = middle
    spans[top + 1, _NOISE] = spans[top, _NOISE]
    spans[top + 1, _LEVEL] = spans[top, _LEVEL]
    spans[top, _LOW] = middle


@inline
def _angle(arc, t):
    return CENTRES[arc] + 2.0 * math.atan(ARC_TANGENT * t)


@lean
def _tolerance(noise, level):
    """Return the rounding of coefficients at a level of the stack."""
    if level >= 0:
        return noise * _FROM_INTERVAL[min(level, _LAST)]
    return noise * _FROM_CIRCLE


@lean
def _enter(start, end, roots, count):
    """Enter an interval unless the list is full; return the number of intervals."""
    if count < MAX_ROOTS:
        roots[count, 0], roots[count, 1] = start, end
        count += 1
    return count


@lean
def _enter_or_extend(start, end, roots, count):
    """Enter an interval or extend the last one by it; return the number of intervals."""
    continues = count > 0 and start - roots[count - 1, 1] < GENERAL_WIDTH
    if continues and roots[count - 1, 1] > roots[count - 1, 0]:
        roots[count - 1, 1] = end
        return count
    return _enter(start, end, roots, count)


@part(types.Tuple((i8, b1, i8))(IN2, IN2, f8, i8, OUT2, OUT2, OUT2, OUT2))
def isolate(E, form, noise, most, A, B, K, roots):
    """Write the zeros to roots (MAX_ROOTS, 2) in order.

    A row holds both ends of an interval; they are equal for a simple zero.  The determinant of E
    is resampled at ``most`` so many times; with 0 E is not used.  Returns the number of rows,
    whether these are all zeros, and the number of samplings.  If the halvings allowed do not
    suffice, the undecided intervals are listed, too.
    """
    stack = np.empty((_DEPTH, 17))
    spans = np.empty((_DEPTH, 4))
    turned = np.empty((2, 9))
    values = np.empty(17)
    count = 0
    halvings = 0
    samplings = 0
    whole = True
    for arc in range(ARCS):
        _arc_coefficients(form, arc, turned, stack[0])
        spans[0, _LOW], spans[0, _HIGH] = -1.0, 1.0
        spans[0, _NOISE], spans[0, _LEVEL] = noise, -1.0
        top = 0
        while top >= 0:
            b = stack[top]
            level = int(spans[top, _LEVEL])
            tolerance = _tolerance(spans[top, _NOISE], level)
            changes, vague, lowest, highest = _signs(b, tolerance)
            low, high = spans[top, _LOW], spans[top, _HIGH]
            if lowest > tolerance or highest < -tolerance:
                top -= 1
                continue
            if changes == 1 and not vague:
                zero = _angle(arc, low + (high - low) * _only_root(b))
                count = _enter(zero, zero, roots, count)
                top -= 1
                continue
            spent = halvings >= GENERAL_HALVINGS or top + 2 >= _DEPTH
            unsure = vague and max(highest, -lowest) < GENERAL_RESAMPLE * tolerance
            rounding = max(highest, -lowest) < GENERAL_ROUNDING * tolerance
            known = high - low < GENERAL_ROUGH_WIDTH or samplings >= most
            done = most > 0 and rounding and known and level >= _LAST - 1
            if high - low < GENERAL_WIDTH or spent or done:
                whole = whole and not spent
                count = _enter_or_extend(_angle(arc, low), _angle(arc, high), roots, count)
                top -= 1
                continue
            if unsure and (level < 0 or level >= _LAST) and samplings < most:
                samplings += 1
                fresh = _resample(E, arc, low, high, A, B, K, values, b)
                gained = fresh < 0.1 * spans[top, _NOISE]
                spans[top, _NOISE] = fresh
                spans[top, _LEVEL] = 0.0
                if gained or level < 0:
                    continue
            _halve(stack, spans, top)
            halvings += 1
            top += 1
    return count, whole and count < MAX_ROOTS, samplings


@inline
def near_zeros(form, angles):
    """Write the minima of the polynomial's absolute value near zero to ``angles``; return how many.

    They belong to pairs of complex zeros less than GENERAL_NEAR_ZERO (rad) off the real line.
    """
    room = angles.shape[0]
    values = np.empty(_GRID)
    for j in range(_GRID):
        value = 0.0
        for k in range(9):
            m = (k * j) % _GRID
            value += form[0, k] * _GRID_COSINES[m]
            value += form[1, k] * _GRID_COSINES[(m + 3 * (_GRID // 4)) % _GRID]
        values[j] = value
    count = 0
    for j in range(_GRID):
        left, here, right = values[j - 1], values[j], values[(j + 1) % _GRID]
        if here < 0.0:
            left, here, right = -left, -here, -right
        if not (here <= left and here < right) or count == room:
            continue
        curvature = left + right - 2.0 * here
        shift = 0.5 * (left - right) / curvature
        lowest = here - 0.5 * curvature * shift * shift
        if 2.0 * lowest * _STEP * _STEP < curvature * GENERAL_NEAR_ZERO * GENERAL_NEAR_ZERO:
            angles[count] = _STEP * (j + shift)
            count += 1
    return count
