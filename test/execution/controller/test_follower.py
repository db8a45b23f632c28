import numpy as np
import pytest
from execution_cases import (
    ACCELERATION,
    PERIOD,
    assert_continuous,
    follower,
    run,
    single_point,
    to_rest,
    tolerances,
)

from robomech_ros.errors import BadValueError, LimitExceededError
from robomech_ros.execution.controller.follower import Phase
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.rejections import StartMismatchError

GOAL = np.array([0.5, 0.2, -0.1])


def test_holds_at_first():
    arm = follower((0.1, 0.2, 0.3))
    run(arm, 0.0, 0.1)
    assert arm.phase is Phase.HOLDING
    np.testing.assert_array_equal(arm.actual.position, [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(arm.actual.velocity, 0.0)


def test_follows_and_ends_at_the_goal():
    arm = follower()
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    seen = run(arm, 0.0, 0.99)
    assert sent.result is None
    assert sent.progress == pytest.approx(0.99)
    planned = to_rest(GOAL).curve
    for now, state in seen:
        np.testing.assert_allclose(state.position, planned.sample(now).position, atol=1e-12)
        np.testing.assert_allclose(state.velocity, planned.sample(now).velocity, atol=1e-12)
    run(arm, 0.99, 1.02)
    assert (sent.result.end, sent.result.code, sent.result.text) == (End.REACHED, 0, "")
    np.testing.assert_allclose(sent.result.error, 0.0, atol=1e-12)
    np.testing.assert_allclose(arm.actual.position, GOAL, atol=1e-12)
    np.testing.assert_array_equal(arm.actual.velocity, 0.0)


def test_a_refusal_changes_nothing():
    arm = follower()
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.3)
    with pytest.raises(StartMismatchError):
        arm.start(to_rest(GOAL, start=(1.0, 1.0, 1.0)), tolerances(), 0.3)
    with pytest.raises(LimitExceededError):
        arm.start(single_point((1.9, 0.0, 0.0), 0.1), tolerances(), 0.3)
    run(arm, 0.3, 1.02)
    assert sent.result.end is End.REACHED


def test_a_second_trajectory_takes_over_smoothly():
    arm = follower()
    first = arm.start(to_rest(GOAL), tolerances(), 0.0)
    seen = run(arm, 0.0, 0.4)
    second = arm.start(single_point((-0.2, 0.0, 0.0), 0.8), tolerances(), 0.4, by="a newer goal")
    assert (first.result.end, first.result.code) == (End.ABORTED, 222)
    assert first.result.text == "preempted by a newer goal"
    seen += run(arm, 0.4, 1.22)
    assert_continuous(seen)
    assert second.result.end is End.REACHED
    np.testing.assert_allclose(arm.actual.position, [-0.2, 0.0, 0.0], atol=1e-12)


def test_cancel_slows_down_on_the_path_within_the_limits():
    arm = follower()
    goal = np.array([1.0, -0.5, 0.3])
    sent = arm.start(to_rest(goal, duration=1.2), tolerances(), 0.0)
    seen = run(arm, 0.0, 0.6)
    assert arm.stop(End.CANCELLED, 222, "cancelled by the client", sent)
    assert arm.phase is Phase.STOPPING
    seen += run(arm, 0.6, 1.2)
    assert arm.phase is Phase.HOLDING
    assert (sent.result.end, sent.result.text) == (End.CANCELLED, "cancelled by the client")
    np.testing.assert_array_equal(arm.actual.velocity, 0.0)
    # On the straight line of this path, beyond where the stop began and short of the goal.
    position = arm.actual.position
    np.testing.assert_allclose(position / goal, position[0] / goal[0], atol=1e-12)
    assert 0.5 < position[0] < 0.75
    velocities = np.array([state.velocity for _, state in seen])
    # 1 % for what the integration loses within a cycle.
    assert np.abs(np.diff(velocities, axis=0)).max() <= ACCELERATION * PERIOD * 1.01
    stopped = next(now for now, state in seen if now > 0.61 and not state.velocity.any())
    speed = velocities[59].max()
    assert stopped - 0.6 <= speed / ACCELERATION + 2 * PERIOD


def test_a_stop_is_within_limits_wherever_it_begins():
    for begin in np.arange(0.02, 1.19, 0.06):
        arm = follower()
        arm.start(to_rest((1.15, -0.5, 0.3), duration=1.2), tolerances(), 0.0)
        seen = run(arm, 0.0, begin)
        arm.stop(End.ABORTED, 222, "hold")
        seen += run(arm, begin, begin + 1.2)
        velocities = np.array([state.velocity for _, state in seen])
        assert np.abs(np.diff(velocities, axis=0)).max() <= ACCELERATION * PERIOD * 1.02
        assert not velocities[-1].any()
        assert arm.phase is Phase.HOLDING


def test_stop_with_nothing_to_stop():
    arm = follower()
    assert not arm.stop(End.ABORTED, 222, "hold")
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 1.1)
    assert not arm.stop(End.CANCELLED, 222, "too late", sent)


