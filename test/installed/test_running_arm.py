"""One installed arm whose nodes are processes, driven from outside by all tests of this module."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import time

import numpy as np
import pytest
import yaml
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from test_servo_suite import check_twists_for_two_seconds
from test_suite import (
    NODES,
    PATIENCE,
    PUMA_Q,
    in_kinematics,
    plan,
    plan_and_arrive,
    wait_until_the_state_is_known,
)

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanJoint, QueryWorkspace
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import load_reach_map
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.robots import load_robot


@pytest.fixture(scope="module")
def running_arm(shared_bringup):
    """A PUMA 560 for all tests of this module."""
    return shared_bringup("--robot", "puma560")


@pytest.fixture
def arm(running_arm):
    """The PUMA 560 at home, wherever another test left it, and a planner that knows it is there."""
    chain, outsider = load_robot("puma560"), running_arm.outsider
    wait_until_the_state_is_known(outsider)
    assert outsider.call(Trigger, "joint_trajectory_controller/reset", Trigger.Request()).success
    goal = JointState(name=chain.joint_names, position=chain.home() + 0.1)
    deadline, start = time.monotonic() + PATIENCE, np.full(chain.n, np.nan)
    while not np.allclose(start, chain.home(), atol=1e-9):
        assert time.monotonic() < deadline, f"the planner takes {start} for home"
        start = plan(outsider, PlanJoint.Request(goal=goal)).points[0].positions
    return running_arm


def test_six_nodes_and_ten_rounds_none_lost(arm):
    chain, outsider = load_robot("puma560"), arm.outsider
    rng = np.random.default_rng(5)
    goals = chain.home() + rng.uniform(-0.4, 0.4, (10, chain.n))
    for i, goal in enumerate(goals):
        profile = PlanJoint.Request.RUCKIG if i % 2 else PlanJoint.Request.POLY345
        plan_and_arrive(outsider, dict(zip(chain.joint_names, goal, strict=True)), profile)
    in_kinematics(outsider, chain, PUMA_Q)
    nodes = {
        f"{namespace.rstrip('/')}/{name}"
        for name, namespace in outsider.node.get_node_names_and_namespaces()
    }
    assert nodes >= NODES


def readme_call(repository, tool):
    """Find a call by a tool in README.md, as a command line, and what is shown below it."""
    text = (repository / "README.md").read_text(encoding="utf-8")
    block = next(b for b in re.findall(r"^```\w+\n(.*?)^```", text, re.S | re.M) if f"{tool} " in b)
    lines = block.removeprefix("$ ").replace("\\\n", " ").splitlines(keepends=True)
    start = next(i for i, line in enumerate(lines) if line.startswith(f"{tool} "))
    return shlex.split(lines[start]), "".join(lines[start + 1 :])


def test_call_of_the_readme_is_answered_as_it_shows(arm, repository):
    words, shown = readme_call(repository, "robomech call")
    done = arm.suite.run(*words, "--timeout", str(PATIENCE))
    assert done.returncode == 0, done.stderr
    answer, expected = yaml.safe_load(done.stdout), yaml.safe_load(shown)
    assert answer.keys() == expected.keys()
    for name in expected.keys() - {"solve_time"}:
        assert_alike(answer[name], expected[name], name)


if shutil.which("ros2"):

    def test_call_of_the_readme_with_the_tool_of_ros(arm, repository):
        words, _ = readme_call(repository, "ros2 service call")
        _, shown = readme_call(repository, "robomech call")
        done = subprocess.run(
            words,
            env=arm.suite.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=True,
        )
        assert "error_code=0" in done.stdout
        for solution in yaml.safe_load(shown)["solutions"]:
            assert f"positions=[{solution['positions'][0]:.6f}"[:-1] in done.stdout


def assert_alike(answer, shown, where):
    """Compare what was answered with what is shown; rounding differs from machine to machine."""
    if isinstance(shown, dict):
        for name in shown:
            assert_alike(answer[name], shown[name], f"{where}.{name}")
    elif isinstance(shown, list):
        assert len(answer) == len(shown), where
        for i, (one, other) in enumerate(zip(answer, shown, strict=True)):
            assert_alike(one, other, f"{where}[{i}]")
    elif isinstance(shown, float):
        assert answer == pytest.approx(shown, rel=1e-3, abs=1e-9), where
    else:
        assert answer == shown, where


def test_what_is_reached_by_the_service_and_in_a_map(arm, tmp_path):
    puma = load_robot("puma560")
    T = np.stack([forward_kinematics(puma, PUMA_Q)] * 2)
    T[1, 0, 3] = 2.0
    box = ("--lower", "0.3", "0", "0", "--upper", "0.6", "0", "0", "--shape", "2", "1", "1")
    words = ("map", "--robot", "puma560", *box, "--orientations", "8", "--length", "0.3")
    poses = [stamped_pose(pose, "") for pose in T]
    answer = arm.outsider.call(
        QueryWorkspace, "kinematics/query_workspace", QueryWorkspace.Request(poses=poses)
    )
    made = arm.suite.run("robomech", *words, "--output", str(tmp_path / "map.npz"))
    assert answer.error_code == 0, answer.error_msg
    assert list(answer.reachable) == [True, False]
    assert answer.reason[1] == ErrorCode.OUT_OF_REACH
    assert answer.boundary_distances[0] > 0.0 > answer.boundary_distances[1]
    assert made.returncode == 0, made.stderr
    found = load_reach_map(tmp_path / "map.npz", puma)
    assert found.complete
    assert found.reached.max() > 0


def test_target_out_of_reach_through_the_command(arm):
    request = "{target: {pose: {position: {x: 5.0}, orientation: {w: 1.0}}}}"
    words = ("call", "kinematics/solve_ik", request, "--timeout", str(PATIENCE))
    done = arm.suite.run("robomech", *words)
    assert done.returncode == 1
    assert "error 201 OUT_OF_REACH" in done.stderr
    assert yaml.safe_load(done.stdout)["solutions"] == []


def test_twists_move_the_tip_of_an_arm_whose_nodes_are_processes(arm):
    check_twists_for_two_seconds(arm.outsider)
