"""Frames of a robot that other nodes publish on /tf and /tf_static."""

import random
from collections import Counter
from collections.abc import Collection
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.messages.error_codes import shortened
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.robot.robot_description import STATIC_FRAMES
from robomech_ros.nodes.display.frame_publisher import FramePublisher
from robomech_ros.nodes.middleware.polled_subscription import Inbox, UnreadableMessageError, unpack
from robomech_ros.nodes.middleware.reliable_topics import node_of
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.robots.entry_checks import bare_link

# How often the graph is looked at, s.
PERIOD = 0.5
# Others that are silent for so long publish no more, s.  Up to the second number is added by
# chance, so that of two nodes that yield to each other one is back first.
SILENCE, BY_CHANCE = 3.0, 1.0
# As many messages of /tf are read in a look, the latest: to unpack one takes 0.1 ms, in which the
# robot may have to move.
_DEPTH = 40
# So many of its own messages may still be on their way to itself.
_MAX_AWAITED = 500
# Frames are published from this look on, later where others are on /tf: a robot_state_publisher
# needs joint_states before it says anything.
FIRST, FIRST_BESIDE_OTHERS = 2, 4
_MOST_NAMES = 5


class OtherPublishers:
    """Finds the publishers of a topic that are not a node's own.

    - ``node``: the node whose own publishers do not count.  Another node of the same name counts:
      only as many publishers as this node has are left out.
    - ``topic``: full name of the topic.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._node, self._topic = node, topic
        self._known: set[bytes] = set()
        #: Full name of the node of each other publisher at the last look.
        self.nodes: tuple[str, ...] = ()
        #: Whether a publisher disappeared between the last two looks.
        self.one_left = False

    def look(self) -> tuple[str, ...]:
        """Find the present publishers, and return their nodes."""
        found = self._node.get_publishers_info_by_topic(self._topic)
        present = {bytes(info.endpoint_gid) for info in found}
        self.one_left = bool(self._known - present)
        self._known = present
        nodes, name = sorted(map(node_of, found)), self._node.get_fully_qualified_name()
        own = sum(one.topic_name == self._topic for one in self._node.publishers)
        for _ in range(min(own, nodes.count(name))):
            nodes.remove(name)
        self.nodes = tuple(nodes)
        return self.nodes


class MovingFrames:
    """Frames that others publish on /tf.

    While nobody else publishes there, nothing is read.  Messages do not name their sender: among
    those with a stamp and frames of the node's own, as many as the node has sent count as its own.

    - ``publisher``: publisher of the node's own frames.
    - ``rate``: how often frames are due (Hz).
    """

    def __init__(self, node: Node, publisher: FramePublisher, rate: float) -> None:
        self._node, self._publisher = node, publisher
        self._frames = frozenset(publisher.moving)
        self.others = OtherPublishers(node, publisher.topic)
        silence = SILENCE + random.uniform(0.0, BY_CHANCE)
        self._silence = max(2, round(silence * rate))
        # Last receipt of a frame, in cycles of the publisher: simulated time may stand still.
        self._received: dict[str, int] = {}
        self._own: Counter[tuple[int, frozenset[str]]] = Counter()
        self._inbox: Inbox | None = None

    def look(self) -> frozenset[str]:
        """Return the frames that others publish at present."""
        if not self.others.look():
            self._received.clear()
            return frozenset()
        if self._inbox is None:
            kind, topic = self._publisher.kind, self._publisher.topic
            self._inbox = Inbox(self._node, kind, topic, _DEPTH)
        # In this order: what arrived was sent, and noted, before.
        messages, sent = [*self._inbox.take()], self._publisher.sent
        self._listen(messages, Counter(sent.popleft() for _ in range(len(sent))))
        turn = self._publisher.turns
        return frozenset(f for f, at in self._received.items() if turn - at < self._silence)

    def _listen(self, messages: list[Any], sent: Counter[tuple[int, frozenset[str]]]) -> None:
        """Note what others have said, given what was sent since the last look."""
        own = self._own + sent
        for message in messages:
            children = frozenset(_children(message))
            frames = self._frames & children
            if not frames:
                continue
            stamp = message.transforms[0].header.stamp
            what = stamp.sec * NANO + stamp.nanosec, children
            if own[what] > 0:
                own[what] -= 1
            else:
                self._received.update(dict.fromkeys(frames, self._publisher.turns))
        # Older messages no longer arrive, even on a busy machine.
        waiting = [(what, n) for what, n in own.items() if n > 0]
        self._own = Counter(dict(waiting[-_MAX_AWAITED:]))


class FixedFrames:
    """Frames that running publishers other than the node itself publish on /tf_static.

    - ``publisher``: publisher of the node's own frames.
    """

    def __init__(self, node: Node, publisher: FramePublisher) -> None:
        self._node, self._publisher = node, publisher
        self._frames = frozenset(publisher.fixed)
        self.others = OtherPublishers(node, publisher.fixed_topic)
        self._received: set[str] = set()
        self._log = ThrottledLog(node.get_logger())
        self._subscription: Any = None

    def look(self) -> frozenset[str] | None:
        """Return the frames that others publish; None where that will be known at the next look."""
        if not self.others.look():
            self._received.clear()
            return frozenset()
        if self._subscription is not None and not self.others.one_left:
            return frozenset(self._received)
        # The latched messages of the remaining publishers show which frames are gone.
        # The callback group of the node would keep a trace of every subscription there was.
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
        self._received.clear()
        kind, topic = self._publisher.kind, self._publisher.fixed_topic
        self._subscription = self._node.create_subscription(
            kind,
            topic,
            self._take,
            STATIC_FRAMES,
            callback_group=ReentrantCallbackGroup(),
            raw=True,
        )
        return None

    def _take(self, data: bytes) -> None:
        try:
            message = unpack(data, self._publisher.kind)
        except UnreadableMessageError as error:
            self._log.warning(f"passed over on '{self._publisher.fixed_topic}': {error}")
            return
        if message != self._publisher.at_rest:
            self._received.update(self._frames & _children(message))


def _children(message: Any) -> set[str]:
    """Name the frames that a message places."""
    return {bare_link(entry.child_frame_id) for entry in message.transforms}


class UnclaimedFrames:
    """Restricts a publisher to the frames of a robot that no other node publishes.

    - ``publisher``: publisher of all frames.
    - ``robot``: name of the robot.
    - ``rate``: how often frames are due (Hz).
    """

    def __init__(self, node: Node, publisher: FramePublisher, robot: str, rate: float) -> None:
        self._node, self._publisher, self._robot = node, publisher, robot
        self._moving = MovingFrames(node, publisher, rate)
        self._fixed = FixedFrames(node, publisher)
        self._left: frozenset[str] | None = None
        self._looks = 0
        steady_timer(node, PERIOD, self._look)

    def _look(self) -> None:
        self._looks += 1
        moving, fixed = self._moving.look(), self._fixed.look()
        others = {*self._moving.others.nodes, *self._fixed.others.nodes}
        if fixed is None or self._looks < (FIRST_BESIDE_OTHERS if others else FIRST):
            return
        left = moving | fixed
        if left == self._left:
            return
        self._left = left
        self._publisher.choose(
            [frame for frame in self._publisher.moving if frame not in left],
            [frame for frame in self._publisher.fixed if frame not in left],
        )
        self._node.get_logger().info(self._decision(left, sorted(others)))

    def _decision(self, left: Collection[str], others: list[str]) -> str:
        count = len(self._publisher.moving) + len(self._publisher.fixed)
        topic, robot = self._publisher.topic, self._robot
        if not left:
            return f"{topic}: nobody else publishes frames of {robot}: this node does, all {count}"
        who = others[0] if len(others) == 1 else f"one or more of {shortened(others, _MOST_NAMES)}"
        hint = ""
        if any(name.endswith(f"/{self._node.get_name()}") for name in others):
            hint = ". If that is another robot, set frame_prefix (bringup --namespace does)"
        if len(left) == count:
            return f"{topic}: all {count} frames of {robot} come from {who}, not from here{hint}"
        some = f"{len(left)} of {count} frames of {robot} come from {who}"
        names = shortened(sorted(left), _MOST_NAMES)
        return f"{topic}: {some}: {names}; the others from here{hint}"
