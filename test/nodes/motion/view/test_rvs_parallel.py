"""The page of a parallel robot that runs, asked by a connection that is no browser."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from raw_client import wait_until

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.rvs.node import RvsNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.parallel import load_parallel


@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", ["hexapod", "delta"])
def test_the_platform_is_drawn_where_it_is_and_goes_where_it_is_sent(graph, browse, name):
    graph.start(JointTrajectoryControllerNode, robot_description=name)
    graph.start(TrajectoryPlannerNode, robot_description=name)
    graph.start(TrajectoryPublisherNode, robot_description=name)
    shown = browse(graph.start(RvsNode, robot_description=name, port=0))
    mechanism = load_parallel(name).mechanism
    layer, platform = shown.layer, shown.page._arm
    wait_until(lambda: layer._goal._robot is not None)
    np.testing.assert_allclose(layer._goal._robot, mechanism.home(), atol=1e-6)
    target = mechanism.pose(mechanism.home())
    target[:3, 3] += [0.01, -0.015, 0.02]
    shown.page.drag(lambda: target)
    wait_until(lambda: layer._goal.is_apart)
    wait_until(lambda: np.allclose(platform.tip, target, atol=1e-6))
    goal, start = platform.q.copy(), layer._goal._robot
    shown.click("Plan")
    wait_until(lambda: "the motion takes" in shown.said() or "o plan" in shown.said())
    wait_until(lambda: shown.page._plan.motion is not None)
    planned = shown.page._plan.motion
    np.testing.assert_allclose(planned.q[[0, -1]], [start, goal], atol=1e-6)
    assert mechanism.loop_errors(planned.q).max() < 1e-9
    np.testing.assert_allclose(layer._goal._robot, start, atol=1e-9)
    shown.click("Execute")
    wait_until(lambda: "the robot arrived" in shown.said() or "o plan" in shown.said())
    assert "the robot arrived" in shown.said()
    wait_until(lambda: np.allclose(layer._goal._robot, goal, atol=1e-4))
    assert mechanism.loop_errors(layer._goal._robot).max() < 1e-9
