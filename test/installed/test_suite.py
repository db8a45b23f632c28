"""The installed suite, driven from outside: processes of its own, over real DDS."""

from __future__ import annotations

import re
import signal
import subprocess
import time

import numpy as np
import pytest
import rclpy
import yaml
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import Execute, GetJacobian, PlanCartesian, PlanJoint, SolveFK, SolveIK
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import (
    matrix_from_pose,
    pose_from_matrix,
    stamped_pose,
)
from robomech_ros.robots import load_description, load_robot

PATIENCE = 60.0
NODES = {
    "/dynamics",
    "/joint_trajectory_controller",
    "/kinematics",
    "/servo",
    "/trajectory_planner",
    "/trajectory_publisher",
}
UR_HOME = [0.5, -1.2, 1.1, -0.6, 0.9, 0.2]
PUMA_Q = [0.3, -0.4, 0.2, 0.5, 0.6, -0.7]


def wait_until_the_state_is_known(outsider):
    """Wait until `kinematics` has the joint states, which are the seed where none is given."""
    deadline = time.monotonic() + PATIENCE
    request = GetJacobian.Request()
    while outsider.call(GetJacobian, "kinematics/get_jacobian", request).error_code:
        assert time.monotonic() < deadline, "kinematics gets no joint states"


def in_kinematics(outsider, chain, q, prefix=""):
    """Ask for FK and IK of a posture, and check that it comes back."""
    fk = outsider.call(
        SolveFK,
        f"{prefix}kinematics/solve_fk",
        SolveFK.Request(states=[joint_state(chain.joint_names, np.array(q))]),
    )
    assert fk.error_code == 0, fk.error_msg
    np.testing.assert_allclose(
        matrix_from_pose(fk.poses[0].pose), forward_kinematics(chain, q), atol=1e-12
    )
    ik = outsider.call(
        SolveIK,
        f"{prefix}kinematics/solve_ik",
        SolveIK.Request(target=fk.poses[0], seed=joint_state((), np.array(q))),
    )
    assert ik.error_code == 0, ik.error_msg
    np.testing.assert_allclose(ik.solutions[0].positions, q, atol=1e-8)


def plan(outsider, request, prefix=""):
    """Plan from the present state, as soon as the planner has heard of it."""
    deadline = time.monotonic() + PATIENCE
    while True:
        response = outsider.call(PlanJoint, f"{prefix}trajectory_planner/plan_joint", request)
        if response.error_code != ErrorCode.NO_STATE or time.monotonic() > deadline:
            break
    assert response.error_code == 0, response.error_msg
    return response.trajectory


def execute(outsider, trajectory=None, prefix=""):
    """Execute a trajectory, or the latest plan."""
    request = Execute.Request(trajectory=trajectory or JointTrajectory())
    response = outsider.call(Execute, f"{prefix}trajectory_publisher/execute", request)
    assert response.error_code == 0, response.error_msg


def fix_frame(outsider, parent, child, T):
    """Publish where a frame is, for ever."""
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = outsider.node.create_publisher(TFMessage, "/tf_static", latched)
    message, pose = TransformStamped(child_frame_id=child), pose_from_matrix(T)
    message.header.frame_id = parent
    place = message.transform.translation
    place.x, place.y, place.z = pose.position.x, pose.position.y, pose.position.z
    message.transform.rotation = pose.orientation
    publisher.publish(TFMessage(transforms=[message]))


