"""Odometry of robots that move: its publisher with the frame of the base, and covariances."""

from typing import Any

import numpy as np
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node

from robomech_ros.nodes.common.messages.message_fields import fill_header
from robomech_ros.nodes.common.messages.pose_messages import PlainPose, fill_place, fill_twist
from robomech_ros.typing import Array

# Queue depths of odometry, and of tf as in tf2_ros.
_DEPTH, _FRAMES_DEPTH = 10, 100
# Filters such as those of robot_localization invert covariances, so no variance is 0. That of z,
# roll and pitch, which wheels and feet do not measure, and the addition to the others.
UNMEASURED, LEAST = 1e6, 1e-6
# Indices of x, y and heading in the six of a message, and of heading, x, y.
POSE, TWIST = (0, 1, 5), (5, 0, 1)


def full_covariance(planar: Array, places: tuple[int, ...]) -> Array:
    """Return the 36 numbers of a message, with positive variances, from three of the plane.

    - ``planar``: covariance (m^2, m rad, rad^2, or each per s^2), shape (3, 3).
    - ``places``: indices of its rows in the six of a message: `POSE` or `TWIST`.
    """
    full = np.diag(np.full(6, UNMEASURED))
    full[np.ix_(places, places)] = planar + LEAST * np.eye(3)
    return full.ravel()


class OdometryPublisher:
    """Publishes the pose and the twist of a robot, and the frame of its base on tf.

    - ``topic``, ``frames``: topics of odometry and of tf; the latter is empty for no frame.
    - ``odom``, ``base``: names of the two frames.
    """

    def __init__(self, node: Node, topic: str, frames: str, odom: str, base: str) -> None:
        self._odom, self._base = odom, base
        self._odometry = node.create_publisher(Odometry, topic, _DEPTH)
        self._frames: Any = None
        if frames:
            try:
                from tf2_msgs.msg import TFMessage
            except ImportError as error:
                node.get_logger().warning(f"no frames are published: {error}")
            else:
                self._frames = node.create_publisher(TFMessage, frames, _FRAMES_DEPTH)

    def publish(
        self, place: PlainPose, twist: Array, covariances: tuple[Array, Array], stamp: int
    ) -> None:
        """Publish them at a ROS time (ns).

        - ``place``: position (m) and quaternion xyzw of the base in the frame of odometry.
        - ``twist``: in the axes of the base, angular first (rad/s and m/s), shape (6,).
        - ``covariances``: the 36 numbers of the pose and of the twist.
        """
        message = Odometry(child_frame_id=self._base)
        fill_header(message.header, self._odom, stamp)
        fill_place(message.pose.pose.position, message.pose.pose.orientation, place)
        fill_twist(message.twist.twist, twist)
        message.pose.covariance, message.twist.covariance = covariances
        self._odometry.publish(message)
        if self._frames is not None:
            frame = TransformStamped(header=message.header, child_frame_id=self._base)
            fill_place(frame.transform.translation, frame.transform.rotation, place)
            self._frames.publish(self._frames.msg_type(transforms=[frame]))
