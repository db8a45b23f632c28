"""The messages that the servo publishes: its stream of joint positions, and its status."""

from collections.abc import Sequence
from typing import Any

from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.msg import ServoStatus
from robomech_ros.nodes.common.message_fields import duration_from_seconds, floats
from robomech_ros.servo.motion import Samples
from robomech_ros.servo.report import ServoCondition, ServoReport

__all__ = ["status_message", "stream_message"]

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


def stream_message(
    names: Sequence[str], samples: Samples, ahead: float, stamp: Time
) -> JointTrajectory:
    """Make the message: positions and velocities only, between which a cubic is exact.

    Parameters
    ----------
    names : sequence of str
        The n joints.
    samples : Samples
        From a knot to rest.
    ahead : float
        How long after the stamp the knot is (s).
    stamp : Time
        When the message was made, in ROS time.
    """
    q, v, end, n = floats(samples.positions), floats(samples.velocities), 0, len(names)
    points = []
    for time in samples.times.tolist():
        begin, end = end, end + n
        point = JointTrajectoryPoint(time_from_start=duration_from_seconds(ahead + time))
        # A part of Python's array is taken without conversion.
        point.positions, point.velocities = q[begin:end], v[begin:end]
        points.append(point)
    message = JointTrajectory(joint_names=list(names), points=points)
    message.header.stamp = stamp
    return message


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
