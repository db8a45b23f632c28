"""A plain `colcon build` in a scratch workspace, and a node started from its install space."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

# Whichever test is the first waits until the workspace is built.
pytestmark = pytest.mark.timeout(1200)

NODES = {
    "calibration_node",
    "dynamics_node",
    "grasping_node",
    "joint_state_simulator_node",
    "kinematics_node",
    "mobile_base_node",
    "move_group_node",
    "robomech",
    "rvs_node",
    "servo_node",
    "trajectory_planner_node",
    "trajectory_publisher_node",
    "walker_node",
}
NOT_SOURCE = shutil.ignore_patterns(
    ".git", ".venv*", "build", "install", "log", "output", "__pycache__", ".*_cache", "*.egg-info"
)


@dataclass(frozen=True)
class Workspace:
    """A workspace after `colcon build`, and the environment after its setup.bash."""

    source: Path
    install: Path
    environment: Mapping[str, str]


def sourced(setup: Path, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a shell that has sourced a file."""
    script = f'. "{setup}" && env -0'
    done = subprocess.run(
        ["bash", "-c", script], env=dict(environment), capture_output=True, text=True, check=True
    )
    pairs = (entry.split("=", 1) for entry in done.stdout.split("\0") if "=" in entry)
    return {name: value for name, value in pairs if not name.startswith("BASH_FUNC")}


@pytest.fixture(scope="module")
def workspace(
    tmp_path_factory: pytest.TempPathFactory,
    repository: Path,
    shell_environment: Callable[..., dict[str, str]],
    output_of: Callable[..., str],
) -> Workspace:
    """Copy the sources, build them with the command that README.md gives, source the result."""
    if " " in sys.prefix:
        pytest.skip("colcon's setup.bash and scripts do not work with a space in Python's path")
    source = tmp_path_factory.mktemp("workspace") / "robomech_ros"
    shutil.copytree(repository, source, ignore=NOT_SOURCE)
    wheels = shell_environment(AMENT_PREFIX_PATH=sys.prefix, CMAKE_PREFIX_PATH=sys.prefix)
    wheels["PATH"] = f"{sys.prefix}/bin{os.pathsep}{wheels['PATH']}"
    output_of("colcon", "build", env=wheels, cwd=source)
    return Workspace(source, source / "install", sourced(source / "install/setup.bash", wheels))


def test_a_plain_build_finds_both_packages(workspace):
    packages = {path.parent.name for path in workspace.install.glob("*/share")}
    assert packages == {"robomech_ros", "robomech_interfaces"}


def test_what_is_imported_is_what_was_built(workspace, output_of, tmp_path):
    code = (
        "import robomech_ros, robomech_interfaces.srv\n"
        "from robomech_ros.hands import list_hands\n"
        "from robomech_ros.parallel import list_parallel\n"
        "from robomech_ros.rolling import list_rolling\n"
        "from robomech_ros.robots import list_robots, robot_folders\n"
        "from robomech_ros.walking import list_legged\n"
        "from ament_index_python.packages import get_package_share_directory as share\n"
        "print(robomech_ros.__file__, robomech_interfaces.__file__, share('robomech_ros'))\n"
        "print('robots', *list_robots(), *list_parallel(), *list_rolling())\n"
        "print(*list_hands(), *list_legged())"
    )
    env = workspace.environment
    places, *robots = output_of("python", "-c", code, env=env, cwd=tmp_path).splitlines()
    assert all(Path(place).is_relative_to(workspace.install) for place in places.split()), places
    folder = workspace.source / "config" / "robots"
    in_source = {path.stem for path in folder.rglob("*") if path.is_file()}
    assert "hexapod" in in_source
    assert in_source <= set(" ".join(robots).split())


def test_executables_are_where_ros2_run_looks(workspace):
    folder = workspace.install / "robomech_ros" / "lib" / "robomech_ros"
    assert {path.name for path in folder.iterdir() if os.access(path, os.X_OK)} == NODES


def test_a_node_from_the_install_space_answers(workspace, installed_at, network):
    folder = workspace.install / "robomech_ros" / "lib" / "robomech_ros"
    suite = installed_at(folder, {**workspace.environment, **network})
    warm = suite.run("robomech", "warmup", timeout=280)
    assert warm.returncode == 0, warm.stderr
    with suite.node("kinematics_node", "-p", "robot_description:=puma560"):
        q = [0.3, 0.5, -1.1, 0.4, 0.6, -0.2]
        pose = suite.call("kinematics/solve_fk", {"states": [{"position": q}]})["poses"][0]
        answer = suite.call("kinematics/solve_ik", {"target": pose, "seed": {"position": q}})
    assert answer["error_code"] == 0, answer["error_msg"]
    assert answer["solutions"][0]["positions"] == pytest.approx(q, abs=1e-9)
