"""Postures of six-joint arms with two or three slides, without special geometry.

Slides leave directions alone.  Round the loop of arm and target the rotations of four revolute
joints a, b, c, d obey ``R_a A R_b B R_c C R_d D = 1`` with constant rotations between them, one of
which holds the target.  Given a, they are

    R_b (B R_c C) R_d = M,  M = (D R_a A)^-1,

of which ``z . B R_c C z = z . M z`` is an equation of order one for c; b and d follow from the third
column and the third row.  An arm with three slides has no joint a, and the slides, wherever they
are, obey linear equations.

With two slides the loop closes where their directions u, v and the way w round it lie in a plane.
With f the triple product of these three, for both values of c, the function

    g(a) = f_1 f_2 (1 - (z . M z)^2)

is a trigonometric polynomial of order four, whatever the arm and whichever joint is a: the last
factor takes away the poles where axes b and d line up.  Where c is not real, f_1 and f_2 are
conjugate.  The eight zeros of g are the values of a in all postures.
"""

import math

import numpy as np
from numba import types

from robomech_ros._kernels import general_layout as at
from robomech_ros._kernels._jit import IN1, OUT2, b1, i8, inline, part
from robomech_ros._kernels.angles import wrapped
from robomech_ros._kernels.circle_tables import SAMPLE_COSINES, SAMPLE_SINES, SAMPLES, TO_COSINES
from robomech_ros._kernels.circle_tables import TO_SINES
from robomech_ros._kernels.general_roots import MAX_ROOTS, isolate
from robomech_ros._kernels.tolerances import (
    DETERMINANT_NOISE,
    GENERAL_FREE_VALUES,
    GENERAL_VOID,
    SLIDES_FARTHEST,
    SLIDES_REGULAR,
)

__all__ = ["MAX_TRIALS", "slide_postures"]

MAX_TRIALS = 16
_ORDER = 4


@inline
def _multiply(a, b, out):
    """Write the product of rotations, rows of nine numbers."""
    for i in range(3):
        for j in range(3):
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]


@inline
def _read(data, form, back, loop, between):
    """Write the links of the loop (6, 12) and the rotations between revolute joints (4, 9).

    Rotations A .. D follow joints a .. d; with three revolute joints they are b, c, d, and A is 1.
    """
    target = int(data[form + at.TARGET_LINK])
    for k in range(6):
        for i in range(12):
            loop[k, i] = back[i] if k == target else data[form + at.LOOP + 12 * k + i]
    between[:] = 0.0
    for r in range(4):
        for i in range(3):
            between[r, 4 * i] = 1.0
    link = np.empty(9)
    out = np.empty(9)
    r = 3 - int(6.0 - data[at.SLIDES])
    for k in range(6):
        if data[form + at.KINDS + k] == 0.0:
            r += 1
        for i in range(3):
            for j in range(3):
                link[3 * i + j] = loop[k, 4 * i + j]
        _multiply(between[r], link, out)
        for i in range(9):
            between[r, i] = out[i]


@inline
def _demanded(between, cosine, sine, M):
    """Write M (9,) for a value of joint a."""
    turned = np.empty(9)
    # D R_a A.
    for i in range(3):
        x, y = between[3, 3 * i], between[3, 3 * i + 1]
        turned[3 * i] = x * cosine + y * sine
        turned[3 * i + 1] = y * cosine - x * sine
        turned[3 * i + 2] = between[3, 3 * i + 2]
    back = np.empty(9)
    _multiply(turned, between[0], back)
    for i in range(3):
        for j in range(3):
            M[3 * i + j] = back[3 * j + i]


@inline
def _middle(between, M):
    """Give constant, cosine and sine part of the equation for joint c."""
    B, C = between[1], between[2]
    constant = B[8] * C[8] - M[8]
    cosine = B[6] * C[2] + B[7] * C[5]
    sine = B[7] * C[2] - B[6] * C[5]
    return constant, cosine, sine


@inline
def _inverse(z):
    """Invert a complex number; 0 gives no number, where a division would raise an error."""
    square = z.real * z.real + z.imag * z.imag
    return complex(z.real / square, -z.imag / square)


@inline
def _turns(between, M, cosine, sine, turns):
    """Write cosine and sine of joints b, c, d to turns (3, 2), complex, given those of c."""
    B, C = between[1], between[2]
    # Third column and third row of B R_c C.
    x = cosine * C[2] - sine * C[5]
    y = sine * C[2] + cosine * C[5]
    u = B[0] * x + B[1] * y + B[2] * C[8]
    v = B[3] * x + B[4] * y + B[5] * C[8]
    inverse = _inverse(u * u + v * v)
    turns[0, 0] = (u * M[2] + v * M[5]) * inverse
    turns[0, 1] = (u * M[5] - v * M[2]) * inverse
    turns[1, 0], turns[1, 1] = cosine, sine
    x = B[6] * cosine + B[7] * sine
    y = B[7] * cosine - B[6] * sine
    u = x * C[0] + y * C[3] + B[8] * C[6]
    v = x * C[1] + y * C[4] + B[8] * C[7]
    inverse = _inverse(u * u + v * v)
    turns[2, 0] = (u * M[6] + v * M[7]) * inverse
    turns[2, 1] = (v * M[6] - u * M[7]) * inverse


