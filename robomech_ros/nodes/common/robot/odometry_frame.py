"""Odometry of mobile robots: publisher of its frame, and covariances."""

from typing import Any

import numpy as np
from rclpy.node import Node

from robomech_ros.typing import Array

# As tf2_ros has it.
_DEPTH = 100
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


def odometry_frame(node: Node, topic: str) -> Any:
    """Make the publisher of tf2_msgs/TFMessage; None, with a warning, without these messages."""
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError as error:
        node.get_logger().warning(f"no frames are published: {error}")
        return None
    return node.create_publisher(TFMessage, topic, _DEPTH)
