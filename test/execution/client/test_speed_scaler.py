"""Pauses, speeds, and changes that come too late."""

import numpy as np
import pytest
from dispatch_cases import NAMES, delivery, move_along, stamped
from execution_cases import to_rest

from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.execution.rejections import TrajectoryRefusedError


@pytest.mark.parametrize("transport", list(Transport))
def test_a_pause_that_comes_too_late_is_sent_again(robot, dispatcher, transport):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 3.0), transport)
    planned = one.waypoints.curve
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.2)
    assert len(robot.sent) == 2
    first, now = one.goal.copy(), 0.4
    robot.old_goal_runs = True
    if transport is Transport.ACTION:
        dispatcher.conclude(one, 221, "it should be over by now", now)
    while len(robot.sent) < 3:
        now += 0.05
        move_along(robot, dispatcher, lambda time: planned.sample(time).position, now, now + 0.04)
    assert now < 1.0
    assert one.report is None
    # From where the robot is now, since it has moved on.
    assert one.goal[0] > first[0]
    assert one.delay == pytest.approx(0.4)


def test_a_pause_too_late_for_the_end_lets_the_robot_arrive(robot, dispatcher):
    one = delivery()
    planned, goal = one.waypoints.curve, one.goal.copy()
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.4)
    assert len(robot.sent) == 2
    move_along(robot, dispatcher, lambda now: planned.sample(now).position, 0.45, 2.0)
    np.testing.assert_array_equal(one.goal, goal)
    assert one.report.code == 0
    assert len(robot.sent) == 2
    assert dispatcher.paused


def test_a_pause_that_is_refused_again_and_again_is_given_up(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.01)
    robot.old_goal_runs = True
    now = 0.01
    while one.report is None:
        now += 0.01
        dispatcher.conclude(one, 221, "no", now)
    assert 2 <= len(robot.sent) <= 5
    assert robot.cancelled == [one]
    assert (one.report.code, one.report.text) == (221, "no")


def test_what_was_paused_goes_on_to_its_end(robot, dispatcher):
    one = delivery()
    planned = one.waypoints.curve
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.2)
    stop = one.waypoints.curve
    begin = one.sent_at + one.delay
    move_along(robot, dispatcher, lambda now: planned.sample(now).position, 0.2, begin)
    place = one.goal.copy()
    assert 0.0 < place[0] < 0.5
    move_along(robot, dispatcher, lambda now: stop.sample(now - begin).position, begin + 0.05, 3.0)
    assert one.report is None
    assert len(robot.sent) == 2
    dispatcher.resume(3.0)
    np.testing.assert_allclose(one.waypoints.positions[0], place, atol=1e-12)
    rest = one.waypoints.curve
    move_along(robot, dispatcher, lambda now: rest.sample(now - 3.0).position, 3.0, 6.0)
    assert one.report.code == 0
    assert len(robot.sent) == 3


def test_a_speed_at_which_a_trajectory_would_last_too_long_changes_nothing(robot):
    dispatcher = Dispatcher(robot, DispatchSettings(max_duration=100.0))
    one, two = delivery(), delivery()
    planned = one.waypoints.curve
    dispatcher.offer(one, 0.0)
    with pytest.raises(TrajectoryRefusedError, match=r"at speed 0\.001 .* last .* at most 100 s"):
        dispatcher.set_speed(1e-3, 0.2)
    assert (dispatcher.speed, len(robot.sent)) == (1.0, 1)
    move_along(robot, dispatcher, lambda now: planned.sample(min(now, 1.0)).position, 0.2, 2.0)
    assert one.report.code == 0
    robot.at = np.zeros(3)
    dispatcher.set_speed(1e-3, 3.0)
    dispatcher.offer(two, 3.0)
    assert (two.report.code, len(robot.sent)) == (221, 1)
    assert "at speed 0.001 the trajectory would last 1000 s, at most 100 s" in two.report.text


def test_the_speed_can_be_set_when_what_waited_over_a_jump_has_begun(robot, dispatcher):
    one = stamped(3.0)
    dispatcher.offer(one, 0.0)
    dispatcher.clock_jumped(-10.0, 0.5)
    with pytest.raises(TrajectoryRefusedError, match="only begins in 9 s"):
        dispatcher.set_speed(0.5, 4.0)
    for time in np.arange(4.0, 13.3, 0.05):
        robot.at = one.waypoints.curve.sample(max(time - 13.0, 0.0)).position
        dispatcher.step(time)
    dispatcher.set_speed(0.5, 13.3)
    assert len(robot.sent) == 2


def test_a_change_of_pace_does_not_outlive_its_delivery(robot, dispatcher):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.set_speed(0.5, 0.2)
    dispatcher.conclude(one, 223, "it left its path", 0.4)
    two = delivery(goal=(0.1, 0.1, 0.1), transport=Transport.ACTION)
    dispatcher.offer(two, 0.5)
    count, planned = len(robot.sent), two.waypoints.positions.copy()
    robot.old_goal_runs = True
    dispatcher.conclude(two, 221, "busy with another goal", 0.6)
    assert (two.report.code, two.report.text) == (221, "busy with another goal")
    assert len(robot.sent) == count
    np.testing.assert_array_equal(two.waypoints.positions, planned)
