"""Publication of joint_states, with efforts that another node may report."""

from array import array
from collections.abc import Sequence
from contextlib import AbstractContextManager

import numpy as np
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState

from robomech_ros.nodes.common.messages.message_fields import NANO, floats
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

# Efforts older than this (ns) are no longer those of the robot.
_OLDEST = NANO // 2
# Reliable; what is older than the last ten states is of no interest to anybody.
_DEPTH = 10


class ReportedEfforts:
    """Keeps the latest efforts of all joints of a robot, from a topic.

    - ``topic``: topic of JointState messages with efforts (N m or N).
    - ``names``: joints whose efforts are kept, in this order.
    - ``lock``: held while efforts change, and to be held while they are read.
    """

    def __init__(
        self, node: Node, topic: str, names: Sequence[str], lock: AbstractContextManager[object]
    ) -> None:
        self._names, self._lock, self._topic = list(names), lock, topic
        self._log = ThrottledLog(node.get_logger())
        self._efforts, self._time = array("d"), -_OLDEST
        node.create_subscription(JointState, topic, self._take, qos_profile_sensor_data)

    def at(self, stamp: tuple[int, int]) -> "array[float]":
        """Return the efforts (n,) at a ROS time (s and ns); empty if none are known."""
        age = stamp[0] * NANO + stamp[1] - self._time
        return self._efforts if abs(age) <= _OLDEST else array("d")

    def _take(self, message: JointState) -> None:
        known = dict(zip(message.name, message.effort, strict=False))
        missing = [name for name in self._names if not np.isfinite(known.get(name, np.nan))]
        if missing:
            self._log.warning(
                f"efforts on '{self._topic}' are ignored: none, or not a finite one, of joint "
                f"'{missing[0]}'; publish one for each of {', '.join(self._names)}"
            )
            return
        when = message.header.stamp
        with self._lock:
            self._efforts = floats(np.array([known[name] for name in self._names]))
            self._time = when.sec * NANO + when.nanosec


class StatePublisher:
    """Publishes the positions and velocities of all joints of a robot, those of its chain first.

    The passive joints of a parallel robot move as its loops have them.  Joints that mimic others
    follow them; those that nothing commands stand still at home, else at 0 or at the limit nearest
    to it.  Efforts of drives that are not known are NaN; those that another node reports are there
    for all joints, or for none.

    - ``model``: the robot and its chain.
    - ``commanded``: what moves: the joints of the chain, and those of a gripper.
    """

    def __init__(self, node: Node, model: RobotModel, commanded: Sequence[CommandedJoints]) -> None:
        description = model.description
        #: Efforts of the joints in the order of ``names``, if another node reports them.
        self.reported: ReportedEfforts | None = None
        names = list(dict.fromkeys((*commanded[0].shown_names, *model.joint_names)))
        at_rest = description.joint_positions(description.home)
        self._commanded = [
            (joints, np.array([names.index(name) for name in joints.shown_names]))
            for joints in commanded
        ]
        following = description.followers
        self._following = np.array([names.index(name) for name in following], dtype=np.int64)
        self._leading = np.array(
            [names.index(follower.leader) for follower in following.values()], dtype=np.int64
        )
        self._multiplier = np.array([follower.multiplier for follower in following.values()])
        self._offset = np.array([follower.offset for follower in following.values()])
        self._message = JointState(
            name=names,
            position=floats(np.array([at_rest[name] for name in names])),
            velocity=floats(np.zeros(len(names))),
        )
        # The message's arrays, written in place.
        if any(joints.simulated_joints.effort is not None for joints in commanded):
            self._message.effort = floats(np.full(len(names), np.nan))
        self._effort = np.frombuffer(self._message.effort) if self._message.effort else None
        self._position = np.frombuffer(self._message.position)
        self._velocity = np.frombuffer(self._message.velocity)
        self._publisher = node.create_publisher(JointState, "joint_states", _DEPTH)

    @property
    def names(self) -> Sequence[str]:
        """Names of all joints, in the order of their states."""
        return list(self._message.name)

    @property
    def positions(self) -> dict[str, float]:
        """Position (rad or m) of every joint, as published last."""
        return dict(zip(self._message.name, self._message.position, strict=True))

    @property
    def stamp(self) -> tuple[int, int]:
        """ROS time (s and ns) of that."""
        when = self._message.header.stamp
        return when.sec, when.nanosec

    def publish(self, stamp: tuple[int, int]) -> None:
        """Publish where the joints are, at a ROS time (s and ns); their lock is to be held."""
        position, velocity = self._position, self._velocity
        for joints, places in self._commanded:
            state, effort = joints.shown(), joints.shown_efforts()
            position[places], velocity[places] = state.position, state.velocity
            if self._effort is not None and effort is not None:
                self._effort[places] = effort
        if len(self._following):
            position[self._following] = self._multiplier * position[self._leading] + self._offset
            velocity[self._following] = self._multiplier * velocity[self._leading]
        if self.reported is not None:
            self._message.effort = self.reported.at(stamp)
        when = self._message.header.stamp
        when.sec, when.nanosec = stamp
        self._publisher.publish(self._message)