def test_goals_in_the_world_and_in_a_camera_that_the_arm_carries(bringup, outsider):
    chain = load_robot("puma560")
    in_world, in_hand = np.eye(4), np.eye(4)
    in_world[:3, :3], in_world[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [1.0, -2.0, 0.8]
    in_hand[:3, 3] = 0.0, 0.05, 0.1
    fix_frame(outsider, "world", chain.base, in_world)
    fix_frame(outsider, chain.tip, "camera", in_hand)
    with bringup("--robot", "puma560", "--auto-execute", "--in-one-process"):
        start = outsider.wait_for_joints(lambda q: set(q) == set(chain.joint_names))
        q = [dict(zip(start.name, start.position, strict=True))[n] for n in chain.joint_names]
        end = forward_kinematics(chain, q)
        end[:3, 3] += (0.02, -0.03, 0.04)
        waypoints = [stamped_pose(in_world @ end, "world")]
        wait_until_the_state_is_known(outsider)
        path = outsider.call(
            PlanCartesian,
            "trajectory_planner/plan_cartesian",
            PlanCartesian.Request(waypoints=waypoints),
        )
        assert path.error_code == 0, path.error_msg

        def arrived(at):
            q = [at[name] for name in chain.joint_names]
            return np.allclose(forward_kinematics(chain, q), end, atol=1e-6)

        outsider.wait_for_joints(arrived)
        # Seen from the camera in the hand, where the hand is now: by the joints, and by /tf,
        # between whose transforms the hand moves evenly until it has arrived in both.
        clock = outsider.node.get_clock()
        for now in (Time, lambda: clock.now().to_msg()):
            deadline = time.monotonic() + PATIENCE
            found = np.zeros((4, 4))
            while not np.allclose(found, end, atol=1e-6):
                assert time.monotonic() < deadline, f"{found - end}"
                target = stamped_pose(np.linalg.inv(in_hand), "camera")
                target.header.stamp = now()
                ik = outsider.call(SolveIK, "kinematics/solve_ik", SolveIK.Request(target=target))
                assert ik.error_code == 0, ik.error_msg
                found = forward_kinematics(chain, ik.solutions[0].positions)


def plan_and_arrive(outsider, goal, profile=PlanJoint.Request.POLY345, prefix=""):
    """Plan to a goal, execute that, and wait until the published joints are there."""
    names = list(goal)
    request = PlanJoint.Request(
        goal=JointState(name=names, position=list(goal.values())), profile=profile
    )
    execute(outsider, plan(outsider, request, prefix), prefix)
    outsider.wait_for_joints(
        lambda q: all(abs(q[name] - goal[name]) < 1e-6 for name in names), f"{prefix}joint_states"
    )


def test_robot_by_topic_in_one_process(bringup, outsider):
    description = load_description("panda")
    with open(description.where, encoding="utf-8") as file:
        message = String(data=file.read())
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = outsider.node.create_publisher(String, "robot_description", latched)
    chain = description.chain()
    with bringup("--in-one-process"):
        publisher.publish(message)
        outsider.wait_for_joints(lambda q: set(q) >= set(chain.joint_names))
        in_kinematics(outsider, chain, chain.home() + 0.1)


def test_two_robots_in_namespaces_one_by_its_path(bringup, outsider, tmp_path, repository):
    path = tmp_path / "my arm.urdf"
    source = repository / "config" / "robots" / "ur5e.urdf"
    path.write_bytes(source.read_bytes())
    path.with_suffix(".yaml").write_bytes(source.with_suffix(".yaml").read_bytes())
    chain, options = load_robot(path), ("--namespace", "left", "--rate", "50")
    with (
        bringup("--robot", str(path), *options, end=signal.SIGTERM),
        bringup("--robot", "scara", "--namespace", "/right", "--in-one-process"),
    ):
        for prefix, robot in (("/left/", chain), ("/right/", load_robot("scara"))):
            goal = dict(zip(robot.joint_names, robot.home() + 0.05, strict=True))
            plan_and_arrive(outsider, goal, prefix=prefix)
        q = [0.3, -1.0, 1.2, 0.4, 0.9, -0.5]
        in_kinematics(outsider, chain, q, prefix="/left/")
        plan_and_arrive(outsider, dict(zip(chain.joint_names, q, strict=True)), prefix="/left/")


def test_one_process_in_mid_motion_ends_cleanly(bringup, outsider):
    chain = load_robot("puma560")
    goal = dict(zip(chain.joint_names, chain.home() + 0.5, strict=True))
    start = float(chain.home()[0])
    with bringup("--robot", "puma560", "--in-one-process", "--auto-execute"):
        outsider.wait_for_joints(lambda q: True)
        request = PlanJoint.Request(
            goal=JointState(name=list(goal), position=list(goal.values())),
            duration=rclpy.duration.Duration(seconds=20.0).to_msg(),
        )
        plan(outsider, request)
        outsider.wait_for_joints(lambda q: abs(q[chain.joint_names[0]] - start) > 1e-4)


def test_when_a_node_dies_bringup_says_which_and_stops_the_others(suite):
    process = subprocess.Popen(
        [str(suite.executables / "robomech"), "bringup", "--robot", "puma560"],
        env=suite.environment,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        children = wait_for_children(process.pid, {name.strip("/") for name in NODES})
        subprocess.run(["kill", "-KILL", str(children["servo"])], check=True)
        assert any("servo ended with exit code -9; the other" in line for line in process.stderr)
        others = {name: pid for name, pid in children.items() if name != "servo"}
        assert all(is_alive(pid) for pid in others.values())
        subprocess.run(["kill", "-KILL", str(children["trajectory_planner"])], check=True)
        _, errors = process.communicate(timeout=PATIENCE)
        assert process.returncode == 1
        assert "trajectory_planner ended with exit code -9" in errors
        assert not [name for name, pid in children.items() if is_alive(pid)]
    finally:
        if process.poll() is None:
            process.kill()


def wait_for_children(parent, names):
    """Wait until a process has a child for each name in its command line; gives their ids.

    A child that was just started still shows the command line of its parent.
    """
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        listed = subprocess.run(
            ["ps", "-ww", "-o", "pid=,args=", "--ppid", str(parent)],
            capture_output=True,
            text=True,
            check=False,
        ).stdout
        lines = [line.split(maxsplit=1) for line in listed.splitlines()]
        found = {name: int(pid) for pid, command in lines for name in names if name in command}
        if len(found) == len(names):
            return found
    raise AssertionError(f"no process for each of {names}: {listed}")


def is_alive(pid):
    return (
        subprocess.run(["kill", "-0", str(pid)], capture_output=True, check=False).returncode == 0
    )


@pytest.mark.parametrize(
    ("node", "arguments", "words"),
    [
        (
            "kinematics_node",
            ["-p", "robot_description:=puma560", "-p", "max_batch_size:=0"],
            "parameter 'max_batch_size' is 0; allowed is an integer from 1 to 10000000 poses",
        ),
        (
            "joint_state_simulator_node",
            ["-p", "robot_description:=puma560", "-p", "publish_rate:=many"],
            "parameter 'publish_rate' is 'many'",
        ),
        (
            "joint_state_simulator_node",
            ["-p", "robot_description:=pumba560"],
            "unknown robot 'pumba560' (did you mean 'puma560'?)",
        ),
        (
            "joint_state_simulator_node",
            ["-p", "robot_description:=puma560", "-p", "tip_link:=hand"],
            "unknown link 'hand'",
        ),
        ("joint_state_simulator_node", ["-p", "robot_description:=<robot>"], "URDF string"),
        ("joint_state_simulator_node", ["-p", "robot_description"], "robot_description"),
    ],
)
def test_a_node_that_cannot_start_says_why_in_one_line(suite, node, arguments, words):
    done = suite.run(node, "--ros-args", *arguments)
    assert done.returncode == 2
    assert done.stderr.startswith(f"{node}: ")
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "node",
    [
        "calibration_node",
        "dynamics_node",
        "grasping_node",
        "joint_state_simulator_node",
        "kinematics_node",
        "mobile_base_node",
        "move_group_node",
        "rvs_node",
        "servo_node",
        "trajectory_planner_node",
        "trajectory_publisher_node",
        "walker_node",
    ],
)
def test_every_node_takes_what_launch_appends_and_ends_with_0_on_a_signal(suite, node, tmp_path):
    """By SIGTERM; SIGINT ends the nodes of each bringup, which requires 0 of them."""
    # As launch_ros's Node makes it of name, namespace, parameters and remappings.
    file = tmp_path / "launch_params_0"
    others = {
        "grasping_node": "three_fingered",
        "mobile_base_node": "mecanum",
        "walker_node": "phantomx",
    }
    robot = others.get(node, "puma560")
    parameters = {"robot_description": robot, "frame_prefix": "left/"}
    parameters |= {"port": 0} if node == "rvs_node" else {}
    file.write_text(yaml.safe_dump({"/**": {"ros__parameters": parameters}}))
    given = ["-r", "__node:=named", "-r", "__ns:=/left", "--params-file", str(file)]
    process = subprocess.Popen(
        [str(suite.executables / node), "--ros-args", *given, "-r", "/tf:=tf"],
        env=suite.environment,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stderr is not None
        said = iter(process.stderr.readline, "")
        found = next((line for line in said if "ready" in line), None)
        assert found, f"{node} ended before it was ready"
        assert "[left.named]: ready" in found
        process.send_signal(signal.SIGTERM)
        _, rest = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0
        assert "Traceback" not in rest
        assert "leaked" not in rest
    finally:
        if process.poll() is None:
            process.kill()


def test_every_node_explains_its_parameters(suite):
    names = "kinematics_node", "joint_state_simulator_node", "calibration_node", "servo_node"
    for node in names:
        done = suite.run(node, "--help")
        assert done.returncode == 0
        assert "robot_description (default ''; a string)" in done.stdout


def test_demo_of_a_robot_from_a_path_with_a_payload_that_the_drives_do_not_know(
    suite, tmp_path, repository
):
    """A URDF without acceleration limits, with a word about what is assumed, and an SRDF.

    Two kilograms are picked and placed by forces, within the tolerance that is said.
    """
    bare = tmp_path / "bare.urdf"
    bare.write_bytes((repository / "config" / "robots" / "ur5e.urdf").read_bytes())
    home = dict(zip(load_robot("ur5e").joint_names, UR_HOME, strict=True))
    joints = "".join(f'<joint name="{name}" value="{at}"/>' for name, at in home.items())
    srdf = tmp_path / "bare.srdf"
    srdf.write_text(
        '<robot name="ur5e"><group name="arm"><chain base_link="base_link" tip_link="tool0"/>'
        f'</group><group_state name="home" group="arm">{joints}</group_state></robot>'
    )
    files = ["--robot", str(bare), "--srdf", str(srdf), "--output", str(tmp_path / "out")]
    done = suite.run("robomech", "demo", *files, "--dynamic", "--payload", "2", timeout=120)
    assert done.returncode == 0, done.stderr
    stands = re.search(r"stands at home: (.*) rad or m", done.stdout)[1]
    assert [float(at) for at in stands.split()] == pytest.approx(UR_HOME, abs=5e-3)
    assert "home, by its name" in done.stdout
    assert "acceleration or jerk limits of some joints are missing" in done.stdout
    assert "picked 2 kg, unknown to the controller of the drives" in done.stdout
    assert "every joint stayed within 0.02 rad or m of its path" in done.stdout
    assert "everything worked" in done.stdout
    assert sorted(path.suffix for path in (tmp_path / "out").iterdir()) == [".html", ".png"]


@pytest.mark.parametrize(
    ("robot", "driven", "forces"),
    [
        ("hexapod", "6 of them", ["--dynamic", "--payload", "2"]),
        pytest.param("delta", "3 of them", [], marks=pytest.mark.long),
    ],
)
def test_demo_of_a_parallel_robot(suite, tmp_path, robot, driven, forces):
    """Picked, lifted over and placed, and a circle; arrival is checked after every motion."""
    options = ["--robot", robot, *forces, "--output", str(tmp_path / "out")]
    done = suite.run("robomech", "demo", *options, timeout=180)
    assert done.returncode == 0, done.stderr
    assert f"{driven} driven" in done.stdout
    circle = "circle with tilt" if robot == "hexapod" else "circle"
    for motion in ("pick", "place", circle):
        assert f"{motion}: the tip is off by" in done.stdout
    assert "everything worked" in done.stdout
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == [f"{robot}.html", f"{robot}.png"]
    tracked = "every joint stayed within 0.02 rad or m of its path"
    assert (tracked in done.stdout) == bool(forces)
    refused = suite.run("robomech", "demo", *options, "--group", "legs")
    assert refused.returncode == 2
    assert f"--group does not apply to '{robot}', a parallel robot" in refused.stderr


def test_demo_with_a_payload_that_is_too_heavy(suite, tmp_path):
    options = ["--robot", "ur5e", "--dynamic", "--payload", "200", "--output", str(tmp_path)]
    heavy = suite.run("robomech", "demo", *options, timeout=120)
    assert heavy.returncode == 1
    assert "was at its effort limit for" in heavy.stderr


def test_demo_of_a_capture_in_space(suite, tmp_path):
    """The tip is where it should be in inertial space, and the momentum stays."""
    options = ["--robot", "canadarm2", "--output", str(tmp_path)]
    done = suite.run("robomech", "demo", *options, timeout=180)
    assert done.returncode == 0, done.stderr
    for proof in ("tip in inertial space:", "momentum after it: constant up to", "has moved by x"):
        assert proof in done.stdout
    assert "everything worked" in done.stdout
    assert sorted(path.name for path in tmp_path.iterdir()) == ["canadarm2.html", "canadarm2.png"]


def test_demo_with_obstacles(suite, tmp_path):
    """Each motion is proved by the states that were published, and the direct one would hit."""
    options = ["--obstacles", "--robot", "ur5e", "--output", str(tmp_path)]
    done = suite.run("robomech", "demo", *options, timeout=180)
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stdout.split())
    assert said.count("certified True") == 3
    assert said.count("none is in contact, nor is any posture between them") == 3
    assert float(re.search(r"'wall' ([\d.]+) mm into each other", said)[1]) > 1.0
    assert "around the wall: " in said and "everything worked" in said
    assert (tmp_path / "ur5e.png").is_file()
    refused = suite.run("robomech", "demo", *options, "--dynamic")
    assert refused.returncode == 2 and "no --dynamic beside it" in refused.stderr


def test_a_demo_of_no_robot_says_so(suite, tmp_path):
    done = suite.run("robomech", "demo", "--robot", "pumba560", "--output", str(tmp_path))
    assert done.returncode == 2
    assert "robomech demo: unknown robot 'pumba560'" in done.stderr