def test_a_new_trajectory_while_slowing_down():
    arm = follower()
    first = arm.start(to_rest(GOAL), tolerances(), 0.0)
    seen = run(arm, 0.0, 0.5)
    arm.stop(End.CANCELLED, 222, "cancelled by the client", first)
    seen += run(arm, 0.5, 0.52)
    second = arm.start(single_point((0.0, 0.0, 0.0), 0.8), tolerances(), 0.52)
    assert first.result.end is End.CANCELLED
    seen += run(arm, 0.52, 1.4)
    assert_continuous(seen)
    assert second.result.end is End.REACHED


def test_halt_is_at_once():
    arm = follower()
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.5)
    position = arm.actual.position
    arm.halt(222, "the controller shuts down")
    assert (sent.result.end, sent.result.text) == (End.ABORTED, "the controller shuts down")
    np.testing.assert_array_equal(arm.actual.position, position)
    np.testing.assert_array_equal(arm.actual.velocity, 0.0)
    np.testing.assert_allclose(sent.result.error, GOAL - position, atol=1e-12)


def test_reset():
    arm = follower()
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.5)
    arm.reset(np.array([0.3, 0.2, 0.1]), "reset")
    assert sent.result.end is End.ABORTED
    np.testing.assert_array_equal(arm.actual.position, [0.3, 0.2, 0.1])


def test_a_future_trajectory_waits_while_the_present_one_goes_on():
    arm = follower()
    first = arm.start(to_rest(GOAL), tolerances(), 0.0)
    second = arm.start(to_rest((0.0, 0.0, 0.0), start=GOAL), tolerances(), 0.1, delay=1.103)
    seen = run(arm, 0.0, 1.2)
    assert first.result.end is End.REACHED
    assert second.time == 0.0
    seen += run(arm, 1.2, 1.21)
    assert second.time == pytest.approx(0.007)
    seen += run(arm, 1.21, 2.3)
    assert_continuous(seen)
    assert second.result.end is End.REACHED


def test_a_future_trajectory_replaces_the_present_one_in_motion():
    arm = follower()
    first = arm.start(to_rest(GOAL), tolerances(), 0.0)
    second = arm.start(single_point((0.0, 0.0, 0.0), 1.0), tolerances(), 0.1, delay=0.4)
    seen = run(arm, 0.0, 0.49)
    assert first.result is None
    seen += run(arm, 0.49, 1.6)
    assert first.result.text == "preempted by a trajectory that was to begin now"
    assert_continuous(seen)
    assert second.result.end is End.REACHED


def test_a_future_trajectory_that_no_longer_fits():
    arm = follower()
    arm.start(to_rest(GOAL), tolerances(), 0.0)
    second = arm.start(to_rest((0.0, 0.0, 0.0), start=GOAL), tolerances(), 0.1, delay=1.5)
    run(arm, 0.0, 0.3)
    arm.stop(End.ABORTED, 222, "hold", arm.active)
    run(arm, 0.3, 2.0)
    assert (second.result.end, second.result.code) == (End.ABORTED, 221)
    assert "when its time had come" in second.result.text
    assert "'shoulder'" in second.result.text


def test_waiting_trajectories_are_cancelled_and_replaced():
    arm = follower()
    first = arm.start(to_rest(GOAL), tolerances(), 0.0, delay=1.0)
    second = arm.start(to_rest(GOAL), tolerances(), 0.0, delay=1.0, by="a newer goal")
    assert first.result.text == "before it began: replaced by a newer goal"
    assert arm.stop(End.CANCELLED, 222, "cancelled", second)
    assert second.result.end is End.CANCELLED
    with pytest.raises(BadValueError, match="at most 3600 s"):
        arm.start(to_rest(GOAL), tolerances(), 0.0, delay=1e9)


