"""Exponential, logarithm and adjoint of poses, their screws, and the factors of rotation vectors.

A pose is a row of sixteen numbers, a screw vector a row of six, angular first.
"""

import math

from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN2, OUT2, i8
from robomech_ros._kernels.spatial.conversions import STATUSES
from robomech_ros._kernels.spatial.representations import (
    BAD_INPUT,
    canonical,
    quaternion_of_matrix,
    quaternion_of_vector,
    vector_of_quaternion,
)
from robomech_ros._kernels.spatial.vectors import (
    combined,
    cross,
    dot,
    length,
    scaled,
    sine_cosine,
    triple,
)
from robomech_ros._kernels.tolerances import ROTATION_ERROR

# Squared angle below which series replace closed forms, in which digits cancel.
_SERIES = 1.0
_TERMS = 11
# Coefficients 2 zeta(2 k) / (2 pi)^(2 k), from k = 1, of the series of x/2 cot(x/2).
_COTANGENT = tuple(
    abs_b / math.factorial(2 * k)
    for k, abs_b in enumerate(
        (
            1 / 6, 1 / 30, 1 / 42, 1 / 30, 5 / 66, 691 / 2730, 7 / 6, 3617 / 510, 43867 / 798,
            174611 / 330, 854513 / 138,
        ),
        start=1,
    )
)  # fmt: skip
_EVEN = tuple((-1.0) ** k / math.factorial(2 * k + 2) for k in range(_TERMS))
_ODD = tuple((-1.0) ** k / math.factorial(2 * k + 3) for k in range(_TERMS))


@lean
def _summed(coefficients, x):
    """Return value and derivative of a power series."""
    value = slope = 0.0
    for k in range(_TERMS - 1, -1, -1):
        slope = slope * x + value
        value = value * x + coefficients[k]
    return value, slope


@lean
def turn_factors(x):
    """Return ``(1 - cos)/t^2`` and ``(t - sin)/t^3`` of t, and their derivatives by x = t^2."""
    if x < _SERIES:
        a, da = _summed(_EVEN, x)
        b, db = _summed(_ODD, x)
        return a, b, da, db
    t = math.sqrt(x)
    sine = sine_cosine(t)[0]
    half = sine_cosine(0.5 * t)[0]
    a, b = 2.0 * half * half / x, (t - sine) / (x * t)
    return a, b, (0.5 * sine / t - a) / x, (0.5 * a - 1.5 * b) / x


@lean
def inverse_factors(x):
    """Return ``(1 - t/2 cot(t/2)) / t^2`` of an angle t, and its derivative by x = t^2."""
    if x < _SERIES:
        return _summed(_COTANGENT, x)
    half = 0.5 * math.sqrt(x)
    sine, cosine = sine_cosine(half)
    value = (1.0 - half * cosine / sine) / x
    return value, 0.25 * (half / (sine * sine) - cosine / sine) / (2.0 * half * x) - value / x


@lean
def _write_pose(x, y, z, w, p, out, k):
    out[k, 0] = 1.0 - 2.0 * (y * y + z * z)
    out[k, 1] = 2.0 * (x * y - z * w)
    out[k, 2] = 2.0 * (x * z + y * w)
    out[k, 4] = 2.0 * (x * y + z * w)
    out[k, 5] = 1.0 - 2.0 * (x * x + z * z)
    out[k, 6] = 2.0 * (y * z - x * w)
    out[k, 8] = 2.0 * (x * z - y * w)
    out[k, 9] = 2.0 * (y * z + x * w)
    out[k, 10] = 1.0 - 2.0 * (x * x + y * y)
    out[k, 3], out[k, 7], out[k, 11] = p
    out[k, 12], out[k, 13], out[k, 14], out[k, 15] = 0.0, 0.0, 0.0, 1.0


@kernel(i8(IN2, OUT2))
def exponentials(rows, out):
    """Write the poses (m, 16) of screw vectors (m, 6)."""
    for k in range(rows.shape[0]):
        turn = rows[k, 0], rows[k, 1], rows[k, 2]
        x, y, z, w = quaternion_of_vector(turn[0], turn[1], turn[2])
        a, b, _, _ = turn_factors(dot(turn, turn))
        v = rows[k, 3], rows[k, 4], rows[k, 5]
        p = combined(combined(v, cross(turn, v), a), triple(turn, v), b)
        if not abs(p[0]) + abs(p[1]) + abs(p[2]) + abs(w) < math.inf:
            return k * STATUSES + BAD_INPUT
        _write_pose(x, y, z, w, p, out, k)
    return 0


@lean
def _read_pose(rows, k):
    """Return status, canonical quaternion and position of row k."""
    off = max(abs(rows[k, 12]), abs(rows[k, 13]), abs(rows[k, 14]), abs(rows[k, 15] - 1.0))
    p = rows[k, 3], rows[k, 7], rows[k, 11]
    status, x, y, z, w = quaternion_of_matrix(
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 4], rows[k, 5], rows[k, 6], rows[k, 8],
        rows[k, 9], rows[k, 10],
    )  # fmt: skip
    x, y, z, w = canonical(x, y, z, w)
    off += 0.0 * (rows[k, 12] + rows[k, 13] + rows[k, 14] + rows[k, 15])
    if not (off <= ROTATION_ERROR and abs(p[0]) + abs(p[1]) + abs(p[2]) < math.inf):
        status = BAD_INPUT
    return status, x, y, z, w, p


