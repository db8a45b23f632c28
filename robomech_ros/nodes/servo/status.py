"""The servo's status: every period while it drives, otherwise on changes."""

from collections.abc import Callable

from rclpy.node import Node

from robomech_interfaces.msg import ServoStatus
from robomech_ros.servo.report import ServoCondition, ServoReport

# MoveIt's servo, a node of this name, publishes its status here.
MOVEIT_STATUS = "servo_node/status"

_CODES = {
    ServoCondition.NO_WARNING: ServoStatus.NO_WARNING,
    ServoCondition.APPROACHING_SINGULARITY: ServoStatus.DECELERATE_FOR_APPROACHING_SINGULARITY,
    ServoCondition.SINGULARITY: ServoStatus.HALT_FOR_SINGULARITY,
    ServoCondition.LEAVING_SINGULARITY: ServoStatus.DECELERATE_FOR_LEAVING_SINGULARITY,
    ServoCondition.APPROACHING_CONTACT: ServoStatus.DECELERATE_FOR_COLLISION,
    ServoCondition.CONTACT: ServoStatus.HALT_FOR_COLLISION,
    ServoCondition.JOINT_BOUND: ServoStatus.JOINT_BOUND,
    ServoCondition.RATE_BOUND: ServoStatus.RATE_BOUND,
    ServoCondition.IMPOSSIBLE: ServoStatus.INVALID,
    ServoCondition.STALE_COMMAND: ServoStatus.STALE_COMMAND,
    ServoCondition.PAUSED: ServoStatus.PAUSED,
}

# How often a status is repeated while nothing moves (s).
REPEATED = 1.0


def status_topic(node: Node, servo: str = "~") -> str:
    """Return the topic of our status of a servo, as a node knows its name.

    A topic has one type, and the one that MoveIt's servo has is left to MoveIt's type.
    """
    topic = "~/status".replace("~", servo)
    taken = node.resolve_topic_name(topic) == node.resolve_topic_name(MOVEIT_STATUS)
    return f"{servo}/servo_status" if taken else topic


class StatusPublisher:
    """Publishes the status of a servo.

    - ``refusal``: returns why a command was refused just before a time (s); empty if none was.
    """

    def __init__(self, node: Node, refusal: Callable[[float], str]) -> None:
        self._clock, self._refusal = node.get_clock(), refusal
        self._publisher = node.create_publisher(ServoStatus, status_topic(node), 10)
        #: Called with every message that is published.
        self.also: Callable[[ServoStatus], None] = lambda status: None
        self._published: tuple[tuple[object, ...], float] = ((), -REPEATED)

    def is_new(self, situation: tuple[object, ...], now: float) -> bool:
        """Return whether a situation, or a refusal in it, was not reported in the last second."""
        situation = (*situation, self._refusal(now))
        if situation == self._published[0] and now < self._published[1] + REPEATED:
            return False
        self._published = (situation, now)
        return True

    def publish(
        self,
        now: float,
        report: ServoReport | None = None,
        why: str = "",
        joints: tuple[str, ...] = (),
    ) -> None:
        """Publish a report, or why there is none and the joints at fault."""
        status = ServoStatus(code=ServoStatus.NO_STATE, message=why, joint_names=list(joints))
        status.header.stamp = self._clock.now().to_msg()
        status.condition_number = float("nan")
        if report is not None:
            status.code = _CODES[report.condition]
            status.message = report.text
            status.scale = report.scale
            status.condition_number = report.condition_number
            status.joint_names = list(report.joints)
        if refusal := self._refusal(now):
            status.code, status.message = ServoStatus.INVALID, refusal
        self._publisher.publish(status)
        self.also(status)
