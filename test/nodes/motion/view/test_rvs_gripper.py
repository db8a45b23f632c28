"""The slider of the gripper on the page of a running robot."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("viser")
pytest.importorskip("control_msgs")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from gripper_cases import panda_with_hand
from raw_client import wait_until

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.rvs.node import RvsNode

FINGER = "panda_finger_joint1"
GRIP = {"gripper_stall_timeout": 0.2, "gripper_goal_tolerance": 0.001}


def shown_gripper(graph, browse, **parameters):
    """A simulated Panda with a hand, its page, and the layer of the gripper."""
    robot = {"robot_description": panda_with_hand(), "tip_link": "panda_hand_tcp"}
    graph.start(JointTrajectoryControllerNode, **robot, **GRIP, **parameters)
    shown = browse(graph.start(RvsNode, **robot, port=0))
    layer = shown.page._layers[1]
    wait_until(lambda: FINGER in shown.page._arm.others and layer._slider is not None)
    client = shown.node._robot._gripper._client
    wait_until(client.server_is_ready)
    return shown, layer


@pytest.mark.timeout(300)
def test_the_slider_opens_and_closes_the_gripper(graph, browse):
    shown, layer = shown_gripper(graph, browse)
    assert layer._slider.value == pytest.approx(0.0, abs=1e-4)
    shown.set(layer._slider, 0.05)
    wait_until(lambda: "Gripper: 0.05 m wide." in shown.said("gripper"))
    wait_until(lambda: shown.page._arm.others[FINGER] == pytest.approx(0.025, abs=1e-6))
    assert layer._slider.value == pytest.approx(0.05, abs=1e-4)
    # Of values in quick succession the last one counts.
    for width in (0.02, 0.06, 0.08):
        shown.set(layer._slider, width)
    wait_until(lambda: "Gripper: 0.08 m wide." in shown.said("gripper"))


def test_an_object_and_a_value_outside_are_told(graph, browse):
    shown, layer = shown_gripper(graph, browse, gripper_object_width=0.05)
    shown.set(layer._slider, 0.08)
    wait_until(lambda: "Gripper: 0.08 m wide." in shown.said("gripper"))
    shown.set(layer._slider, 0.0)
    wait_until(lambda: "stopped by something at 0.05 m wide" in shown.said("gripper"))
    # The slider shows where the gripper is, not where it was to go.
    wait_until(lambda: layer._slider.value == pytest.approx(0.05, abs=1e-4))
    shown.set(layer._slider, 1e9)
    notice = shown.page._stage._notice
    wait_until(lambda: "width is 1000000000.0, expected 0 to 0.08 m" in str(notice.content))


def test_a_robot_without_a_gripper_has_no_slider(graph, browse, arm):
    shown = browse(graph.start(RvsNode, robot_description="puma560", port=0))
    assert shown.page._layers[1]._slider is None and not shown.node._robot.gripper_moves
