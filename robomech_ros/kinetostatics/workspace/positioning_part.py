"""The joints of an arm that place a point, whatever the others do."""

import math
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.axis_points import common_point, nearest_points
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinematics.tolerances import CONCURRENT
from robomech_ros.kinetostatics.reduced_jacobians import planar_rows
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

_EXPECTED = (
    "one with joints that place a point which later joints do not move: an arm of three "
    "joints or with a spherical wrist after three, or a planar arm of two joints or with one that "
    "turns after two"
)


class PositioningPart(NamedTuple):
    """The first joints, 3 or the 2 of a planar arm, and the point (3,) that they place (m).

    The point is in the frame that moves with the last of them, and ``in_tip`` (3,) in that of the
    tip.  The columns of the plane (3, 3) are x, y and normal of a planar arm in the base.
    """

    joints: int
    point: Array
    in_tip: Array
    plane: Array | None


def positioning_part(chain: SerialChain) -> PositioningPart:
    """Find the joints of an arm that place a point, and the point.

    Of three joints they place the tip; of four to six, the centre of the wrist about which the
    later ones turn (of four, a point of an axis through the tip).  Of two joints the arm is planar;
    of three it may be, with the axis of the last one placed.
    """
    check_chain(chain)
    chain.require_uncoupled(instead="with mimic joints reach_map computes what the tip reaches")
    C = chain.transforms
    plane = _plane(chain) if chain.n in (2, 3) else None
    if plane is not None:
        joints, height = 2, (None if chain.types[2:].any() else 0.0)
    else:
        joints, height = 3, None
        if 3 <= chain.n <= 6 and not chain.types[3:].any():
            height = _height_on_axis_4(C, chain.n)
    if height is None:
        raise BadValueError("chain", f"{chain.name}, {counted(chain.n, 'joint')}", _EXPECTED)
    point: Array = (C[joints] @ (0.0, 0.0, height, 1.0))[:3]
    # On all later axes, the point stays where it is whatever their joints do.
    pose = np.eye(4)
    for T in C[joints:]:
        pose = pose @ T
    in_tip: Array = (rigid_inverse(pose) @ (*point, 1.0))[:3]
    return PositioningPart(joints, point, in_tip, plane)


def _plane(chain: SerialChain) -> Array | None:
    try:
        rows = planar_rows(chain)
    except BadValueError:
        if chain.n == 2:
            raise  # two joints place a point in a plane or nowhere, and it tells why not here
        return None
    return np.column_stack((rows[1, 3:], rows[2, 3:], rows[0, :3]))


def _height_on_axis_4(C: Array, joints: int) -> float | None:
    """Find the height (m) of the point over the frame after joint 3; None where there is none."""
    size = float(np.linalg.norm(C[1:, :3, 3], axis=1).sum()) or 1.0
    if joints == 3:
        return 0.0
    if joints == 4:
        return float(C[4, 2, 3]) if math.hypot(*C[4, :2, 3]) <= CONCURRENT * size else None
    if joints == 5:
        pair = nearest_points(C[4])
        return None if pair is None or pair[2] > CONCURRENT * size else pair[0]
    centre = common_point(C[4], C[5])
    return None if centre is None or centre[2] > CONCURRENT * size else centre[0]