@kernel(i8(IN2, OUT2))
def logarithms(rows, out):
    """Write the screw vectors (m, 6) of poses (m, 16)."""
    for k in range(rows.shape[0]):
        status, x, y, z, w, p = _read_pose(rows, k)
        if status != 0:
            return k * STATUSES + status
        turn = vector_of_quaternion(x, y, z, w)
        square = dot(turn, turn)
        if square < _SERIES:
            factor = inverse_factors(square)[0]
        else:
            cotangent = w / math.sqrt(x * x + y * y + z * z)
            factor = (1.0 - 0.5 * math.sqrt(square) * cotangent) / square
        v = combined(combined(p, cross(turn, p), -0.5), triple(turn, p), factor)
        out[k, 0], out[k, 1], out[k, 2] = turn
        out[k, 3], out[k, 4], out[k, 5] = v
    return 0


@lean
def _write_block(rows, out, k, i, j):
    """Write a block (3, 3) to a matrix with six columns, from row i and column j on."""
    for r in range(3):
        at = 6 * (i + r) + j
        out[k, at], out[k, at + 1], out[k, at + 2] = rows[r]


@kernel(i8(IN2, OUT2))
def adjoints(rows, out):
    """Write the adjoint matrices (m, 36) of poses (m, 16), which transform twists."""
    zero = 0.0, 0.0, 0.0
    for k in range(rows.shape[0]):
        status, x, y, z, w, p = _read_pose(rows, k)
        if status != 0:
            return k * STATUSES + status
        a = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)
        b = 2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)
        c = 2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)
        one = combined(scaled(c, p[1]), b, -p[2])
        two = combined(scaled(a, p[2]), c, -p[0])
        three = combined(scaled(b, p[0]), a, -p[1])
        total = dot(one, one) + dot(two, two) + dot(three, three)
        if not total < math.inf:
            return k * STATUSES + BAD_INPUT
        _write_block((a, b, c), out, k, 0, 0)
        _write_block((zero, zero, zero), out, k, 0, 3)
        _write_block((one, two, three), out, k, 3, 0)
        _write_block((a, b, c), out, k, 3, 3)
    return 0


@kernel(i8(IN2, OUT2))
def screws(rows, out):
    """Write axis, its point nearest to the origin, angle and displacement (m, 8) of poses."""
    for k in range(rows.shape[0]):
        status, x, y, z, w, p = _read_pose(rows, k)
        if status != 0:
            return k * STATUSES + status
        sine = length(x, y, z)
        point = 0.0, 0.0, 0.0
        if sine == 0.0:
            way = length(p[0], p[1], p[2])
            axis = 0.0, 0.0, 1.0
            if way > 0.0:
                axis = p[0] / way + 0.0, p[1] / way + 0.0, p[2] / way + 0.0
            angle = 0.0
        else:
            axis = x / sine, y / sine, z / sine
            way = dot(axis, p)
            angle = vector_of_quaternion(0.0, 0.0, sine, w)[2]
            # The component of p perpendicular to the axis, rotated by a quarter turn.
            aside = cross(axis, p)
            across = cross(aside, axis)
            point = scaled(combined(across, aside, w / sine), 0.5)
        if not abs(point[0]) + abs(point[1]) + abs(point[2]) < math.inf:
            return k * STATUSES + BAD_INPUT
        out[k, 0], out[k, 1], out[k, 2] = axis
        out[k, 3], out[k, 4], out[k, 5] = point[0] + 0.0, point[1] + 0.0, point[2] + 0.0
        out[k, 6], out[k, 7] = angle, way
    return 0


@kernel(i8(IN2, OUT2))
def poses_of_screws(rows, out):
    """Write the poses (m, 16) of screws: axis, point, angle and displacement (m, 8)."""
    for k in range(rows.shape[0]):
        norm = length(rows[k, 0], rows[k, 1], rows[k, 2])
        if not 0.0 < norm < math.inf:
            return k * STATUSES + BAD_INPUT
        e = rows[k, 0] / norm, rows[k, 1] / norm, rows[k, 2] / norm
        point = rows[k, 3], rows[k, 4], rows[k, 5]
        s, c = sine_cosine(0.5 * rows[k, 6])
        # (1 - Q) p0 by half angles, which keep all digits of small rotations.
        moved = combined(scaled(cross(e, point), -2.0 * s * c), triple(e, point), -2.0 * s * s)
        p = combined(moved, e, rows[k, 7])
        if not abs(p[0]) + abs(p[1]) + abs(p[2]) < math.inf:
            return k * STATUSES + BAD_INPUT
        _write_pose(e[0] * s, e[1] * s, e[2] * s, c, p, out, k)
    return 0
