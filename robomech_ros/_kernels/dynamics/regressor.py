"""The matrix by which the bodies' parameters give the torques.

The torques are linear in the ten numbers of each body that ``dynamics.layout`` names.  Source:
Atkeson, An, Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J.
Robotics Research 5, 1986.
"""

import math

from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import IN2, OUT3, i8, kernel, lean, scratch
from robomech_ros._kernels.dynamics.base_frame import place_frames, placed_axis, six, write_six
from robomech_ros._kernels.dynamics.inverse import step_between
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS


@lean
def _cross(ax, ay, az, bx, by, bz):
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@lean
def _next_motion(motion, E, slides, rate, gain):
    """Go from the motion of a link, [omega, alpha, a of its origin], to that of the next."""
    wx, wy, wz, bx, by, bz, ax, ay, az = motion
    x, y, z = E[9], E[10], E[11]
    ux, uy, uz = _cross(wx, wy, wz, x, y, z)
    cx, cy, cz = _cross(wx, wy, wz, ux, uy, uz)
    ux, uy, uz = _cross(bx, by, bz, x, y, z)
    ax, ay, az = ax + ux + cx, ay + uy + cy, az + uz + cz
    ax, ay, az = (
        E[0] * ax + E[3] * ay + E[6] * az,
        E[1] * ax + E[4] * ay + E[7] * az,
        E[2] * ax + E[5] * ay + E[8] * az,
    )
    wx, wy, wz = (
        E[0] * wx + E[3] * wy + E[6] * wz,
        E[1] * wx + E[4] * wy + E[7] * wz,
        E[2] * wx + E[5] * wy + E[8] * wz,
    )
    bx, by, bz = (
        E[0] * bx + E[3] * by + E[6] * bz,
        E[1] * bx + E[4] * by + E[7] * bz,
        E[2] * bx + E[5] * by + E[8] * bz,
    )
    if slides:
        ax += 2.0 * wy * rate
        ay -= 2.0 * wx * rate
        az += gain
    else:
        bx += wy * rate
        by -= wx * rate
        bz += gain
        wz += rate
    return wx, wy, wz, bx, by, bz, ax, ay, az


@lean
def _write_row(s, motion, row):
    """Write what the ten parameters of a body give along an axis s (6), both in its frame."""
    wx, wy, wz, bx, by, bz, ax, ay, az = motion
    ex, ey, ez, vx, vy, vz = s
    row[0] = vx * ax + vy * ay + vz * az
    # Transposed [alpha x] + [omega x]^2 times v, plus a x e.
    ux, uy, uz = _cross(vx, vy, vz, bx, by, bz)
    along = wx * vx + wy * vy + wz * vz
    square = wx * wx + wy * wy + wz * wz
    cx, cy, cz = _cross(ax, ay, az, ex, ey, ez)
    row[1] = ux + along * wx - square * vx + cx
    row[2] = uy + along * wy - square * vy + cy
    row[3] = uz + along * wz - square * vz + cz
    # e . (I alpha + omega x I omega) = sum of I times (e alpha^T + (e x omega) omega^T).
    px, py, pz = _cross(ex, ey, ez, wx, wy, wz)
    row[4] = ex * bx + px * wx
    row[5] = ex * by + ey * bx + px * wy + py * wx
    row[6] = ex * bz + ez * bx + px * wz + pz * wx
    row[7] = ey * by + py * wy
    row[8] = ey * bz + ez * by + py * wz + pz * wy
    row[9] = ez * bz + pz * wz


@lean
def _regressor_body(packed, q, qd, qdd, around, Y):
    frames = scratch(MOST_JOINTS, 12)
    axes = scratch(MOST_JOINTS, 6)
    status, point, _ = place_frames(packed, q, frames)
    motion = (
        around[0],
        around[1],
        around[2],
        around[3],
        around[4],
        around[5],
        around[6],
        around[7],
        around[8],
    )
    count = packed.shape[0] - 1
    for k in range(count):
        E = step_between(packed, k, q[k])
        motion = _next_motion(motion, E, packed[k, 0] != 0.0, qd[k], qdd[k])
        write_six(axes[k], placed_axis(packed, frames, k, point))
        F = frames[k]
        dx, dy, dz = F[9] - point[0], F[10] - point[1], F[11] - point[2]
        for i in range(count):
            row = Y[i, 10 * k : 10 * k + 10]
            if i > k:
                for j in range(10):
                    row[j] = 0.0
                continue
            ex, ey, ez, vx, vy, vz = six(axes[i])
            cx, cy, cz = _cross(ex, ey, ez, dx, dy, dz)
            vx, vy, vz = vx + cx, vy + cy, vz + cz
            s = (
                F[0] * ex + F[3] * ey + F[6] * ez,
                F[1] * ex + F[4] * ey + F[7] * ez,
                F[2] * ex + F[5] * ey + F[8] * ez,
                F[0] * vx + F[3] * vy + F[6] * vz,
                F[1] * vx + F[4] * vy + F[7] * vz,
                F[2] * vx + F[5] * vy + F[8] * vz,
            )
            _write_row(s, motion, row)
            for j in range(10):
                if not math.isfinite(row[j]):
                    status = NOT_FINITE
    return status


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT3))
def torque_regressor(packed, q, qd, qdd, around, out):
    """Regressors for states (m, n) into out (m, n, 10 n); ``around`` has m rows, or one for all."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= _regressor_body(packed, q[k], qd[k], qdd[k], around[min(k, last)], out[k])
    return status
