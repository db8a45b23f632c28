"""Bodies and joint axes of a chain in the axes of the base.

All quantities refer to one point, the origin of the last joint.  So nothing is transformed from
link to link, and the small moments of a wrist lose no digits to its distance from the base.
Motions are [omega; v] and forces [n; f]; v is the velocity of the body at the reference point.
"""

import math

from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import fused
from robomech_ros._kernels.dynamics.inverse import step_between


@fused
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@fused
def _times(v, rows):
    """Multiply a row of three by a matrix of three rows."""
    a, b, c = rows
    return (
        v[0] * a[0] + v[1] * b[0] + v[2] * c[0],
        v[0] * a[1] + v[1] * b[1] + v[2] * c[1],
        v[0] * a[2] + v[1] * b[2] + v[2] * c[2],
    )


@fused
def place_frames(model, q, frames):
    """Write rotation and origin in the base (n, 12) of the frame of every link.

    Returns the status, the origin of the last joint, and the vector from there to the tip.
    """
    count = model.shape[0] - 1
    a, b, c = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    x, y, z = 0.0, 0.0, 0.0
    status = OK
    for i in range(count):
        if not math.isfinite(q[i]):
            status = NOT_FINITE
        E = step_between(model, i, q[i])
        step, rows = E[9:], (E[:3], E[3:6], E[6:9])
        x, y, z = x + _dot(a, step), y + _dot(b, step), z + _dot(c, step)
        a, b, c = _times(a, rows), _times(b, rows), _times(c, rows)
        frames[i, 0], frames[i, 1], frames[i, 2] = a
        frames[i, 3], frames[i, 4], frames[i, 5] = b
        frames[i, 6], frames[i, 7], frames[i, 8] = c
        frames[i, 9], frames[i, 10], frames[i, 11] = x, y, z
    tip = model[count, 10], model[count, 11], model[count, 12]
    return status, (x, y, z), (_dot(a, tip), _dot(b, tip), _dot(c, tip))


@fused
def placed_axis(model, frames, i, point):
    """Return the axis (6) of joint i about a reference point."""
    ex, ey, ez = frames[i, 2], frames[i, 5], frames[i, 8]
    if model[i, 0] != 0.0:
        return (0.0, 0.0, 0.0, ex, ey, ez)
    dx, dy, dz = frames[i, 9] - point[0], frames[i, 10] - point[1], frames[i, 11] - point[2]
    return (ex, ey, ez, dy * ez - dz * ey, dz * ex - dx * ez, dx * ey - dy * ex)


@fused
def placed_body(model, frames, i, point):
    """Return the inertial parameters (10) of link i about a point, in the axes of the base."""
    a = frames[i, 0], frames[i, 1], frames[i, 2]
    b = frames[i, 3], frames[i, 4], frames[i, 5]
    c = frames[i, 6], frames[i, 7], frames[i, 8]
    dx, dy, dz = frames[i, 9] - point[0], frames[i, 10] - point[1], frames[i, 11] - point[2]
    m, hx, hy, hz = model[i, 13], model[i, 14], model[i, 15], model[i, 16]
    xx, xy, xz = model[i, 17], model[i, 18], model[i, 19]
    yy, yz, zz = model[i, 20], model[i, 21], model[i, 22]
    moment, inertia = (hx, hy, hz), ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    sx, sy, sz = _dot(a, moment), _dot(b, moment), _dot(c, moment)
    # R I, then R I R^T.
    p, q, r = _times(a, inertia), _times(b, inertia), _times(c, inertia)
    # The first moment about the reference point, and its sum with that about the link's origin.
    gx, gy, gz = sx + m * dx, sy + m * dy, sz + m * dz
    kx, ky, kz = dx * (sx + gx), dy * (sy + gy), dz * (sz + gz)
    return (
        m,
        gx,
        gy,
        gz,
        _dot(p, a) + ky + kz,
        _dot(p, b) - dx * sy - gx * dy,
        _dot(p, c) - dx * sz - gx * dz,
        _dot(q, b) + kx + kz,
        _dot(q, c) - dy * sz - gy * dz,
        _dot(r, c) + kx + ky,
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
    """Return the composite (10) of two bodies."""
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
    """Return the force (6) that is the inertia of a body (10) times a motion (6)."""
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
    """Return the rate a x b of a motion b (6) that moves with the motion a (6)."""
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
    """Return the rate a x* f of a force f (6) that moves with the motion a (6)."""
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
    """Return the scalar product of a (6) and b (6)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]


@fused
def base_motion(around, point):
    """Return velocity (6) and acceleration (6) of the base less gravity, about a point.

    The velocity of the base's origin is assumed to be zero, which changes no torque.
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
    """Return the wrench on the tip (6) about the point from which ``tip`` is the vector."""
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
