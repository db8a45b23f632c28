"""Unit quaternions from each representation of a rotation, and back.

A row of numbers represents a rotation, depending on its kind; quaternions have their scalar last.
All conversions use the quaternion, which is well conditioned at every angle: near a half turn its
scalar, and near the identity its vector, keeps all digits.
"""

import math

from robomech_ros._kernels.algebra.angles import angle_of, wrapped
from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.spatial.tolerances import UNIT_NORM
from robomech_ros._kernels.spatial.vectors import length, sine_cosine
from robomech_ros._kernels.tolerances import ORTHOGONAL, ROTATION_ERROR

MATRIX = 0
QUATERNION = 1
AXIS_ANGLE = 2
ROTATION_VECTOR = 3
RODRIGUES_VECTOR = 4
LINEAR_INVARIANTS = 5
# Plus i + 3 j + 9 k for rotations about the axes i, j, k, and 27 if the axes are fixed.
EULER = 8

# Not a rotation, or not finite; the caller finds the cause.
BAD_INPUT = 1
# A half turn, which the representation cannot express.
HALF_TURN = 2

# Squared length below which the outer two Euler angles are indistinguishable.  Setting the third
# to 0 then changes the rotation by at most twice the root of this.
_LOCKED = 5e-31
# A smaller scalar is that of a half turn: division by it overflows.
_NOTHING = 1e-290
# Below this angle (rad), the sine equals the angle.
_TINY = 1e-140


@lean
def canonical(x, y, z, w):
    """Return the quaternion whose scalar, or else first nonzero number, is positive, without -0."""
    first = w
    if first == 0.0:
        first = x if x != 0.0 else (y if y != 0.0 else z)
    if first < 0.0:
        return 0.0 - x, 0.0 - y, 0.0 - z, 0.0 - w
    return x + 0.0, y + 0.0, z + 0.0, w + 0.0


@lean
def _orthonormalised(a, b, c, d, e, f, g, h, i):
    """Return a matrix nearer to the polar factor of a matrix that is nearly a rotation."""
    xx = 1.5 - 0.5 * (a * a + d * d + g * g)
    yy = 1.5 - 0.5 * (b * b + e * e + h * h)
    zz = 1.5 - 0.5 * (c * c + f * f + i * i)
    xy = -0.5 * (a * b + d * e + g * h)
    xz = -0.5 * (a * c + d * f + g * i)
    yz = -0.5 * (b * c + e * f + h * i)
    return (
        a * xx + b * xy + c * xz,
        a * xy + b * yy + c * yz,
        a * xz + b * yz + c * zz,
        d * xx + e * xy + f * xz,
        d * xy + e * yy + f * yz,
        d * xz + e * yz + f * zz,
        g * xx + h * xy + i * xz,
        g * xy + h * yy + i * yz,
        g * xz + h * yz + i * zz,
    )


@lean
def quaternion_of_matrix(a, b, c, d, e, f, g, h, i):
    """Return status and quaternion of a matrix, row by row, by Shepperd's method."""
    error = max(abs(a * a + d * d + g * g - 1.0), abs(a * b + d * e + g * h))
    error = max(error, abs(b * b + e * e + h * h - 1.0), abs(a * c + d * f + g * i))
    error = max(error, abs(c * c + f * f + i * i - 1.0), abs(b * c + e * f + h * i))
    volume = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)
    # A NaN in any entry makes the volume NaN.
    if not (error <= ROTATION_ERROR and volume > 0.0):
        return BAD_INPUT, 0.0, 0.0, 0.0, 1.0
    if error > ORTHOGONAL:
        # Convergence is quadratic: 2e-4, 3e-8, 7e-16.
        a, b, c, d, e, f, g, h, i = _orthonormalised(a, b, c, d, e, f, g, h, i)
        a, b, c, d, e, f, g, h, i = _orthonormalised(a, b, c, d, e, f, g, h, i)
        a, b, c, d, e, f, g, h, i = _orthonormalised(a, b, c, d, e, f, g, h, i)
    if a + e + i > 0.0:
        x, y, z, w = h - f, c - g, d - b, 1.0 + a + e + i
    elif a >= e and a >= i:
        x, y, z, w = 1.0 + a - e - i, b + d, c + g, h - f
    elif e >= i:
        x, y, z, w = b + d, 1.0 - a + e - i, f + h, c - g
    else:
        x, y, z, w = c + g, f + h, 1.0 - a - e + i, d - b
    factor = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return 0, x * factor, y * factor, z * factor, w * factor


@lean
def quaternion_of_vector(x, y, z):
    """Return the quaternion of a rotation vector."""
    angle = length(x, y, z)
    if angle < _TINY:
        return 0.5 * x, 0.5 * y, 0.5 * z, 1.0
    sine, cosine = sine_cosine(0.5 * angle)
    factor = sine / angle
    return x * factor, y * factor, z * factor, cosine


