"""Inverse kinematics of a leg of three joints from a near posture."""

import math

from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN2, IN3, OUT2, i8
from robomech_ros._kernels.spatial.vectors import cramer, lower, scaled

FOLLOWED = 0
LOST = 1
# Rounding error of a foot position (m).
CLOSED = 1e-13
_STEPS = 30
# Largest rotation of one step (rad), and largest determinant (m^3) that counts as zero.
_FARTHEST = 0.3
_SINGULAR = 1e-12


@lean
def follow_foot(packed, x, y, z, q, J, T):
    """Move q (3) from a near posture until the foot is at (x, y, z) in the trunk.

    J (6, 3) and T (4, 4) are working space.  Returns FOLLOWED, or LOST if the foot cannot reach
    the point.
    """
    for _ in range(_STEPS):
        if jacobian_body(packed, q, J, T) != 0:
            return LOST
        ex, ey, ez = x - T[0, 3], y - T[1, 3], z - T[2, 3]
        if abs(ex) + abs(ey) + abs(ez) <= CLOSED:
            return FOLLOWED
        det, found = cramer(lower(J, 0), lower(J, 1), lower(J, 2), (ex, ey, ez))
        if not abs(det) > _SINGULAR:
            return LOST
        s0, s1, s2 = scaled(found, 1.0 / det)
        most = max(abs(s0), abs(s1), abs(s2))
        part = 1.0 if most <= _FARTHEST else _FARTHEST / most
        q[0] += part * s0
        q[1] += part * s1
        q[2] += part * s2
        if most < 1e-15:
            break
    if jacobian_body(packed, q, J, T) != 0:
        return LOST
    miss = math.hypot(x - T[0, 3], math.hypot(y - T[1, 3], z - T[2, 3]))
    return FOLLOWED if miss <= 100.0 * CLOSED else LOST


@kernel(i8(IN3, IN2, OUT2))
def follow_feet(packed, feet, q):
    """Move q (legs, 3) until the feet are at the positions (legs, 3) in the trunk.

    Returns -1, or the first leg whose foot cannot reach its position.
    """
    J, T = scratch(6, 3), scratch(4, 4)
    for leg in range(feet.shape[0]):
        at = feet[leg]
        if follow_foot(packed[leg], at[0], at[1], at[2], q[leg], J, T) != FOLLOWED:
            return leg
    return -1
