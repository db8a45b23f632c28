"""Postures of six-joint arms with two or three slides, without special geometry.

Slides do not change directions.  Along the loop of arm and target the rotations of four revolute
joints a, b, c, d satisfy ``R_a A R_b B R_c C R_d D = 1`` with constant rotations between them, one
of which contains the target.  Given a, that is

    R_b (B R_c C) R_d = M,  M = (D R_a A)^-1,

and ``z . B R_c C z = z . M z`` is an equation of order one for c; b and d follow from the third
column and the third row.  An arm with three slides has no joint a, and its slides satisfy linear
equations.

With two slides the loop closes if their directions u, v and its gap w without them lie in a plane.
With f the triple product of these three, for both values of c, the function

    g(a) = f_1 f_2 (1 - (z . M z)^2)

is a trigonometric polynomial of order four for every choice of a: the last factor removes the
poles at which axes b and d are parallel.  If c is at the same angle to both, both f have a pole,
and the square of this factor is needed, order six.  If c is not real, f_1 and f_2 are conjugate.
The zeros of g, eight without those of the factor, are the values of a in all postures.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import IN1, OUT2, b1, i8
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.inverse.general.circle_tables import SAMPLES, TO_COSINES, TO_SINES
from robomech_ros._kernels.inverse.general.roots import DETERMINANT_NOISE, MAX_ROOTS, isolate
from robomech_ros._kernels.inverse.general.slide_loop import (
    closure_gap,
    equation_of_c,
    read_loop,
    required_rotation,
    root_of_c,
    triple,
    turns_for_c,
)

# Least ratio of the largest value of a determinant to its rounding; below it the form is void.
GENERAL_VOID = 1e3
# Below this squared sine two axes count as parallel, and another form is needed.
SLIDES_REGULAR = 1e-8
# A discriminant of joint c (absolute) of at least minus this may be negative only by the rounding
# of a simple zero.
SLIDES_BRANCH = 1e-6
# Above this discriminant (relative) two postures are more than SAME_POSTURE apart, and rounding
# does not move them.
SLIDES_DOUBLE = 1e-11
# Widest interval (rad) in which a discriminant beyond SLIDES_REGULAR at both ends is so in between.
SLIDES_WIDTH = 1e-4
# Damping (of squared sines) for slides that can move against each other: above the rounding.
SLIDES_DAMPING = 1e-13
# Largest displacement of slides (of the arm's size); beyond it they are parallel.
SLIDES_FARTHEST = 1e6
# Number of values tried for a hidden joint if its determinant vanishes at all angles.
GENERAL_FREE_VALUES = 16

MAX_TRIALS = 16
_ORDER = 4
_ORDER_SQUARED = 6
# Added to equally spaced samples, so that none is a multiple of 45 degrees, with parallel axes.
_OFFSET = math.pi / (8 * SAMPLES)
_COSINES = np.cos(_OFFSET + 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES)
_SINES = np.sin(_OFFSET + 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES)


@inline
def _evaluate(data, form, loop, between, cosine, sine, M, turns, gap, slides):
    """Return g at a value of joint a, the scale of its rounding and its last factor."""
    required_rotation(between, cosine, sine, M)
    k, c, s = equation_of_c(between, M)
    square = c * c + s * s
    room = square - k * k
    p, q = root_of_c(k, c, s, 1.0)
    turns_for_c(between, M, p, q, turns)
    closure_gap(data, form, loop, turns, gap, slides)
    first = triple(gap, slides[0], slides[1])
    length = abs(gap[0]) + abs(gap[1]) + abs(gap[2])
    other = complex(first.real, -first.imag)
    if room >= 0.0:
        p, q = root_of_c(k, c, s, -1.0)
        turns_for_c(between, M, p, q, turns)
        closure_gap(data, form, loop, turns, gap, slides)
        other = triple(gap, slides[0], slides[1])
        length = max(length, abs(gap[0]) + abs(gap[1]) + abs(gap[2]))
    apart = (1.0 - M[8]) * (1.0 + M[8])
    # If axis c is nearly parallel to a neighbour, its angle is less certain.
    others = length * (abs(first) + abs(other)) / math.sqrt(square)
    return (first * other).real * apart, others, apart


@inline
def _slide_displacements(slides, gap, used, values):
    """Write the shortest displacements (3,) of the slides that close the loop.

    Damped least squares, so that slides that can move against each other share the motion.
    """
    N = np.zeros((3, 4))
    for i in range(3):
        N[i, i] = SLIDES_DAMPING
    for i in range(used):
        for m in range(3):
            for j in range(used):
                N[i, j] += slides[i, m].real * slides[j, m].real
            N[i, 3] -= slides[i, m].real * gap[m].real
    for k in range(3):
        for i in range(k + 1, 3):
            factor = N[i, k] / N[k, k]
            for j in range(k + 1, 4):
                N[i, j] -= factor * N[k, j]
    for i in range(2, -1, -1):
        value = N[i, 3]
        for j in range(i + 1, 3):
            value -= N[i, j] * values[j]
        values[i] = value / N[i, i]


@inline
def _enter(data, form, cosine, sine, turns, gap, slides, trial):
    """Write the joint values of a posture, real parts if complex, to trial (6,)."""
    two = data[at.SLIDES] == 2.0
    values = np.empty(3)
    _slide_displacements(slides, gap, 2 if two else 3, values)
    slide = 0
    r = -1 if two else 0
    for k in range(6):
        joint = int(data[form + at.JOINTS + k])
        if data[form + at.KINDS + k] != 0.0:
            trial[joint] = values[slide] * data[at.SIZE]
            slide += 1
        else:
            if r < 0:
                trial[joint] = math.atan2(sine, cosine)
            else:
                trial[joint] = wrapped(math.atan2(turns[r, 1].real, turns[r, 0].real))
            r += 1


@inline
def _harmonics(values, order, shape):
    """Write the harmonics up to an order to shape (2, 9); return the largest higher one."""
    rounding = 0.0
    for k in range(9):
        a, b = 0.0, 0.0
        for j in range(SAMPLES):
            a += TO_COSINES[k, j] * values[j]
            b += TO_SINES[k, j] * values[j]
        if k > order:
            rounding = max(rounding, abs(a), abs(b))
            a, b = 0.0, 0.0
        shape[0, k], shape[1, k] = a, b
    return rounding


@inline
def _hidden_values(data, form, loop, between, seed, roots, M, turns, gap, slides):
    """Write the values of joint a in all postures; return how many, if these are all, and if void.

    If g vanishes at all angles, joint a may be free; then the seed's value and others are used.
    """
    values = np.empty(SAMPLES)
    factors = np.empty(SAMPLES)
    noise = 0.0
    for j in range(SAMPLES):
        values[j], others, factors[j] = _evaluate(
            data, form, loop, between, _COSINES[j], _SINES[j], M, turns, gap, slides
        )
        noise = max(noise, DETERMINANT_NOISE * others)
    shape = np.empty((2, 9))
    rounding = _harmonics(values, _ORDER, shape)
    if rounding > GENERAL_VOID * noise:
        for j in range(SAMPLES):
            values[j] *= factors[j]
        rounding = _harmonics(values, _ORDER_SQUARED, shape)
    noise = max(noise, rounding)
    largest = 0.0
    for j in range(SAMPLES):
        largest = max(largest, abs(values[j]))
    if not largest > GENERAL_VOID * noise:
        start = seed[int(data[form + at.JOINTS])]
        for k in range(GENERAL_FREE_VALUES):
            away = 2.0 * math.pi * ((k + 1) // 2) / GENERAL_FREE_VALUES
            roots[k, 0] = start + (away if k % 2 == 1 else -away)
            roots[k, 1] = roots[k, 0]
        return GENERAL_FREE_VALUES, False, True
    unused = np.empty((0, 0))
    count, whole, _ = isolate(unused, shape, noise, 0, unused, unused, unused, roots)
    for k in range(count):
        roots[k, 0] += _OFFSET
        roots[k, 1] += _OFFSET
    return count, whole, False


@inline
def _is_complex(between, hidden, M):
    """Return whether joint c has no real value for a value of joint a."""
    required_rotation(between, math.cos(hidden), math.sin(hidden), M)
    k, c, s = equation_of_c(between, M)
    return c * c + s * s - k * k < -SLIDES_REGULAR


@inline
def _nearness(gap, slides):
    """Return 1 if two slides close the loop near the arm, 0 if nowhere, -1 if anywhere."""
    across, along = 0.0, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        u, v, w = slides[0], slides[1], gap
        across += abs(u[j].real * v[k].real - u[k].real * v[j].real)
        along += abs(u[j].real * w[k].real - u[k].real * w[j].real)
        along += abs(v[j].real * w[k].real - v[k].real * w[j].real)
    if across * SLIDES_FARTHEST < along:
        return 0
    return 1 if across > SLIDES_REGULAR else -1


@inline
def _better_posture(data, form, loop, between, cosine, sine, M, turns, gap, slides, trial):
    """Write the better of the two postures for a value of joint a, a simple zero or in a cluster.

    Returns the number of postures near the arm, and whether that number is certain.  At a simple
    zero c is real; if its two values coincide, the rounding of the zero may make it complex.
    """
    required_rotation(between, cosine, sine, M)
    k, c, s = equation_of_c(between, M)
    square = c * c + s * s
    if not square - k * k > -SLIDES_BRANCH:
        return 0, False
    sign, least = 1.0, math.inf
    for number in range(3):
        # The third evaluation repeats the better of the first two.
        p, q = root_of_c(k, c, s, sign if number == 2 else 1.0 - 2.0 * number)
        turns_for_c(between, M, p, q, turns)
        closure_gap(data, form, loop, turns, gap, slides)
        off = abs(triple(gap, slides[0], slides[1]))
        if off < least and number < 2:
            least, sign = off, 1.0 - 2.0 * number
    if not least < math.inf:
        return 0, False
    near = _nearness(gap, slides)
    if near == 0:
        # Unless axes are parallel, the directions of the slides are accurate.
        return 0, min(square, (1.0 - M[8]) * (1.0 + M[8])) > SLIDES_REGULAR
    _enter(data, form, cosine, sine, turns, gap, slides, trial)
    return 1, near > 0


@inline
def _three_slide_postures(data, form, loop, between, M, turns, gap, slides, trials):
    """Write the two postures of an arm with three slides; return how many, and if these are all."""
    required_rotation(between, 1.0, 0.0, M)
    k, c, s = equation_of_c(between, M)
    square = c * c + s * s
    room = square - k * k
    if not (square > SLIDES_REGULAR and (1.0 - M[8]) * (1.0 + M[8]) > SLIDES_REGULAR):
        return 0, False
    if room < -SLIDES_REGULAR * square:
        return 0, True
    simple = room > SLIDES_DOUBLE * square
    room = max(room, 0.0)
    for number in range(2):
        sign = 1.0 - 2.0 * number
        p, q = root_of_c(k, c, s, sign)
        turns_for_c(between, M, p, q, turns)
        closure_gap(data, form, loop, turns, gap, slides)
        # Slides in one plane may move while the tip does not.
        simple = simple and abs(triple(slides[0], slides[1], slides[2])) > SLIDES_REGULAR
        _enter(data, form, 1.0, 0.0, turns, gap, slides, trials[number])
    return 2, simple


@part(types.Tuple((i8, b1, b1))(IN1, i8, IN1, IN1, OUT2))
def slide_postures(data, form, back, seed, trials):
    """Write the postures of a form to trials (MAX_TRIALS, 6).

    ``back`` (12,) is the inverse of the required pose.  Returns their number, whether they are all
    postures and all different, and whether the hidden joint may be free; then they are a selection.
    """
    loop = np.empty((6, 12))
    between = np.empty((4, 9))
    M = np.empty(9)
    turns = np.empty((3, 2), np.complex128)
    gap = np.empty(3, np.complex128)
    slides = np.empty((3, 3), np.complex128)
    read_loop(data, form, back, loop, between)
    if data[at.SLIDES] == 3.0:
        count, clean = _three_slide_postures(
            data, form, loop, between, M, turns, gap, slides, trials
        )
        return count, clean, False
    roots = np.empty((MAX_ROOTS, 2))
    zeros, clean, void = _hidden_values(
        data, form, loop, between, seed, roots, M, turns, gap, slides
    )
    count = 0
    for k in range(zeros):
        low, high = roots[k, 0], roots[k, 1]
        if 0.0 < high - low < SLIDES_WIDTH:
            # If c is not real, g is a square times a positive factor: no zero is simple.
            if _is_complex(between, low, M) and _is_complex(between, high, M):
                continue
        clean = clean and low == high and count < MAX_TRIALS
        if count >= MAX_TRIALS:
            break
        hidden = 0.5 * (low + high)
        c, s = math.cos(hidden), math.sin(hidden)
        near, clear = _better_posture(
            data, form, loop, between, c, s, M, turns, gap, slides, trials[count]
        )
        clean = clean and clear
        count += near
    return count, clean, void
