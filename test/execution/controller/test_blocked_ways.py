"""A late trajectory that leaves no way onto it yet is tried again, while the robot goes on."""

import numpy as np
import pytest
from execution_cases import ACCELERATION, NAMES, VELOCITY, to_rest, tolerances

from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.joints import Joints
from robomech_ros.trajectory import Limits, Waypoints

# Not a part of the time between attempts, so that each is made after its time.
CYCLE = 0.003
SENT = 0.6


def arm_in_motion(goal):
    """Three joints with limited jerks, on their way from zero."""
    limits = Limits(NAMES, VELOCITY, ACCELERATION, jerk=100.0, units=["rad"] * 3)
    arm = Joints(limits, np.zeros(3, dtype=bool))
    follower = TrajectoryFollower(arm, SimulatedJoints(np.zeros(3)))
    follower.start(to_rest(goal, 2.0), tolerances(), 0.0)
    for cycle in range(1, round(SENT / CYCLE) + 1):
        follower.advance(cycle * CYCLE)
    return follower


def message(here, late, off, faster, harder):
    """A stream's message of some time ago, of a motion that is nearly that of the robot."""
    t = 0.03 * np.arange(8.0)
    v = here.velocity + faster
    a = here.acceleration + harder
    begin = here.position - late * v + off
    positions = begin + np.outer(t, v) + np.outer(0.5 * t * t, a)
    velocities = v + np.outer(t, a)
    end = positions[-1] + 0.15 * velocities[-1]
    return Waypoints(
        np.append(t, t[-1] + 0.3), np.vstack((positions, end)), np.vstack((velocities, np.zeros(3)))
    )


@pytest.mark.parametrize(
    ("goal", "late", "off", "faster", "harder"),
    [
        (
            (-0.13, -0.58, 0.82),
            0.05,
            (0.0008, 0.0014, 0.0004),
            (0.03, -0.01, 0.02),
            (4.12, 0.96, -5.46),
        ),
        (
            (0.56, 0.69, 0.21),
            0.04,
            (0.0014, -0.0001, 0.0),
            (-0.01, -0.02, 0.0),
            (-2.15, -8.99, -1.83),
        ),
        (
            (0.85, -0.89, -0.54),
            0.09,
            (-0.0023, -0.0008, -0.0001),
            (-0.04, 0.0, 0.0),
            (-3.47, 2.74, 5.9),
        ),
    ],
)
def test_it_is_tried_again_by_the_time_up_to_which_the_robot_has_moved(
    goal, late, off, faster, harder
):
    """By the time of the cycle, what is followed seemed slowed down, and it was refused."""
    arm = arm_in_motion(goal)
    before, here = arm.active, arm.desired
    given = message(here, late, *map(np.array, (off, faster, harder)))
    sent = arm.start(given, tolerances(), SENT, -late)
    assert arm.waiting is sent and arm.active is before
    seen = [here]
    for cycle in range(round(SENT / CYCLE) + 1, 600):
        arm.advance(cycle * CYCLE)
        seen.append(arm.desired)
        if arm.waiting is sent:
            assert before.result is None and arm.active is before
    assert (before.result.end, before.result.code) == (End.ABORTED, 222)
    assert sent.result.end is End.REACHED
    np.testing.assert_allclose(arm.actual.position, given.positions[-1], atol=1e-9)
    changes = np.abs(np.diff([state.velocity for state in seen], axis=0)) / CYCLE
    assert changes.max() <= ACCELERATION * (1.0 + 1e-6)
