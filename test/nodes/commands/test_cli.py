"""The `robomech` command, in this process."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from builtin_interfaces.msg import Duration
from rclpy.node import Node
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.srv import Execute
from robomech_ros import __version__, fastdds_shared_memory
from robomech_ros.cli import doctor, main as cli
from robomech_ros.cli.warmup import kernel_modules
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.process.entry_points import NODE_MODULES
from robomech_ros.robots import list_robots
from robomech_ros.stop_signals import STOP_SIGNALS


class Servant(Node):
    """Answers with what it was asked."""

    def __init__(self, **options):
        super().__init__("servant", **options)
        self.create_service(SetBool, "~/switch", self._switch)
        self.create_service(Execute, "~/execute", self._execute)

    def _switch(self, request, response):
        response.success = request.data
        response.message = f"{request.data}"
        return response

    def _execute(self, request, response):
        response.error_code = len(request.trajectory.points) * 201
        response.error_msg = "out by 0.1 m"
        return response


class Leaver(Node):
    """Has its service go while a request waits."""

    def __init__(self, **options):
        super().__init__("leaver", **options)
        self._service = self.create_service(SetBool, "~/switch", self._leave)

    def _leave(self, request, response):
        self.destroy_service(self._service)
        raise RuntimeError("gone")


@pytest.fixture(autouse=True)
def signals_as_before():
    """Undo what bringup does with the signals of this process."""
    handlers = {number: signal.getsignal(number) for number in STOP_SIGNALS}
    yield
    for number, handler in handlers.items():
        signal.signal(number, handler)


def run(capfd, *arguments):
    code = cli.main(list(arguments))
    captured = capfd.readouterr()
    return code, captured.out, captured.err


def test_call_finds_the_type_and_prints_the_answer_as_yaml(graph, capfd):
    graph.start(Servant)
    code, out, _ = run(capfd, "call", "servant/switch", "{data: true}")
    assert (code, yaml.safe_load(out)) == (0, {"success": True, "message": "True"})


def test_call_says_what_the_code_means(graph, capfd):
    graph.start(Servant)
    code, out, err = run(capfd, "call", "/servant/execute", "{trajectory: {points: [{}]}}")
    assert code == 1
    assert yaml.safe_load(out)["error_code"] == 201
    assert "error 201 OUT_OF_REACH: out by 0.1 m" in err


def test_call_says_what_a_code_of_moveit_means(graph, capfd):
    graph.start(MoveGroupNode, robot_description="puma560")
    pose = "pose_stamped: {pose: {position: {x: 0.4, z: 0.3}, orientation: {w: 1.0}}}"
    code, out, err = run(capfd, "call", "compute_ik", f"{{ik_request: {{{pose}}}}}")
    assert (code, "error" in err) == (0, False)
    assert len(yaml.safe_load(out)["solution"]["joint_state"]["position"]) == 6
    request = "{ik_request: {group_name: legs}}"
    code, _, err = run(capfd, "call", "compute_ik", request)
    assert code == 1
    assert "error -15 INVALID_GROUP_NAME: group_name is 'legs'" in err


def test_call_of_a_service_that_says_no(graph, capfd):
    graph.start(Servant)
    code, _, err = run(capfd, "call", "servant/switch")
    assert code == 1
    assert "no success: False" in err


def test_call_of_a_service_that_goes_before_it_answers(graph, capfd):
    graph.start(Leaver)
    began = time.monotonic()
    code, _, err = run(capfd, "call", "leaver/switch", "--timeout", "600")
    assert code == 3
    assert "service '/leaver/switch' has gone before it answered" in err
    assert time.monotonic() - began < 20.0


@pytest.mark.parametrize(
    ("request_text", "words"),
    [
        ("{daat: true}", "SetBool_Request has no field 'daat' (did you mean 'data'?)"),
        ("{data: maybe}", "data is 'maybe', expected a value of type boolean"),
        ("{data", "expected YAML"),
    ],
)
def test_call_with_a_bad_request(graph, capfd, request_text, words):
    graph.start(Servant)
    code, out, err = run(capfd, "call", "servant/switch", request_text)
    assert (code, out) == (2, "")
    assert words in err
    # A second call from this process works: the first has left nothing behind.
    assert run(capfd, "call", "servant/switch", "{data: true}")[0] == 0


@pytest.mark.slow
def test_call_of_a_service_that_is_not_there_lists_those_that_are(graph, capfd):
    graph.start(Servant)
    code, out, err = run(capfd, "call", "servant/swich", "--timeout", "6")
    assert (code, out) == (3, "")
    assert "'/servant/swich' did not appear (did you mean '/servant/switch'?)" in err
    assert "/servant/execute" in err
    assert "parameters" not in err


@pytest.mark.parametrize("number", STOP_SIGNALS)
@pytest.mark.parametrize("type_given", [False, True])
def test_call_ends_quietly_on_a_signal(graph, type_given, number):
    """It could show the traceback of an RCLError, since rclpy takes the context away."""
    command = [sys.executable, "-m", "robomech_ros.cli.main", "call", "never/there"]
    command += ["{}", "--timeout", "60"]
    command += ["--type", "std_srvs/srv/Trigger"] if type_given else []
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 30.0
    while "robomech_call" not in graph.client.get_node_names():
        assert time.monotonic() < deadline, "it never began"
        time.sleep(0.02)
    process.send_signal(number)
    _, said = process.communicate(timeout=30.0)
    ends = {
        (cli.EXIT_INTERRUPTED, ""),
        (3, "robomech call: ROS was shut down before the answer came\n"),
    }
    assert (process.returncode, said) in ends


@pytest.mark.parametrize("timeout", ["nan", "-1", "0", "inf", "1e9", "soon"])
def test_call_with_a_time_that_is_none(capfd, timeout):
    with pytest.raises(SystemExit) as caught:
        cli.main(["call", "servant/switch", f"--timeout={timeout}"])
    assert caught.value.code == 2
    expected = f"--timeout: '{timeout}', expected a number of seconds above 0 and up to 86400"
    assert expected in capfd.readouterr().err


def test_plot_draws_all_postures_of_a_pose(capfd, tmp_path):
    joints = ["-3.1089", "1.8884", "-2.5785", "-0.0994", "-2.8742", "3.1343"]
    path = str(tmp_path / "all.png")
    code, out, _ = run(capfd, "plot", "general6r", "--joints", *joints, "--output", path)
    assert (code, out) == (0, f"{path}: 16 postures; these are all\n")
    assert (tmp_path / "all.png").stat().st_size > 100_000
    pose = ["0.4", "0.1", "0.3", "0", "1", "0", "0"]
    code, out, _ = run(capfd, "plot", "puma560", "--pose", *pose, "--output", path)
    assert code == 0
    far = ["9", "0", "0", "0", "0", "0", "1"]
    code, _, err = run(capfd, "plot", "puma560", "--pose", *far, "--output", path)
    assert code == 1
    assert "out of reach" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--pose", *["0", "0", "0", "0", "0", "0", "0"]], "quaternion"),
        (["--joints", "0.1"], "q has shape"),
        (["--joints", *["0"] * 6, "--output", "arm.doc"], "png, svg or pdf"),
        (["--joints", *["0"] * 6, "--azimuth", "inf"], "--azimuth is inf"),
    ],
)
def test_plot_refuses_what_it_cannot_draw(capfd, arguments, words):
    code, _, err = run(capfd, "plot", "puma560", *arguments)
    assert code == cli.EXIT_USAGE
    assert words in err


def test_robots_are_listed_with_joints_and_family(capfd):
    code, out, _ = run(capfd, "robots")
    assert code == 0
    for name in list_robots():
        assert name in out
    assert re.search(r"puma560.*RRRRRR.*decoupled", out)
    assert re.search(r"ur5e.*RRRRRR.*three-parallel", out)
    assert re.search(r"panda.*RRRRRRR.*redundant", out)
    assert re.search(r"stanford.*RRPRRR.*decoupled", out)
    assert re.search(r"hexapod.*6 x RR\[P\]RRR.*parallel", out)
    assert re.search(r"delta.*3 x \[R\]RRRR.*parallel", out)
    assert re.search(r"mecanum.*4 wheels.*rolling: mecanum", out)
    assert re.search(r"tricycle.*3 wheels, 1 steered.*rolling: tricycle", out)


def test_warmup_imports_every_kernel_module(capfd):
    code, out, _ = run(capfd, "warmup")
    assert code == 0
    some = {"chain.serial", "inverse.decoupled.wrist", "dynamics.forward"}
    assert some <= set(kernel_modules())
    assert f"{len(kernel_modules())} kernel modules" in out


def test_doctor_finds_nothing_missing_here(capfd, domain_id):
    code, out, _ = run(capfd, "doctor")
    assert code == 0, out
    assert "nothing is missing" in out
    assert f"{domain_id}" in out
    for package, feature in (
        ("control_msgs", "follow_joint_trajectory"),
        ("moveit_msgs", "compute_cartesian_path"),
        ("tf2_msgs", "/tf_static"),
        ("coal", "collision checks"),
        ("ompl", "planning around obstacles"),
    ):
        assert re.search(rf"ok +{package} .*{feature}", out)


def test_doctor_names_what_is_missing_and_the_command(capfd, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "300")
    monkeypatch.setitem(sys.modules, "ruckig", None)
    code, out, _ = run(capfd, "doctor")
    assert code == 1
    assert re.search(r"MISSING +ROS domain +'300'\n +-> export ROS_DOMAIN_ID=", out)
    assert re.search(r"MISSING +ruckig.*\n +-> make setup", out)


@pytest.mark.parametrize(
    "domain, said",
    [("101", "ok +ROS domain +101"), ("202", "- +ROS domain +202, .*32768 to 60999")],
)
def test_doctor_knows_domains_whose_ports_others_may_have(capfd, monkeypatch, domain, said):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    monkeypatch.setattr(doctor, "_ports_given_away", lambda: range(32768, 61000))
    assert re.search(said, str(run(capfd, "doctor")[1])), said


def test_doctor_lists_ports_that_killed_processes_left(capfd, monkeypatch, tmp_path):
    monkeypatch.setattr(fastdds_shared_memory, "FOLDER", tmp_path)
    assert re.search(r"ok +shared memory +no ports left", str(run(capfd, "doctor")[1]))
    for name in ("fastdds_port7000", "fastdds_port7411", "fastdds_0123456789abcdef"):
        (tmp_path / name).touch()
    _, out, _ = run(capfd, "doctor")
    assert (
        "killed processes left ports of Fast DDS, on which messages may be lost: 7000, 7411" in out
    )
    assert "-> fastdds shm clean" in out


def test_unknown_command_and_version(capfd):
    with pytest.raises(SystemExit) as caught:
        cli.main(["dance"])
    assert caught.value.code == 2
    assert "invalid choice: 'dance'" in capfd.readouterr().err
    with pytest.raises(SystemExit) as caught:
        cli.main(["--version"])
    assert caught.value.code == 0
    assert __version__ in capfd.readouterr().out


def test_unknown_robot_is_said_once_before_anything_starts(capfd):
    code, out, err = run(capfd, "bringup", "--robot", "pumba560")
    assert (code, out) == (2, "")
    assert err.count("unknown robot 'pumba560' (did you mean 'puma560'?)") == 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--payload", "2"], "--payload is 2.0, expected 0 without --dynamic"),
        (["--dynamic", "--payload", "nan"], "--payload is nan, expected 0 to 1000 kg"),
        (["--dynamic", "--payload", "-1"], "--payload is -1.0, expected 0 to 1000 kg"),
    ],
)
def test_payloads_that_the_demo_refuses(capfd, options, said):
    code, out, err = run(capfd, "demo", *options)
    assert (code, out) == (2, "")
    assert said in err


def test_the_demo_refuses_a_folder_that_takes_no_files_before_it_starts(capfd, tmp_path):
    taken = tmp_path / "taken"
    taken.write_text("a file")
    code, out, err = run(capfd, "demo", "--robot", "mecanum", "--output", f"{taken}")
    assert (code, out) == (2, "")
    assert f"--output is '{taken}', expected a folder that can be written" in err


def test_the_demo_says_of_a_hand_that_it_has_none(capfd, tmp_path):
    code, out, err = run(capfd, "demo", "--robot", "three_fingered", "--output", f"{tmp_path}")
    assert (code, out) == (2, "")
    assert "--robot is 'three_fingered'" in err and "a hand has none" in err


@pytest.mark.parametrize(
    ("robot", "options", "said"),
    [
        ("mecanum", ["--dynamic"], "--dynamic does not apply to 'mecanum', a rolling robot"),
        ("go1", ["--srdf", "x"], "--srdf does not apply to 'go1', a walking machine"),
        ("delta", ["--group", "x"], "--group does not apply to 'delta', a parallel robot"),
        ("canadarm2", ["--dynamic"], "--dynamic is 'canadarm2', expected a robot on a fixed base"),
        ("mecanun", [], "unknown robot 'mecanun' (did you mean 'mecanum'?)"),
        ("/no/such.urdf", [], "/no/such.urdf: No such file"),
    ],
)
def test_the_demo_refuses_what_does_not_apply_as_other_commands_do(capfd, robot, options, said):
    code, _, err = run(capfd, "demo", "--robot", robot, *options)
    assert code == 2
    assert err.startswith(f"robomech demo: {said}") and err.count("\n") == 1


def test_calibrate_demo_takes_arms(capfd):
    code, out, err = run(capfd, "calibrate-demo", "--robot", "mecanum")
    assert (code, out) == (2, "")
    said = "'mecanum' is a robot of kind 'rolling', which is not taken here; available: canadarm2, "
    assert said in err and "unknown" not in err


def test_a_robot_of_another_kind_is_named_as_such(capfd):
    code, out, err = run(capfd, "plot-workspace", "mecanum")
    assert (code, out) == (2, "")
    said = "'mecanum' is a robot of kind 'rolling', which is not taken here; available: canadarm2, "
    assert said in err and "unknown" not in err


@pytest.mark.parametrize(
    ("robot", "node", "shown"),
    [
        ("three_fingered", "grasping", False),
        ("mecanum", "mobile_base", True),
        ("go1", "joint_trajectory_controller", True),
    ],
)
def test_policies_of_robots_that_are_no_arms_are_written(tmp_path, robot, node, shown):
    file = tmp_path / "policy.xml"
    command = [sys.executable, "-m", "robomech_ros.cli.main", "security-policies"]
    done = subprocess.run(
        [*command, "--robot", robot, "--output", file],
        capture_output=True,
        text=True,
        timeout=300.0,
    )
    assert done.returncode == 0, done.stderr
    (profile,) = ElementTree.parse(file).findall(f".//profile[@node='{node}']")
    allowed = {
        way: {entry.text for part in profile.findall(f"*[@{way}='ALLOW']") for entry in part}
        for way in ("publish", "subscribe")
    }
    # What shows a robot comes a moment after the start, and yields to others.
    expected = {"/robot_description", "/tf", "/tf_static"} if shown else set()
    assert allowed["publish"] & {"/robot_description", "/tf", "/tf_static"} == expected
    assert allowed["subscribe"] & {"/tf", "/tf_static"} == expected - {"/robot_description"}


@pytest.mark.parametrize("module", ["robomech_ros", "robomech_ros.cli.main"])
def test_import_pulls_in_neither_ros_nor_numba(module):
    code = (
        f"import sys, {module}; "
        "print([m for m in ('rclpy', 'numba', 'scipy', 'matplotlib', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


IMPORTS = """
import importlib, sys
heavy = "scipy.optimize", "scipy.spatial", "scipy.interpolate", "matplotlib", "rich", "numba"
for module in sys.argv[1:]:
    importlib.import_module(module)
    print(module, *(one for one in heavy if one in sys.modules))
