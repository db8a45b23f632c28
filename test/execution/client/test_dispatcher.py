"""Deliveries are sent, executed and told of."""

import math

import numpy as np
import pytest
from dispatch_cases import NAMES, delivery

from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.execution.client.position_check import joint_distance
from robomech_ros.trajectory import Waypoints


def test_sends_and_sees_the_robot_arrive(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    assert robot.sent == [one]
    dispatcher.step(0.5)
    robot.at = one.goal.copy()
    dispatcher.step(1.0)
    assert one.begun_at is not None and one.report is None
    dispatcher.step(1.05)
    assert (one.report.code, one.report.text) == (0, "")
    assert one.report.duration == pytest.approx(1.05)
    assert not dispatcher.busy


def test_a_start_elsewhere_is_refused_and_the_next_one_sent(robot, dispatcher):
    far, near = delivery(start=(0.0, 0.3, 0.0)), delivery()
    robot.lacking = "controller"
    dispatcher.offer(far, 0.0)
    dispatcher.offer(near, 0.0)
    robot.lacking = ""
    dispatcher.step(0.1)
    assert far.report.code == 221
    assert (
        "starts with joint 'elbow' at 0.3 m, but the joint is at 0 m: 0.3 m apart"
        in far.report.text
    )
    assert robot.sent == [near]


def test_whole_turns(robot, dispatcher):
    robot.at = np.array([0.0, 0.0, math.tau])
    one = delivery()
    dispatcher.offer(one, 0.0)
    assert robot.sent == [one]
    np.testing.assert_allclose(
        joint_distance(np.array([math.tau, 0.1]), np.zeros(2), np.array([True, False])), [0.0, 0.1]
    )


def test_a_start_whole_turns_away_from_a_joint_with_limits_is_said(robot, dispatcher):
    """Encoders and planners may disagree by turns: 6.28 rad apart said nothing of that."""
    robot.at = np.array([2.0 * math.tau, 0.0, 0.0])
    turned, between = delivery(), delivery(start=(math.tau + 0.5, 0.0, 0.0))
    for one in (turned, between):
        dispatcher.offer(one, 0.0)
    assert turned.report.code == 221
    assert "12.6 rad apart, allowed is 0.01 rad (2 whole turn(s), which" in turned.report.text
    assert "5.78 rad apart" in between.report.text and "turn" not in between.report.text
    assert robot.sent == []


def test_a_slide_has_no_turns(robot, dispatcher):
    robot.at = np.array([0.0, math.tau, 0.0])
    one = delivery()
    dispatcher.offer(one, 0.0)
    assert one.report.text.endswith("6.28 m apart, allowed is 0.01 m")


def test_a_first_point_later_than_zero_starts_anywhere(robot, dispatcher):
    robot.at = np.array([1.0, 1.0, 1.0])
    waypoints = Waypoints(np.array([1.0]), np.zeros((1, 3)))
    one = ExecutionRequest(None, NAMES, waypoints, Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    assert robot.sent == [one]


def test_close_tells_everybody(robot, dispatcher):
    told = []
    one, two = delivery(), delivery()
    for each in (one, two):
        each.listen(told.append)
        dispatcher.offer(each, 0.0)
    dispatcher.close("the publisher shuts down")
    assert len(told) == 2
    assert not dispatcher.busy


def test_late_listeners_are_told_at_once(robot, dispatcher):
    one = delivery(start=(1.0, 1.0, 1.0))
    dispatcher.offer(one, 0.0)
    told = []
    one.listen(told.append)
    assert told == [one.report]
