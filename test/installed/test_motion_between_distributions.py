"""Motions across processes of two ROS distributions, by follow_joint_trajectory and execute."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

CLIENT = Path(__file__).with_name("follow_client.py")
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
ROBOT = ("-p", "robot_description:=puma560")
LAG = ("-p", "tracking_lag:=0.1", "-p", "goal_time:=5.0")
JOINTS = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_bend", "wrist_swivel"]


@pytest.fixture
def client_of(output_of):
    """Have the client of an installation drive the robot; returns how its goals ended."""

    def drive(installed):
        python = installed.executables / "python"
        return json.loads(output_of(python, CLIENT, env=installed.environment).splitlines()[-1])

    return drive


def check(found):
    """Check status, code and text of every goal that the client sent."""
    cancelled = "cancelled by the client; the robot has stopped on its path"
    assert found["success"] == [SUCCEEDED, 0, ""]
    assert found["cancel"] == [CANCELED, 0, cancelled]
    assert found["preempted"] == [ABORTED, -1, "preempted by a newer goal of the action"]
    assert found["preempting"] == [SUCCEEDED, 0, ""]
    for case, code, said in (("path", -4, "path"), ("goal", -5, "goal")):
        status, given, text = found[case]
        assert (status, given) == (ABORTED, code), text
        assert text.startswith("joint 'shoulder' is 0.0")
        assert f" rad off its {said}, the tolerance is " in text
    status, code, text = found["thumb"]
    assert (status, code) == (SUCCEEDED, 0)
    assert "the default tolerances hold, as one of the goal cannot: unknown joint 'thumb'" in text


def test_a_client_here_drives_a_controller_there(suite, other_suite, client_of):
    with other_suite.node("joint_state_simulator_node", *ROBOT, *LAG):
        check(client_of(suite))


def test_a_client_there_drives_a_controller_here(suite, other_suite, client_of):
    with suite.node("joint_state_simulator_node", *ROBOT, *LAG):
        check(client_of(other_suite))


def test_speed_of_a_robot_there(suite, other_suite):
    follow = ("-p", "transport:=follow_joint_trajectory", *ROBOT)
    start = ("-p", "initial_positions:=[0.2, 0.2, 0.2, 0.2, 0.2, 0.2]")
    points = [
        {"positions": [place] * 6, "velocities": [0.0] * 6, "accelerations": [0.0] * 6}
        for place in (0.2, 0.4)
    ]
    points[1]["time_from_start"] = {"sec": 1}
    request = {"trajectory": {"joint_names": JOINTS, "points": points}}
    with (
        other_suite.node("joint_state_simulator_node", *ROBOT, *start),
        other_suite.node("trajectory_publisher_node", *follow),
    ):
        answer = other_suite.call("trajectory_publisher/set_speed", {"speed": 2.0})
        assert answer["error_code"] == 109
        assert "speed is 2.0, expected from 1e-06 up to 1" in answer["error_msg"]
        answer = suite.call("trajectory_publisher/set_speed", {"speed": 0.5})
        assert (answer["error_code"], answer["error_msg"]) == (0, "")
        answer = other_suite.call("trajectory_publisher/execute", request)
        assert (answer["error_code"], answer["error_msg"]) == (0, "")
        assert answer["duration"]["sec"] == 2
