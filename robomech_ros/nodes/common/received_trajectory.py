"""Trajectory messages for the execution."""

from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.received_trajectory import ReceivedTrajectory

_NANO = 1e-9


def received_trajectory(message: JointTrajectory) -> ReceivedTrajectory:
    """Hand over a message that nothing is known about; its points are not copied."""
    times = [
        point.time_from_start.sec + point.time_from_start.nanosec * _NANO
        for point in message.points
    ]
    return ReceivedTrajectory(message.joint_names, times, message.points)
