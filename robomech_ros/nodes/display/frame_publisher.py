"""Publishes frames of a robot on /tf and /tf_static."""

from collections import deque
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node

from robomech_ros.kinematics.joint_poses import JointPoses
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.robots import Joint, RobotDescription
from robomech_ros.typing import Array

# As tf2_ros has them.
_DEPTH = 100
# Number of messages kept for subscribers slower than the publication of frames.
_SENT = 1000


class _Moving(NamedTuple):
    """The frames that move: names of their joints, poses, the message to be written, its frames."""

    names: list[str]
    poses: JointPoses
    message: Any
    children: frozenset[str]


class FramePublisher:
    """Publishes the pose of every link in the one before it, of all links or of some.

    Links behind a joint of several degrees of freedom are left out: where such a link is, others
    know, such as an odometry.

    - ``description``: the robot; the frame of each joint's child is that of the joint, as in a
      URDF.
    - ``prefix``: prefix of the names of frames.
    - ``message``: tf2_msgs/TFMessage.
    - ``moving``, ``fixed``: the frames of links that move in the one before them, and of those that
      do not.
    - ``topic``, ``fixed_topic``: full names of the topics.
    """

    def __init__(self, node: Node, description: RobotDescription, prefix: str, message: Any):
        self._clock, self._prefix, self.kind = node.get_clock(), prefix, message
        joints = description.joints
        self._of_moving = {f"{prefix}{joint.child}": joint for joint in joints if joint.moves}
        self._of_fixed = {
            f"{prefix}{joint.child}": joint for joint in joints if joint.type == "fixed"
        }
        self.moving, self.fixed = tuple(self._of_moving), tuple(self._of_fixed)
        shown = {*self._of_moving.values(), *self._of_fixed.values()}
        if left_out := sorted(joint.name for joint in joints if joint not in shown):
            node.get_logger().warning(f"/tf lacks what is behind the joints {', '.join(left_out)}")
        self._publisher = node.create_publisher(message, "/tf", _DEPTH)
        self._latched = node.create_publisher(message, "/tf_static", LATCHED)
        self.topic, self.fixed_topic = self._publisher.topic_name, self._latched.topic_name
        self.turns = 0  #: Number of times that frames were due.
        #: The latest messages on /tf: ROS time (ns) and frames.
        self.sent: deque[tuple[int, frozenset[str]]] = deque(maxlen=_SENT)
        self.at_rest: Any = None  #: The latest message on /tf_static.
        # Replaced as a whole: frames are published in another thread.
        self._frames: _Moving | None = None

    def choose(self, moving: Collection[str], fixed: Collection[str]) -> None:
        """Publish these frames from now on, and those that do not move at once.

        - ``moving``, ``fixed``: parts of the attributes of these names.
        """
        still = [joint for frame, joint in self._of_fixed.items() if frame in fixed]
        self.at_rest = self.kind(transforms=self._transforms(still))
        now = divmod(int(self._clock.now().nanoseconds), NANO)
        _put(self.at_rest, JointPoses(still), np.zeros(len(still)), now)
        self._latched.publish(self.at_rest)
        joints = [joint for frame, joint in self._of_moving.items() if frame in moving]
        message = self.kind(transforms=self._transforms(joints))
        children = frozenset(entry.child_frame_id for entry in message.transforms)
        chosen = _Moving([joint.name for joint in joints], JointPoses(joints), message, children)
        self._frames = chosen if joints else None

    def publish(self, positions: Mapping[str, float], stamp: tuple[int, int]) -> None:
        """Publish the frames of the joints that move.

        - ``positions``: position of every moving joint (rad or m).
        - ``stamp``: ROS time (s and ns) at which the joints were there.
        """
        self.turns += 1
        frames = self._frames
        if frames is None:
            return
        at = np.array([positions[name] for name in frames.names])
        _put(frames.message, frames.poses, at, stamp)
        self.sent.append((stamp[0] * NANO + stamp[1], frames.children))
        self._publisher.publish(frames.message)

    def _transforms(self, joints: Sequence[Joint]) -> list[TransformStamped]:
        """Make the transforms of joints, their numbers to be filled in."""
        made = []
        for joint in joints:
            made.append(TransformStamped(child_frame_id=f"{self._prefix}{joint.child}"))
            made[-1].header.frame_id = f"{self._prefix}{joint.parent}"
        return made


def _put(message: Any, poses: JointPoses, at: Array, stamp: tuple[int, int]) -> None:
    """Write the poses at positions (rad or m) into a message, with a ROS time (s and ns)."""
    places, turns = poses.at(at)
    for entry, place, turn in zip(message.transforms, places.tolist(), turns.tolist(), strict=True):
        entry.header.stamp.sec, entry.header.stamp.nanosec = stamp
        translation, rotation = entry.transform.translation, entry.transform.rotation
        translation.x, translation.y, translation.z = place
        rotation.x, rotation.y, rotation.z, rotation.w = turn
