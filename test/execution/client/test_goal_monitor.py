"""Motion progress by joint states: a robot arrives, is at rest, or sends no more states."""

import numpy as np
import pytest
from dispatch_cases import HOME, NAMES, delivery, follow
from execution_cases import to_rest

from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.trajectory import Waypoints


def test_a_robot_that_still_moves_has_not_arrived(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    robot.at = one.goal - 0.008
    dispatcher.step(1.0)
    robot.at = one.goal - 0.002
    dispatcher.step(1.05)
    assert one.report is None
    dispatcher.step(1.1)
    assert one.report.code == 0


def test_names_joint_and_amount_when_it_does_not_arrive(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 2.2, 0.05):
        # It moves all the time, but not there.
        robot.at = np.array([0.5, 0.05, 0.1 - 0.04 * time])
        dispatcher.step(time)
    assert one.report.code == 224
    assert (
        "joint 'elbow' is at 0.05 m, 0.15 m off its goal 0.2 m, allowed is 0.01 m"
        in one.report.text
    )
    assert dispatcher.tally.failed == 1


def test_says_that_the_robot_has_not_moved(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    dispatcher.step(2.05)
    dispatcher.step(2.1)
    assert "has not moved" in one.report.text


def test_a_robot_that_was_stopped_on_its_way_is_noticed_at_once(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.32)
    for time in np.arange(0.35, 1.05, 0.05):
        dispatcher.step(time)
    assert one.report.code == 222
    assert one.report.duration < 1.0
    assert "the robot stands for 0.6 s" in one.report.text or "for 0.5 s" in one.report.text
    assert "it was stopped" in one.report.text
    assert "joint 'shoulder' is at" in one.report.text and "off its goal 0.5" in one.report.text


def test_a_robot_that_never_moves_is_noticed_before_the_trajectory_is_over(robot, dispatcher):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 5.0, 0.05):
        dispatcher.step(time)
    assert one.report.code == 221
    assert "the robot does not move for" in one.report.text
    assert "the controller's log may say why" in one.report.text


def test_a_trajectory_that_rests_on_its_way_is_not_taken_for_a_stop(robot, dispatcher):
    times = np.array([0.0, 1.0, 4.0, 5.0])
    places = np.array([HOME, (0.5, 0.2, 0.1), (0.5, 0.2, 0.1), (0.9, 0.2, 0.1)])
    still = np.zeros_like(places)
    one = ExecutionRequest(None, NAMES, Waypoints(times, places, still, still), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 5.2)
    assert one.report.code == 0


def test_a_trajectory_that_begins_later_is_not_taken_for_a_stop(robot, dispatcher):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 1.0), Transport.TOPIC, delay=3.0)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 4.3, 0.05):
        robot.at = one.waypoints.curve.sample(max(time - 3.0, 0.0)).position
        dispatcher.step(time)
    assert one.report.code == 0


def test_a_single_point_is_watched_from_where_the_robot_is(robot, dispatcher):
    robot.at = np.full(3, 0.3)
    waypoints = Waypoints(np.array([10.0]), np.zeros((1, 3)))
    one = ExecutionRequest(None, NAMES, waypoints, Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 1.5, 0.05):
        dispatcher.step(time)
    assert one.report.code == 221


def test_of_a_silent_robot_nobody_says_that_it_stands(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.32)
    robot.talks = False
    for time in np.arange(0.35, 1.9, 0.05):
        dispatcher.step(time)
    assert one.report is None
    robot.talks, robot.at = True, one.goal.copy()
    dispatcher.step(1.9)
    dispatcher.step(1.95)
    assert one.report.code == 0


@pytest.mark.parametrize("transport", Transport)
def test_a_robot_that_falls_silent_is_gone(robot, dispatcher, transport):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), transport)
    dispatcher.offer(one, 0.0)
    robot.at = np.array([0.1, 0.0, 0.0])
    dispatcher.step(3.0)
    robot.talks = False
    dispatcher.step(4.9)
    assert one.report is None
    dispatcher.step(5.1)
    assert one.report.code == 221
    assert one.report.text.startswith("the controller is gone: no joint states of shoulder, elbow")
    assert "for 2.1 s; how the motion ended is not known; at last joint 'sh" in one.report.text


