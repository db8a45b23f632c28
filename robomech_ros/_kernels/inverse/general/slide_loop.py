"""The loop of a six-joint arm with two or three slides and its target: rotations, then positions.

Joints a, b, c, d are the revolute ones in the order of a form, as in ``slides``.  Angles
are given as cosine and sine, complex where a joint has no real value.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline
from robomech_ros._kernels.inverse.general import layout as at


@inline
def _multiply(a, b, out):
    """Write the product of two rotations, each nine numbers row by row."""
    for i in range(3):
        for j in range(3):
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]


@inline
def read_loop(data, form, back, loop, between):
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
def required_rotation(between, cosine, sine, M):
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
def equation_of_c(between, M):
    """Return constant, cosine and sine part of the equation for joint c."""
    B, C = between[1], between[2]
    constant = B[8] * C[8] - M[8]
    cosine = B[6] * C[2] + B[7] * C[5]
    sine = B[7] * C[2] - B[6] * C[5]
    return constant, cosine, sine


@inline
def _inverse(z):
    """Return the inverse of a complex number; for 0 it is NaN, a division would raise an error."""
    square = z.real * z.real + z.imag * z.imag
    return complex(z.real / square, -z.imag / square)


@inline
def turns_for_c(between, M, cosine, sine, turns):
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
def closure_gap(data, form, loop, turns, gap, slides):
    """Write the closure gap (3,) of the loop with slides at zero, and their directions (3, 3).

    Both are in the frame behind joint a, without one in the first frame.  ``turns`` (3, 2) are
    those of joints b, c and d.
    """
    frame = np.zeros((3, 3), np.complex128)
    row = np.empty(3, np.complex128)
    for i in range(3):
        frame[i, i] = 1.0
        gap[i] = 0.0
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
            gap[i] += (
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
def triple(u, v, w):
    """Return the triple product of three vectors."""
    x = v[1] * w[2] - v[2] * w[1]
    y = v[2] * w[0] - v[0] * w[2]
    z = v[0] * w[1] - v[1] * w[0]
    return u[0] * x + u[1] * y + u[2] * z


@inline
def root_of_c(constant, cosine, sine, sign):
    """Return cosine and sine, complex, of one solution of the equation for joint c."""
    square = cosine * cosine + sine * sine
    room = (square - constant * constant) / (square * square)
    h = complex(math.sqrt(room), 0.0) if room >= 0.0 else complex(0.0, math.sqrt(-room))
    inverse = constant / square
    return -cosine * inverse - sign * sine * h, -sine * inverse + sign * cosine * h
