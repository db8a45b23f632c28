"""Takes commands from the topics of the servo, and refuses those that cannot be followed."""

import math
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.middleware.polled_subscription import Inbox
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.servo.command_reader import CommandReader
from robomech_ros.nodes.servo.settings import ServoNodeSettings
from robomech_ros.servo.commands import Command
from robomech_ros.servo.servo import Servo

# Messages of one kind that are looked at in a period; of faster senders the latest.
_DEPTH = 10


class CommandIntake:
    """Gives commands to a servo, one kind at a time.

    - ``servo``: follows the commands.
    - ``reader``: makes them of messages.
    - ``on_message``: called when a message comes while the executor attends to the topics.
    """

    def __init__(
        self,
        node: Node,
        servo: Servo,
        reader: CommandReader,
        settings: Callable[[], ServoNodeSettings],
        on_message: Callable[[], None],
    ) -> None:
        self._servo, self._settings = servo, settings
        self._log = ThrottledLog(node.get_logger())
        self._refusal, self._refused_until = "", -math.inf
        # The kind of commands that was chosen; None as long as none was.
        self._chosen: type[Command] | None = None
        kinds: list[tuple[type, str, Callable[[Any], Command]]] = [
            (TwistStamped, "~/delta_twist_cmds", reader.twist),
            (JointState, "~/joint_velocity_cmds", reader.joint_state),
            (PoseStamped, "~/pose_target_cmds", reader.pose),
        ]
        try:
            from control_msgs.msg import JointJog
        except ImportError as error:
            if getattr(error, "name", "") != "control_msgs":
                node.get_logger().warning(f"no delta_joint_cmds: {error}")
        else:
            kinds.append((JointJog, "~/delta_joint_cmds", reader.joint_jog))
        self._readers = [
            (Inbox(node, kind, topic, _DEPTH, on_message), read) for kind, topic, read in kinds
        ]

    def attend(self, attended: bool) -> None:
        """Switch between reception by the executor and by `take`."""
        for inbox, _ in self._readers:
            inbox.attend(attended)

    def clear(self) -> None:
        """Pass over all messages that wait."""
        for inbox, _ in self._readers:
            list(inbox.take())

    def choose(self, kind: type[Command]) -> None:
        """Take commands of one kind only from now on; a robot that follows others brakes."""
        self._chosen = kind
        if not isinstance(self._servo.command, kind):
            self._servo.forget()

    def take(self, now: float) -> bool:
        """Return all commands that wait to the servo; says whether there was a message."""
        some = False
        for inbox, read in self._readers:
            for message in inbox.take():
                some = True
                try:
                    self._offer(read(message), inbox.topic, now)
                except RobomechError as error:
                    self._refuse(f"command on '{inbox.topic}' refused: {error}", now)
        return some

    def refusal(self, now: float) -> str:
        """Return why a command was refused within the command timeout; empty if none was."""
        return self._refusal if now <= self._refused_until else ""

    def _offer(self, command: Command, topic: str, now: float) -> None:
        """Follow a command, unless one of another kind is being followed, or was chosen."""
        last = self._servo.command
        if self._chosen is not None and not isinstance(command, self._chosen):
            text = f"command on '{topic}' refused: switch_command_type has chosen another kind"
            self._refuse(text, now)
        elif self._servo.wants_to_move(now) and type(last) is not type(command):
            text = f"command on '{topic}' refused: commands of another kind are being followed"
            self._refuse(f"{text}; one kind at a time", now)
        elif not self._servo.paused:
            self._servo.take(command)
            if self._refused_until <= now:
                self._refusal = ""

    def _refuse(self, text: str, now: float) -> None:
        self._refusal = text
        self._log.warning(text)
        self._refused_until = now + self._settings().command_timeout
