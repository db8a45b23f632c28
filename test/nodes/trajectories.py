"""Trajectory messages as tests read them."""

import numpy as np

from robomech_ros.nodes.common.messages.message_fields import seconds_from_duration
from robomech_ros.trajectory import Waypoints


def waypoints(trajectory):
    """Return the points of a JointTrajectory message."""
    seconds = [seconds_from_duration(point.time_from_start, "time") for point in trajectory.points]
    states = (
        np.array([getattr(point, name) for point in trajectory.points])
        for name in ("positions", "velocities", "accelerations")
    )
    return Waypoints(np.array(seconds), *states)
