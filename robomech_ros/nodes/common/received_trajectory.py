"""Trajectory messages, as the execution takes them."""

from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.received_trajectory import GivenTrajectory

__all__ = ["given_trajectory"]

_NANO = 1e-9


def given_trajectory(message: JointTrajectory) -> GivenTrajectory:
    """Hand over a message that nothing is known about; its points are not copied."""
    times = [
        point.time_from_start.sec + point.time_from_start.nanosec * _NANO
        for point in message.points
    ]
    return GivenTrajectory(message.joint_names, times, message.points)
