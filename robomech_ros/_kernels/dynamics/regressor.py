"""Regressor: the matrix from the inertial parameters of the bodies to the torques.

The torques are linear in the ten parameters of each body in ``dynamics.layout``.  Source:
Atkeson, An, Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J.
Robotics Research 5, 1986.
"""

import math

from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN2, OUT3, i8
from robomech_ros._kernels.dynamics.base_frame import place_frames, placed_axis, write_six
from robomech_ros._kernels.dynamics.inverse import into, next_motion, step_between, three
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS
from robomech_ros._kernels.spatial.vectors import combined, cross, dot, triple


@lean
def _write_row(turning, moving, motion, row):
    """Write the coefficients of a body's ten parameters in the effort along a joint axis."""
    w, b, a = motion
    row[0] = dot(moving, a)
    # Transposed [alpha x] + [omega x]^2 times v, plus a x e.
    bent = combined(cross(moving, b), triple(w, moving), 1.0)
    row[1], row[2], row[3] = combined(bent, cross(a, turning), 1.0)
    # e . (I alpha + omega x I omega) = sum of I times (e alpha^T + (e x omega) omega^T).
    (wx, wy, wz), (bx, by, bz), (ex, ey, ez) = w, b, turning
    px, py, pz = cross(turning, w)
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
    motion = three(around, 0), three(around, 3), three(around, 6)
    count = packed.shape[0] - 1
    for k in range(count):
        E = step_between(packed, k, q[k])
        motion = next_motion(motion, E, packed[k, 0] != 0.0, qd[k], qdd[k])
        write_six(axes[k], placed_axis(packed, frames, k, point))
        F = frames[k]
        lever = combined(three(F, 9), point, -1.0)
        for i in range(count):
            row = Y[i, 10 * k : 10 * k + 10]
            if i > k:
                for j in range(10):
                    row[j] = 0.0
                continue
            axis = three(axes[i], 0)
            moving = combined(three(axes[i], 3), cross(axis, lever), 1.0)
            _write_row(into(F, axis), into(F, moving), motion, row)
            for j in range(10):
                if not math.isfinite(row[j]):
                    status = NOT_FINITE
    return status


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT3))
def torque_regressor(packed, q, qd, qdd, around, out):
    """Write regressors for states (m, n) to out (m, n, 10 n); ``around`` has m rows, or one."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        status |= _regressor_body(packed, q[k], qd[k], qdd[k], around[min(k, last)], out[k])
    return status
