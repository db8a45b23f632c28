"""The matrix by which the bodies' parameters give the torques.

The torques are linear in the ten numbers of each body that ``dynamics.layout`` names.  Source:
Atkeson, An, Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J.
Robotics Research 5, 1986.
"""

import math

from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN2, OUT3, i8
from robomech_ros._kernels.dynamics.base_frame import place_frames, placed_axis, six, write_six
from robomech_ros._kernels.dynamics.inverse import cross, into, step_between
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS


@lean
def _next_motion(motion, E, slides, rate, gain):
    """Go from the motion of a link, [omega, alpha, a of its origin], to that of the next."""
    wx, wy, wz, bx, by, bz, ax, ay, az = motion
    x, y, z = E[9], E[10], E[11]
    ux, uy, uz = cross(wx, wy, wz, x, y, z)
    cx, cy, cz = cross(wx, wy, wz, ux, uy, uz)
    ux, uy, uz = cross(bx, by, bz, x, y, z)
    ax, ay, az = into(E, ax + ux + cx, ay + uy + cy, az + uz + cz)
    wx, wy, wz = into(E, wx, wy, wz)
    bx, by, bz = into(E, bx, by, bz)
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
def _write_row(turning, moving, motion, row):
    """Write what the ten parameters of a body give along an axis, both in its frame."""
    wx, wy, wz, bx, by, bz, ax, ay, az = motion
    ex, ey, ez = turning
    vx, vy, vz = moving
    row[0] = vx * ax + vy * ay + vz * az
    # Transposed [alpha x] + [omega x]^2 times v, plus a x e.
    ux, uy, uz = cross(vx, vy, vz, bx, by, bz)
    along = wx * vx + wy * vy + wz * vz
    square = wx * wx + wy * wy + wz * wz
    cx, cy, cz = cross(ax, ay, az, ex, ey, ez)
    row[1] = ux + along * wx - square * vx + cx
    row[2] = uy + along * wy - square * vy + cy
    row[3] = uz + along * wz - square * vz + cz
    # e . (I alpha + omega x I omega) = sum of I times (e alpha^T + (e x omega) omega^T).
    px, py, pz = cross(ex, ey, ez, wx, wy, wz)
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
    motion = six(around) + (around[6], around[7], around[8])
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
            cx, cy, cz = cross(ex, ey, ez, dx, dy, dz)
            turning, moving = into(F, ex, ey, ez), into(F, vx + cx, vy + cy, vz + cz)
            _write_row(turning, moving, motion, row)
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
