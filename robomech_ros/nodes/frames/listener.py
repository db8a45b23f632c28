"""Frame tree of the messages on ``/tf`` and ``/tf_static``.

Messages on ``/tf`` are taken from the middleware only when somebody asks: a node that listens to
fast robots spends nothing while it is idle.
"""

import math
import time
from functools import partial
from typing import Any

import numpy as np
from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node

from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.robot.robot_description import STATIC_FRAMES
from robomech_ros.nodes.frames.history import Sample
from robomech_ros.nodes.frames.tree import FrameTree
from robomech_ros.nodes.middleware.polled_subscription import Inbox, UnreadableMessageError, unpack
from robomech_ros.robots.entry_checks import bare_link

# Between two looks, the latest so many are kept: some seconds of robot_state_publisher.
_DEPTH = 500
# Bytes of a message at most, enough for a thousand frames, and of all that one look takes in, which
# is some 0.1 s of work; of more the latest count.
_LARGEST_MESSAGE, _LARGEST_LOOK = 200_000, 1_000_000


class FrameListener:
    """Knows the frames that others publish."""

    def __init__(self, node: Node) -> None:
        self.tree = FrameTree()  #: The frames known at the last look.
        self.missing = ""  #: Why tf cannot be read; empty if tf2_msgs is installed.
        #: Text on the latest invalid transform; empty if there was none, or if a valid transform of
        #: the same frame came later.
        self.fault = ""
        #: When the first frame of the tree was received (s, on the monotonic clock); infinite while
        #: the tree is empty.
        self.receiving_since = math.inf
        self._faulty = ""
        self._clock = node.get_clock()
        self._kind: Any = None
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError as error:
            absent = getattr(error, "name", "") == "tf2_msgs"
            why = "the package tf2_msgs is not installed" if absent else error
            self.missing = f"frames of tf are not received: {why}"
            return
        self._kind = TFMessage
        self._moving = Inbox(node, TFMessage, "/tf", _DEPTH)
        self._static = node.create_subscription(
            TFMessage, "/tf_static", partial(self._take, static=True), STATIC_FRAMES, raw=True
        )
        back = JumpThreshold(
            min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        # Jumps are reported as long as this is kept.
        self._jumps = self._clock.create_jump_callback(back, post_callback=self._restart)

    @property
    def now(self) -> int:
        """ROS time (ns)."""
        return int(self._clock.now().nanoseconds)

    @property
    def topics(self) -> tuple[str, str]:
        """Full names of the two topics."""
        return self._moving.topic, str(self._static.topic_name)

    @property
    def source(self) -> str:
        """The two topics, and the latest rejected message, as text."""
        fault = f"; rejected messages: {self.fault}" if self.fault else ""
        return " and ".join(f"'{topic}'" for topic in self.topics) + fault

    def look(self) -> None:
        """Take in what has come since the last look."""
        if self.missing:
            return
        taken = self._moving.take_packed()
        sizes = np.cumsum([len(data) for data in reversed(taken)])
        kept = int(np.searchsorted(sizes, _LARGEST_LOOK, side="right"))
        for data in taken[len(taken) - kept :]:
            self._take(data, static=False)

    def _restart(self, jump: TimeJump) -> None:
        # Waiting messages are outdated, too.
        self._moving.take_packed()
        self.tree.forget_moving()
        self.receiving_since = math.inf

    def _take(self, data: bytes, *, static: bool) -> None:
        if len(data) > _LARGEST_MESSAGE:
            self.fault = f"a message of {len(data)} bytes on '{self.topics[static]}', too many"
            return
        try:
            entries = unpack(data, self._kind).transforms
        except UnreadableMessageError as error:
            self.fault, self._faulty = f"{error}, on '{self.topics[static]}'", ""
            return
        now = self.now
        for entry in entries:
            stamp, transform = entry.header.stamp, entry.transform
            place, turn = transform.translation, transform.rotation
            sample = Sample(
                stamp.sec * NANO + stamp.nanosec,
                bare_link(entry.header.frame_id),
                (place.x, place.y, place.z),
                (turn.x, turn.y, turn.z, turn.w),
            )
            child = bare_link(entry.child_frame_id)
            fault = self.tree.insert(child, sample, now, static=static)
            if not fault:
                self.receiving_since = min(self.receiving_since, time.monotonic())
            if fault or child == self._faulty:
                self.fault, self._faulty = fault, child if fault else ""
