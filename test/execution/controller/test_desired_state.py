"""Desired states of a follower in the future and in the past."""

import numpy as np
import pytest
from execution_cases import follower, run, to_rest, tolerances

from robomech_ros.execution.controller.desired_state import desired_state
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.rejections import TrajectoryRefusedError

GOAL = np.array([0.5, 0.2, -0.1])


def test_while_holding():
    arm = follower((0.1, 0.2, 0.3))
    run(arm, 0.0, 1.0)
    for ahead in (-1.0, 0.0, 5.0):
        np.testing.assert_array_equal(desired_state(arm, ahead).position, [0.1, 0.2, 0.3])
    with pytest.raises(TrajectoryRefusedError, match=r"1.5 s ago is not known .* held since 1 s"):
        desired_state(arm, -1.5)


def test_under_way_and_after():
    arm = follower()
    arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.4)
    curve = to_rest(GOAL).curve
    for ahead in (-0.4, -0.1, 0.0, 0.3):
        expected = curve.sample(0.4 + ahead)
        np.testing.assert_allclose(desired_state(arm, ahead).position, expected.position)
        np.testing.assert_allclose(desired_state(arm, ahead).velocity, expected.velocity)
    later = desired_state(arm, 10.0)
    np.testing.assert_allclose(later.position, GOAL)
    np.testing.assert_array_equal(later.velocity, 0.0)
    with pytest.raises(TrajectoryRefusedError, match=r"under way began 0.4 s ago"):
        desired_state(arm, -0.5)


def test_what_waits_counts_from_its_begin_on():
    arm = follower()
    arm.start(to_rest(GOAL), tolerances(), 0.0)
    arm.start(to_rest(2 * GOAL, start=GOAL), tolerances(), 0.0, delay=2.0)
    np.testing.assert_allclose(desired_state(arm, 1.9).position, GOAL)
    np.testing.assert_allclose(desired_state(arm, 2.5).position, 1.5 * GOAL)


def test_a_stop_is_foreseen():
    arm = follower()
    arm.start(to_rest(GOAL, duration=0.8), tolerances(), 0.0)
    run(arm, 0.0, 0.4)
    arm.stop(End.ABORTED, 222, "hold")
    foreseen = desired_state(arm, 0.1).position
    with pytest.raises(TrajectoryRefusedError, match="is being stopped"):
        desired_state(arm, -0.1)
    run(arm, 0.4, 0.5)
    np.testing.assert_allclose(arm.desired.position, foreseen, atol=1e-5)


def test_at_the_present_pace():
    arm = follower()
    arm.motion.scale = 0.5
    arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.8)
    foreseen = desired_state(arm, 0.4)
    run(arm, 0.8, 1.2)
    np.testing.assert_allclose(foreseen.position, arm.desired.position, atol=1e-9)
    np.testing.assert_allclose(foreseen.velocity, arm.desired.velocity, atol=1e-9)
    with pytest.raises(TrajectoryRefusedError, match=r"under way began 1.2 s ago"):
        desired_state(arm, -1.5)
