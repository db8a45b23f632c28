"""Publishes /tf and /tf_static of a simulated robot, where nobody else is there to."""

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from robomech_ros.nodes.controller.settings import FRAMES_AUTO, FRAMES_NEVER
from robomech_ros.nodes.conversions import pose_from_matrix
from robomech_ros.robots import Joint, RobotDescription
from robomech_ros.spatial import matrix_from_axis_angle

__all__ = ["FramePublisher", "frame_publisher"]

# As tf2_ros has them.
_DEPTH = 100
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_OTHER = "robot_state_publisher"


def frame_publisher(
    node: Node, description: RobotDescription, wanted: str
) -> "FramePublisher | None":
    """Make the publisher, if it is wanted and tf2_msgs is installed.

    Parameters
    ----------
    node : Node
        Owner of the publishers.
    description : RobotDescription
        The robot.
    wanted : str
        The parameter publish_frames.

    Returns
    -------
    FramePublisher or None
    """
    if wanted == FRAMES_NEVER or (wanted == FRAMES_AUTO and _is_installed(_OTHER)):
        return None
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError as error:
        if getattr(error, "name", "") != "tf2_msgs" or wanted != FRAMES_AUTO:
            node.get_logger().warning(f"no /tf: {error}")
        return None
    return FramePublisher(node, description, TFMessage)


class FramePublisher:
    """Publishes the pose of every link in the one before it.

    Links behind a joint that follows another, or has several degrees of freedom, are left out.

    Parameters
    ----------
    node : Node
        Owner of the publishers.
    description : RobotDescription
        The robot.
    message : type
        tf2_msgs/TFMessage.
    """

    def __init__(self, node: Node, description: RobotDescription, message: Any) -> None:
        self._clock = node.get_clock()
        self._message = message
        joints = description.joints
        self._moving = [joint for joint in joints if joint.moves and joint.mimic is None]
        fixed = [joint for joint in joints if joint.type == "fixed"]
        left_out = set(joints) - set(self._moving) - set(fixed)
        if left_out:
            names = ", ".join(sorted(joint.name for joint in left_out))
            node.get_logger().warning(f"/tf lacks what is behind the joints {names}")
        self._publisher = node.create_publisher(message, "/tf", _DEPTH)
        self._latched = node.create_publisher(message, "/tf_static", _LATCHED)
        self._latched.publish(message(transforms=[self._transform(j, 0.0) for j in fixed]))

    def publish(self, positions: Mapping[str, float]) -> None:
        """Publish the frames of all joints that move, at positions (rad or m) by joint."""
        transforms = [self._transform(joint, positions[joint.name]) for joint in self._moving]
        self._publisher.publish(self._message(transforms=transforms))

    def _transform(self, joint: Joint, position: float) -> TransformStamped:
        pose = pose_from_matrix(joint_pose(joint, position))
        place, turn = pose.position, pose.orientation
        result = TransformStamped(
            child_frame_id=joint.child,
            transform=Transform(
                translation=Vector3(x=place.x, y=place.y, z=place.z),
                rotation=Quaternion(x=turn.x, y=turn.y, z=turn.z, w=turn.w),
            ),
        )
        result.header.frame_id = joint.parent
        result.header.stamp = self._clock.now().to_msg()
        return result


def joint_pose(joint: Joint, position: float) -> NDArray[np.float64]:
    """Give the pose of a joint's child link in its parent, shape (4, 4) (m), at rad or m."""
    motion = np.eye(4)
    if joint.type == "prismatic":
        motion[:3, 3] = joint.axis * position
    elif joint.moves:
        motion[:3, :3] = matrix_from_axis_angle(joint.axis, position)
    pose: NDArray[np.float64] = joint.origin @ motion @ joint.after
    return pose


def _is_installed(package: str) -> bool:
    prefixes = [sys.prefix, *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
    return any(Path(prefix, "share", package).is_dir() for prefix in prefixes if prefix)
