"""Publishes /tf and /tf_static of a simulated robot, where nobody else does."""

import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from geometry_msgs.msg import TransformStamped
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from robomech_ros.nodes.joint_trajectory_controller.settings import FRAMES_AUTO, FRAMES_NEVER
from robomech_ros.robots import Joint, RobotDescription
from robomech_ros.spatial import position_quaternion_from_pose

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

    Links behind a joint of several degrees of freedom are left out.

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
        joints = description.joints
        self._moving = [joint for joint in joints if joint.moves]
        fixed = [joint for joint in joints if joint.type == "fixed"]
        left_out = set(joints) - set(self._moving) - set(fixed)
        if left_out:
            names = ", ".join(sorted(joint.name for joint in left_out))
            node.get_logger().warning(f"/tf lacks what is behind the joints {names}")
        self._publisher = node.create_publisher(message, "/tf", _DEPTH)
        self._latched = node.create_publisher(message, "/tf_static", _LATCHED)
        at_rest = message(transforms=_transforms(fixed))
        self._put(at_rest, JointPoses(fixed), np.zeros(len(fixed)))
        self._latched.publish(at_rest)
        self._names = [joint.name for joint in self._moving]
        self._poses = JointPoses(self._moving)
        # Written in place for every publication.
        self._frames = message(transforms=_transforms(self._moving))

    def publish(self, positions: Mapping[str, float]) -> None:
        """Publish the frames of all joints that move, at positions (rad or m) by joint."""
        self._put(self._frames, self._poses, np.array([positions[name] for name in self._names]))
        self._publisher.publish(self._frames)

    def _put(self, message: Any, poses: "JointPoses", at: NDArray[np.float64]) -> None:
        """Write the poses at positions (rad or m) into a message, with the present time."""
        stamp = self._clock.now().to_msg()
        places, turns = poses.at(at)
        for entry, place, turn in zip(
            message.transforms, places.tolist(), turns.tolist(), strict=True
        ):
            entry.header.stamp = stamp
            translation, rotation = entry.transform.translation, entry.transform.rotation
            translation.x, translation.y, translation.z = place
            rotation.x, rotation.y, rotation.z, rotation.w = turn


class JointPoses:
    r"""Poses of the child links of k joints in their parents, all of them at once.

    By Rodrigues' formula the place is :math:`p_0 + p_1 \cos\theta + p_2 \sin\theta + p_3 d` for a
    joint turned by :math:`\theta` or moved by d, and the quaternion
    :math:`q_0 \cos(\theta/2) + q_1 \sin(\theta/2)`; what is constant is made once.

    Parameters
    ----------
    joints : sequence of Joint
        Fixed ones and those of one degree of freedom.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 2 and app. A.
    """

    def __init__(self, joints: Sequence[Joint]) -> None:
        self._turns = np.array([j.moves and j.type != "prismatic" for j in joints], dtype=bool)
        (here, there, aside), (start, quarter) = self._samples(joints)
        self._place = np.stack(
            (0.5 * (here + there), 0.5 * (here - there), aside - 0.5 * (here + there))
        )
        self._place[:, ~self._turns] = 0.0
        self._place[0, ~self._turns] = here[~self._turns]
        self._way = np.where(self._turns[:, None], 0.0, there - here) / np.pi
        # Of the two quaternions of the quarter turn the one nearer to that of the start.
        near = np.where(np.sum(start * quarter, axis=1, keepdims=True) < 0.0, -1.0, 1.0)
        self._quaternion = np.stack((start, np.sqrt(2.0) * near * quarter - start))

    @staticmethod
    def _samples(joints: Sequence[Joint]) -> tuple[list[Any], list[Any]]:
        """Give places at 0, pi and pi / 2, and quaternions at 0 and pi / 2, each (k, 3 or 4)."""
        poses = [
            np.array([joint.pose(at) for joint in joints]).reshape(-1, 4, 4)
            for at in (0.0, np.pi, 0.5 * np.pi)
        ]
        split = [position_quaternion_from_pose(pose) for pose in poses]
        return [place for place, _ in split], [split[0][1], split[2][1]]

    def at(self, positions: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Give places (k, 3) in m and quaternions xyzw (k, 4), at positions (k,) in rad or m."""
        angle = np.where(self._turns, positions, 0.0)[:, None]
        first, second, third = self._place
        place = first + second * np.cos(angle) + third * np.sin(angle)
        half = 0.5 * angle
        turn = self._quaternion[0] * np.cos(half) + self._quaternion[1] * np.sin(half)
        return place + self._way * positions[:, None], turn


def _transforms(joints: Sequence[Joint]) -> list[TransformStamped]:
    """Make the transforms of joints, their numbers to be filled in."""
    transforms = [TransformStamped(child_frame_id=joint.child) for joint in joints]
    for transform, joint in zip(transforms, joints, strict=True):
        transform.header.frame_id = joint.parent
    return transforms


def _is_installed(package: str) -> bool:
    prefixes = [sys.prefix, *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
    return any(Path(prefix, "share", package).is_dir() for prefix in prefixes if prefix)