"""


def test_nodes_import_no_heavy_library_and_those_that_plan_nothing_no_compiled_code():
    """One process imports all, those that plan nothing first, and lists what has come by then."""
    nothing = "trajectory_publisher", "joint_trajectory_controller"
    modules = [NODE_MODULES[node] for node in dict.fromkeys([*nothing, *NODE_MODULES])]
    command = [sys.executable, "-c", IMPORTS, *modules]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert lines[: len(nothing)] == modules[: len(nothing)]
    assert [line.removesuffix(" numba") for line in lines] == modules


def test_the_demonstration_of_an_arm_loads_only_the_kernels_that_are_compiled_for_it():
    code = (
        "import sys; from robomech_ros.nodes.demonstration import session; "
        "from robomech_ros.rvs.page import recording; "
        "import robomech_ros.nodes.dynamics.node, robomech_ros.nodes.kinematics.node; "
        "import robomech_ros.nodes.trajectory_planner.node; "
        "from robomech_ros.cli.warmup import demonstration_modules, kernel_modules; "
        "others = set(kernel_modules()) - set(demonstration_modules('puma560', '')); "
        "print([one for one in others if f'robomech_ros._kernels.{one}' in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


TRAJECTORY = """
header: {frame_id: ''}
joint_names: [waist, shoulder]
points:
- {positions: [0.0, 0.5], velocities: [0.0, 0.0], accelerations: [0.0, 0.0]}
- positions: [1.0, 0.0]
  velocities: [0.0, 0.0]
  accelerations: [0.0, 0.0]
  time_from_start: {sec: 2, nanosec: 500000000}
