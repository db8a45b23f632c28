"""Postures of seven revolute joints, spherical at shoulder and wrist, for an arm angle.

The distance between both centres gives joint 4.  Shoulder, elbow and wrist are then a rigid
triangle that can turn about the line between the centres; the arm angle is that of the elbow,
measured from a reference direction.  The rotation of the upper arm gives joints 1 to 3, and the
remaining rotation of the tip joints 5 to 7: up to eight postures.

References
----------
M. Shimizu, H. Kakuya, W.-K. Yoon, K. Kitagaki and K. Kosuge, Analytical inverse kinematic
computation for 7-DOF redundant manipulators with joint limits, IEEE Trans. Robotics 24(5), 2008.
"""

import math

from robomech_ros._kernels.algebra.angles import angle_of, wrapped
from robomech_ros._kernels.algebra.polynomials import order_one_roots
from robomech_ros._kernels.compiling.jit import inline, kernel, linked, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT2, ZERO, f8, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.decoupled import layout as wrist_at
from robomech_ros._kernels.inverse.decoupled.wrist import spherical_wrist
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.vectors import rotated_back_by, turned
from robomech_ros._kernels.spatial.vectors import (
    combined,
    cross,
    dot,
    mixed,
    product,
    scaled,
    times,
)
from robomech_ros._kernels.tolerances import ACCEPTED, ON_AXIS, ON_BOUNDARY, PARALLEL_AXES


@inline
def parts_of(data):
    """Return the packed chain (8, 13) and the constants of the arm."""
    packed = data[at.PARTS : at.ARM].reshape((8, 13))
    return packed, data[at.ARM :]


@inline
def _vector(data, k):
    return data[k], data[k + 1], data[k + 2]


@inline
def _scaled(u, factor):
    return u[0] * factor, u[1] * factor, u[2] * factor


@inline
def _shoulder_to(packed, parts):
    """Return the vector from the shoulder to joint 4, in the frame that moves with joint 3."""
    sx, sy, sz = _vector(parts, at.CENTRE_3)
    return packed[3, 10] - sx, packed[3, 11] - sy, packed[3, 12] - sz


@inline
def to_wrist(packed, parts, cosine, sine):
    """Return the vector from shoulder to wrist in the frame that moves with joint 3."""
    wx, wy, wz = _vector(parts, at.CENTRE_4)
    x, y, z = turned(packed, 3, (cosine * wx - sine * wy, sine * wx + cosine * wy, wz))
    ux, uy, uz = _shoulder_to(packed, parts)
    return x + ux, y + uy, z + uz


@inline
def _perpendicular(along, v):
    """Return direction and length of the component of v perpendicular to unit vector ``along``."""
    part = dot(along, v)
    x, y, z = v[0] - part * along[0], v[1] - part * along[1], v[2] - part * along[2]
    length = math.sqrt(x * x + y * y + z * z)
    inverse = 1.0 / length if length > 0.0 else 0.0
    return (x * inverse, y * inverse, z * inverse), length


@inline
def arm_triad(packed, parts, p):
    """Return the arm's axes in the frame behind joint 3: to the wrist, to the elbow, normal."""
    inverse = 1.0 / math.sqrt(dot(p, p))
    along = _scaled(p, inverse)
    axis = (packed[3, 3], packed[3, 6], packed[3, 9])
    side, _ = _perpendicular(along, cross(axis, along))
    ex, ey, ez = _vector(parts, at.ELBOW)
    sx, sy, sz = _vector(parts, at.CENTRE_3)
    if dot(side, (ex - sx, ey - sy, ez - sz)) < 0.0:
        side = _scaled(side, -1.0)
    return along, side, cross(along, side)


@inline
def base_triad(parts, d):
    """Return axes in the base: to the wrist, the reference perpendicular to it, their normal."""
    inverse = 1.0 / math.sqrt(dot(d, d))
    along = _scaled(d, inverse)
    side, length = _perpendicular(along, _vector(parts, at.REFERENCE))
    if length < ON_BOUNDARY:
        side, length = _perpendicular(along, _vector(parts, at.OTHER))
    return along, side, cross(along, side)


@inline
def product_of(a, b):
    """Return a^T b for rotations given as three rows."""
    x = mixed((a[0][0], a[1][0], a[2][0]), b[0], b[1], b[2])
    y = mixed((a[0][1], a[1][1], a[2][1]), b[0], b[1], b[2])
    return x + y + mixed((a[0][2], a[1][2], a[2][2]), b[0], b[1], b[2])


@inline
def upper_arm(base, arm, cosine, sine):
    """Return the rotation, in rows, from the arm's axes to the base's turned by the arm angle."""
    d, e, n = base
    ex, ey, ez = combined(scaled(e, cosine), n, sine)
    nx, ny, nz = combined(scaled(n, cosine), e, -sine)
    return product(((d[0], ex, nx), (d[1], ey, ny), (d[2], ez, nz)), arm)


@inline
def rows_of(packed, row):
    """Return the rows of the rotation of a constant transform."""
    return (
        (packed[row, 1], packed[row, 2], packed[row, 3]),
        (packed[row, 4], packed[row, 5], packed[row, 6]),
        (packed[row, 7], packed[row, 8], packed[row, 9]),
    )


