"""Forward kinematics and Jacobian of a serial chain.

A chain is the constant transforms C_0 .. C_n between its joints, one row each of ``packed``:
``[type, r00 r01 r02 r10 r11 r12 r20 r21 r22, x y z]`` with the type of the joint that follows
(0 revolute, 1 prismatic, -1 in the last row).  The tip's pose in the base is
``C_0 J_1(q_1) C_1 J_2(q_2) ... J_n(q_n) C_n`` with J_i a rotation about, or a translation along,
the joint's z axis.

With mimic joints, the rows are longer, and q are the drives: see :mod:`.layout`.

Status: 0, or 1 if a joint variable is not finite, or so large that the pose is not finite.  Then
the pose is NaN and the Jacobian undefined.
"""

import math

from robomech_ros._kernels.chain.coupling import collect_columns, expand, is_coupled
from robomech_ros._kernels.chain.layout import MOST_JOINTS
from robomech_ros._kernels.compiling.jit import fused, kernel, lean, lean_part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT2, OUT3, i8

OK = 0
NOT_FINITE = 1
_NO_FRAME = (math.nan,) * 12


@lean
def _first_frame(packed):
    """Read C_0 as the twelve numbers of rotation (row by row) and origin."""
    return (
        packed[0, 1],
        packed[0, 2],
        packed[0, 3],
        packed[0, 4],
        packed[0, 5],
        packed[0, 6],
        packed[0, 7],
        packed[0, 8],
        packed[0, 9],
        packed[0, 10],
        packed[0, 11],
        packed[0, 12],
    )


@fused
def _advance(frame, packed, i, value):
    """Return the frame before joint i, multiplied by J_i(value) and C_(i+1)."""
    r00, r01, r02, r10, r11, r12, r20, r21, r22, x, y, z = frame
    if packed[i, 0] == 0.0:
        c = math.cos(value)
        s = math.sin(value)
        r00, r01 = c * r00 + s * r01, c * r01 - s * r00
        r10, r11 = c * r10 + s * r11, c * r11 - s * r10
        r20, r21 = c * r20 + s * r21, c * r21 - s * r20
    else:
        x += value * r02
        y += value * r12
        z += value * r22
    k = i + 1
    a0, a1, a2 = packed[k, 1], packed[k, 2], packed[k, 3]
    b0, b1, b2 = packed[k, 4], packed[k, 5], packed[k, 6]
    c0, c1, c2 = packed[k, 7], packed[k, 8], packed[k, 9]
    px, py, pz = packed[k, 10], packed[k, 11], packed[k, 12]
    return (
        r00 * a0 + r01 * b0 + r02 * c0,
        r00 * a1 + r01 * b1 + r02 * c1,
        r00 * a2 + r01 * b2 + r02 * c2,
        r10 * a0 + r11 * b0 + r12 * c0,
        r10 * a1 + r11 * b1 + r12 * c1,
        r10 * a2 + r11 * b2 + r12 * c2,
        r20 * a0 + r21 * b0 + r22 * c0,
        r20 * a1 + r21 * b1 + r22 * c1,
        r20 * a2 + r21 * b2 + r22 * c2,
        x + r00 * px + r01 * py + r02 * pz,
        y + r10 * px + r11 * py + r12 * pz,
        z + r20 * px + r21 * py + r22 * pz,
    )


@lean
def _write_pose(frame, T):
    T[0, 0], T[0, 1], T[0, 2], T[0, 3] = frame[0], frame[1], frame[2], frame[9]
    T[1, 0], T[1, 1], T[1, 2], T[1, 3] = frame[3], frame[4], frame[5], frame[10]
    T[2, 0], T[2, 1], T[2, 2], T[2, 3] = frame[6], frame[7], frame[8], frame[11]
    T[3, 0], T[3, 1], T[3, 2], T[3, 3] = 0.0, 0.0, 0.0, 1.0


@lean
def _is_finite(frame):
    """Return whether the origin is finite; a sum of huge displacements is not."""
    return math.isfinite(frame[9]) and math.isfinite(frame[10]) and math.isfinite(frame[11])


