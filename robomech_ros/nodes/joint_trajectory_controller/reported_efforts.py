"""Joint efforts that another node computes, such as those of a walk, for joint_states."""

from array import array
from collections.abc import Sequence
from contextlib import AbstractContextManager

import numpy as np
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState

from robomech_ros.nodes.common.messages.message_fields import NANO, floats
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

# Efforts older than this (ns) are no longer those of the robot.
_OLDEST = NANO // 2


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