def test_path_tolerance_names_joint_and_amount():
    arm = follower(lag=0.1)
    sent = arm.start(to_rest((0.8, 0.1, 0.0)), tolerances(path=0.05), 0.0)
    run(arm, 0.0, 1.5)
    assert (sent.result.end, sent.result.code) == (End.ABORTED, 223)
    assert sent.result.text.startswith("joint 'shoulder' is 0.05")
    assert "off its path, the tolerance is 0.05 rad" in sent.result.text
    assert not arm.actual.velocity.any()


def test_goal_tolerance_names_joint_and_amount():
    arm = follower(lag=0.4)
    sent = arm.start(to_rest((0.8, 0.1, 0.0)), tolerances(goal_time=0.1), 0.0)
    run(arm, 0.0, 1.3)
    assert (sent.result.end, sent.result.code) == (End.ABORTED, 224)
    assert sent.result.text.startswith("joint 'shoulder' is 0.")
    assert "off its goal, the tolerance is 0.01 rad" in sent.result.text
    assert sent.result.error[0] > 0.01


def test_velocity_tolerance_at_the_goal():
    arm = follower(lag=0.4)
    loose = tolerances(goal=np.inf, velocity=1e-3, goal_time=0.05)
    sent = arm.start(to_rest((0.8, 0.1, 0.0)), loose, 0.0)
    run(arm, 0.0, 1.3)
    assert sent.result.code == 224
    assert "rad/s off rest" in sent.result.text


def test_a_lagging_robot_may_take_its_time():
    arm = follower(lag=0.05)
    sent = arm.start(to_rest(GOAL), tolerances(goal=1e-3, velocity=1e-2), 0.0)
    run(arm, 0.0, 1.5)
    assert sent.result.end is End.REACHED


def test_a_clock_that_jumps_back_does_no_harm():
    arm = follower()
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    run(arm, 0.0, 0.5)
    before = arm.actual.position
    arm.advance(-1000.0)
    np.testing.assert_array_equal(arm.actual.position, before)
    run(arm, -1000.0, -999.4)
    assert sent.result.end is End.REACHED


def test_the_outcome_is_told_once():
    told = []
    arm = follower()
    arm.start(to_rest(GOAL), tolerances(), 0.0, on_end=told.append)
    run(arm, 0.0, 1.2)
    arm.halt(222, "again")
    assert len(told) == 1


@pytest.mark.parametrize("scale", [0.5, 0.1])
def test_scaled_from_the_begin(scale):
    arm = follower()
    arm.motion.scale = scale
    sent = arm.start(to_rest(GOAL), tolerances(), 0.0)
    planned = to_rest(GOAL).curve
    for now, state in run(arm, 0.0, 0.95 / scale):
        np.testing.assert_allclose(state.position, planned.sample(scale * now).position, atol=1e-9)
        velocity = scale * planned.sample(scale * now).velocity
        np.testing.assert_allclose(state.velocity, velocity, atol=1e-9)
    assert sent.result is None
    run(arm, 0.95 / scale, 1.0 / scale + 0.05)
    assert sent.result.end is End.REACHED


def test_scale_changes_on_the_way_within_the_limits():
    arm = follower()
    goal = np.array([1.0, -0.5, 0.3])
    sent = arm.start(to_rest(goal, duration=1.2), tolerances(), 0.0)
    seen = run(arm, 0.0, 0.5)
    arm.motion.scale = 0.2
    seen += run(arm, 0.5, 1.5)
    slow = seen[-1][1].position
    assert 0.3 < slow[0] < 0.8
    arm.motion.scale = 0.0
    seen += run(arm, 1.5, 2.5)
    np.testing.assert_array_equal(arm.actual.velocity, 0.0)
    assert sent.result is None
    arm.motion.scale = 1.0
    seen += run(arm, 2.5, 4.0)
    assert sent.result.end is End.REACHED
    assert_continuous(seen, 1.02 * ACCELERATION)
    positions = np.array([state.position for _, state in seen])
    np.testing.assert_allclose(positions, np.outer(positions[:, 0], goal), atol=1e-9)


def test_a_stop_and_a_replacement_while_scaled_are_smooth():
    arm = follower()
    arm.motion.scale = 0.3
    arm.start(to_rest((1.0, -0.5, 0.3), duration=1.2), tolerances(), 0.0)
    seen = run(arm, 0.0, 2.0)
    arm.start(single_point((0.0, 0.0, 0.0), 1.5), tolerances(), 2.0)
    seen += run(arm, 2.0, 2.6)
    arm.stop(End.ABORTED, 222, "hold")
    seen += run(arm, 2.6, 4.0)
    assert arm.phase is Phase.HOLDING
    assert_continuous(seen)
