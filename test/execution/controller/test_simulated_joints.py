"""Faults of simulated joints, and what becomes of motions then."""

import numpy as np
import pytest
from execution_cases import PERIOD, follower, run, single_point, to_rest, tolerances

from robomech_ros.execution.controller.simulated_joints import Faults, SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.joints import at_rest

GOAL = np.array([0.5, 0.2, -0.1])


def faults(**wrong):
    given = {"stuck": np.zeros(3, dtype=bool), "offset": np.zeros(3), **wrong}
    return Faults(**given)


def faulty(**wrong):
    arm = follower()
    arm.simulated_joints.inject(faults(**wrong))
    return arm


def test_none():
    assert faults().none
    assert not faults(delay=0.1).none
    assert not faults(offset=np.array([0.0, 0.1, 0.0])).none


def test_a_stuck_joint_violates_the_path_tolerance():
    arm = faulty(stuck=np.array([False, True, False]))
    sent = arm.start(to_rest(GOAL), tolerances(path=0.05), 0.0)
    run(arm, 0.0, 1.5)
    assert (sent.result.end, sent.result.code) == (End.ABORTED, 223)
    assert "joint 'elbow' is 0.05" in sent.result.text
    assert "off its path, the tolerance is 0.05 rad" in sent.result.text
    assert arm.actual.position[1] == 0.0
    assert arm.actual.position[0] > 0.05


def test_a_stuck_joint_comes_loose():
    arm = faulty(stuck=np.array([True, False, False]))
    sent = arm.start(to_rest(GOAL), tolerances(goal_time=np.inf), 0.0)
    run(arm, 0.0, 5.0)
    assert sent.result is None
    arm.simulated_joints.inject(faults())
    run(arm, 5.0, 5.1)
    assert sent.result.end is End.REACHED
    np.testing.assert_allclose(arm.actual.position, GOAL, atol=1e-12)


def test_delay():
    arm, delay = faulty(delay=0.2), 0.2
    arm.start(to_rest(GOAL), tolerances(), 0.0)
    planned = to_rest(GOAL).curve
    for now, state in run(arm, 0.0, 1.0):
        late = planned.sample(max(now - delay, 0.0))
        np.testing.assert_allclose(state.position, late.position, atol=1e-9)
    run(arm, 1.0, 1.3)
    np.testing.assert_allclose(arm.actual.position, GOAL, atol=1e-12)


def test_dropped_commands_are_made_up_for_by_the_next():
    arm = faulty(dropped=0.5, seed=3)
    sent = arm.start(to_rest(GOAL), tolerances(path=0.05), 0.0)
    positions = np.array([state.position[0] for _, state in run(arm, 0.0, 1.1)])
    still = np.diff(positions[:100]) == 0.0
    assert 30 < still.sum() < 70
    assert sent.result.end is End.REACHED


def test_all_commands_dropped():
    arm = faulty(dropped=1.0)
    sent = arm.start(to_rest(GOAL), tolerances(goal_time=0.1), 0.0)
    run(arm, 0.0, 1.3)
    assert (sent.result.end, sent.result.code) == (End.ABORTED, 224)
    np.testing.assert_array_equal(arm.actual.position, 0.0)


def test_offset_is_seen_and_does_not_grow():
    shift = np.array([0.0, 0.003, 0.0])
    arm = faulty(offset=shift)
    for k in range(3):
        goal = GOAL * (1 - k % 2)
        sent = arm.start(single_point(goal, 1.0), tolerances(), 2.0 * k)
        run(arm, 2.0 * k, 2.0 * k + 1.5)
        assert sent.result.end is End.REACHED
        np.testing.assert_allclose(arm.actual.position, goal + shift, atol=1e-12)
        arm.stop(End.ABORTED, 222, "hold")
    arm.halt(222, "halt")
    np.testing.assert_allclose(arm.actual.position, GOAL + shift, atol=1e-12)


def test_noise_is_the_same_for_the_same_seed():
    def seen(seed):
        arm = faulty(noise=1e-3, seed=seed)
        return np.array([state.position for _, state in run(arm, 0.0, 10.0)])

    first = seen(7)
    np.testing.assert_array_equal(first, seen(7))
    assert np.abs(first - seen(8)).max() > 1e-3
    assert first.std() == pytest.approx(1e-3, rel=0.05)


def test_lag_is_that_of_first_order():
    joints = SimulatedJoints(np.zeros(3), lag=0.5)
    for _ in range(50):
        state = joints.follow(at_rest(GOAL), PERIOD)
    np.testing.assert_allclose(state.position, GOAL * (1.0 - np.exp(-1.0)), rtol=1e-12)


def test_a_stop_with_delay_leaves_the_joints_where_they_are():
    arm = faulty(delay=0.1)
    arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.5)
    arm.stop(End.ABORTED, 222, "hold")
    run(arm, 0.5, 1.0)
    place = arm.actual.position
    run(arm, 1.0, 2.0)
    np.testing.assert_array_equal(arm.actual.position, place)
