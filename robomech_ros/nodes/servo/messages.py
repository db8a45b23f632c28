"""The message of the servo's status."""

from collections.abc import Sequence
from typing import Any

from robomech_interfaces.msg import ServoStatus
from robomech_ros.servo.report import ServoCondition, ServoReport

_CODES = {
    ServoCondition.NO_WARNING: ServoStatus.NO_WARNING,
    ServoCondition.APPROACHING_SINGULARITY: ServoStatus.DECELERATE_FOR_APPROACHING_SINGULARITY,
    ServoCondition.SINGULARITY: ServoStatus.HALT_FOR_SINGULARITY,
    ServoCondition.LEAVING_SINGULARITY: ServoStatus.DECELERATE_FOR_LEAVING_SINGULARITY,
    ServoCondition.JOINT_BOUND: ServoStatus.JOINT_BOUND,
    ServoCondition.RATE_BOUND: ServoStatus.RATE_BOUND,
    ServoCondition.IMPOSSIBLE: ServoStatus.INVALID,
    ServoCondition.STALE_COMMAND: ServoStatus.STALE_COMMAND,
    ServoCondition.PAUSED: ServoStatus.PAUSED,
}


def status_message(
    stamp: Any, report: ServoReport | None, refusal: str, no_state: str, joints: Sequence[str] = ()
) -> ServoStatus:
    """Make the message.

    Parameters
    ----------
    stamp : builtin_interfaces.msg.Time
        By the clock of the node.
    report : ServoReport or None
        What was made of the command; None where the state of the joints is not known.
    refusal : str
        Why the last command was refused; empty if it was not.
    no_state : str
        Why the state of the joints is unknown, or off the commands; empty otherwise.
    joints : sequence of str
        Those that this is about.
    """
    status = ServoStatus(code=ServoStatus.NO_STATE, message=no_state, joint_names=list(joints))
    status.header.stamp = stamp
    status.condition_number = float("nan")
    if report is not None:
        status.code = _CODES[report.condition]
        status.message = report.text
        status.scale = report.scale
        status.condition_number = report.condition_number
        status.joint_names = list(report.joints)
    if refusal:
        status.code, status.message = ServoStatus.INVALID, refusal
    return status
