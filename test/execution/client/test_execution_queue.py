"""Requests in the queue, and their waiting times."""

import pytest
from dispatch_cases import HOME, delivery, stamped
from execution_cases import to_rest

from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.client.execution_queue import QueueFullError
from robomech_ros.execution.client.execution_request import Transport


def test_one_after_the_other_in_order(robot, dispatcher):
    goals = [(0.1, 0.0, 0.0), (0.1, 0.1, 0.0), (0.0, 0.1, 0.0)]
    starts = [HOME, *goals[:-1]]
    many = [delivery(goal, start) for goal, start in zip(goals, starts, strict=True)]
    for one in many:
        dispatcher.offer(one, 0.0)
    assert robot.sent == many[:1]
    time = 0.0
    for count, one in enumerate(many, 1):
        assert robot.sent == many[:count]
        robot.at = one.goal.copy()
        dispatcher.step(time + 1.1)
        dispatcher.step(time + 1.2)
        time += 1.2
    assert [one.report.code for one in many] == [0, 0, 0]


def test_a_full_queue(robot, dispatcher):
    robot.lacking = "controller"
    for _ in range(3):
        dispatcher.offer(delivery(), 0.0)
    with pytest.raises(QueueFullError, match="the queue is full, with 3 waiting"):
        dispatcher.offer(delivery(), 0.0)


def test_without_controller_topics_wait_and_callers_are_told(robot):
    stalls, told = [], []
    dispatcher = Dispatcher(robot, DispatchSettings(controller_timeout=2.0), on_stall=stalls.append)
    robot.lacking = "action '/arm/execute'"
    waits, asks = delivery(), delivery(transport=Transport.ACTION)
    waits.listen(told.append)
    dispatcher.offer(waits, 0.0)
    dispatcher.offer(asks, 0.0)
    dispatcher.step(1.9)
    assert not told
    dispatcher.step(2.0)
    assert stalls == ["action '/arm/execute' not there after 2.0 s"]
    assert (asks.report.code, asks.report.text) == (221, stalls[0])
    assert told[0].code == 221
    assert "stays queued" in told[0].text
    robot.lacking = ""
    dispatcher.step(100.0)
    assert robot.sent == [waits]
    assert len(stalls) == 1


def test_without_joint_states_the_first_gives_way(robot, dispatcher):
    robot.known = False
    strange, one = delivery(), delivery(transport=Transport.ACTION)
    dispatcher.offer(strange, 0.0)
    dispatcher.offer(one, 0.0)
    dispatcher.step(2.0)
    assert strange.report.code == 107
    assert "no joint states of shoulder, elbow, roll within 2.0 s" in strange.report.text
    assert one.report is None
    robot.known = True
    dispatcher.step(2.1)
    assert robot.sent == [one]


def test_joint_states_have_their_time_from_when_the_controller_is_there(robot, dispatcher):
    robot.lacking, robot.known = "the controller", False
    one = delivery()
    dispatcher.offer(one, 0.0)
    dispatcher.step(50.0)
    robot.lacking = ""
    dispatcher.step(51.0)
    dispatcher.step(52.9)
    assert one.report is None
    robot.known = True
    dispatcher.step(52.95)
    assert robot.sent == [one]


def test_the_stamp_of_what_has_queued_counts_when_it_is_sent(robot, dispatcher):
    one, two = delivery(), stamped(3.0, (0.7, 0.2, 0.1))
    two.waypoints = to_rest((0.7, 0.2, 0.1), 1.0, one.goal)
    dispatcher.offer(one, 0.0)
    dispatcher.offer(two, 0.0)
    dispatcher.clock_jumped(-4.0, 0.2)
    robot.at = one.goal.copy()
    for time in (1.0, 1.05):
        dispatcher.step(time)
    assert robot.sent == [one, two]
    assert two.delay == pytest.approx(7.0 - 1.05)