def test_a_robot_that_falls_silent_at_the_end_is_gone(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.92)
    robot.talks = False
    for time in (1.0, 1.5, 1.95):
        dispatcher.step(time)
    assert one.report is None
    dispatcher.step(2.05)
    assert one.report.code == 221
    assert "the controller is gone: no joint states" in one.report.text


def test_a_subscriber_that_disappears(robot, dispatcher):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.5)
    robot.lacking = "subscriber of '/arm/joint_trajectory'"
    follow(robot, dispatcher, one, 0.5, 2.7)
    assert one.report.code == 221
    assert "the controller is gone: subscriber of '/arm/joint_trajectory' dis" in one.report.text


@pytest.mark.parametrize("transport", [Transport.TOPIC, Transport.ACTION])
def test_a_controller_that_has_died_is_told_at_once(robot, dispatcher, transport):
    one = delivery(transport=transport)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.3)
    robot.died = True
    # As long as there are joint states, somebody moves the robot.
    follow(robot, dispatcher, one, 0.3, 0.6)
    assert one.report is None
    robot.talks = 0
    dispatcher.step(0.7)
    assert one.report is None
    dispatcher.step(0.9)
    assert one.report.code == 221
    assert one.report.text.startswith("the controller has died: its process is gone")
    assert "at last joint 'shoulder' is at" in one.report.text


@pytest.mark.parametrize("gaps", [(0.3,), (1.0,), (0.3, 0.1)])
def test_who_looks_seldom_takes_a_dead_controller_for_dead(robot, dispatcher, gaps):
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.3)
    robot.died, robot.talks = True, 0
    now = 0.25
    for k in range(3):
        assert one.report is None
        now += gaps[k % len(gaps)]
        dispatcher.step(now)
        if one.report is not None:
            break
    assert k >= 1, "the first look after a pause has not heard what was said meanwhile"
    assert one.report.text.startswith("the controller has died: its process is gone")


def test_who_looks_seldom_does_not_take_one_that_speaks_for_dead(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    robot.died = True
    for now in (0.3, 0.6, 0.9, 1.2, 1.5):
        assert one.report is None
        robot.at = one.waypoints.curve.sample(min(now, 1.0)).position
        dispatcher.step(now)
    assert one.report.code == 0


def test_who_was_held_up_does_not_take_the_controller_for_dead(robot, dispatcher):
    """The lease had run out while the publisher stood still, and no joint states were heard."""
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.1)
    robot.died, robot.talks = True, 0
    dispatcher.step(0.9)
    assert one.report is None
    robot.died, robot.talks = False, 1
    follow(robot, dispatcher, one, 0.95, 1.5)
    assert one.report.code == 0


@pytest.mark.parametrize("held_up", [2.5, 15.0, 25.0])
def test_who_was_held_up_hears_the_joint_states_before_missing_them(robot, dispatcher, held_up):
    """After 5 s of SIGSTOP the controller was gone: what came meanwhile was heard too late."""
    one = ExecutionRequest(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 3.0)
    robot.talks = 0
    dispatcher.step(3.0 + held_up)
    assert one.report is None
    robot.talks = 1
    follow(robot, dispatcher, one, 3.05 + held_up, 20.0)
    robot.at = one.goal
    for ahead in (0.1, 0.2):
        dispatcher.step(max(20.0, 3.0 + held_up) + ahead)
    assert one.report.code == 0


@pytest.mark.parametrize("transport", [Transport.TOPIC, Transport.ACTION])
def test_a_controller_whose_place_another_has_taken_is_told_at_once(robot, dispatcher, transport):
    """The successor publishes joint states, and knows nothing of the motion."""
    one = delivery(transport=transport)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.3)
    robot.replaced = True
    dispatcher.step(0.31)
    assert one.report.code == 221
    assert one.report.text.startswith("the controller has died: its process is gone")
