"""MoveIt's servo interface besides command topics: choice of the command type, and status."""

from collections.abc import Callable
from typing import Any

from moveit_msgs.msg import ServoStatus as MoveItStatus
from moveit_msgs.srv import ServoCommandType
from rclpy.node import Node

from robomech_interfaces.msg import ServoStatus
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.servo.status import MOVEIT_STATUS
from robomech_ros.servo.commands import Command, JointCommand, PoseCommand, TwistCommand

_KINDS: dict[int, type[Command]] = {
    ServoCommandType.Request.JOINT_JOG: JointCommand,
    ServoCommandType.Request.TWIST: TwistCommand,
    ServoCommandType.Request.POSE: PoseCommand,
}


class MoveItInterface:
    """The service switch_command_type, and the status as MoveIt's clients read it.

    - ``choose``: called with the only type of command that the servo is to accept.
    """

    def __init__(self, node: Node, choose: Callable[[type[Command]], None]) -> None:
        self._log, self._choose = ThrottledLog(node.get_logger()), choose
        self._publisher = node.create_publisher(MoveItStatus, MOVEIT_STATUS, 10)
        serve(node, ServoCommandType, "~/switch_command_type", self._switch)

    def publish(self, status: ServoStatus) -> None:
        """Publish a status; what MoveIt has no code for has its text."""
        code = status.code
        if code > MoveItStatus.JOINT_BOUND:
            unknown = status.code == ServoStatus.NO_STATE
            code = MoveItStatus.INVALID if unknown else MoveItStatus.NO_WARNING
        self._publisher.publish(MoveItStatus(code=code, message=status.message))

    def _switch(self, request: Any, response: Any) -> Any:
        kind = _KINDS.get(request.command_type)
        response.success = kind is not None
        if kind is None:
            text = f"no command type {request.command_type}: 0 is JOINT_JOG, 1 TWIST, 2 POSE"
            self._log.error(text)
        else:
            self._choose(kind)
        return response
