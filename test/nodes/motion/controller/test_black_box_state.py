"""Interpolation, time, and what the controller tells of its state, as in ros2_control's tests."""

import math

import numpy as np
import pytest
from control_msgs.msg import JointTrajectoryControllerState, SpeedScalingFactor
from follow_cases import (
    ABORTED,
    CANCELED,
    CODES,
    FAR,
    JOINTS,
    NEAR,
    SLOWLY,
    START,
    SUCCEEDED,
    ZERO,
    lagging,
)
from rclpy.duration import Duration
from rclpy.time import Time


def test_hold_on_startup(follower):
    arm = follower()
    answer = arm.query()
    assert answer.success
    assert list(answer.name) == list(JOINTS)
    np.testing.assert_array_equal(answer.position, START)
    np.testing.assert_array_equal(answer.velocity, ZERO)
    np.testing.assert_array_equal(arm.position, START)


def test_timeout(follower):
    arm = follower(tracking_lag=5.0, goal_time=0.0, cmd_timeout=0.3)
    status, code, text = arm.follow(arm.points((0.3, FAR, ZERO, ZERO)))
    assert (status, code) == (ABORTED, CODES.INVALID_GOAL)
    assert "still not at its goal 0.3" in text
    arm.until_still()


@pytest.mark.parametrize("given", ["pos", "pos_vel", "pos_vel_accel"])
def test_interpolation(follower, given):
    # Upstream: interpolation_pos_vel, interpolation_pos_vel_accel.
    arm = follower()
    goal, part = START + 0.2, 0.25
    states = [goal, ZERO, ZERO][: len(given.split("_"))]
    starts = [START, ZERO, ZERO][: len(states)]
    trajectory = arm.stamped(arm.points((0.0, *starts), (2.0, *states)), 30.0)
    arm.publish(trajectory)
    expected = {
        "pos": part,
        "pos_vel": 3.0 * part**2 - 2.0 * part**3,
        "pos_vel_accel": 10.0 * part**3 - 15.0 * part**4 + 6.0 * part**5,
    }[given]
    begin = Time.from_msg(trajectory.header.stamp)
    asked = begin + Duration(seconds=2.0 * part)
    while (answer := arm.query_at(asked.to_msg())).position[0] == START[0]:
        # The trajectory may not have arrived yet.
        assert arm.graph.client.get_clock().now() < begin
    assert answer.success
    np.testing.assert_allclose(answer.position, START + 0.2 * expected, atol=1e-9)


