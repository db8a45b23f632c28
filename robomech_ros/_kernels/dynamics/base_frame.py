"""The bodies and the joint axes of a chain in the axes of the base.

All is seen from one point, the origin of the last joint, so that nothing has to be carried from
link to link, and the small moments of a wrist lose no digits to its distance from the base.
Motions are [omega; v] and forces [n; f], v the velocity of the point of the body that passes there.
"""

import math

from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import fused
from robomech_ros._kernels.dynamics.inverse import step_between


@fused
def place_frames(model, q, frames):
    """Write rotation and origin in the base (n, 12) of the frame of every link.

    Returns the status, the origin of the last joint, and the tip seen from there.
    """
    count = model.shape[0] - 1
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    x, y, z = 0.0, 0.0, 0.0
    status = OK
    for i in range(count):
        if not math.isfinite(q[i]):
            status = NOT_FINITE
        E = step_between(model, i, q[i])
        x += r00 * E[9] + r01 * E[10] + r02 * E[11]
        y += r10 * E[9] + r11 * E[10] + r12 * E[11]
        z += r20 * E[9] + r21 * E[10] + r22 * E[11]
        r00, r01, r02 = (
            r00 * E[0] + r01 * E[3] + r02 * E[6],
            r00 * E[1] + r01 * E[4] + r02 * E[7],
            r00 * E[2] + r01 * E[5] + r02 * E[8],
        )
        r10, r11, r12 = (
            r10 * E[0] + r11 * E[3] + r12 * E[6],
            r10 * E[1] + r11 * E[4] + r12 * E[7],
            r10 * E[2] + r11 * E[5] + r12 * E[8],
        )
        r20, r21, r22 = (
            r20 * E[0] + r21 * E[3] + r22 * E[6],
            r20 * E[1] + r21 * E[4] + r22 * E[7],
            r20 * E[2] + r21 * E[5] + r22 * E[8],
        )
        frames[i, 0], frames[i, 1], frames[i, 2] = r00, r01, r02
        frames[i, 3], frames[i, 4], frames[i, 5] = r10, r11, r12
        frames[i, 6], frames[i, 7], frames[i, 8] = r20, r21, r22
        frames[i, 9], frames[i, 10], frames[i, 11] = x, y, z
    tx, ty, tz = model[count, 10], model[count, 11], model[count, 12]
    tip = (
        r00 * tx + r01 * ty + r02 * tz,
        r10 * tx + r11 * ty + r12 * tz,
        r20 * tx + r21 * ty + r22 * tz,
    )
    return status, (x, y, z), tip


@fused
def placed_axis(model, frames, i, point):
    """Return the axis (6) of joint i, seen from a point."""
    ex, ey, ez = frames[i, 2], frames[i, 5], frames[i, 8]
    if model[i, 0] != 0.0:
        return (0.0, 0.0, 0.0, ex, ey, ez)
    dx, dy, dz = frames[i, 9] - point[0], frames[i, 10] - point[1], frames[i, 11] - point[2]
    return (ex, ey, ez, dy * ez - dz * ey, dz * ex - dx * ez, dx * ey - dy * ex)


@fused
def placed_body(model, frames, i, point):
    """Return the body (10) of link i, seen from a point, in the axes of the base."""
    a0, a1, a2 = frames[i, 0], frames[i, 1], frames[i, 2]
    b0, b1, b2 = frames[i, 3], frames[i, 4], frames[i, 5]
    c0, c1, c2 = frames[i, 6], frames[i, 7], frames[i, 8]
    dx, dy, dz = frames[i, 9] - point[0], frames[i, 10] - point[1], frames[i, 11] - point[2]
    m, hx, hy, hz = model[i, 13], model[i, 14], model[i, 15], model[i, 16]
    xx, xy, xz = model[i, 17], model[i, 18], model[i, 19]
    yy, yz, zz = model[i, 20], model[i, 21], model[i, 22]
    sx = a0 * hx + a1 * hy + a2 * hz
    sy = b0 * hx + b1 * hy + b2 * hz
    sz = c0 * hx + c1 * hy + c2 * hz
    # R I, then R I R^T.
    px, py, pz = (
        xx * a0 + xy * a1 + xz * a2,
        xy * a0 + yy * a1 + yz * a2,
        xz * a0 + yz * a1 + zz * a2,
    )
    qx, qy, qz = (
        xx * b0 + xy * b1 + xz * b2,
        xy * b0 + yy * b1 + yz * b2,
        xz * b0 + yz * b1 + zz * b2,
    )
    rx, ry, rz = (
        xx * c0 + xy * c1 + xz * c2,
        xy * c0 + yy * c1 + yz * c2,
        xz * c0 + yz * c1 + zz * c2,
    )
    # About the other point: the first moment about it, plus the one about the link's own origin.
    gx, gy, gz = sx + m * dx, sy + m * dy, sz + m * dz
    kx, ky, kz = dx * (sx + gx), dy * (sy + gy), dz * (sz + gz)
    return (
        m,
        gx,
        gy,
        gz,
        px * a0 + py * a1 + pz * a2 + ky + kz,
        px * b0 + py * b1 + pz * b2 - dx * sy - gx * dy,
        px * c0 + py * c1 + pz * c2 - dx * sz - gx * dz,
        qx * b0 + qy * b1 + qz * b2 + kx + kz,
        qx * c0 + qy * c1 + qz * c2 - dy * sz - gy * dz,
        rx * c0 + ry * c1 + rz * c2 + kx + ky,
    )