@inline
def _round(data, form, loop, turns, way, slides):
    """Write the way (3,) round the loop, slides at zero, and the directions of slides (3, 3).

    Seen from the frame behind joint a, or from the first one where there is none: ``turns`` (3, 2)
    are those of the joints b, c and d.
    """
    frame = np.zeros((3, 3), np.complex128)
    row = np.empty(3, np.complex128)
    for i in range(3):
        frame[i, i] = 1.0
        way[i] = 0.0
    r = -1 if data[at.SLIDES] == 2.0 else 0
    slide = 0
    for k in range(6):
        if data[form + at.KINDS + k] != 0.0:
            for i in range(3):
                slides[slide, i] = frame[i, 2]
            slide += 1
        else:
            if r >= 0:
                c, s = turns[r, 0], turns[r, 1]
                for i in range(3):
                    x, y = frame[i, 0], frame[i, 1]
                    frame[i, 0] = x * c + y * s
                    frame[i, 1] = y * c - x * s
            r += 1
        for i in range(3):
            way[i] += (
                frame[i, 0] * loop[k, 3] + frame[i, 1] * loop[k, 7] + frame[i, 2] * loop[k, 11]
            )
            for j in range(3):
                row[j] = (
                    frame[i, 0] * loop[k, j]
                    + frame[i, 1] * loop[k, 4 + j]
                    + frame[i, 2] * loop[k, 8 + j]
                )
            for j in range(3):
                frame[i, j] = row[j]


@inline
def _triple(u, v, w):
    """Give the triple product of three vectors."""
    x = v[1] * w[2] - v[2] * w[1]
    y = v[2] * w[0] - v[0] * w[2]
    z = v[0] * w[1] - v[1] * w[0]
    return u[0] * x + u[1] * y + u[2] * z


@inline
def _root(constant, cosine, sine, sign):
    """Give cosine and sine, complex, of one solution of the equation for joint c."""
    square = cosine * cosine + sine * sine
    room = (square - constant * constant) / (square * square)
    h = complex(math.sqrt(room), 0.0) if room >= 0.0 else complex(0.0, math.sqrt(-room))
    inverse = constant / square
    return -cosine * inverse - sign * sine * h, -sine * inverse + sign * cosine * h


@inline
def _evaluate(data, form, loop, between, cosine, sine, M, turns, way, slides):
    """Evaluate g at a value of joint a; return it and what rounding may have done to it."""
    _demanded(between, cosine, sine, M)
    k, c, s = _middle(between, M)
    room = c * c + s * s - k * k
    p, q = _root(k, c, s, 1.0)
    _turns(between, M, p, q, turns)
    _round(data, form, loop, turns, way, slides)
    first = _triple(way, slides[0], slides[1])
    length = abs(way[0]) + abs(way[1]) + abs(way[2])
    other = complex(first.real, -first.imag)
    if room >= 0.0:
        p, q = _root(k, c, s, -1.0)
        _turns(between, M, p, q, turns)
        _round(data, form, loop, turns, way, slides)
        other = _triple(way, slides[0], slides[1])
        length = max(length, abs(way[0]) + abs(way[1]) + abs(way[2]))
    apart = (1.0 - M[8]) * (1.0 + M[8])
    return (first * other).real * apart, length * (abs(first) + abs(other))


@inline
def _enter(data, form, cosine, sine, turns, way, slides, trial):
    """Write the joint values of a posture to trial (6,), real parts of what there is."""
    two = data[at.SLIDES] == 2.0
    u, v, x, w = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(3):
        u[i], v[i], x[i], w[i] = slides[0, i].real, slides[1, i].real, slides[2, i].real, way[i].real
    if two:
        # Across both slides nothing is to be done.
        x[0], x[1], x[2] = (
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        )
    inverse = -data[at.SIZE] / _triple(u, v, x)
    values = (
        _triple(w, v, x) * inverse,
        _triple(u, w, x) * inverse,
        _triple(u, v, w) * inverse,
    )
    slide = 0
    r = -1 if two else 0
    for k in range(6):
        joint = int(data[form + at.JOINTS + k])
        if data[form + at.KINDS + k] != 0.0:
            trial[joint] = values[slide]
            slide += 1
        else:
            if r < 0:
                trial[joint] = math.atan2(sine, cosine)
            else:
                trial[joint] = wrapped(math.atan2(turns[r, 1].real, turns[r, 0].real))
            r += 1


