"""Recent poses of a frame in another one, from tf or a pose topic."""

from geometry_msgs.msg import PoseStamped
from rclpy.node import Node

from robomech_ros.nodes.common.messages.error_codes import shortened
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.frames.history import Sample
from robomech_ros.nodes.frames.listener import FrameListener
from robomech_ros.nodes.frames.tree import FrameTree, NoTransformError
from robomech_ros.nodes.middleware.polled_subscription import Inbox
from robomech_ros.typing import Array

# Some seconds of a fast sender, between two looks.
_DEPTH = 500
_MOST_LISTED = 30


class TfTrack:
    """The poses of a frame in another one, of those that tf has."""

    def __init__(self, listener: FrameListener, parent: str, child: str) -> None:
        self._listener, self.parent, self._child = listener, parent, child

    @property
    def what(self) -> str:
        """Whose poses they are, and where they come from."""
        return f"frame {self._child!r} in {self.parent!r}"

    def look(self) -> None:
        """Take in what has come."""
        self._listener.look()

    def last(self) -> int | None:
        """Return the latest instant (ns) with a pose, None for any, or raise NoTransformError."""
        if self._listener.missing:
            raise NoTransformError(self._listener.missing, may_come=False)
        return self._listener.tree.between(self.parent, self._child).stamp

    def at(self, stamp: int) -> Array:
        """Return the pose (4, 4) at an instant (ns), or raise NoTransformError if it is unknown."""
        return self._listener.tree.between(self.parent, self._child, stamp).pose

    def context(self) -> str:
        """List what else was received if there is no pose."""
        listener = self._listener
        if listener.missing:
            return ""
        known = shortened(listener.tree.frames, _MOST_LISTED) or "none"
        return f", on {listener.source}; known frames: {known}"


class TopicTrack:
    """The poses that a topic of geometry_msgs/PoseStamped gives.

    - ``parent``: frame that the poses have to be in; empty = that of the first.
    """

    def __init__(self, node: Node, topic: str, parent: str) -> None:
        self._clock = node.get_clock()
        self._inbox = Inbox(node, PoseStamped, topic, _DEPTH)
        self._tree, self.parent, self._fault = FrameTree(), parent, ""

    @property
    def what(self) -> str:
        """The topic."""
        return f"pose on '{self._inbox.topic}'"

    def look(self) -> None:
        """Take in what has come."""
        for message in self._inbox.take():
            self._fault = self._take(message)

    def _take(self, message: PoseStamped) -> str:
        """Keep a pose; says why one cannot be used."""
        frame, stamp = message.header.frame_id.removeprefix("/"), message.header.stamp
        nano = stamp.sec * NANO + stamp.nanosec
        if not nano:
            return "its stamp is 0, expected the time at which it was there"
        self.parent = self.parent or frame
        if frame != self.parent:
            return f"its frame is {frame[:200]!r}, expected {self.parent!r}"
        p, o = message.pose.position, message.pose.orientation
        sample = Sample(nano, self.parent, (p.x, p.y, p.z), (o.x, o.y, o.z, o.w))
        now = int(self._clock.now().nanoseconds)
        return self._tree.insert(self._inbox.topic, sample, now, static=False)

    def last(self) -> int | None:
        """Return the stamp of the latest pose."""
        if not self._tree.frames:
            raise NoTransformError("nothing received")
        return self._tree.between(self.parent, self._inbox.topic).stamp

    def at(self, stamp: int) -> Array:
        """Return the pose (4, 4) at an instant (ns)."""
        return self._tree.between(self.parent, self._inbox.topic, stamp).pose

    def context(self) -> str:
        """Say why received poses were rejected."""
        return f"; rejected messages: {self._fault}" if self._fault else ""


PoseTrack = TfTrack | TopicTrack