@fused
def six(row):
    """Read a row of six numbers."""
    return (row[0], row[1], row[2], row[3], row[4], row[5])


@fused
def write_six(row, values):
    """Write a row of six numbers."""
    row[0], row[1], row[2] = values[0], values[1], values[2]
    row[3], row[4], row[5] = values[3], values[4], values[5]


@fused
def plus(a, b, factor):
    """Return a (6) plus a multiple of b (6)."""
    return (
        a[0] + b[0] * factor,
        a[1] + b[1] * factor,
        a[2] + b[2] * factor,
        a[3] + b[3] * factor,
        a[4] + b[4] * factor,
        a[5] + b[5] * factor,
    )


@fused
def joined(a, b):
    """Make one body (10) of two."""
    return (
        a[0] + b[0],
        a[1] + b[1],
        a[2] + b[2],
        a[3] + b[3],
        a[4] + b[4],
        a[5] + b[5],
        a[6] + b[6],
        a[7] + b[7],
        a[8] + b[8],
        a[9] + b[9],
    )


@fused
def inertia_times(body, motion):
    """Multiply a body (10) by a motion (6): a force (6)."""
    m, hx, hy, hz = body[0], body[1], body[2], body[3]
    wx, wy, wz = motion[0], motion[1], motion[2]
    vx, vy, vz = motion[3], motion[4], motion[5]
    return (
        body[4] * wx + body[5] * wy + body[6] * wz + hy * vz - hz * vy,
        body[5] * wx + body[7] * wy + body[8] * wz + hz * vx - hx * vz,
        body[6] * wx + body[8] * wy + body[9] * wz + hx * vy - hy * vx,
        m * vx + wy * hz - wz * hy,
        m * vy + wz * hx - wx * hz,
        m * vz + wx * hy - wy * hx,
    )


@fused
def motion_cross(a, b):
    """Return the rate of a motion b (6) that moves with a (6)."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
        a[1] * b[5] - a[2] * b[4] + a[4] * b[2] - a[5] * b[1],
        a[2] * b[3] - a[0] * b[5] + a[5] * b[0] - a[3] * b[2],
        a[0] * b[4] - a[1] * b[3] + a[3] * b[1] - a[4] * b[0],
    )


@fused
def force_cross(a, f):
    """Return the rate of a force f (6) that moves with a (6)."""
    return (
        a[1] * f[2] - a[2] * f[1] + a[4] * f[5] - a[5] * f[4],
        a[2] * f[0] - a[0] * f[2] + a[5] * f[3] - a[3] * f[5],
        a[0] * f[1] - a[1] * f[0] + a[3] * f[4] - a[4] * f[3],
        a[1] * f[5] - a[2] * f[4],
        a[2] * f[3] - a[0] * f[5],
        a[0] * f[4] - a[1] * f[3],
    )


@fused
def dot(a, b):
    """Multiply six numbers by six."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]


@fused
def base_motion(around, point):
    """Return the base's velocity (6) and acceleration (6) less gravity, both as motions.

    The base's origin is taken to stand still for the moment, which no torque notices.
    """
    x, y, z = point
    wx, wy, wz = around[0], around[1], around[2]
    bx, by, bz = around[3], around[4], around[5]
    velocity = (wx, wy, wz, wy * z - wz * y, wz * x - wx * z, wx * y - wy * x)
    acceleration = (
        bx,
        by,
        bz,
        around[6] + by * z - bz * y,
        around[7] + bz * x - bx * z,
        around[8] + bx * y - by * x,
    )
    return velocity, acceleration


@fused
def wrench_about(around, tip):
    """Return the wrench on the tip (6) as seen from the point that the tip is seen from."""
    x, y, z = tip
    fx, fy, fz = around[12], around[13], around[14]
    return (
        around[9] + y * fz - z * fy,
        around[10] + z * fx - x * fz,
        around[11] + x * fy - y * fx,
        fx,
        fy,
        fz,
    )