@inline
def _hidden_values(data, form, loop, between, seed, roots, M, turns, way, slides):
    """Write the values of joint a in all postures; return how many, if all are simple, if void.

    Where g vanishes all round, joint a may be free; then the seed's value and others are given.
    """
    values = np.empty(SAMPLES)
    noise = 0.0
    largest = 0.0
    for j in range(SAMPLES):
        values[j], others = _evaluate(
            data, form, loop, between, SAMPLE_COSINES[j], SAMPLE_SINES[j], M, turns, way, slides
        )
        largest = max(largest, abs(values[j]))
        noise = max(noise, DETERMINANT_NOISE * others)
    shape = np.zeros((2, 9))
    for k in range(9):
        a, b = 0.0, 0.0
        for j in range(SAMPLES):
            a += TO_COSINES[k, j] * values[j]
            b += TO_SINES[k, j] * values[j]
        if k > _ORDER:
            # Nothing but rounding.
            noise = max(noise, abs(a), abs(b))
        else:
            shape[0, k], shape[1, k] = a, b
    if not largest > GENERAL_VOID * noise:
        start = seed[int(data[form + at.JOINTS])]
        for k in range(GENERAL_FREE_VALUES):
            away = 2.0 * math.pi * ((k + 1) // 2) / GENERAL_FREE_VALUES
            roots[k, 0] = start + (away if k % 2 == 1 else -away)
            roots[k, 1] = roots[k, 0]
        return GENERAL_FREE_VALUES, False, True
    unused = np.empty((0, 0))
    count, simple = isolate(unused, shape, noise, 0, unused, unused, unused, roots)
    for k in range(count):
        simple = simple and roots[k, 0] == roots[k, 1]
    return count, simple, False


@inline
def _is_far(way, slides):
    """Tell whether two slides are parallel where the loop does not close: it does so nowhere near."""
    across, along = 0.0, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        u, v, w = slides[0], slides[1], way
        across += abs(u[j].real * v[k].real - u[k].real * v[j].real)
        along += abs(u[j].real * w[k].real - u[k].real * w[j].real)
        along += abs(v[j].real * w[k].real - v[k].real * w[j].real)
    return across * SLIDES_FARTHEST < along


@inline
def _better(data, form, loop, between, cosine, sine, M, turns, way, slides, trial):
    """Write the better of the two postures with a value of joint a.

    Returns how many there are near the arm, -1 where there is none with real angles.
    """
    _demanded(between, cosine, sine, M)
    k, c, s = _middle(between, M)
    if not c * c + s * s >= k * k:
        return -1
    sign, least = 1.0, math.inf
    for number in range(3):
        # The better one is the last that is looked at.
        p, q = _root(k, c, s, sign if number == 2 else 1.0 - 2.0 * number)
        _turns(between, M, p, q, turns)
        _round(data, form, loop, turns, way, slides)
        off = abs(_triple(way, slides[0], slides[1]))
        if off < least and number < 2:
            least, sign = off, 1.0 - 2.0 * number
    if not least < math.inf:
        return -1
    _enter(data, form, cosine, sine, turns, way, slides, trial)
    return 0 if _is_far(way, slides) else 1


@inline
def _without_hidden(data, form, loop, between, M, turns, way, slides, trials):
    """Write the two postures of an arm with three slides; return how many, and if these are all."""
    _demanded(between, 1.0, 0.0, M)
    k, c, s = _middle(between, M)
    square = c * c + s * s
    room = square - k * k
    if not (square > SLIDES_REGULAR and (1.0 - M[8]) * (1.0 + M[8]) > SLIDES_REGULAR):
        return 0, False
    if room < -SLIDES_REGULAR * square:
        return 0, True
    simple = room > SLIDES_REGULAR * square
    room = max(room, 0.0)
    for number in range(2):
        sign = 1.0 - 2.0 * number
        p, q = _root(k, c, s, sign)
        _turns(between, M, p, q, turns)
        _round(data, form, loop, turns, way, slides)
        _enter(data, form, 1.0, 0.0, turns, way, slides, trials[number])
    return 2, simple


@part(types.Tuple((i8, b1, b1))(IN1, i8, IN1, IN1, OUT2))
def slide_postures(data, form, back, seed, trials):
    """Write the postures that a form gives to trials (MAX_TRIALS, 6).

    ``back`` (12,) is the inverse of the pose demanded.  Returns how many they are, whether all
    postures are among them and each stands for one alone, and whether the hidden joint may be free;
    then they are a choice.
    """
    loop = np.empty((6, 12))
    between = np.empty((4, 9))
    M = np.empty(9)
    turns = np.empty((3, 2), np.complex128)
    way = np.empty(3, np.complex128)
    slides = np.empty((3, 3), np.complex128)
    _read(data, form, back, loop, between)
    if data[at.SLIDES] == 3.0:
        count, clean = _without_hidden(
            data, form, loop, between, M, turns, way, slides, trials
        )
        return count, clean, False
    roots = np.empty((MAX_ROOTS, 2))
    zeros, clean, void = _hidden_values(
        data, form, loop, between, seed, roots, M, turns, way, slides
    )
    count = 0
    for k in range(min(zeros, MAX_TRIALS)):
        hidden = 0.5 * (roots[k, 0] + roots[k, 1])
        c, s = math.cos(hidden), math.sin(hidden)
        near = _better(data, form, loop, between, c, s, M, turns, way, slides, trials[count])
        clean = clean and near >= 0
        count += max(near, 0)
    return count, clean, void
