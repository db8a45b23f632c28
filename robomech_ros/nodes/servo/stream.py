"""A stream of joint positions as a trajectory message."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.nodes.common.conversions import duration_from_seconds, floats
from robomech_ros.servo.motion import Samples

__all__ = ["stream_message"]


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
