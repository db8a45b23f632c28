"""The message that a delivery is sent as."""

import copy

import numpy as np
from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.execution.client.delivery import Delivery
from robomech_ros.nodes.common.message_fields import duration_from_seconds, floats
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["trajectory_message"]

_NANO = 1_000_000_000


def trajectory_message(delivery: Delivery, now: int) -> JointTrajectory:
    """Make the message of a delivery.

    Parameters
    ----------
    delivery : Delivery
        What is to be sent.
    now : int
        ROS time of `sent_at`, ns; where the pace is changed on the way, the stamp counts from it.

    Returns
    -------
    JointTrajectory
        As it came, unless it is sent at another pace.
    """
    if not delivery.paced:
        message: JointTrajectory = delivery.trajectory
        return message
    header = copy.copy(delivery.trajectory.header)
    if delivery.paced_on_way:
        header.stamp = _stamp(now, delivery.delay)
    waypoints = delivery.waypoints
    message = JointTrajectory(header=header, joint_names=list(delivery.names))
    for k, time in enumerate(waypoints.times.tolist()):
        message.points.append(
            JointTrajectoryPoint(
                positions=floats(waypoints.positions[k]),
                velocities=_given(waypoints.velocities, k),
                accelerations=_given(waypoints.accelerations, k),
                time_from_start=duration_from_seconds(time),
            )
        )
    return message


def _stamp(now: int, delay: float) -> Time:
    """Give the stamp `delay` (s) from now; 0, which means at once, where there is none."""
    if delay <= 0.0:
        return Time()
    seconds, nanoseconds = divmod(now + round(delay * _NANO), _NANO)
    return Time(sec=seconds, nanosec=nanoseconds)


def _given(rows: FloatArray | None, k: int) -> object:
    """Give a row; nothing where it is NaN."""
    if rows is None or np.isnan(rows[k]).any():
        return []
    return floats(rows[k])
