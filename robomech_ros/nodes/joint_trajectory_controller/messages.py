"""States of joints in messages of the controller."""

from typing import Any

from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_ros.execution.joints import State
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds, floats


def point_from_state(state: State, time: Any) -> JointTrajectoryPoint:
    """Make a point of a state, at a time (builtin_interfaces/Duration) of a trajectory."""
    return JointTrajectoryPoint(
        positions=floats(state.position),
        velocities=floats(state.velocity),
        accelerations=floats(state.acceleration),
        time_from_start=time,
    )


def fill_feedback(message: Any, desired: State, actual: State, time: float) -> None:
    """Fill the points desired, actual and error of a feedback, at a time (s) of the trajectory."""
    when = duration_from_seconds(time)
    message.desired = point_from_state(desired, when)
    message.actual = point_from_state(actual, when)
    error = desired - actual
    message.error.positions = floats(error.position)
    message.error.velocities = floats(error.velocity)
    message.error.time_from_start = when
