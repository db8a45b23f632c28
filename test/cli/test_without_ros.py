"""The `robomech` command on a machine where ROS cannot be imported."""

import json
import re
import subprocess
import sys

import pytest

from robomech_ros.cli.main import COMMANDS

# Everything that comes with ROS, as `import` sees it where none of it is installed.
BLOCKED = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        root = name.partition(".")[0]
        if root in ("rclpy", "rcl_interfaces", "rosidl_runtime_py", "ament_index_python") or (
            root.endswith(("_interfaces", "_msgs", "_srvs"))
        ):
            raise ModuleNotFoundError(f"No module named {root!r}", name=root)

sys.meta_path.insert(0, Blocked())
from robomech_ros.cli.main import main
"""
ONE = "\nraise SystemExit(main())"
# The help of every command named, in one process: exit code, output and errors of each.
HELP = """
import contextlib, io, json

found = {}
for command in sys.argv[1:]:
    out, err, code = io.StringIO(), io.StringIO(), None
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main([*command.split(), "--help"])
        except SystemExit as exit:
            code = exit.code
    found[command] = code or 0, out.getvalue(), err.getvalue()
print(json.dumps(found))
"""


def robomech(*arguments, program=ONE):
    command = [sys.executable, "-c", BLOCKED + program, *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.slow
def test_help_needs_no_ros():
    code, out, err = robomech("", *COMMANDS, program=HELP)
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert list(found) == ["", *COMMANDS]
    for command, (code, out, err) in found.items():
        assert (code, err) == (0, ""), command
        assert out.startswith(f"usage: robomech {command}".rstrip())


def test_doctor_names_what_is_missing():
    code, out, _ = robomech("doctor")
    assert code == 1
    assert "MISSING  ROS 2 client library" in out
    assert "No module named 'rclpy'" in out
    assert re.search(r"robots +arms \d+, parallel \d+, rolling 6, walking \d+, hand \d+ in ", out)


@pytest.mark.slow
def test_robots_are_listed():
    code, out, err = robomech("robots")
    assert (code, err) == (0, "")
    assert "puma560" in out


@pytest.mark.parametrize(
    ("arguments", "missing"),
    [(["call", "kinematics/solve_ik"], "rclpy"), (["plot-trajectory"], "trajectory_msgs")],
)
def test_commands_that_need_ros_say_so_in_one_line(arguments, missing):
    code, out, err = robomech(*arguments)
    assert (code, out) == (1, "")
    assert err == (
        f"robomech {arguments[0]}: ROS 2 is needed and cannot be imported "
        f"(No module named '{missing}'); see `robomech doctor`\n"
    )
