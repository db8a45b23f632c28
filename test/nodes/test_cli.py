"""The `robomech` command, in this process."""

import re
import signal
import subprocess
import sys

import pytest
import yaml
from rclpy.node import Node
from std_srvs.srv import SetBool

from robomech_interfaces.srv import Execute
from robomech_ros import __version__
from robomech_ros.nodes import cli
from robomech_ros.nodes.commands.warmup import kernel_modules
from robomech_ros.nodes.kinematics_node import KinematicsNode
from robomech_ros.nodes.process_group import NODE_MODULES, STOP_SIGNALS
from robomech_ros.robots import list_robots


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
    graph.start(KinematicsNode, robot_description="puma560")
    pose = "pose_stamped: {pose: {position: {x: 0.4, z: 0.3}, orientation: {w: 1.0}}}"
    code, out, err = run(capfd, "call", "kinematics/compute_ik", f"{{ik_request: {{{pose}}}}}")
    assert (code, "error" in err) == (0, False)
    assert len(yaml.safe_load(out)["solution"]["joint_state"]["position"]) == 6
    request = "{ik_request: {group_name: legs}}"
    code, _, err = run(capfd, "call", "kinematics/compute_ik", request)
    assert code == 1
    assert "error -15 INVALID_GROUP_NAME: group_name is 'legs'" in err


def test_call_of_a_service_that_says_no(graph, capfd):
    graph.start(Servant)
    code, _, err = run(capfd, "call", "servant/switch")
    assert code == 1
    assert "no success: False" in err


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


def test_call_of_a_service_that_is_not_there_lists_those_that_are(graph, capfd):
    graph.start(Servant)
    code, out, err = run(capfd, "call", "servant/swich", "--timeout", "6")
    assert (code, out) == (3, "")
    assert "'/servant/swich' did not appear (did you mean '/servant/switch'?)" in err
    assert "/servant/execute" in err
    assert "parameters" not in err


@pytest.mark.parametrize("timeout", ["nan", "-1", "0", "inf", "1e9", "soon"])
def test_call_with_a_time_that_is_none(capfd, timeout):
    with pytest.raises(SystemExit) as caught:
        cli.main(["call", "servant/switch", f"--timeout={timeout}"])
    assert caught.value.code == 2
    expected = f"--timeout: '{timeout}', expected a number of seconds above 0 and up to 86400"
    assert expected in capfd.readouterr().err


def test_robots_are_listed_with_joints_and_family(capfd):
    code, out, _ = run(capfd, "robots")
    assert code == 0
    for name in list_robots():
        assert name in out
    assert re.search(r"puma560.*RRRRRR.*decoupled", out)
    assert re.search(r"ur5e.*RRRRRR.*three-parallel", out)
    assert re.search(r"panda.*RRRRRRR.*redundant", out)
    assert re.search(r"stanford.*RRPRRR.*decoupled", out)


def test_warmup_imports_every_kernel_module(capfd):
    code, out, _ = run(capfd, "warmup")
    assert code == 0
    assert {"serial", "inverse_decoupled", "inverse_parallel"} <= set(kernel_modules())
    assert f"{len(kernel_modules())} kernel modules" in out


def test_doctor_finds_nothing_missing_here(capfd, domain_id):
    code, out, _ = run(capfd, "doctor")
    assert code == 0, out
    assert "nothing is missing" in out
    assert f"{domain_id}" in out


def test_doctor_names_what_is_missing_and_the_command(capfd, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "300")
    monkeypatch.setitem(sys.modules, "ruckig", None)
    code, out, _ = run(capfd, "doctor")
    assert code == 1
    assert re.search(r"MISSING +ROS domain +'300'\n +-> export ROS_DOMAIN_ID=", out)
    assert re.search(r"MISSING +ruckig.*\n +-> make setup", out)


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


@pytest.mark.parametrize("module", ["robomech_ros", "robomech_ros.nodes.cli"])
def test_import_pulls_in_neither_ros_nor_numba(module):
    code = (
        f"import sys, {module}; "
        "print([m for m in ('rclpy', 'numba', 'scipy', 'matplotlib', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("node", NODE_MODULES)
def test_nodes_import_no_heavy_library(node):
    code = (
        f"import sys, {NODE_MODULES[node]}; "
        "heavy = ('scipy.optimize', 'scipy.spatial', 'scipy.interpolate', 'matplotlib', 'rich');"
        "print([m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
