"""First and second derivatives of representations of a rotation, and angular motion from them.

Angular velocity and acceleration are in the fixed frame.
"""

import math

from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN2, OUT2, i8
from robomech_ros._kernels.spatial import representations as kinds
from robomech_ros._kernels.spatial.conversions import STATUSES
from robomech_ros._kernels.spatial.exponential import inverse_factors, turn_factors
from robomech_ros._kernels.spatial.representations import BAD_INPUT, decoded, euler_axes
from robomech_ros._kernels.spatial.vectors import combined, cross, dot, scaled, sine_cosine, triple

# Status: no rates, or infinitely many, give this angular velocity.
SINGULAR = 3

# Sine of an angle below which its axis, or two of three Euler angles, are undetermined.
_LEAST_SINE = 1e-14


@lean
def _vector(rows, k, first):
    return rows[k, first], rows[k, first + 1], rows[k, first + 2]


@lean
def _write(out, k, first, v):
    out[k, first], out[k, first + 1], out[k, first + 2] = v


@lean
def _one(rows, k):
    return k if rows.shape[0] > 1 else 0


@lean
def _quaternion_rates(r, r0, w, dw):
    """Return r', r0', r'' and r0''."""
    first = scaled(combined(scaled(w, r0), cross(w, r), 1.0), 0.5)
    first0 = -0.5 * dot(r, w)
    second = combined(scaled(w, first0), scaled(dw, r0), 1.0)
    second = combined(combined(second, cross(dw, r), 1.0), cross(w, first), 1.0)
    return first, first0, scaled(second, 0.5), -0.5 * (dot(first, w) + dot(r, dw))


@lean
def _of_quaternion_rates(r, r0, first, first0):
    """Return the angular velocity from r', r0', or the angular acceleration from r'', r0''."""
    part = combined(scaled(first, r0), cross(r, first), 1.0)
    return scaled(combined(part, r, -first0), 2.0)


@lean
def _matrix_rates(rows, k, w, dw, first, second):
    for j in range(3):
        column = rows[k, j], rows[k, 3 + j], rows[k, 6 + j]
        moved = cross(w, column)
        first[k, j], first[k, 3 + j], first[k, 6 + j] = moved
        turned = combined(cross(dw, column), cross(w, moved), 1.0)
        second[k, j], second[k, 3 + j], second[k, 6 + j] = turned


@lean
def _axis_angle_rates(e, angle, w, dw, first, second, k):
    s, c = sine_cosine(0.5 * angle)
    if abs(s) < _LEAST_SINE:
        return SINGULAR
    rate = dot(w, e)
    cotangent = c / s
    aside = triple(e, w)
    axis = combined(scaled(cross(w, e), 0.5), aside, -0.5 * cotangent)
    growth = combined(cross(axis, cross(e, w)), cross(e, cross(axis, w)), 1.0)
    growth = combined(growth, triple(e, dw), 1.0)
    change = combined(scaled(cross(dw, e), 0.5), cross(w, axis), 0.5)
    change = combined(combined(change, aside, 0.25 * rate / (s * s)), growth, -0.5 * cotangent)
    _write(first, k, 0, axis)
    _write(second, k, 0, change)
    first[k, 3], second[k, 3] = rate, dot(dw, e) + dot(w, axis)
    return 0


@lean
def _vector_rates(v, w, dw, first, second, k):
    square = dot(v, v)
    factor, slope = inverse_factors(square)
    if square > 1.0 and abs(sine_cosine(0.5 * math.sqrt(square))[0]) < _LEAST_SINE:
        return SINGULAR
    across = cross(v, w)
    twice = cross(v, across)
    rate = combined(combined(w, across, -0.5), twice, factor)
    change = combined(dw, combined(cross(rate, w), cross(v, dw), 1.0), -0.5)
    change = combined(change, twice, 2.0 * slope * dot(v, rate))
    growth = combined(cross(rate, across), cross(v, cross(rate, w)), 1.0)
    growth = combined(growth, triple(v, dw), 1.0)
    _write(first, k, 0, rate)
    _write(second, k, 0, combined(change, growth, factor))
    return 0


@lean
def _euler_frame(kind, rows, k):
    """Return the axes of the three rotations, in a right-handed frame of axes i, j and 3."""
    _, _, _, parity, proper, fixed = euler_axes(kind)
    first = rows[k, 2] if fixed else rows[k, 0]
    s1, c1 = sine_cosine(first)
    s2, c2 = sine_cosine(rows[k, 1])
    one, two = (1.0, 0.0, 0.0), (0.0, c1, s1)
    if proper:
        three = (c2, s2 * s1, -s2 * c1)
    else:
        three = (parity * s2, -parity * s1 * c2, parity * c1 * c2)
    return one, two, three


@lean
def _euler_local(kind, v):
    i, j, other, parity, _, _ = euler_axes(kind)
    at_i = v[0] if i == 0 else (v[1] if i == 1 else v[2])
    at_j = v[0] if j == 0 else (v[1] if j == 1 else v[2])
    at_other = v[0] if other == 0 else (v[1] if other == 1 else v[2])
    return at_i, at_j, parity * at_other


