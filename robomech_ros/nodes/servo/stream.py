"""A stream of joint positions as a trajectory message."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.nodes.conversions import duration_from_seconds, floats
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
    points = [
        JointTrajectoryPoint(
            positions=floats(position),
            velocities=floats(velocity),
            time_from_start=duration_from_seconds(ahead + time),
        )
        for time, position, velocity in zip(
            samples.times.tolist(), samples.positions, samples.velocities, strict=True
        )
    ]
    message = JointTrajectory(joint_names=list(names), points=points)
    message.header.stamp = stamp
    return message