"""


@pytest.fixture
def trajectory_file(tmp_path):
    path = tmp_path / "trajectory.yaml"
    path.write_text(TRAJECTORY + "---\n", encoding="utf-8")
    return path


def test_plot_trajectory_draws_a_file_with_and_without_limits(capfd, tmp_path, trajectory_file):
    path = str(tmp_path / "motion.svg")
    code, out, _ = run(capfd, "plot-trajectory", str(trajectory_file), "--output", path)
    assert (code, out) == (0, f"{path}: 2 joints, 2 points, 2.5 s\n")
    plain = Path(path).read_text(encoding="utf-8")
    answer = tmp_path / "answer.yaml"
    indented = TRAJECTORY.replace("\n", "\n  ")
    answer.write_text(f"trajectory:{indented}\nfraction: 1.0\n", encoding="utf-8")
    options = ("--robot", "puma560", "--title", "up and round", "--output", path)
    code, _, _ = run(capfd, "plot-trajectory", str(answer), *options)
    assert code == 0
    limited = Path(path).read_text(encoding="utf-8")
    # Two bounds of two joints for position, velocity, acceleration and jerk.
    assert limited.count("stroke-dasharray") == plain.count("stroke-dasharray") + 16


@pytest.mark.parametrize(
    ("change", "options", "words"),
    [
        (("waist", "knee"), ["--robot", "puma560"], "knee"),
        (("[1.0, 0.0]", "[1.0]"), [], "positions"),
        (("[1.0, 0.0]", "[.nan, 0.0]"), [], "nan"),
        (("points", "dots"), [], "expected a JointTrajectory, or an answer"),
        (("sec: 2", "sec: -2"), [], "time_from_start"),
        (("", ""), ["--output", "motion.doc"], "png, svg or pdf"),
        (("", ""), ["--joint-limits", "limits.yaml"], "expected a robot as well"),
    ],
)
def test_plot_trajectory_refuses_what_it_cannot_draw(
    capfd, tmp_path, trajectory_file, change, options, words
):
    trajectory_file.write_text(TRAJECTORY.replace(*change), encoding="utf-8")
    if "--output" not in options:
        options = [*options, "--output", str(tmp_path / "motion.png")]
    code, _, err = run(capfd, "plot-trajectory", str(trajectory_file), *options)
    assert code == cli.EXIT_USAGE
    assert words in err
    assert not (tmp_path / "motion.png").exists()


def test_plot_trajectory_takes_the_latched_topic(capfd, tmp_path, graph):
    """From the topic that a planner latches; positions alone make two diagrams."""
    message = JointTrajectory(joint_names=["slide"])
    message.points = [
        JointTrajectoryPoint(positions=[float(k)], time_from_start=Duration(sec=k)) for k in (0, 1)
    ]
    publisher = graph.client.create_publisher(JointTrajectory, "planned", LATCHED)
    publisher.publish(message)
    path = str(tmp_path / "latched.png")
    code, out, _ = run(capfd, "plot-trajectory", "--topic", "planned", "--output", path)
    assert (code, out) == (0, f"{path}: 1 joint, 2 points, 1 s\n")
    options = ("--topic", "nobody", "--timeout", "0.3", "--output", path)
    code, _, err = run(capfd, "plot-trajectory", *options)
    assert code == 3 and "nothing came on topic 'nobody' within 0.3 s" in err


def test_what_does_not_apply_is_not_listed(capfd):
    code, _, err = run(capfd, "bringup", "--robot", "three_fingered", "--group", "arm")
    assert code == 2
    listed = err.partition("what applies: ")[2]
    assert "--robot" in listed
    for option in ("--no-servo", "--view", "--joint-limits", "--calibration", "--rate"):
        assert option not in listed


def shown_help(capfd, command):
    with pytest.raises(SystemExit):
        cli.main([command, "--help"])
    return capfd.readouterr().out


def test_help_says_what_options_are_for(capfd):
    text = " ".join(shown_help(capfd, "bringup").split())
    for said in (
        "--group GROUP group whose chain is used (arms only)",
        "--no-servo all nodes but the servo (arms only)",
        "such as MoveIt's joint_limits.yaml (arms only)",
        "friction and effort limits (not for hands, walking machines)",
        "--params-file PARAMS_FILE YAML with parameters --dynamic",
    ):
        assert said in text
    assert "(arms and parallel robots only)" in " ".join(shown_help(capfd, "demo").split())


def test_joints_beyond_their_limits_are_named(capfd, tmp_path):
    picture = f"{tmp_path / 'out.png'}"
    joints = ["0.1", "0.2", "4.5"]
    code, _, err = run(capfd, "plot", "planar3r", "--joints", *joints, "--output", picture)
    warning = "robomech plot: warning: --joints of joint 'joint_3' is 4.5"
    assert err.startswith(warning) and "outside its limits" in err
    assert code in (0, 1)
    with pytest.raises(SystemExit):
        run(capfd, "plot", "planar3r", "--joints", "\uff10", "0", "0")
    assert "invalid number value" in capfd.readouterr().err


@pytest.mark.parametrize("robot", ["ur5e", "gen3"])
def test_an_arm_without_such_a_workspace_is_pointed_to_the_map(capfd, robot):
    code, _, err = run(capfd, "plot-workspace", robot)
    assert code == 2
    assert f"`robomech map --robot {robot}`" in err


@pytest.mark.parametrize("digits", ["0", "18", "four", "\uff14"])
def test_digits_that_are_none(capfd, digits):
    with pytest.raises(SystemExit):
        run(capfd, "call", "service", "--digits", digits)
    assert "expected an integer from 1 to 17" in capfd.readouterr().err


def test_a_service_of_moveit_without_its_types_points_to_what_works(capfd, domain_id):
    code, _, err = run(capfd, "call", "kinematics/compute_ik", "--timeout", "0.1")
    assert code == 3
    assert (
        "needs MoveIt's message types (see `robomech doctor`), kinematics/solve_ik does not" in err
    )
    kind = "no_such_msgs/srv/GetPositionIK"
    code, _, err = run(capfd, "call", "kinematics/compute_ik", "--type", kind)
    assert code == 2 and "kinematics/solve_ik does not" in err