@lean
def _euler_global(kind, v):
    i, j, _, parity, _, _ = euler_axes(kind)
    at_i, at_j, at_other = v[0], v[1], parity * v[2]
    x = at_i if i == 0 else (at_j if j == 0 else at_other)
    y = at_i if i == 1 else (at_j if j == 1 else at_other)
    z = at_i if i == 2 else (at_j if j == 2 else at_other)
    return x, y, z


@lean
def _along(one, two, three, v):
    """Return the components of a vector along three axes, the second orthogonal to the others."""
    normal = cross(one, two)
    volume = dot(normal, three)
    return dot(v, cross(two, three)) / volume, dot(v, two), dot(v, normal) / volume


@lean
def _turning(one, two, three, a, b, c):
    """Return the angular acceleration of constant rates a, b, c about successive axes."""
    part = combined(scaled(cross(one, two), a * b), cross(one, three), a * c)
    return combined(part, cross(two, three), b * c)


@lean
def _euler_rates(kind, rows, k, w, dw, first, second):
    one, two, three = _euler_frame(kind, rows, k)
    if abs(dot(cross(one, two), three)) < _LEAST_SINE:
        return SINGULAR
    fixed = euler_axes(kind)[5]
    a, b, c = _along(one, two, three, _euler_local(kind, w))
    rest = combined(_euler_local(kind, dw), _turning(one, two, three, a, b, c), -1.0)
    d, e, f = _along(one, two, three, rest)
    _write(first, k, 0, (c, b, a) if fixed else (a, b, c))
    _write(second, k, 0, (f, e, d) if fixed else (d, e, f))
    return 0


@lean
def _one_rate(kind, rows, k, w, dw, first, second):
    """Write both derivatives of row k; return the status."""
    status, x, y, z, r0 = decoded(kind, rows, k)
    if status != 0:
        return status
    if kind == kinds.MATRIX:
        _matrix_rates(rows, k, w, dw, first, second)
        return 0
    if kind == kinds.ROTATION_VECTOR:
        return _vector_rates(_vector(rows, k, 0), w, dw, first, second, k)
    if kind == kinds.AXIS_ANGLE:
        e = _vector(rows, k, 0)
        e = scaled(e, 1.0 / math.sqrt(dot(e, e)))
        return _axis_angle_rates(e, rows[k, 3], w, dw, first, second, k)
    if kind > kinds.LINEAR_INVARIANTS:
        return _euler_rates(kind, rows, k, w, dw, first, second)
    r = (x, y, z)
    rate, rate0, change, change0 = _quaternion_rates(r, r0, w, dw)
    if kind == kinds.QUATERNION:
        _write(first, k, 0, rate)
        _write(second, k, 0, change)
        first[k, 3], second[k, 3] = rate0, change0
    elif kind == kinds.RODRIGUES_VECTOR:
        ratio = scaled(r, 1.0 / r0)
        ratio_rate = scaled(combined(rate, ratio, -rate0), 1.0 / r0)
        part = combined(combined(change, ratio_rate, -2.0 * rate0), ratio, -change0)
        _write(first, k, 0, ratio_rate)
        _write(second, k, 0, scaled(part, 1.0 / r0))
    else:
        _write(first, k, 0, scaled(combined(scaled(r, rate0), rate, r0), 2.0))
        part = combined(combined(scaled(r, change0), rate, 2.0 * rate0), change, r0)
        _write(second, k, 0, scaled(part, 2.0))
        first[k, 3] = 4.0 * r0 * rate0
        second[k, 3] = 4.0 * (rate0 * rate0 + r0 * change0)
    return 0


@kernel(i8(i8, IN2, IN2, IN2, OUT2, OUT2))
def rates(kind, rows, velocity, acceleration, first, second):
    """Write both derivatives of rows of a kind from angular velocity and acceleration."""
    for k in range(rows.shape[0]):
        w = _vector(velocity, _one(velocity, k), 0)
        dw = _vector(acceleration, _one(acceleration, k), 0)
        status = _one_rate(kind, rows, k, w, dw, first, second)
        if status != 0:
            return k * STATUSES + status
    return 0


@lean
def _of_matrix_rates(rows, rate, k):
    """Return half the sum of the cross products of columns and their derivatives."""
    total = (0.0, 0.0, 0.0)
    for j in range(3):
        column = rows[k, j], rows[k, 3 + j], rows[k, 6 + j]
        total = combined(total, cross(column, (rate[k, j], rate[k, 3 + j], rate[k, 6 + j])), 0.5)
    return total


