"""Frame tree of the messages on ``/tf`` and ``/tf_static``.

Messages on ``/tf`` are taken from the middleware only when somebody asks: a node that listens to
fast robots spends nothing while it is idle.
"""

import math
import time
from collections.abc import Iterator
from typing import Any

from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from robomech_ros.nodes.common.message_fields import NANO
from robomech_ros.nodes.frames.history import Sample
from robomech_ros.nodes.frames.tree import FrameTree
from robomech_ros.nodes.middleware.polled_subscription import ManualSubscription
from robomech_ros.nodes.middleware.raw_messages import UnreadableMessageError, unpack

# Between two looks, the latest so many are kept: some seconds of robot_state_publisher.
_DEPTH = 500
# A best-effort reader hears every sender, and only the latest counts.
_MOVING = QoSProfile(
    depth=_DEPTH, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.BEST_EFFORT
)
# As tf2_ros has it.
_STATIC = QoSProfile(
    depth=100,
    history=HistoryPolicy.KEEP_LAST,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
# Bytes of a message at most, enough for a thousand frames, and of all that one look takes in, which
# is some 0.1 s of work; of more the latest count.
_LARGEST_MESSAGE, _LARGEST_LOOK = 200_000, 1_000_000


class FrameListener:
    """Knows the frames that others publish.

    Parameters
    ----------
    node : Node
        Owner of the subscriptions.

    Attributes
    ----------
    tree : FrameTree
        As of the last look.
    missing : str
        Why there is nothing to listen to; empty where tf2_msgs is installed.
    fault : str
        What of what was heard could not be used at last; empty if all could, or if the same frame
        was heard of rightly since.
    heard_since : float
        When the first of the frames in the tree was heard of (s, on the monotonic clock), infinite
        while there is none.
    """

    def __init__(self, node: Node) -> None:
        self.tree = FrameTree()
        self.missing = ""
        self.fault = ""
        self.heard_since = math.inf
        self._faulty = ""
        self._clock = node.get_clock()
        self._kind: Any = None
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError as error:
            self.missing = (
                "frames of tf are not heard: the package tf2_msgs is not installed"
                if getattr(error, "name", "") == "tf2_msgs"
                else f"frames of tf are not heard: {error}"
            )
            return
        self._kind = TFMessage
        self._moving = node.create_subscription(
            TFMessage,
            "/tf",
            self._take_moving,
            _MOVING,
            callback_group=ManualSubscription(),
            raw=True,
        )
        self._static = node.create_subscription(
            TFMessage, "/tf_static", self._take_static, _STATIC, raw=True
        )
        back = JumpThreshold(
            min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        # Jumps are reported as long as this is kept.
        self._jumps = self._clock.create_jump_callback(back, post_callback=self._begin_anew)

    @property
    def now(self) -> int:
        """ROS time (ns)."""
        return int(self._clock.now().nanoseconds)

    @property
    def topics(self) -> tuple[str, str]:
        """Full names of the two topics."""
        return str(self._moving.topic_name), str(self._static.topic_name)

    def look(self) -> None:
        """Take in what has come since the last look."""
        latest, left = [], _LARGEST_LOOK
        for data in reversed(list(self._waiting())):
            left -= len(data)
            if left < 0:
                break
            latest.append(data)
        for data in reversed(latest):
            self._take_moving(data)

    def _waiting(self) -> Iterator[bytes]:
        if self._kind is None:
            return
        with self._moving.handle:
            for _ in range(_DEPTH):
                taken = self._moving.handle.take_message(self._kind, True)
                if taken is None:
                    return
                yield taken[0]

    def _begin_anew(self, jump: TimeJump) -> None:
        # What waits is from before, too.
        list(self._waiting())
        self.tree.forget_moving()
        self.heard_since = math.inf

    def _take_moving(self, data: bytes) -> None:
        self._take(data, static=False)

    def _take_static(self, data: bytes) -> None:
        self._take(data, static=True)

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
            stamp, place, turn = (
                entry.header.stamp,
                entry.transform.translation,
                entry.transform.rotation,
            )
            sample = Sample(
                stamp.sec * NANO + stamp.nanosec,
                _bare(entry.header.frame_id),
                (place.x, place.y, place.z),
                (turn.x, turn.y, turn.z, turn.w),
            )
            child = _bare(entry.child_frame_id)
            fault = self.tree.insert(child, sample, now, static=static)
            if not fault:
                self.heard_since = min(self.heard_since, time.monotonic())
            if fault or child == self._faulty:
                self.fault, self._faulty = fault, child if fault else ""


def _bare(frame: str) -> str:
    """Return the name of a frame without the slash that tf had before it once."""
    return str(frame).removeprefix("/")
