"""The six joint values of a general arm, given the hidden one and two of its neighbours."""

import math

from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import inline, part
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, f8
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.spatial.vectors import rotated, rotated_back

_ROOT_2 = math.sqrt(2.0)


@inline
def half_angles(x, slide):
    """Return the values of joints THIRD and FOURTH from a null vector x (6,).

    It holds ``s c (s, c)`` of the first half angle times ``(s s, sqrt(2) s c, c c)`` of the other.
    For a slide, s / c is the displacement.
    """
    first, second, product = 0.0, 0.0, 0.0
    for j in range(3):
        first += x[j] * x[j]
        second += x[3 + j] * x[3 + j]
        product += x[j] * x[3 + j]
    if first >= second:
        third = _joint_value(first, product, slide == at.THIRD)
        k = 0
    else:
        third = _joint_value(product, second, slide == at.THIRD)
        k = 3
    product = x[k + 1] / _ROOT_2
    if abs(x[k]) >= abs(x[k + 2]):
        return third, _joint_value(x[k], product, slide == at.FOURTH)
    return third, _joint_value(product, x[k + 2], slide == at.FOURTH)


@inline
def _joint_value(sine, cosine, slides):
    """Return the angle from multiples of sine and cosine of its half, or a slide, their ratio."""
    if slides:
        return sine / cosine
    return 2.0 * math.atan2(sine, cosine)


@inline
def _turned(data, k, angle, x, y, z):
    """Return a vector rotated by the link at k of the data, then about z."""
    u, v, w = rotated(data, k, (x, y, z))
    c = math.cos(angle)
    s = math.sin(angle)
    return c * u - s * v, s * u + c * v, w


@inline
def _last_angle(data, links, before, behind, q1, q2, q3, q4, q5):
    """Return the angle of joint LAST, from x of the frame behind it transformed along the loop."""
    x, y, z = data[links + 36], data[links + 40], data[links + 44]
    c, s = math.cos(q5), math.sin(q5)
    x, y = c * x - s * y, s * x + c * y
    x, y, z = _turned(data, links + 24, q4, x, y, z)
    x, y, z = _turned(data, links + 12, q3, x, y, z)
    x, y, z = _turned(data, links, q2, x, y, z)
    x, y, z = rotated_back(behind, 0, (x, y, z))
    c, s = math.cos(q1), math.sin(q1)
    u, v, _ = rotated_back(before, 0, (c * x - s * y, s * x + c * y, z))
    return -math.atan2(v, u)


@inline
def _half_sine_cosine(value, slides):
    """Return sine and cosine of half an angle; for a slide, its value and 1."""
    if slides:
        return value, 1.0
    return math.sin(0.5 * value), math.cos(0.5 * value)


@inline
def _left_side(form, hidden, third, fourth, left):
    """Write the fourteen quantities of three joints to left (14,)."""
    c3, s3 = math.cos(hidden), math.sin(hidden)
    s, c = _half_sine_cosine(third, form[at.SLIDE] == at.THIRD)
    u, v = _half_sine_cosine(fourth, form[at.SLIDE] == at.FOURTH)
    fourths = (u * u, _ROOT_2 * u * v, v * v)
    thirds = (s * s, s * c, c * c)
    k = at.EQUATIONS
    for r in range(at.N_EQUATIONS):
        total = 0.0
        for i in range(3):
            part = 0.0
            for j in range(3):
                m = k + 3 * i + j
                part += fourths[j] * (c3 * form[m] + s3 * form[m + 9] + form[m + 18])
            total += thirds[i] * part
        left[r] = total
        k += at.N_COLUMNS


@inline
def _first_value(X, left, slides):
    """Return the value of joint FIRST from six linear equations by least squares."""
    aa, ab, bb, ay, by = 0.0, 0.0, 0.0, 0.0, 0.0
    for r in range(8, 14):
        y = left[r] - X[r, 2]
        aa += X[r, 0] * X[r, 0]
        ab += X[r, 0] * X[r, 1]
        bb += X[r, 1] * X[r, 1]
        ay += X[r, 0] * y
        by += X[r, 1] * y
    if slides:
        return (aa * by - ab * ay) / (aa * bb - ab * ab)
    return math.atan2(aa * by - ab * ay, bb * ay - ab * by)


@inline
def _second_angle(X, left, first, slides):
    """Return the angle of joint SECOND from four complex equations by least squares."""
    c, s = math.cos(first), math.sin(first)
    if slides:
        c, s = first * first, first
    real, imaginary = 0.0, 0.0
    for r in range(4):
        x = X[r, 0] * c + X[r, 1] * s + X[r, 2]
        y = X[4 + r, 0] * c + X[4 + r, 1] * s + X[4 + r, 2]
        real += left[r] * x + left[4 + r] * y
        imaginary += left[r] * y - left[4 + r] * x
    return math.atan2(imaginary, real)


@part(types.void(IN1, f8, IN2, f8, f8, f8, OUT1, OUT1))
def remaining_joints(form, size, X, hidden, third, fourth, left, q):
    """Write the six joint values to q (6,), given three; ``left`` (14,) is working space.

    Slides are in units of the ``size`` (m).  Joints FIRST and SECOND follow from linear equations,
    joint LAST from the remaining rotation.
    """
    _left_side(form, hidden, third, fourth, left)
    slide = form[at.SLIDE]
    first = _first_value(X, left, slide == at.FIRST)
    second = _second_angle(X, left, first, slide == at.FIRST)
    last = _last_angle(
        form,
        at.LINKS,
        form[at.BEFORE : at.BEFORE + 12],
        form[at.BEHIND : at.BEHIND + 12],
        0.0 if slide == at.FIRST else first,
        second,
        hidden,
        0.0 if slide == at.THIRD else third,
        0.0 if slide == at.FOURTH else fourth,
    )
    third += form[at.OFFSETS]
    fourth += form[at.OFFSETS + 1]
    values = (first, second, hidden, third, fourth, last)
    sense = form[at.SENSE]
    for k in range(6):
        value = sense * values[k]
        joint = int(form[at.JOINTS + k])
        q[joint] = value * size if k == slide else wrapped(value)
