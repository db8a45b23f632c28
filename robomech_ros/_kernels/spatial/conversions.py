"""Conversion, composition and interpolation of many rotations."""

import math

from robomech_ros._kernels.algebra.angles import angle_of
from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT2, i8
from robomech_ros._kernels.spatial.representations import (
    BAD_INPUT,
    MATRIX,
    ROTATION_VECTOR,
    canonical,
    decoded,
    encode,
    quaternion_of_matrix,
    quaternion_of_vector,
    vector_of_quaternion,
    write_matrix,
)
from robomech_ros._kernels.spatial.tolerances import UNIT_NORM
from robomech_ros._kernels.spatial.vectors import sine_cosine

# A status is the index of a row times this, plus its error code; 0 means no error.
STATUSES = 4


@lean
def _exponentials(rows, out):
    """Convert rotation vectors to matrices, in a loop without tests of kinds."""
    for k in range(rows.shape[0]):
        x, y, z, w = quaternion_of_vector(rows[k, 0], rows[k, 1], rows[k, 2])
        if not abs(w) <= 2.0:
            return k * STATUSES + BAD_INPUT
        write_matrix(x, y, z, w, out, k)
    return 0


@lean
def _logarithms(rows, out):
    """Convert matrices to rotation vectors."""
    for k in range(rows.shape[0]):
        status, x, y, z, w = quaternion_of_matrix(
            rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5], rows[k, 6],
            rows[k, 7], rows[k, 8],
        )  # fmt: skip
        if status != 0:
            return k * STATUSES + status
        x, y, z, w = canonical(x, y, z, w)
        out[k, 0], out[k, 1], out[k, 2] = vector_of_quaternion(x, y, z, w)
    return 0


@kernel(i8(i8, i8, IN2, OUT2))
def convert(source, target, rows, out):
    """Convert rows of numbers from one kind to another."""
    if source == ROTATION_VECTOR and target == MATRIX:
        return _exponentials(rows, out)
    if source == MATRIX and target == ROTATION_VECTOR:
        return _logarithms(rows, out)
    for k in range(rows.shape[0]):
        status, x, y, z, w = decoded(source, rows, k)
        if status == 0:
            x, y, z, w = canonical(x, y, z, w)
            status = encode(target, x, y, z, w, out, k)
        if status != 0:
            return k * STATUSES + status
    return 0


@lean
def _row_of(rows, k):
    """Return the row for item k: the only one, or k."""
    return k if rows.shape[0] > 1 else 0


@kernel(i8(i8, IN2, IN2, OUT2))
def compose(kind, second, first, out):
    """Compose rotations of one kind; if an operand has one row, this applies to all."""
    for k in range(out.shape[0]):
        status, x, y, z, w = decoded(kind, second, _row_of(second, k))
        if status != 0:
            return _row_of(second, k) * STATUSES + status
        status, a, b, c, d = decoded(kind, first, _row_of(first, k))
        if status != 0:
            return _row_of(first, k) * STATUSES + status
        e = w * a + d * x + (y * c - z * b)
        f = w * b + d * y + (z * a - x * c)
        g = w * c + d * z + (x * b - y * a)
        h = w * d - (x * a + y * b + z * c)
        norm = math.sqrt(e * e + f * f + g * g + h * h)
        e, f, g, h = canonical(e / norm, f / norm, g / norm, h / norm)
        status = encode(kind, e, f, g, h, out, k)
        if status != 0:
            return k * STATUSES + status
    return 0


@lean
def _unit(rows, k):
    """Return status and unit quaternion of row k."""
    x, y, z, w = rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3]
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    status = 0 if abs(norm - 1.0) <= UNIT_NORM else BAD_INPUT
    return status, x / norm, y / norm, z / norm, w / norm


@lean
def _geodesic(start, goal):
    """Return the shorter angle between two quaternions, and a unit one orthogonal to start."""
    x, y, z, w = start
    a, b, c, d = goal
    if x * a + y * b + z * c + w * d < 0.0:
        a, b, c, d = -a, -b, -c, -d
    dx, dy, dz, dw = a - x, b - y, c - z, d - w
    square = dx * dx + dy * dy + dz * dz + dw * dw
    less, more = (
        math.sqrt(square),
        math.sqrt((a + x) ** 2 + (b + y) ** 2 + (c + z) ** 2 + (d + w) ** 2),
    )
    if less == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    sine, half = 0.5 * less * more, 0.5 * square
    aside = (dx + half * x) / sine, (dy + half * y) / sine
    return 2.0 * angle_of(less, more), *aside, (dz + half * z) / sine, (dw + half * w) / sine


@kernel(i8(IN2, IN2, IN1, OUT2))
def interpolate(start, goal, fraction, out):
    """Interpolate between quaternions along the shorter arc at a constant rate."""
    x, y, z, w = 0.0, 0.0, 0.0, 1.0
    angle, a, b, c, d = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(out.shape[0]):
        i, j = _row_of(start, k), _row_of(goal, k)
        if k == 0 or i > 0 or j > 0:
            status, x, y, z, w = _unit(start, i)
            if status != 0:
                return i * STATUSES + status
            status, a, b, c, d = _unit(goal, j)
            if status != 0:
                return j * STATUSES + status
            angle, a, b, c, d = _geodesic((x, y, z, w), (a, b, c, d))
        t = fraction[k] if fraction.shape[0] > 1 else fraction[0]
        sine, cosine = sine_cosine(t * angle)
        if not abs(sine) <= 2.0:
            return k * STATUSES + BAD_INPUT
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = canonical(
            cosine * x + sine * a,
            cosine * y + sine * b,
            cosine * z + sine * c,
            cosine * w + sine * d,
        )
    return 0
