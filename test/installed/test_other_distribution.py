"""The other ROS distribution: its interfaces are usable, and the two understand each other."""

from __future__ import annotations

import pytest

Q = [0.3, 0.5, -1.1, 0.4, 0.6, -0.2]
ROBOT = ("-p", "robot_description:=puma560")
ALL_TYPES = """
import importlib, pathlib, re, sys
from rclpy.type_support import check_for_type_support
root = pathlib.Path(sys.argv[1])
for path in sorted(root.glob("*/*")):
    if path.suffix in (".msg", ".srv", ".action"):
        module = importlib.import_module("robomech_interfaces." + path.suffix[1:])
        check_for_type_support(getattr(module, path.stem))
        print(path.stem)
"""


def solve_back_and_forth(client):
    """Ask for the pose of Q and for the postures of that pose; Q has to be among them."""
    answer = client.call("kinematics/solve_fk", {"states": [{"position": Q}]})
    assert answer["error_code"] == 0, answer["error_msg"]
    request = {"target": answer["poses"][0], "seed": {"position": Q}}
    answer = client.call("kinematics/solve_ik", request)
    assert answer["error_code"] == 0, answer["error_msg"]
    assert answer["complete"] is True
    assert answer["solutions"][0]["positions"] == pytest.approx(Q, abs=1e-9)


def moveit_back_and_forth(client):
    """Ask MoveIt's services for the pose of Q and, from near by, for Q."""
    names = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_bend", "wrist_swivel"]
    state = {"joint_state": {"name": names, "position": Q}}
    request = {"fk_link_names": ["tool0"], "robot_state": state}
    answer = client.call("compute_fk", request)
    assert answer["error_code"]["val"] == 1, answer["error_code"]
    pose = answer["pose_stamped"][0]
    state["joint_state"]["position"] = [angle + 0.1 for angle in Q]
    request = {"robot_state": state, "pose_stamped": pose, "timeout": {"nanosec": 500_000_000}}
    answer = client.call("compute_ik", {"ik_request": request})
    assert answer["error_code"]["val"] == 1, answer["error_code"]
    solution = answer["solution"]["joint_state"]
    assert solution["name"] == names
    assert solution["position"] == pytest.approx(Q, abs=1e-9)
    request["avoid_collisions"] = True
    answer = client.call("compute_ik", {"ik_request": request})
    assert answer["error_code"]["val"] == 1
    assert "no collisions were checked" in answer["error_code"]["message"]


def test_every_interface_has_its_type_support(other_suite, repository, output_of):
    python = other_suite.executables / "python"
    interfaces = repository / "robomech_interfaces"
    names = output_of(python, "-c", ALL_TYPES, interfaces, env=other_suite.environment)
    assert len(names.split()) >= 14


def test_inverse_kinematics_between_two_processes(other_suite):
    with other_suite.node("kinematics_node", *ROBOT):
        solve_back_and_forth(other_suite)


def test_a_client_there_is_answered_by_a_node_here(suite, other_suite):
    with suite.node("kinematics_node", *ROBOT), suite.node("move_group_node", *ROBOT):
        solve_back_and_forth(other_suite)
        moveit_back_and_forth(other_suite)


def test_a_client_here_is_answered_by_a_node_there(suite, other_suite):
    with other_suite.node("kinematics_node", *ROBOT), other_suite.node("move_group_node", *ROBOT):
        solve_back_and_forth(suite)
        moveit_back_and_forth(suite)
