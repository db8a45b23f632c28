"""A palletizer, on which two joints follow, in the browser view of a robot with dynamics."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from raw_client import wait_until

from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.robots import load_description
from robomech_ros.rvs.model.bodies.visual_model import load_visual_model
from test.coupled_robots import palletizer_with_bodies

START, REAR = [0.2, 0.4, 0.5, 0.3], 1


@pytest.fixture
def shown(graph, drive, browse, tmp_path):
    """The palletizer, simulated with its dynamics, its planner and publisher, and a page."""
    text = palletizer_with_bodies()
    robot = drive(robot_description=text, simulation="dynamic", initial_positions=START)
    limits = tmp_path / "joint_limits.yaml"
    rate = (
        "has_acceleration_limits: true, max_acceleration: 8.0, has_jerk_limits: true, max_jerk: 80"
    )
    rows = "".join(f"  {name}: {{{rate}}}\n" for name in robot.names)
    limits.write_text(f"joint_limits:\n{rows}", encoding="utf-8")
    graph.start(TrajectoryPlannerNode, robot_description=text, joint_limits=str(limits))
    graph.start(TrajectoryPublisherNode, robot_description=text)
    browser = browse(graph.start(RvsNode, robot_description=text, port=0))
    motions = browser.node._robot._motions
    wait_until(lambda: motions._planner.service_is_ready() and motions._executor.service_is_ready())
    wait_until(lambda: np.allclose(browser.page._arm.q, START, atol=1e-3))
    return browser, robot, text


def test_the_slider_of_a_drive_moves_its_follower_and_the_robot_goes_there(shown):
    browser, robot, text = shown
    arm = browser.page._arm
    assert len(browser.page._panel._sliders) == arm.chain.n == 4
    browser.set(browser.page._panel._sliders[REAR], 0.9)
    wait_until(lambda: browser.layer._goal.is_apart)
    goal = arm.q
    np.testing.assert_allclose(goal, [0.2, 0.9, 0.5, 0.3], atol=1e-3)
    # The joints as they are drawn: the rods turn link_a and the hand back.
    seen = load_visual_model(load_description(text))
    drawn = [joint.name for joint in seen.moving]
    _, turns = seen.joint_poses(arm.positions_of(goal))
    for follower, drive in (("rear_back", 1), ("level", 2)):
        _, y, _, w = turns[drawn.index(follower)]
        assert 2.0 * np.arctan2(y, w) == pytest.approx(-goal[drive], abs=1e-9)
    browser.click("Plan")
    wait_until(lambda: browser.page._plan.motion is not None)
    np.testing.assert_allclose(browser.page._plan.motion.q[-1], goal, atol=1e-9)
    browser.click("Execute")
    wait_until(lambda: "arrived after" in browser.said())
    there = [*goal, -goal[1], -goal[2]]
    robot.until(lambda: np.allclose(robot.position, there, atol=2e-3))
    assert robot.states[-1].name[4:] == ["rear_back", "level"]
