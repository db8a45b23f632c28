"""The Jacobian of a point of the tip link."""

from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT3, i8
from robomech_ros._kernels.spatial.vectors import combined, cross, lower, times, upper


@lean
def move_jacobian(J, pose, point):
    """Change J (6, n) from the tip's origin to a point (3,) in the frame of the tip link.

    ``v_P = v + omega x r`` with r from the tip's origin to the point, in the axes of the base.
    """
    r = times(pose, (point[0], point[1], point[2]))
    for i in range(J.shape[1]):
        J[3, i], J[4, i], J[5, i] = combined(lower(J, i), cross(upper(J, i), r), 1.0)


@kernel(i8(IN2, IN2, IN1, OUT3, OUT3))
def point_jacobian(packed, q, point, out, poses):
    """Write Jacobians at a point (3,) for q (m, n) to out (m, 6, n), and tip poses to poses."""
    status = 0
    for k in range(q.shape[0]):
        status |= jacobian_body(packed, q[k], out[k], poses[k])
        move_jacobian(out[k], poses[k], point)
    return status
