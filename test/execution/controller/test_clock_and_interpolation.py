"""A clock that jumps, stamps that do not wait, points that are not interpolated."""

import math

import numpy as np
import pytest
from execution_cases import assert_continuous, follower, run, single_point, to_rest, tolerances

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.follower import Phase
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.rejections import StartMismatchError
from robomech_ros.trajectory import Waypoints

GOAL = np.array([0.5, 0.2, -0.1])


def test_a_clock_that_jumps_is_told():
    arm = follower()
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.5)
    arm.clock_jumped(5.0)
    seen = run(arm, 0.5, 1.2)
    assert_continuous(seen)
    assert (sent.result.end, sent.result.code) == (End.REACHED, 0)
    assert sent.result.text == (
        "the clock jumped forward by 5 s on the way, and the robot went on from where it was"
    )
    sent = arm.start(to_rest((0.0, 0.0, 0.0), start=GOAL), tolerances(), 1.2)
    arm.clock_jumped(-5.0)
    arm.stop(End.CANCELLED, 222, "cancelled")
    run(arm, 1.2, 1.3)
    assert sent.result.text.startswith("cancelled; the clock jumped back by 5 s on the way")


def test_what_waits_keeps_to_its_stamp_when_the_clock_jumps():
    arm = follower()
    # Reached at 2.0 and 4.0 s by the stamps, which are 1.5 s nearer after the jump.
    waypoints = Waypoints(np.array([1.0, 3.0]), np.array([[0.1, 0.0, 0.0], [0.2, 0.0, 0.0]]))
    sent = arm.start(waypoints, tolerances(), 0.0, delay=1.0)
    arm.clock_jumped(0.7)
    run(arm, 0.0, 0.3)
    assert not arm.actual.velocity.any()
    arm.clock_jumped(1.8)
    seen = run(arm, 0.3, 0.4)
    # What should have been reached by now is passed over.
    assert sent.late == pytest.approx(1.8)
    assert seen[-1][1].velocity[0] == pytest.approx(0.2 / 1.2)
    run(arm, 0.4, 1.6)
    assert (sent.result.end, sent.result.text) == (End.REACHED, "")
    late = arm.start(to_rest(GOAL, start=(0.2, 0.0, 0.0)), tolerances(), 1.6, delay=1.0)
    arm.clock_jumped(3.0)
    run(arm, 1.6, 1.7)
    assert (late.result.end, late.result.code) == (End.ABORTED, 221)
    assert late.result.text.startswith("when its time had come: the trajectory ended 1 s ago")
    assert not arm.actual.velocity.any()


def test_a_stamp_in_the_future_that_does_not_wait():
    arm = follower(wait_for_stamp=False)
    first = arm.start(to_rest(GOAL), tolerances(), 0.0)
    seen = run(arm, 0.0, 0.5)
    second = arm.start(to_rest((0.0, 0.0, 0.0), start=(0.1, 0.1, 0.1)), tolerances(), 0.5, delay=1)
    assert (first.result.code, first.result.text) == (222, "preempted by a newer trajectory")
    seen += run(arm, 0.5, 1.5)
    # Its first point is reached when the stamp says so.
    np.testing.assert_allclose(arm.actual.position, 0.1, atol=1e-9)
    seen += run(arm, 1.5, 2.6)
    assert_continuous(seen)
    assert second.result.end is End.REACHED


def test_without_interpolation_the_joints_are_told_the_next_point():
    arm = follower(interpolate=False)
    points = Waypoints(np.array([0.5, 1.0, 1.5]), np.outer([0.1, 0.3, 0.2], np.ones(3)))
    sent = arm.start(points, tolerances(), 0.0)
    for now, state in run(arm, 0.0, 1.6):
        told = 0.0 if now < 0.5 - 1e-9 else 0.3 if now < 1.0 - 1e-9 else 0.2
        np.testing.assert_array_equal(state.position, told, err_msg=str(now))
        np.testing.assert_array_equal(state.velocity, 0.0)
    assert sent.result.end is End.REACHED
    single = arm.start(single_point(GOAL, 0.5), tolerances(), 2.0)
    run(arm, 2.0, 2.48)
    np.testing.assert_array_equal(arm.actual.position, 0.2)
    run(arm, 2.48, 2.53)
    assert single.result.end is End.REACHED
    np.testing.assert_array_equal(arm.actual.position, GOAL)


def test_without_interpolation_limits_and_the_start_are_checked_as_well():
    arm = follower(interpolate=False)
    with pytest.raises(LimitExceededError, match="velocity of joint 'shoulder' is 3"):
        arm.start(single_point((1.5, 0.0, 0.0), 0.5), tolerances(), 0.0)
    with pytest.raises(LimitExceededError, match="position of joint 'elbow' is 2.5"):
        arm.start(single_point((0.0, 2.5, 0.0), 5.0), tolerances(), 0.0)
    with pytest.raises(StartMismatchError, match="joint 'shoulder' at 0.5"):
        arm.start(to_rest(GOAL, start=(0.5, 0.0, 0.0)), tolerances(), 0.0)
    assert arm.active is None
    turned = to_rest((0.1, 0.0, math.tau), start=(0.0, 0.0, math.tau))
    arm.start(turned, tolerances(), 0.0)
    run(arm, 0.0, 0.02)
    np.testing.assert_allclose(arm.actual.position, [0.1, 0.0, 0.0], atol=1e-15)
    arm.stop(End.CANCELLED, 222, "cancelled")
    run(arm, 0.02, 0.1)
    assert arm.phase is Phase.HOLDING