@lean
def _joint_forward(packed, q, T):
    """Write the tip's pose for the values (m,) of all joints to T (4, 4)."""
    frame = _first_frame(packed)
    for i in range(packed.shape[0] - 1):
        value = q[i]
        if not math.isfinite(value):
            _write_pose(_NO_FRAME, T)
            return NOT_FINITE
        frame = _advance(frame, packed, i, value)
    if not _is_finite(frame):
        _write_pose(_NO_FRAME, T)
        return NOT_FINITE
    _write_pose(frame, T)
    return OK


@lean_part(i8(IN2, IN1, OUT2))
def _coupled_forward(packed, q, T):
    values = scratch(MOST_JOINTS)
    expand(packed, q, True, values)
    return _joint_forward(packed, values, T)


@lean
def forward_body(packed, q, T):
    """Write the tip's pose in the base to T (4, 4); return the status."""
    if is_coupled(packed):
        return _coupled_forward(packed, q, T)
    return _joint_forward(packed, q, T)


@fused
def joint_jacobian(packed, q, J, T):
    """Write the Jacobian (6, m) of all joints, mimic joints uncoupled, to J, and the pose to T."""
    frame = _first_frame(packed)
    n = packed.shape[0] - 1
    for i in range(n):
        value = q[i]
        if not math.isfinite(value):
            _write_pose(_NO_FRAME, T)
            return NOT_FINITE
        # A joint does not move its own axis; the lower rows hold a point of the axis for now.
        J[0, i], J[1, i], J[2, i] = frame[2], frame[5], frame[8]
        J[3, i], J[4, i], J[5, i] = frame[9], frame[10], frame[11]
        frame = _advance(frame, packed, i, value)
    if not _is_finite(frame):
        _write_pose(_NO_FRAME, T)
        return NOT_FINITE
    for i in range(n):
        ex, ey, ez = J[0, i], J[1, i], J[2, i]
        if packed[i, 0] == 0.0:
            rx = frame[9] - J[3, i]
            ry = frame[10] - J[4, i]
            rz = frame[11] - J[5, i]
            J[3, i], J[4, i], J[5, i] = ey * rz - ez * ry, ez * rx - ex * rz, ex * ry - ey * rx
        else:
            J[0, i], J[1, i], J[2, i] = 0.0, 0.0, 0.0
            J[3, i], J[4, i], J[5, i] = ex, ey, ez
    _write_pose(frame, T)
    return OK


@lean_part(i8(IN2, IN1, OUT2, OUT2))
def _coupled_jacobian(packed, q, J, T):
    values, columns = scratch(MOST_JOINTS), scratch(6, MOST_JOINTS)
    expand(packed, q, True, values)
    status = joint_jacobian(packed, values, columns, T)
    collect_columns(packed, columns, J)
    return status


@lean
def jacobian_body(packed, q, J, T):
    """Write J (6, n) at the tip in base axes, angular rows first, and the pose T."""
    if is_coupled(packed):
        return _coupled_jacobian(packed, q, J, T)
    return joint_jacobian(packed, q, J, T)


@kernel(i8(IN2, IN1, OUT2))
def forward_one(packed, q, out):
    """Write the pose of the tip for one q (n,) to out (4, 4)."""
    return forward_body(packed, q, out)


@kernel(i8(IN2, IN2, OUT3))
def forward(packed, q, out):
    """Write poses of the tip for q (m, n) to out (m, 4, 4)."""
    status = 0
    for k in range(q.shape[0]):
        status |= forward_body(packed, q[k], out[k])
    return status


@kernel(i8(IN2, IN1, OUT2, OUT2))
def jacobian_one(packed, q, out, pose):
    """Write the Jacobian for one q (n,) to out (6, n), and the tip's pose to pose (4, 4)."""
    return jacobian_body(packed, q, out, pose)


@kernel(i8(IN2, IN2, OUT3, OUT2))
def jacobian(packed, q, out, pose):
    """Write Jacobians for q (m, n) to out (m, 6, n); pose (4, 4) is working space."""
    status = 0
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], out[k], pose)
    return status