@lean
def vector_of_quaternion(x, y, z, w):
    """Return the rotation vector, at most pi long, of a canonical quaternion."""
    sine = length(x, y, z)
    factor = 2.0 if sine < _TINY else 2.0 * angle_of(sine, w) / sine
    return x * factor, y * factor, z * factor


@lean
def write_matrix(x, y, z, w, out, row):
    """Write the matrix of a unit quaternion to a row of nine."""
    out[row, 0] = 1.0 - 2.0 * (y * y + z * z)
    out[row, 1] = 2.0 * (x * y - z * w)
    out[row, 2] = 2.0 * (x * z + y * w)
    out[row, 3] = 2.0 * (x * y + z * w)
    out[row, 4] = 1.0 - 2.0 * (x * x + z * z)
    out[row, 5] = 2.0 * (y * z - x * w)
    out[row, 6] = 2.0 * (x * z - y * w)
    out[row, 7] = 2.0 * (y * z + x * w)
    out[row, 8] = 1.0 - 2.0 * (x * x + y * y)


@lean
def _of_quaternion(x, y, z, w):
    """Return status and quaternion, normalised if the norm is 1 up to rounding."""
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not abs(norm - 1.0) <= UNIT_NORM:
        return BAD_INPUT, 0.0, 0.0, 0.0, 1.0
    return 0, x / norm, y / norm, z / norm, w / norm


@lean
def _of_axis_angle(x, y, z, angle):
    norm = length(x, y, z)
    if not (0.0 < norm < math.inf and abs(angle) < math.inf):
        return BAD_INPUT, 0.0, 0.0, 0.0, 1.0
    sine, cosine = sine_cosine(0.5 * angle)
    return 0, x / norm * sine, y / norm * sine, z / norm * sine, cosine


@lean
def _of_rodrigues_vector(x, y, z):
    """Return status and quaternion of ``e tan(phi/2)``."""
    tangent = length(x, y, z)
    if not tangent < math.inf:
        return BAD_INPUT, 0.0, 0.0, 0.0, 1.0
    if tangent > 1.0:
        w = 1.0 / tangent
        factor = w / math.sqrt(1.0 + w * w)
        return 0, x * factor, y * factor, z * factor, w / math.sqrt(1.0 + w * w)
    w = 1.0 / math.sqrt(1.0 + tangent * tangent)
    return 0, x * w, y * w, z * w, w


@lean
def _of_linear_invariants(x, y, z, q0):
    """Return status and quaternion of ``e sin(phi)`` and ``cos(phi)``."""
    sine = length(x, y, z)
    norm = math.sqrt(sine * sine + q0 * q0)
    if not abs(norm - 1.0) <= UNIT_NORM:
        return BAD_INPUT, 0.0, 0.0, 0.0, 1.0
    if q0 >= 0.0:
        w = math.sqrt(0.5 * (1.0 + q0 / norm))
        factor = 0.5 / (w * norm)
        return 0, x * factor, y * factor, z * factor, w
    if sine == 0.0:
        return HALF_TURN, 0.0, 0.0, 0.0, 1.0
    half = math.sqrt(0.5 * (1.0 - q0 / norm))
    factor = half / sine
    return 0, x * factor, y * factor, z * factor, 0.5 * sine / (half * norm)


@lean
def euler_axes(kind):
    """Return axes i and j, the third axis, their parity, whether k is i, and whether all are fixed.

    Rotations about fixed axes are those about moving axes in the opposite order, so i is then the
    axis of the last rotation.
    """
    code = kind - EULER
    i, j, k, fixed = code % 3, code // 3 % 3, code // 9 % 3, code // 27 > 0
    if fixed:
        i, k = k, i
    other = 3 - i - j
    parity = 1.0 if (j - i) % 3 == 1 else -1.0
    return i, j, other, parity, k == i, fixed


@lean
def _placed(i, j, at_i, at_j, at_other):
    """Return components along axes i, j and the third axis in the order x, y, z."""
    x = at_i if i == 0 else (at_j if j == 0 else at_other)
    y = at_i if i == 1 else (at_j if j == 1 else at_other)
    z = at_i if i == 2 else (at_j if j == 2 else at_other)
    return x, y, z


@lean
def _of_euler_angles(kind, first, second, third):
    if not abs(first) + abs(second) + abs(third) < math.inf:
        return BAD_INPUT, 0.0, 0.0, 0.0, 1.0
    i, j, _, parity, proper, fixed = euler_axes(kind)
    if fixed:
        first, third = third, first
    s1, c1 = sine_cosine(0.5 * first)
    s2, c2 = sine_cosine(0.5 * second)
    s3, c3 = sine_cosine(0.5 * third)
    w, at_i, at_j, at_other = c1 * c2, s1 * c2, c1 * s2, parity * s1 * s2
    if proper:
        w, at_i = w * c3 - at_i * s3, at_i * c3 + w * s3
        at_j, at_other = (at_j * c3 + parity * at_other * s3, at_other * c3 - parity * at_j * s3)
    else:
        w, at_other = w * c3 - at_other * s3, at_other * c3 + w * s3
        at_i, at_j = at_i * c3 + parity * at_j * s3, at_j * c3 - parity * at_i * s3
    x, y, z = _placed(i, j, at_i, at_j, at_other)
    return 0, x, y, z, w


