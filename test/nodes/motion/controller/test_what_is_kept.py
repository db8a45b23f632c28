"""Trajectories that are over leave nothing large in the controller."""

import gc
import time

import numpy as np
from action_msgs.msg import GoalStatus
from drivers import TIMEOUT
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.msg import ErrorCode
from robomech_ros.execution.controller.trajectory_goal import TrajectoryGoal

COUNT, POINTS = 5, 3000
MOVE = np.array([0.02, 0.0, 0.0, 0.0, 0.0, 0.0])


def alive(kind):
    """Count the objects of a type in this process."""
    return sum(type(each) is kind for each in gc.get_objects())


def until_at_most(most, kind):
    """Wait until so many objects of a type are left."""
    deadline = time.monotonic() + TIMEOUT
    while (count := alive(kind)) > most:
        assert time.monotonic() < deadline, f"{count} of {kind.__name__}, expected {most}"
        time.sleep(0.1)
        gc.collect()


def test_a_goal_that_has_ended_leaves_no_points(arm):
    """The controller kept those of each goal for a minute, refused ones as well."""
    refused = arm.trajectory(*((1e-3 * (k + 1), 10.0) for k in range(POINTS)))
    for _ in range(COUNT):
        status, result = arm.execute(refused)
        assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.LIMIT)
    del refused
    until_at_most(POINTS // 2, JointTrajectoryPoint)


def test_trajectories_of_the_topic_are_kept_no_longer_than_they_take(arm):
    """The last hundred were kept: 700 MB where each has 10,000 points."""
    start = arm.position
    for k in range(COUNT):
        arm.publish(arm.trajectory((0.3, MOVE)))
        arm.until_at(start + (k + 1) * MOVE)
    until_at_most(1, TrajectoryGoal)