def test_no_interpolation(follower):
    # Upstream: interpolation_method none.
    arm = follower(interpolation_method="none")
    trajectory = arm.points((0.3, NEAR, ZERO), (0.6, FAR, ZERO))
    assert arm.follow(trajectory) == (SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_at(FAR)
    places = np.unique([state.position for state in arm.states], axis=0)
    np.testing.assert_array_equal(places, [START, FAR])
    status, code, text = arm.follow(arm.points((0.01, START)))
    assert (status, code) == (ABORTED, CODES.INVALID_GOAL)
    assert "the velocity of joint 'joint2' is 30 rad/s, over its limit 5 rad/s by 25 rad/s" in text


def test_no_replacement_of_the_old_kind(follower):
    # Upstream: allow_trajectory_replacement false.
    arm = follower(allow_trajectory_replacement=False)
    first = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    second = arm.send_goal(arm.stamped(arm.points((0.0, NEAR, ZERO), (0.2, START, ZERO)), 0.5))
    assert arm.outcome(first)[:2] == (ABORTED, CODES.INVALID_GOAL)
    assert arm.outcome(second) == (SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_at(START)
    reached = np.abs(np.array([state.position for state in arm.states]) - NEAR).max(axis=1)
    assert reached.min() < 0.02


def test_topic_during_an_action(follower):
    arm = follower()
    handle = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    arm.publish(arm.points((0.5, START, ZERO, ZERO)))
    said = "preempted by a trajectory on the topic joint_trajectory"
    assert arm.outcome(handle) == (ABORTED, CODES.INVALID_GOAL, said)
    arm.until_at(START)


@pytest.mark.slow
def test_an_empty_topic_message_is_refused(follower):
    arm = follower()
    handle = arm.send_goal(arm.points((2.0, NEAR, ZERO, ZERO)))
    arm.until_moving()
    arm.publish(arm.points(names=()))
    status = arm.diagnosis(lambda status: "refused" in status.message)
    assert "joint_names has size 0, expected 3, all joints of the robot" in status.message
    # It does not cancel, as joint_trajectory_controller's documents have it but not its code.
    assert arm.outcome(handle) == (SUCCEEDED, CODES.SUCCESSFUL, "")


def test_query_state_outside_the_range(follower):
    arm = follower()
    answer = arm.query(-1000.0)
    assert not answer.success
    assert "1000" in answer.message
    assert "not known any more: the robot has held since" in answer.message
    handle = arm.send_goal(arm.points((SLOWLY, FAR, ZERO, ZERO)))
    arm.until_moving()
    answer = arm.query(-100.0)
    assert not answer.success
    assert "the trajectory under way began" in answer.message
    # After the end the robot holds there; the query fails, as that of joint_trajectory_controller.
    answer = arm.query(100.0)
    assert not answer.success
    assert "s after the end of the trajectory: position is its last point" in answer.message
    np.testing.assert_allclose(answer.position, FAR, atol=1e-12)
    np.testing.assert_array_equal(answer.velocity, ZERO)
    handle.cancel_goal_async()
    assert arm.outcome(handle)[0] == CANCELED


@pytest.mark.slow
def test_scaling_execution_time_succeeds(follower):
    arm = follower()
    factors = arm.graph.client.create_publisher(
        SpeedScalingFactor, "joint_trajectory_controller/speed_scaling_input", 10
    )
    arm.until(factors.get_subscription_count)

    def scaled(factor, expected):
        factors.publish(SpeedScalingFactor(factor=factor))
        topic = "joint_trajectory_controller/controller_state"
        kind = JointTrajectoryControllerState
        arm.graph.receive(kind, topic, 10, lambda s: s.speed_scaling_factor == expected)

    scaled(0.5, 0.5)
    since = len(arm.states)
    assert arm.follow(arm.points((1.0, FAR, ZERO, ZERO))) == (SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_at(FAR)
    moving = [state.header.stamp for state in arm.states[since:] if any(state.velocity)]
    took = moving[-1].sec - moving[0].sec + 1e-9 * (moving[-1].nanosec - moving[0].nanosec)
    # States are left out where the machine is busy, but none comes from another time.
    assert 1.3 < took < 2.0 + 1e-6
    # What makes no sense changes nothing.
    factors.publish(SpeedScalingFactor(factor=-1.0))
    factors.publish(SpeedScalingFactor(factor=math.nan))
    scaled(0.0, 0.0)
    handle = arm.send_goal(arm.points((0.5, START, ZERO, ZERO)))
    arm.until(lambda: len(arm.states) > since + 300)
    np.testing.assert_allclose(arm.position, FAR, atol=1e-9)
    scaled(1.0, 1.0)
    assert arm.outcome(handle)[0] == SUCCEEDED


def test_controller_state(follower):
    arm = lagging(follower)
    trajectory = arm.points((1.0, FAR, ZERO, ZERO))
    arm.publish(trajectory)
    topic = "joint_trajectory_controller/controller_state"
    message = arm.graph.receive(
        JointTrajectoryControllerState,
        topic,
        10,
        lambda state: any(np.abs(state.reference.velocities) > 0.1),
    )
    assert list(message.joint_names) == list(JOINTS)
    assert message.speed_scaling_factor == 1.0
    reference, feedback, error = (
        np.array(getattr(message, point).positions) for point in ("reference", "feedback", "error")
    )
    np.testing.assert_allclose(error, reference - feedback, atol=1e-15)
    assert np.abs(error).max() > 1e-3
    np.testing.assert_array_equal(message.output.positions, reference)
    assert message.header.stamp.sec > 0