@inline
def wrist_rotation(packed, T, R, cosine, sine):
    """Return Rz(q_5) C_5 Rz(q_6) C_6 Rz(q_7), the remaining rotation, in nine numbers."""
    # R C_3 Rz(q_4) C_4.
    a, b, c = rows_of(packed, 4)
    a, b = combined(scaled(a, cosine), b, -sine), combined(scaled(a, sine), b, cosine)
    upper = product(R, product(rows_of(packed, 3), (a, b, c)))
    h = (
        turned(packed, 7, (T[0, 0], T[0, 1], T[0, 2])),
        turned(packed, 7, (T[1, 0], T[1, 1], T[1, 2])),
        turned(packed, 7, (T[2, 0], T[2, 1], T[2, 2])),
    )
    return product_of(upper, h)


@inline
def _enter(parts, first, q4, last, q):
    """Write the seven joint values, in (-pi, pi]."""
    for j in range(3):
        q[j] = wrapped(first[j] - parts[at.SHOULDER + j])
        q[4 + j] = wrapped(last[j] - parts[at.WRIST + j])
    q[3] = wrapped(q4)


@inline
def _spherical(data, block):
    """Return the constants of a spherical joint in the layout of :func:`spherical_wrist`."""
    return data[at.ARM + block - wrist_at.ANGLES :]


@inline
def elbows(data, T):
    """Return the number of values of joint 4, their cosines and sines, and the wrist vector."""
    packed, parts = parts_of(data)
    x, y, z = times(T, _vector(parts, at.CENTRE_7))
    start = _vector(parts, at.CENTRE_0)
    d = x + T[0, 3] - start[0], y + T[1, 3] - start[1], z + T[2, 3] - start[2]
    unit = 1.0 / (data[at.SIZE] * data[at.SIZE])
    square = dot(d, d)
    if square * unit < ON_AXIS:
        return ZERO, (1.0, 0.0, 1.0, 0.0), d
    w = _vector(parts, at.CENTRE_4)
    u = _shoulder_to(packed, parts)
    ux, uy, uz = rotated_back_by(packed, 3, u)
    constant = dot(w, w) + dot(u, u) + 2.0 * uz * w[2] - square
    roots, c1, s1, c2, s2 = order_one_roots(
        constant * unit,
        2.0 * (ux * w[0] + uy * w[1]) * unit,
        2.0 * (uy * w[0] - ux * w[1]) * unit,
        data[at.SLACK],
    )
    return roots, (c1, s1, c2, s2), d


@kernel(i8(IN1, IN2, IN1, f8, OUT2, IOUT1))
def arm_angle_postures(data, T, seed, angle, q, branch):
    """Write the postures for the pose T (4, 4) with this arm angle to q (8, 7).

    A joint that is free in a singular shoulder or wrist takes the value of ``seed`` (7,).
    Returns the number of postures.
    """
    packed, parts = parts_of(data)
    roots, (c1, s1, c2, s2), d = elbows(data, T)
    if roots == 0:
        return ZERO
    shoulder = _spherical(data, at.SHOULDER)
    wrist = _spherical(data, at.WRIST)
    base = base_triad(parts, d)
    cosine, sine = math.cos(angle), math.sin(angle)
    firsts = scratch(2, 3)
    lasts = scratch(2, 3)
    count = ZERO
    for root in range(roots):
        c, s = (c1, s1) if root == 0 else (c2, s2)
        arm = arm_triad(packed, parts, to_wrist(packed, parts, c, s))
        R = upper_arm(base, arm, cosine, sine)
        turn = product_of(rows_of(packed, 0), R)
        n, _ = spherical_wrist(
            shoulder, turn, seed[0] + parts[at.SHOULDER], ACCEPTED, PARALLEL_AXES, firsts
        )
        if n == 0:
            continue
        rest = wrist_rotation(packed, T, R, c, s)
        m, _ = spherical_wrist(
            wrist, rest, seed[4] + parts[at.WRIST], ACCEPTED, PARALLEL_AXES, lasts
        )
        q4 = angle_of(s, c)
        for i in range(n):
            for j in range(m):
                _enter(parts, firsts[i], q4, lasts[j], q[count])
                bits = bit.SHOULDER_RIGHT if i == 1 else 0
                bits |= bit.ELBOW_DOWN if root == 1 else 0
                bits |= bit.WRIST_FLIP if j == 1 else 0
                branch[count] = bits | bit.SELF_MOTION
                count += 1
    return count


@kernel(f8(IN1, IN1))
def arm_angle(data, q):
    """Return the arm angle (rad) of the posture q (7,)."""
    packed, parts = parts_of(data)
    p = to_wrist(packed, parts, math.cos(q[3]), math.sin(q[3]))
    _, side, _ = arm_triad(packed, parts, p)
    for j in range(2, -1, -1):
        c, s = math.cos(q[j]), math.sin(q[j])
        p = (c * p[0] - s * p[1], s * p[0] + c * p[1], p[2])
        side = (c * side[0] - s * side[1], s * side[0] + c * side[1], side[2])
        p = turned(packed, j, p)
        side = turned(packed, j, side)
    _, reference, normal = base_triad(parts, p)
    return math.atan2(dot(side, normal), dot(side, reference))


call_arm_angle_postures = linked(arm_angle_postures)
call_arm_angle = linked(arm_angle)
