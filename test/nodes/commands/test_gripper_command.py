"""``robomech gripper`` opens and closes the gripper of a running robot."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("control_msgs")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "motion"))

from gripper_cases import panda_with_hand

from robomech_ros.cli import main as cli
from robomech_ros.nodes.commands import gripper
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode

HAND = {"gripper_stall_timeout": 0.2, "gripper_goal_tolerance": 0.001}


def run(capfd, *arguments):
    code = cli.main(["gripper", *arguments])
    captured = capfd.readouterr()
    return code, captured.out, captured.err


@pytest.fixture
def hand(graph):
    """A Panda with Franka's hand, and a way to start it with other parameters."""

    def start(**parameters):
        settings = {"robot_description": panda_with_hand(), "tip_link": "panda_hand_tcp"}
        settings |= HAND | parameters
        return graph.start(JointTrajectoryControllerNode, **settings)

    return start


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_gripper_is_opened_closed_and_brought_to_a_width(hand, capfd):
    hand(gripper_controller="panda_hand_controller", namespace="left")
    for wanted, said in (("open", "0.08"), ("0.03", "0.03"), ("close", "0")):
        code, out, err = run(capfd, wanted, "--namespace", "left", "--timeout", "60")
        assert (code, out) == (0, f"gripper: {said} m wide\n"), err
    for wanted in ("0.09", "-0.01", "nan", "wide"):
        code, out, err = run(capfd, "--namespace", "left", "--timeout", "60", "--", wanted)
        assert (code, out) == (2, "") and "robomech gripper: width is " in err
    assert "open, close or a number in m" in err


def test_an_object_between_the_fingers_is_told(hand, capfd):
    hand(gripper_object_width=0.05)
    assert run(capfd, "open", "--timeout", "60")[0] == 0
    code, out, _ = run(capfd, "close", "--timeout", "60")
    assert (code, out) == (1, "gripper: stopped by something at 0.05 m wide\n")


def test_a_robot_without_a_gripper_is_named(graph, capfd):
    graph.start(JointTrajectoryControllerNode, robot_description="puma560")
    code, _, err = run(capfd, "open", "--timeout", "60")
    assert code == 2 and "robot 'puma560' has no gripper: no joint moves behind" in err


def test_who_does_not_answer_and_missing_types_are_named(domain_id, capfd, monkeypatch):
    code, _, err = run(capfd, "open", "--timeout", "0.5")
    assert code == 3 and "'/joint_trajectory_controller/get_parameters' is not there" in err
    monkeypatch.setattr(gripper, "find_spec", lambda name: None)
    code, _, err = run(capfd, "open")
    assert code == 1 and "control_msgs, which defines GripperCommand, is not" in err
