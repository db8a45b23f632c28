"""Poses, twists and Jacobians in messages: here ROS's order meets the core's.

The core puts angular before linear components and the scalar of a quaternion first; ROS messages
are linear first and have it last.  Single poses are converted with plain numbers, since NumPy's
overhead on four of them would be a good part of a service's answer time.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseStamped, TransformStamped, Twist, TwistStamped
from std_msgs.msg import Header

from robomech_ros._kernels.spatial.tolerances import UNIT_NORM
from robomech_ros.errors import BadQuaternionError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.plain_poses import plain_pose
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.quaternions import matrix_from_quaternion
from robomech_ros.typing import Array

#: Position (m) and quaternion xyzw.
PlainPose = tuple[Sequence[float], Sequence[float]]
_POSE_NUMBERS = 7


def matrix_from_pose(pose: Pose, what: str = "pose") -> Array:
    """Convert a pose message to a homogeneous transform.

    - ``pose``: position in m; the quaternion's norm may differ from 1 by 1e-3 and is then made 1.
    - ``what``: what the pose is, for messages.

    Returns a pose (4, 4).

    Raises BadQuaternionError: the quaternion is zero or far from unit length.
    """
    p, o = pose._position, pose._orientation  # quicker than nine properties
    x, y, z, w = o._x, o._y, o._z, o._w
    if not math.isfinite(p._x + p._y + p._z):
        require_finite(f"{what}.position", p)
        # Finite numbers whose sum overflows count as infinite.
        raise NonFiniteError(f"{what}.position", math.inf)
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not abs(norm - 1.0) <= UNIT_NORM:
        require_finite(f"{what}.orientation", o, "xyzw")
        reason = "all zero" if norm == 0.0 else f"its norm is {norm:.9g}"
        expected = f"expected norm 1 within {UNIT_NORM:g}"
        raise BadQuaternionError([x, y, z, w], f"{what}.orientation: {reason}, {expected}")
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    return np.array((
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w), p._x,
        2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w), p._y,
        2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y), p._z,
        0.0, 0.0, 0.0, 1.0,
    )).reshape(4, 4)  # fmt: skip


def require_finite(what: str, vector: object, fields: Sequence[str] = "xyz") -> None:
    """Reject a vector of a message that is not finite, by the name of the field."""
    for name in fields:
        value = getattr(vector, name)
        if not math.isfinite(value):
            raise NonFiniteError(f"{what}.{name}", value)


def pose_from_matrix(T: Array) -> Pose:
    """Convert a homogeneous transform, shape (4, 4), to a pose message, as :func:`fill_pose`."""
    message = Pose()
    fill_pose(message, T)
    return message


def fill_pose(message: Pose, T: Array) -> None:
    """Write a homogeneous transform, shape (4, 4), to a pose message.

    The quaternion has w >= 0; if w is 0, its first number that is not zero is positive.
    """
    fill_place(message.position, message.orientation, plain_pose(T))


def fill_place(position: Any, orientation: Any, place: PlainPose) -> None:
    """Write a position (m) and a quaternion xyzw to the parts of a pose or a transform."""
    (position.x, position.y, position.z), turn = place
    orientation.x, orientation.y, orientation.z, orientation.w = turn


def stamped_transform(T: Array, parent: str, child: str) -> TransformStamped:
    """Return the transform of a frame, for tf; the stamp stays 0."""
    message = TransformStamped(header=Header(frame_id=parent), child_frame_id=child)
    fill_place(message.transform.translation, message.transform.rotation, plain_pose(T))
    return message


def stamped_pose(T: Array, frame: str) -> PoseStamped:
    """Convert a homogeneous transform to a pose message in a frame; the stamp stays 0."""
    return PoseStamped(header=Header(frame_id=frame), pose=pose_from_matrix(T))


def matrices_from_pose_rows(rows: Sequence[float], what: str = "poses") -> Array:
    """Convert rows of x y z qx qy qz qw to homogeneous transforms.

    - ``rows``: 7 m numbers: position in m, unit quaternion within 1e-3.

    Returns poses (m, 4, 4).

    Raises WrongSizeError: not a multiple of seven numbers. BadQuaternionError: the row is named.
    """
    if len(rows) % _POSE_NUMBERS:
        raise WrongSizeError(what, len(rows), "a multiple of 7: x y z qx qy qz qw of every pose")
    table = np.array(rows, dtype=np.float64).reshape(-1, _POSE_NUMBERS)
    if not np.isfinite(table).all():
        raise NonFiniteError(what, table)
    return assembled(matrix_from_quaternion(table[:, 3:]), table[:, :3])


def point_vector(point: Point, what: str) -> Array:
    """Convert a point message (m) to an array of shape (3,); it must be finite."""
    require_finite(what, point)
    return np.array((point.x, point.y, point.z))


def twist_vector(twist: Twist) -> Array:
    """Convert a twist message to an array of shape (6,), angular first (rad/s and m/s)."""
    angular, linear = twist.angular, twist.linear
    return np.array([angular.x, angular.y, angular.z, linear.x, linear.y, linear.z])


def stamped_twist(twist: Array, frame: str) -> TwistStamped:
    """Convert a twist (6,), angular first, to a message in a frame; the stamp stays 0."""
    message = TwistStamped(header=Header(frame_id=frame))
    fill_twist(message.twist, twist)
    return message


def fill_twist(message: Twist, twist: Array) -> None:
    """Write a twist (6,), angular first (rad/s and m/s), to a message."""
    angular, linear = message.angular, message.linear
    angular.x, angular.y, angular.z, linear.x, linear.y, linear.z = twist.tolist()


def linear_rows_first(J: Array) -> Array:
    """Reorder rows, shape (6, n), or (3, n) in the plane, from angular first to linear first."""
    half = len(J) // 2
    return np.concatenate((J[half:], J[:half]))
