"""Groups and named states of a node's robot: from parameters, or from a latched topic."""

from collections.abc import Callable
from dataclasses import replace

from rclpy.node import Node
from std_msgs.msg import String

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel, RobotSettings
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.robots import RobotDescription, SemanticDescription, load_semantics
from robomech_ros.robots.documents.guarded_xml import is_xml

# As MoveIt's move_group has it.
SEMANTIC_TOPIC = "robot_description_semantic"
_MOST_NOTES = 5
_LONGEST_NOTE = 500


class SemanticSource:
    """Joint groups of the robot.

    If the parameter is empty, it listens to the topic.  A document from there never changes the
    configured chain or its home posture: it may arrive before or after the robot.

    - ``node``: owner of the subscription, and of the log of faults in an SRDF.
    """

    def __init__(self, node: Node, settings: RobotSettings) -> None:
        #: Called when an SRDF arrives by the topic before the robot is known.
        self.on_document: Callable[[], object] = lambda: None
        self._log = node.get_logger()
        self._complaints = ThrottledLog(self._log)
        self._place = node.resolve_topic_name(SEMANTIC_TOPIC)
        self._given = settings.robot_description_semantic
        self._received = ""
        self._groups, self._group = settings.groups, settings.group
        self._model: RobotModel | None = None
        if not self._given:
            node.create_subscription(String, SEMANTIC_TOPIC, self._receive, LATCHED)

    @property
    def lacks_group(self) -> bool:
        """True if the parameter group names one that only an SRDF can have, and none is known."""
        listed = [entry.split(":")[0].strip() for entry in self._groups]
        known = bool(self._given or self._received)
        return bool(self._group) and self._group not in listed and not known

    def semantic(self, description: RobotDescription) -> SemanticDescription:
        """Return the groups and postures that select the chain of a robot.

        Raises RobomechError: the SRDF, or an entry of the parameter groups, does not fit the robot.
        """
        known = self._read(description)
        return known if self._given else replace(known, states={})

    def supply_groups(self, model: RobotModel) -> None:
        """Set the groups of a robot, now and whenever another SRDF arrives."""
        self._model = model
        known = self._read(model.description)
        model.learn(known)
        for note in known.notes[:_MOST_NOTES]:
            self._complaints.warning(note[:_LONGEST_NOTE])
        if len(known.notes) > _MOST_NOTES:
            more = len(known.notes) - _MOST_NOTES
            self._log.warning(f"{more} more such lines: `robomech groups` shows all")

    def _read(self, description: RobotDescription) -> SemanticDescription:
        try:
            return load_semantics(description, self._given or self._received, self._groups)
        except RobomechError as error:
            if not self._received:
                raise
            # It may be of another robot, and must not prevent the start.
            self._drop(error)
            return self._read(description)

    def _receive(self, message: String) -> None:
        if not is_xml(message.data):
            # A message on the topic is a document and never names a file.
            self._complain("it is no XML")
            return
        if self._model is not None and message.data == self._received:
            return
        before, self._received = self._received, message.data
        if self._model is None:
            self.on_document()
            return
        try:
            load_semantics(self._model.description, self._received, self._groups)
        except RobomechError as error:
            self._drop(error)
            self._received = before
            return
        self.supply_groups(self._model)

    def _drop(self, error: RobomechError) -> None:
        self._received = ""
        self._complain(str(error)[:_LONGEST_NOTE])

    def _complain(self, why: str) -> None:
        self._complaints.error(f"unusable SRDF on '{self._place}', ignored: {why}")
