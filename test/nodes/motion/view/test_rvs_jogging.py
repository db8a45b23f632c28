"""Jogging from a page of the node rvs, over real DDS."""

import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from browsers import Browser, drawn, hold_until, until_still
from raw_client import wait_until
from servo_operator import START

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.servo.node import ServoNode

ROBOT = "puma560"
SERVO = {"robot_description": ROBOT, "characteristic_length": 0.283, "publish_rate": 50.0}


def page_of(graph, browse, robot):
    """Open a page of a robot whose servo has been started."""
    browser = browse(graph.start(RvsNode, robot_description=ROBOT, port=0, jog_timeout=1.0))
    jogger = browser.node._robot._jogger
    wait_until(lambda: np.allclose(drawn(browser), robot.position, atol=1e-6))
    for publisher in (jogger._twists, jogger._joints):
        wait_until(publisher.get_subscription_count)
    return browser


@pytest.fixture
def jogged(graph, drive, browse):
    """A PUMA away from singularities, its servo, and a page."""
    robot = drive(initial_positions=START)
    graph.start(ServoNode, **SERVO)
    return page_of(graph, browse, robot), robot


def test_a_button_moves_the_tip_while_it_is_held(jogged):
    browser, robot = jogged

    def tip():
        return forward_kinematics(robot.chain, robot.position)[:3, 3]

    wait_until(lambda: browser.page._panel is not None)
    gizmo, ghosts, hidden = browser.page._panel._gizmo, browser.page._stage.ghosts, []

    def left_behind():
        hidden.append(not gizmo.visible and not ghosts._wanted)
        return any(hidden)

    start = tip()
    # What belongs to a robot at rest has come to it, and is not seen while it moves on.
    wait_until(lambda: browser.layer._goal._brought is not None and gizmo.visible)
    hold_until(browser, "linear 2 +", lambda: left_behind() and tip()[2] > start[2] + 0.03)
    browser.set(browser.layer._pads[0].handle, "")
    until_still(robot)
    wait_until(lambda: not browser.node._robot.jogs)
    moved = tip() - start
    assert np.abs(moved[:2]).max() < 0.1 * moved[2]
    # The goal comes along.
    wait_until(lambda: np.allclose(browser.page._arm.q, robot.position, atol=1e-6))
    wait_until(lambda: gizmo.visible and ghosts._wanted)


def test_a_joint_is_jogged_to_its_limit_and_no_further(jogged):
    browser, robot = jogged
    browser.set(browser.layer._pads[0]._speed, 1.0)
    upper = robot.chain.upper[4]
    hold_until(browser, "joint 4 +", lambda: robot.position[4] > upper - 0.05)
    hold_until(browser, "joint 4 +", lambda: robot.names[4] in browser.said("servo"))
    browser.set(browser.layer._pads[0].handle, "")
    until_still(robot)
    for state in robot.states:
        assert state.position[4] <= upper + 1e-9


@pytest.mark.parametrize("how", ["close", "silence", "take over"])
def test_a_page_that_goes_stops_the_robot(jogged, browse, how):
    browser, robot = jogged
    start = robot.position[1]
    hold_until(browser, "joint 1 +", lambda: robot.position[1] > start + 0.03)
    if how == "close":
        browser.close()
    elif how == "take over":
        lost = browser.layer._pads[0]
        other = Browser(browser.node)
        wait_until(lambda: browser.page._audience._watching)
        ((number, (_, button)),) = browser.page._audience._watching.items()
        other.set(button, True)
        wait_until(lambda: browser.page._audience.commander == number)
        # What it said last may come after.
        lost._take("joint 1 + 99 0")
        assert not browser.node._robot.jogs
        other.close()
    until_still(robot)
    wait_until(lambda: not browser.node._robot.jogs)


WILD = [
    "linear 0 + 1",
    "joint 99 + 1 1",
    "linear 0 + 1 1; drop",
    "nan",
    "joint 0 +" * 300,
    7,
    ["joint 0 + 1 1"],
]


@pytest.mark.parametrize("text", WILD)
def test_wild_jogs_are_refused(jogged, text):
    browser, robot = jogged
    start = robot.position
    browser.set(browser.layer._pads[0].handle, text)
    wait_until(lambda: "Refused" in browser.said())
    layer = browser.layer
    # A slider takes what can be read as a number.
    for field, value, right, word in (
        (layer._pads[0]._speed, 1e300, 0.5, "speed is 1e+300"),
        (layer._pads[0]._speed, "nan", 0.5, "speed is nan"),
        (layer._frame, "sideways", "base", "axes is 'sideways'"),
    ):
        browser.set(field, value)
        browser.press()
        browser.hold("linear 0 +")
        wait_until(lambda w=word: w in browser.said())
        browser.set(field, right)
    assert not browser.node._robot.jogs
    np.testing.assert_array_equal(robot.position, start)


@pytest.mark.slow
def test_a_held_button_moves_nothing_once_the_servo_is_silent(graph, drive, browse, process):
    """Its subscription is there for 20 s after it was killed."""
    robot = drive(initial_positions=START)
    servo = process(ServoNode, **SERVO)
    browser = page_of(graph, browse, robot)
    start = robot.position[1]
    hold_until(browser, "joint 1 +", lambda: robot.position[1] > start + 0.03)
    servo.kill()
    servo.wait(60.0)
    deadline = time.monotonic() + 60.0
    while "has said nothing" not in browser.said("jog"):
        assert time.monotonic() < deadline, browser.said("jog")
        browser.hold("joint 1 +")
        time.sleep(0.05)
    wait_until(lambda: not browser.node._robot.jogs)
    until_still(robot)


def test_a_jog_that_fails_is_told_and_the_next_one_moves(jogged):
    browser, robot = jogged
    browser.node.destroy_publisher(browser.node._robot._jogger._joints)
    browser.press()
    browser.hold("joint 1 +")
    wait_until(lambda: "The jog failed" in browser.said("jog"))
    wait_until(lambda: not browser.node._robot.jogs)
    start = robot.position
    hold_until(browser, "linear 2 +", lambda: np.abs(robot.position - start).max() > 0.01)
    assert browser.said("jog") == ""
