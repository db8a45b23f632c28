"""Loading of a node's robot from parameters or latched topics."""

import logging
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from std_msgs.msg import String

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.robot.robot_description import (
    LATCHED,
    TOPIC,
    RobotModel,
    RobotSettings,
)
from robomech_ros.nodes.common.robot.srdf_source import SEMANTIC_TOPIC, SemanticSource
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.parallel.tree_description import load_tree_description
from robomech_ros.robots import RobotDescription
from robomech_ros.robots.documents.reported_notes import report_once
from robomech_ros.robots.library import is_document
from robomech_ros.robots.robot_kinds import ARM, check_name, kind_of

# The log of the node says the same, and goes to /rosout as well.
logging.getLogger(report_once.__module__).addHandler(logging.NullHandler())
# Number of characters of an invalid robot in an error.
_SHOWN = 80
_MOST_NOTES = 5


def when_robot_known(
    node: Node,
    settings: RobotSettings,
    on_robot: Callable[[RobotModel], None],
    supplemented: Callable[[RobotDescription], RobotDescription] | None = None,
    *,
    completed: Callable[[RobotDescription], RobotDescription] = lambda robot: robot,
    parallel: bool = False,
    legged: bool = False,
) -> None:
    """Call back with the robot: at once from the parameter, or later from the topic.

    Until then the service ``~/ready`` says what is missing.

    - ``on_robot``: called with the robot.  It can refuse a robot of the topic by a RobomechError,
      and is then called with the next one.
    - ``supplemented``: returns the robot with missing data of its description added; only arms can
      be supplemented.
    - ``completed``: returns an arm with the data that it then still lacks.
    - ``parallel``: whether the node serves parallel robots, too; it refuses them otherwise.
    - ``legged``: whether the node serves walking machines, too.

    Raises RobomechError: the parameter's robot is unknown or broken. What is wrong with a robot
    from the topic is logged, and the node goes on waiting for a better one.
    """
    source = SemanticSource(node, settings)

    def begin(robot: str) -> None:
        taken = {ARM: True, "parallel": parallel, "walking": legged}
        check_name(robot, [kind for kind, served in taken.items() if served])
        described, parts = load_walking(robot) if kind_of(robot) == "walking" else load(robot)
        model = RobotModel(described, settings, source.semantic(described), **parts)
        on_robot(model)
        source.supply_groups(model)

    def load(robot: str) -> tuple[RobotDescription, dict[str, Any]]:
        loaded = load_tree_description(robot)
        described = loaded.description
        if loaded.robot is not None and not (parallel and supplemented is None):
            _refuse(node, described.name, parallel)
        if supplemented is not None:
            described = supplemented(described)
        for note in described.notes[:_MOST_NOTES]:
            node.get_logger().warning(note)
        if loaded.robot is None:
            described = completed(described)
        return described, {"robot": loaded.robot}

    def load_walking(robot: str) -> tuple[RobotDescription, dict[str, Any]]:
        # Compiled code for legs is loaded only if there are some.
        from robomech_ros.walking import load_legged

        legs = load_legged(robot)
        if not legged or supplemented is not None:
            expected = f"no walking machine, which the node '{node.get_name()}' does not serve"
            raise BadValueError("robot_description", legs.name, expected)
        return legs.description, {"legged": legs}

    if settings.robot_description and not source.lacks_group:
        begin(settings.robot_description)
        Readiness(node)
        return
    _WaitingNode(node, settings, source, begin)


def _refuse(node: Node, robot: str, parallel: bool) -> None:
    """Return the reason why a node cannot serve a parallel robot."""
    if parallel:
        expected = f"none for '{robot}': a parallel robot has the limits of its own document"
        raise BadValueError("joint_limits", "a file", expected)
    expected = f"a robot without loops: the node '{node.get_name()}' serves no parallel robots"
    raise BadValueError("robot_description", robot, expected)


class _WaitingNode:
    """Wait of a node for a topic with its robot, or with the SRDF of its group."""

    def __init__(
        self,
        node: Node,
        settings: RobotSettings,
        source: SemanticSource,
        begin: Callable[[str], None],
    ) -> None:
        self._node, self._source, self._begin = node, source, begin
        self._complaints = ThrottledLog(node.get_logger())
        self._done = False
        self._group, self._robot = settings.group, settings.robot_description
        self._by_topic = not self._robot
        source.on_document = self._try
        self._place = node.resolve_topic_name(TOPIC if self._by_topic else SEMANTIC_TOPIC)
        text = self._waits_for_group()
        if self._by_topic:
            node.create_subscription(String, TOPIC, self._receive, LATCHED)
            text = self._waits_for("the robot", TOPIC, "robot_state_publisher")
        self._readiness = Readiness(node, text)

    def _waits_for(self, what: str, topic: str, publisher: str) -> str:
        place = self._node.resolve_topic_name(topic)
        return (
            f"waiting for {what} on topic '{place}' (a latched std_msgs/String, as {publisher} has "
            f"it); else name it by the parameter {topic} of "
            f"'{self._node.get_fully_qualified_name()}'. Its other services come with the robot"
        )

    def _waits_for_group(self) -> str:
        return self._waits_for(f"the SRDF with group '{self._group}'", SEMANTIC_TOPIC, "move_group")

    def _receive(self, message: String) -> None:
        if self._done:
            text = "a new robot description is ignored; restart the node to change its robot"
            self._complaints.warning(text)
            return
        self._robot = message.data
        self._try()

    def _try(self) -> None:
        """Begin with the robot if it is known and usable."""
        if self._done or not self._robot:
            return
        if self._source.lacks_group:
            self._readiness.wait_for(self._waits_for_group())
            self._node.get_logger().info(self._waits_for_group())
            return
        try:
            if self._by_topic and not is_document(self._robot):
                # It must not name a file, or any publisher could have files read here.
                expected = "the text of a URDF; names and files are for the parameter"
                raise BadValueError("the robot", self._robot[:_SHOWN], expected)
            self._begin(self._robot)
        except RobomechError as error:
            text = f"unusable robot on '{self._place}': {error}"
            self._complaints.error(text)
            self._readiness.wait_for(text)
            return
        self._done = True
        self._readiness.reached()
