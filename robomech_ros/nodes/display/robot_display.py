"""All of a robot that is shown to others: its description, and where its links are."""

import random
from collections.abc import Mapping
from pathlib import Path

from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import String

from robomech_ros.nodes.common.cooperative_wait import steady_timer
from robomech_ros.nodes.common.robot.robot_description import LATCHED, TOPIC
from robomech_ros.nodes.common.robot.srdf_source import SEMANTIC_TOPIC
from robomech_ros.nodes.display.external_frames import PERIOD, OtherPublishers, UnclaimedFrames
from robomech_ros.nodes.display.frame_publisher import FramePublisher
from robomech_ros.robots import RobotDescription, load_description, urdf_from_description
from robomech_ros.robots.urdf.mesh_urls import with_mesh_urls

# So many looks nobody else may have published before this node does: after the start, and, by
# chance in between, after it yielded, so that of two nodes that yield to each other one is first.
_QUIET, _QUIET_AGAIN = 2, (3, 9)
AUTO, ALWAYS, NEVER = "auto", "always", "never"


class DescriptionPublisher:
    """Publishes a URDF or an SRDF while nobody else publishes one.

    Two latched publishers would leave it to chance which robot a late subscriber gets.

    - ``text``: the document.
    - ``topic``: topic of the document.
    - ``what``: name of the document for the log.
    """

    def __init__(self, node: Node, text: str, topic: str, what: str) -> None:
        self._node, self._text, self._what = node, text, what
        self._topic = node.resolve_topic_name(topic)
        self._own_name = topic
        self._others = OtherPublishers(node, self._topic)
        self._publisher: Publisher[String] | None = None
        self._before: tuple[str, ...] = ()
        self._quiet, self._wanted = 0, _QUIET
        steady_timer(node, PERIOD, self._look)

    def _look(self) -> None:
        others = self._others.look()
        self._quiet = 0 if others else self._quiet + 1
        if others:
            self._wanted = random.randint(*_QUIET_AGAIN)
            if self._publisher is not None:
                self._node.destroy_publisher(self._publisher)
                self._publisher = None
            if not self._before:
                names = ", ".join(dict.fromkeys(others))
                self._node.get_logger().info(f"'{self._topic}' comes from {names}, not from here")
        elif self._publisher is None and self._quiet >= self._wanted:
            self._publisher = self._node.create_publisher(String, self._own_name, LATCHED)
            self._publisher.publish(String(data=self._text))
            self._node.get_logger().info(f"'{self._topic}' comes from here: {self._what}")
        self._before = others


class RobotDisplay:
    """Publishes the description and the frames of a robot, as far as that is wanted and needed.

    The frames are those of the published description.  The description of a robot from a table has
    more links than the table.

    - ``prefix``: prefix of the names of its frames.
    - ``frames``: whether frames are published: auto (those that nobody else publishes), always or
      never.
    - ``rate``: how often `publish` is called (Hz).
    - ``describe``: whether the description is published, unless somebody else does.
    - ``semantic``: the SRDF that is published, unless somebody else does; empty for none.
    """

    def __init__(
        self,
        node: Node,
        description: RobotDescription,
        *,
        prefix: str,
        frames: str,
        rate: float,
        describe: bool,
        semantic: str = "",
    ) -> None:
        text, shown = "", description
        if describe or (frames != NEVER and not shown.document):
            text = urdf_from_description(description)
        if not shown.document and text:
            shown = load_description(text)
        self._frames = None
        if frames != NEVER:
            self._frames = _frame_publisher(node, shown, prefix, frames, rate)
        if describe:
            what = "the robot as a URDF, for RViz and others"
            file = Path(description.where)
            if description.document and file.is_file():
                text = with_mesh_urls(text, file.parent)
            DescriptionPublisher(node, text, TOPIC, what)
        if semantic:
            what = "groups and named states as an SRDF, for MoveIt's clients"
            DescriptionPublisher(node, semantic, SEMANTIC_TOPIC, what)

    def publish(self, positions: Mapping[str, float], stamp: tuple[int, int]) -> None:
        """Publish the frames that move, as :meth:`FramePublisher.publish` does."""
        if self._frames is not None:
            self._frames.publish(positions, stamp)


def _frame_publisher(
    node: Node, shown: RobotDescription, prefix: str, wanted: str, rate: float
) -> FramePublisher | None:
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError as error:
        if getattr(error, "name", "") != "tf2_msgs" or wanted != AUTO:
            node.get_logger().warning(f"no /tf: {error}")
        return None
    publisher = FramePublisher(node, shown, prefix, TFMessage)
    if wanted == ALWAYS:
        publisher.choose(publisher.moving, publisher.fixed)
    else:
        UnclaimedFrames(node, publisher, shown.name, rate)
    return publisher
