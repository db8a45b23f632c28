"""Results of the controller, cancelling, and stamps of a clock that jumps."""

import numpy as np
import pytest
from dispatch_cases import HOME, NAMES, delivery, follow, move_along, stamped

from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.trajectory import Waypoints


def test_the_result_of_an_action(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.step(1.2)
    robot.at = one.goal.copy()
    dispatcher.conclude(one, 0, "", 1.21)
    assert (one.report.code, one.report.text) == (0, "")
    two = delivery(start=one.goal, transport=Transport.ACTION)
    dispatcher.offer(two, 2.0)
    dispatcher.conclude(two, 223, "joint 'elbow' left its path", 2.1)
    assert (two.report.code, two.report.text) == (223, "joint 'elbow' left its path")
    dispatcher.conclude(two, 0, "late", 2.2)
    assert two.report.code == 223


def test_success_that_the_joint_states_do_not_confirm(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.conclude(one, 0, "", 1.0)
    assert one.report is None
    dispatcher.step(2.1)
    assert one.report.code == 222
    assert "reports success, but joint 'shoulder'" in one.report.text
    assert "the robot has not moved, the controller's log may say why" in one.report.text


def test_success_of_what_a_topic_has_replaced(robot, dispatcher):
    """The real controller reports success at the end of what took over: 0, with a warning."""
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    move_along(robot, dispatcher, lambda now: one.waypoints.curve.sample(now).position, 0.05, 0.5)
    back = robot.at.copy()
    move_along(robot, dispatcher, lambda now: back * max(1.0 - 2.0 * (now - 0.5), 0.0), 0.5, 1.05)
    dispatcher.conclude(one, 0, "", 1.05)
    for time in np.arange(1.1, 2.2, 0.05):
        dispatcher.step(time)
    assert one.report.code == 222
    assert "the controller reports success, but joint 'shoulder' is at 0 rad," in one.report.text
    assert "the robot is back at its start; something else has taken over" in one.report.text
    assert "has not moved" not in one.report.text


@pytest.mark.parametrize("transport", [Transport.ACTION, Transport.TOPIC])
def test_a_loop_that_was_replaced_has_not_been_executed(robot, dispatcher, transport):
    """It ends where it began: the robot counted as arrived."""
    out = np.array([0.5, 0.2, 0.1])
    still = np.zeros((3, 3))
    way = Waypoints([0.0, 1.0, 2.0], np.array([HOME, out, HOME]), still, still)

    def of(path):
        one = ExecutionRequest(None, NAMES, way, transport)
        dispatcher.offer(one, start)
        move_along(robot, dispatcher, lambda now: path(now - start), start, start + 2.1)
        if transport.answers:
            dispatcher.conclude(one, 0, "", start + 2.1)
        move_along(robot, dispatcher, lambda now: path(2.0), start + 2.1, start + 3.5)
        return one.report

    start = 0.0
    replaced = of(lambda time: HOME + 0.3 * out * max(0.3 - abs(time - 0.3), 0.0))
    assert replaced.code == 222
    assert "is where the trajectory begins and ends, but has not gone along it" in replaced.text
    assert "joint 'shoulder' was at most 0.045 rad away, planned are 0.5 rad" in replaced.text
    start = 10.0
    assert of(lambda time: way.curve.sample(min(time, 2.0)).position).code == 0


def test_a_controller_that_disappears(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    robot.lacking = "action '/arm/execute'"
    dispatcher.step(0.5)
    dispatcher.step(2.6)
    assert one.report.code == 221
    assert "action '/arm/execute' disappeared" in one.report.text


def test_a_controller_that_never_answers(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    for time in (1.0, 2.0, 3.0, 3.9):
        dispatcher.step(time)
    assert one.report is None
    dispatcher.step(4.1)
    assert one.report.code == 205
    assert robot.cancelled == [one]


def test_cancel_ends_when_the_robot_stands(robot, dispatcher):
    one, two = delivery(), delivery(start=(0.5, 0.2, 0.1), goal=HOME)
    dispatcher.offer(one, 0.0)
    dispatcher.offer(two, 0.0)
    assert dispatcher.cancel("enough", 0.3) == 2
    assert (two.report.code, two.report.text) == (222, "not sent: enough")
    assert one.report is None
    stop, begin = one.waypoints.curve, one.sent_at + one.delay
    move_along(robot, dispatcher, lambda now: stop.sample(now - begin).position, 0.35, 2.0)
    assert (one.report.code, one.report.text) == (222, "enough")
    assert not dispatcher.busy


@pytest.mark.parametrize("transport", [Transport.TOPIC, Transport.ACTION])
def test_what_comes_into_the_way_stops_it_on_its_path_and_later_ones_are_not_sent(robot, transport):
    walls = []
    dispatcher = Dispatcher(robot, obstruction=lambda delivery: "".join(walls))
    one, two = delivery(transport=transport), delivery(start=(0.5, 0.2, 0.1), goal=HOME)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.05, 0.3)
    assert one.report is None
    walls.append("the wall")
    dispatcher.step(0.3)
    if transport is Transport.ACTION:
        assert robot.cancelled == [one]
        dispatcher.conclude(one, 222, "cancelled", 0.5)
    else:
        stop, begin = one.waypoints.curve, one.sent_at + one.delay
        move_along(robot, dispatcher, lambda now: stop.sample(now - begin).position, 0.35, 2.0)
    text = "the robot has stopped on its path: the wall"
    assert (one.report.code, one.report.text) == (215, text)
    robot.at = np.array([0.5, 0.2, 0.1])
    dispatcher.offer(two, 3.0)
    assert (two.report.code, two.report.text) == (215, "not sent: the wall")


@pytest.mark.parametrize("jump", [-100.0, -5.0, 2.0])
def test_what_waits_for_its_stamp_is_watched_by_the_clock_that_jumped(robot, dispatcher, jump):
    one = stamped(3.0)
    dispatcher.offer(one, 0.0)
    dispatcher.step(0.5)
    dispatcher.clock_jumped(jump, 0.5)
    begin = 3.0 - jump
    for time in np.arange(0.55, begin + 1.2, 0.05):
        assert one.report is None or time > begin + 0.95
        robot.at = one.waypoints.curve.sample(max(time - begin, 0.0)).position
        dispatcher.step(time)
    assert (one.report.code, one.report.text) == (0, "")
    assert one.report.duration == pytest.approx(begin + 1.05, abs=0.1)
    assert robot.sent == [one]


def test_a_jump_does_not_touch_what_is_under_way(robot, dispatcher):
    one = stamped(0.2)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 0.5, 0.05):
        robot.at = one.waypoints.curve.sample(max(time - 0.2, 0.0)).position
        dispatcher.step(time)
    dispatcher.clock_jumped(-100.0, 0.5)
    robot.at = one.goal.copy()
    for time in (0.55, 1.2, 1.25, 1.3):
        dispatcher.step(time)
    assert one.report.code == 0