@lean
def _of_axis_angle_rates(e, angle, first, second, k):
    s, c = sine_cosine(angle)
    half = sine_cosine(0.5 * angle)[0]
    versed = 2.0 * half * half
    axis, rate = _vector(first, k, 0), first[k, 3]
    change = _vector(second, k, 0)
    across = cross(e, axis)
    w = combined(combined(scaled(e, rate), axis, s), across, versed)
    dw = combined(combined(scaled(e, second[k, 3]), axis, rate * (1.0 + c)), change, s)
    return w, combined(combined(dw, across, s * rate), cross(e, change), versed)


@lean
def _of_vector_rates(v, rate, change):
    a, b, da, db = turn_factors(dot(v, v))
    across = cross(v, rate)
    twice = cross(v, across)
    growth = 2.0 * dot(v, rate)
    w = combined(combined(rate, across, a), twice, b)
    dw = combined(combined(change, cross(v, change), a), triple(v, change), b)
    dw = combined(combined(dw, across, da * growth), twice, db * growth)
    return w, combined(dw, cross(rate, across), b)


@lean
def _of_euler_rates(kind, rows, first, second, k):
    one, two, three = _euler_frame(kind, rows, k)
    a, b, c = first[k, 0], first[k, 1], first[k, 2]
    d, e, f = second[k, 0], second[k, 1], second[k, 2]
    if euler_axes(kind)[5]:
        a, c, d, f = c, a, f, d
    w = combined(combined(scaled(one, a), two, b), three, c)
    dw = combined(combined(scaled(one, d), two, e), three, f)
    dw = combined(dw, _turning(one, two, three, a, b, c), 1.0)
    return _euler_global(kind, w), _euler_global(kind, dw)


@lean
def _of_rodrigues_rates(r, r0, first, second, k):
    """Return ``omega = 2 r0^2 (rho' + rho x rho')`` and its derivative."""
    ratio = scaled(r, 1.0 / r0)
    rate, change = _vector(first, k, 0), _vector(second, k, 0)
    factor = 2.0 * r0 * r0
    w = scaled(combined(rate, cross(ratio, rate), 1.0), factor)
    dw = scaled(combined(change, cross(ratio, change), 1.0), factor)
    return w, combined(dw, w, -factor * dot(ratio, rate))


@lean
def _of_linear_invariant_rates(r, r0, first, second, k):
    """Return the angular motion from r, r0 and rates of ``q = 2 r0 r`` and ``q0 = 2 r0^2 - 1``."""
    rate0 = first[k, 3] / (4.0 * r0)
    change0 = (0.25 * second[k, 3] - rate0 * rate0) / r0
    rate = scaled(combined(_vector(first, k, 0), r, -2.0 * rate0), 0.5 / r0)
    part = combined(_vector(second, k, 0), r, -2.0 * change0)
    change = scaled(combined(part, rate, -4.0 * rate0), 0.5 / r0)
    return _of_quaternion_rates(r, r0, rate, rate0), _of_quaternion_rates(r, r0, change, change0)


@lean
def _one_motion(kind, rows, first, second, k):
    """Return status, angular velocity and angular acceleration of row k."""
    nothing = (0.0, 0.0, 0.0)
    status, x, y, z, r0 = decoded(kind, rows, k)
    if status != 0:
        return status, nothing, nothing
    r = (x, y, z)
    if kind == kinds.MATRIX:
        return 0, _of_matrix_rates(rows, first, k), _of_matrix_rates(rows, second, k)
    if kind == kinds.QUATERNION:
        w = _of_quaternion_rates(r, r0, _vector(first, k, 0), first[k, 3])
        dw = _of_quaternion_rates(r, r0, _vector(second, k, 0), second[k, 3])
    elif kind == kinds.ROTATION_VECTOR:
        v = _vector(rows, k, 0)
        w, dw = _of_vector_rates(v, _vector(first, k, 0), _vector(second, k, 0))
    elif kind == kinds.AXIS_ANGLE:
        e = _vector(rows, k, 0)
        e = scaled(e, 1.0 / math.sqrt(dot(e, e)))
        w, dw = _of_axis_angle_rates(e, rows[k, 3], first, second, k)
    elif kind == kinds.RODRIGUES_VECTOR:
        w, dw = _of_rodrigues_rates(r, r0, first, second, k)
    elif kind == kinds.LINEAR_INVARIANTS:
        w, dw = _of_linear_invariant_rates(r, r0, first, second, k)
    else:
        w, dw = _of_euler_rates(kind, rows, first, second, k)
    return 0, w, dw


@kernel(i8(i8, IN2, IN2, IN2, OUT2, OUT2))
def angular_motions(kind, rows, first, second, velocity, acceleration):
    """Write angular velocity and acceleration from rows of a kind and their two derivatives."""
    for k in range(rows.shape[0]):
        status, w, dw = _one_motion(kind, rows, first, second, k)
        largest = max(abs(w[0]), abs(w[1]), abs(w[2]), abs(dw[0]), abs(dw[1]), abs(dw[2]))
        if status == 0 and not largest < math.inf:
            status = BAD_INPUT
        if status != 0:
            return k * STATUSES + status
        _write(velocity, k, 0, w)
        _write(acceleration, k, 0, dw)
    return 0