@lean
def decoded(kind, rows, k):
    """Return status and quaternion, of either sign, of row k."""
    if kind == MATRIX:
        return quaternion_of_matrix(
            rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5], rows[k, 6],
            rows[k, 7], rows[k, 8],
        )  # fmt: skip
    if kind == ROTATION_VECTOR:
        x, y, z, w = quaternion_of_vector(rows[k, 0], rows[k, 1], rows[k, 2])
        return (0 if abs(w) <= 2.0 else BAD_INPUT), x, y, z, w
    if kind == QUATERNION:
        return _of_quaternion(rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3])
    if kind == AXIS_ANGLE:
        return _of_axis_angle(rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3])
    if kind == RODRIGUES_VECTOR:
        return _of_rodrigues_vector(rows[k, 0], rows[k, 1], rows[k, 2])
    if kind == LINEAR_INVARIANTS:
        return _of_linear_invariants(rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3])
    return _of_euler_angles(kind, rows[k, 0], rows[k, 1], rows[k, 2])


@lean
def _write_axis_angle(x, y, z, w, out, row):
    sine = length(x, y, z)
    if sine == 0.0:
        x, y, z, sine = 0.0, 0.0, 0.0, 0.0
        out[row, 0], out[row, 1], out[row, 2], out[row, 3] = 0.0, 0.0, 1.0, 0.0
        return
    out[row, 0], out[row, 1], out[row, 2] = x / sine, y / sine, z / sine
    out[row, 3] = 2.0 * angle_of(sine, w)


@lean
def _write_euler_angles(kind, x, y, z, w, out, row):
    i, j, other, parity, proper, fixed = euler_axes(kind)
    at_i = x if i == 0 else (y if i == 1 else z)
    at_j = x if j == 0 else (y if j == 1 else z)
    at_other = parity * (x if other == 0 else (y if other == 1 else z))
    if proper:
        # (a, b): cosine and sine of half the difference of outer angles; (c, d): of half their sum.
        a, b, c, d = at_j, at_other, w, at_i
    else:
        a, b, c, d = w - at_j, at_i - at_other, w + at_j, at_i + at_other
    differing, summed = a * a + b * b, c * c + d * d
    if proper:
        middle = 2.0 * angle_of(math.sqrt(differing), math.sqrt(summed))
    else:
        middle = angle_of(
            2.0 * (w * at_j + at_i * at_other), math.sqrt(differing) * math.sqrt(summed)
        )
    half_difference, half_sum = angle_of(b + 0.0, a + 0.0), angle_of(d + 0.0, c + 0.0)
    # If the outer axes are parallel, only one angle is determined; the third is 0.  With fixed
    # axes, that is the first here.
    sign = -1.0 if fixed else 1.0
    if differing < _LOCKED:
        half_difference = sign * half_sum
    elif summed < _LOCKED:
        half_sum = sign * half_difference
    first, third = half_sum + half_difference, half_sum - half_difference
    if not proper:
        third *= parity
    if fixed:
        first, third = third, first
    out[row, 0], out[row, 1], out[row, 2] = wrapped(first) + 0.0, middle + 0.0, wrapped(third) + 0.0


@lean
def encode(kind, x, y, z, w, out, row):
    """Write a canonical quaternion to a row as another representation; return the status."""
    if kind == MATRIX:
        write_matrix(x, y, z, w, out, row)
    elif kind == ROTATION_VECTOR:
        out[row, 0], out[row, 1], out[row, 2] = vector_of_quaternion(x, y, z, w)
    elif kind == QUATERNION:
        out[row, 0], out[row, 1], out[row, 2], out[row, 3] = x, y, z, w
    elif kind == AXIS_ANGLE:
        _write_axis_angle(x, y, z, w, out, row)
    elif kind == RODRIGUES_VECTOR:
        if w < _NOTHING:
            return HALF_TURN
        out[row, 0], out[row, 1], out[row, 2] = x / w, y / w, z / w
    elif kind == LINEAR_INVARIANTS:
        twice = 2.0 * w
        out[row, 0], out[row, 1], out[row, 2] = twice * x, twice * y, twice * z
        out[row, 3] = w * w - (x * x + y * y + z * z)
    else:
        _write_euler_angles(kind, x, y, z, w, out, row)
    return 0
