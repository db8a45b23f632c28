"""The tools behind `make setup`: what they keep out, what they choose, what they say."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import sysconfig
import threading
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

import pytest
from ament_index_python import get_package_prefix, get_package_share_directory

ROOT = Path(__file__).resolve().parents[2]
SOURCED = {
    "AMENT_PREFIX_PATH": "/ws/install/a:/opt/ros/jazzy",
    "COLCON_PREFIX_PATH": "/ws/install",
    "CMAKE_PREFIX_PATH": "/opt/ros/jazzy",
    "LD_LIBRARY_PATH": "/opt/ros/jazzy/lib:/usr/local/own/lib:/ws/install/a/lib",
    "PYTHONPATH": "/opt/ros/jazzy/lib/python3.12/site-packages",
    "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
    "ROS_DISTRO": "jazzy",
    "ROS_VERSION": "2",
}


def tool(name: str) -> ModuleType:
    """Import a module of tools/, which is no package."""
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        spec = importlib.util.spec_from_file_location(name, ROOT / "tools" / f"{name}.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(ROOT / "tools"))
    return module


def make(*arguments: str, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Run make at the root of the repository."""
    return subprocess.run(
        ["make", *arguments], cwd=ROOT, env=env, capture_output=True, text=True, check=False
    )


def test_a_sourced_distribution_stays_outside(shell_environment, output_of):
    env = shell_environment(**SOURCED)
    env["PATH"] = f"/opt/ros/jazzy/bin:{env['PATH']}:/opt/roster/bin"
    env["PYTHONDONTWRITEBYTECODE"] = "1"
    seen = dict(
        line.split("=", 1)
        for line in output_of("sh", "tools/run.sh", "OWN=1", "env", env=env).splitlines()
        if "=" in line
    )
    assert {*SOURCED, "PYTHONDONTWRITEBYTECODE"} & set(seen) == {"LD_LIBRARY_PATH"}
    assert seen["LD_LIBRARY_PATH"] == "/usr/local/own/lib"
    assert "/opt/ros/jazzy" not in seen["PATH"]
    assert seen["PATH"].endswith("/opt/roster/bin")
    assert seen["OWN"] == "1"


@pytest.mark.parametrize(
    ("arguments", "variables", "folder"),
    [
        ((), {}, ".venv"),
        (("ROS_DISTRO=jazzy",), {}, ".venv-jazzy"),
        ((), {"ROS_DISTRO": "jazzy"}, ".venv-jazzy"),
        ((), SOURCED, ".venv"),
        (("ROS_DISTRO=jazzy",), SOURCED, ".venv-jazzy"),
    ],
)
def test_the_distribution_is_ours_to_choose(arguments, variables, folder, shell_environment):
    env = shell_environment(**variables)
    for name in {"ROS_DISTRO", *SOURCED} - set(variables):
        env.pop(name, None)
    done = make("--dry-run", "setup", *arguments, env=env)
    assert f"tools/set_up.py {folder} " in done.stdout
    assert ("a ROS distribution is sourced here" in done.stdout) == (variables is SOURCED)


def test_a_distribution_without_wheels_is_refused(shell_environment):
    done = make("setup", "ROS_DISTRO=humble", env=shell_environment())
    assert done.returncode != 0
    assert "ROS_DISTRO=humble" in done.stderr
    assert "colcon" in done.stderr


def test_a_python_that_does_not_fit_is_named_with_the_remedy(shell_environment, tmp_path):
    old = tmp_path / "python3.9"
    old.write_text("#!/bin/sh\necho 'False 3.9.18 /usr/bin/python3.9'\n")
    old.chmod(0o755)
    done = make("setup", f"PYTHON={old}", env=shell_environment())
    assert done.returncode != 0
    assert f"PYTHON={old} cannot be used" in done.stderr
    assert "3.9.18" in done.stderr
    assert "install" in done.stderr


def test_the_python_of_an_environment_is_kept(shell_environment, output_of):
    found = output_of("sh", "tools/find_python.sh", Path(sys.prefix), env=shell_environment())
    assert Path(found.strip()).resolve() == Path(sys.executable).resolve()


def test_what_is_missing_is_named_with_the_command_that_installs_it(monkeypatch, tmp_path):
    machine = tool("machine")
    apt = tmp_path / "apt-get"
    apt.touch(mode=0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setattr(machine.sysconfig, "get_paths", lambda: {"include": str(tmp_path)})
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    headers, compiler = machine.missing()
    assert headers.endswith(f"sudo apt-get install {version}-dev")
    assert compiler.endswith("sudo apt-get install g++")
    monkeypatch.setattr(machine.platform, "machine", lambda: "aarch64")
    assert "x86-64 only" in machine.missing()[0]
    assert "colcon" in machine.missing()[0]


def test_a_repeat_is_quick(shell_environment):
    other = ["ROS_DISTRO=jazzy"] if "jazzy" in Path(sys.prefix).name else ["ROS_DISTRO=kilted"]
    make("setup", *other, env=shell_environment())
    packages = Path(sysconfig.get_path("purelib"))

    def installed():
        return {path: path.stat().st_mtime_ns for path in packages.glob("*.dist-info")}

    before = installed()
    done = make("setup", *other, env=shell_environment())
    assert done.returncode == 0, done.stdout + done.stderr
    assert "is ready" in done.stdout
    assert "once" not in done.stdout, "something was done again"
    assert before and installed() == before


def test_an_interrupted_step_is_done_again(tmp_path):
    env = tool("set_up").Environment(tmp_path / "venv", "", "")
    done = []

    def interrupted() -> None:
        done.append("begun")
        raise KeyboardInterrupt

    env.step("a", "key", lambda: done.append("first"))
    env.step("a", "key", lambda: done.append("not again"))
    with pytest.raises(KeyboardInterrupt):
        env.step("a", "other key", interrupted)
    env.step("a", "key", lambda: done.append("recovered"))
    assert done == ["first", "begun", "recovered"]


def test_wire_types_are_built_after_those_that_they_contain():
    names = [place.name for place in tool("wire_types").packages()]
    assert set(names) == {path.parent.name for path in (ROOT / "compat").glob("*/package.xml")}
    assert names.index("object_recognition_msgs") < names.index("moveit_msgs")


@pytest.mark.parametrize(
    ("package", "real"), [("sensor_msgs", True), ("moveit_msgs", False), ("no_such_msgs", False)]
)
def test_a_package_that_is_there_is_not_replaced(package, real, shell_environment):
    command = [sys.executable, "-c", tool("wire_types").IS_REAL, package]
    done = subprocess.run(command, env=shell_environment(), check=False)
    assert (done.returncode == 0) == real


@pytest.mark.parametrize(
    ("target", "part"), [("setup", False), ("test", False), ("test-fast", False), ("demo", True)]
)
def test_only_the_demonstration_sets_up_a_part(target, part, shell_environment):
    done = make("--dry-run", target, env=shell_environment())
    assert ('--distribution kilted --for-demo "puma560"' in done.stdout) == part
    assert ("--distribution kilted\n" in done.stdout) == (not part)


def test_ros2_run_finds_the_executables(monkeypatch):
    """By the index that `ros2 run` asks, and in the folder where it looks then."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)
    prefix = Path(get_package_prefix("robomech_ros"))
    assert prefix == Path(sys.prefix)
    started = {path.name for path in (prefix / "lib" / "robomech_ros").iterdir() if is_run(path)}
    named = entry_points(group="console_scripts").select(
        module="robomech_ros.nodes.process.entry_points"
    )
    assert started == {"robomech", *(script.name for script in named)}
    share = Path(get_package_share_directory("robomech_ros"))
    assert (share / "package.xml").is_file() and (share / "config" / "servo.yaml").is_file()


def is_run(path: Path) -> bool:
    return path.is_file() and os.access(path, os.X_OK)


def test_a_peer_that_cannot_be_installed_is_left_out(monkeypatch, capsys, tmp_path):
    set_up = tool("set_up")
    environment = set_up.Environment(tmp_path, "", set_up.PEERS)
    tried = []

    def pip(*arguments):
        tried.append(arguments[-1])
        if arguments[-1].startswith("EAIK"):
            raise set_up.SetUpError("no wheel for this Python")

    monkeypatch.setattr(environment, "pip", pip)
    set_up.add_extra(environment)
    listed = (ROOT / "requirements" / set_up.PEERS).read_text(encoding="utf-8").splitlines()
    assert len(tried) == sum("==" in line for line in listed) >= 4
    assert "is left out: no wheel for this Python" in capsys.readouterr().out


@pytest.fixture
def installing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Callable[..., tuple[list[str], ModuleType]]:
    """Fill an environment where no command is run; those that contain a word fail."""
    environment = tool("environment")

    def fill(failing: str, error: str = "SetUpError") -> list[str]:
        ran: list[str] = []
        env = environment.Environment(tmp_path / "venv", "kilted", "")

        def run(*command: str, **_: object) -> None:
            ran.append(" ".join(command).replace(f"{env.folder}/bin/", ""))
            if failing in ran[-1]:
                raise getattr(environment, error)(f"{failing} does not work")

        monkeypatch.setattr(env, "run", run)
        monkeypatch.setattr(env, "pip_settings", lambda: "")
        try:
            env.fill()
        except environment.SetUpError as error:
            ran.append(str(error))
        return ran

    return fill


PINS = ("requirements/ros-kilted.txt", "requirements/python.txt")


def test_uv_installs_the_pins_where_it_can_be_had(installing):
    made, fetched, *rest = installing("nothing")
    assert "-m venv" in made
    assert "pip install" in fetched
    assert fetched.endswith("requirements/installer.txt")
    (command,) = rest
    assert command.startswith("uv pip install")
    assert all(pins in command for pins in PINS)


@pytest.mark.parametrize("failing", ["installer.txt", "uv pip install"])
def test_pip_installs_the_pins_where_uv_cannot(failing, installing, capsys):
    ran = installing(failing)
    # Into an environment that is made anew: what uv left half done is none of it.
    assert "-m venv" in ran[-2]
    assert ran[-1].startswith("python -m pip install")
    assert all(pins in ran[-1] for pins in PINS)
    assert "pip takes its place" in capsys.readouterr().out


def test_an_interrupted_uv_is_not_replaced(installing):
    ran = installing("uv pip install", "SetUpStoppedError")
    assert not any(command.startswith("python -m pip install --quiet --no-deps") for command in ran)
    assert ran[-1] == "uv pip install does not work"


@pytest.mark.parametrize("rights", [0o755, 0o644], ids=["of another machine", "not executable"])
def test_pip_installs_where_uv_does_not_start(rights, tmp_path, monkeypatch, capsys):
    environment = tool("environment")
    env = environment.Environment(tmp_path, "", "")
    env.uv.parent.mkdir()
    env.uv.write_bytes(b"\x7fELF")
    env.uv.chmod(rights)
    installed = []
    monkeypatch.setattr(env, "pip", lambda *arguments: installed.append(arguments))
    env.install("a.whl")
    assert installed == [("a.whl",)]
    assert "does not start" in capsys.readouterr().out


def test_uv_asks_the_index_that_pip_asks(monkeypatch):
    environment = tool("environment")
    for name in ("UV_DEFAULT_INDEX", "SSL_CERT_FILE"):
        monkeypatch.delenv(name, raising=False)
    settings = "global.index-url='https://mirror.example/simple'\nglobal.timeout='9'\n"
    assert environment.index_of_pip("") == {}
    assert environment.index_of_pip(settings) == {
        "UV_DEFAULT_INDEX": "https://mirror.example/simple"
    }
    settings += ":env:.index-url='https://own.example/simple'\n:env:.cert='/own.pem'\n"
    assert environment.index_of_pip(settings) == {
        "UV_DEFAULT_INDEX": "https://own.example/simple",
        "SSL_CERT_FILE": "/own.pem",
    }
    monkeypatch.setenv("UV_DEFAULT_INDEX", "https://of-uv.example/simple")
    assert "UV_DEFAULT_INDEX" not in environment.index_of_pip(settings)


def test_kernels_and_packages_are_made_at_the_same_time(tmp_path):
    set_up = tool("set_up")
    env = set_up.Environment(tmp_path, "kilted", "")
    meeting = threading.Barrier(2)
    set_up.at_once(env, [lambda: meeting.wait(60), lambda: meeting.wait(60)])


def test_a_failure_waits_for_what_is_made_beside_it(tmp_path):
    set_up = tool("set_up")
    env = set_up.Environment(tmp_path, "kilted", "")
    failed, finished = threading.Event(), []

    def fail() -> None:
        failed.set()
        raise set_up.SetUpError("no compiler")

    def finish() -> None:
        assert failed.wait(60)
        finished.append(True)

    with pytest.raises(set_up.SetUpError, match="no compiler"):
        set_up.at_once(env, [fail, finish])
    assert finished


def test_all_failures_of_what_is_made_at_the_same_time_are_said(tmp_path):
    set_up = tool("set_up")
    env = set_up.Environment(tmp_path, "kilted", "")

    def fail(text: str) -> None:
        raise set_up.SetUpError(text)

    with pytest.raises(set_up.SetUpError, match="^no compiler; no disk$"):
        set_up.at_once(env, [lambda: fail("no compiler"), lambda: fail("no disk")])


def test_ctrl_c_ends_the_wait_for_another_set_up(tmp_path, monkeypatch):
    set_up = tool("set_up")
    monkeypatch.setattr(set_up, "ROOT", tmp_path)
    env = set_up.Environment(tmp_path, "kilted", "")
    waiting, ended = threading.Event(), []
    monkeypatch.setattr(set_up, "say", lambda text: waiting.set())

    def interrupt() -> None:
        assert waiting.wait(60)
        raise KeyboardInterrupt

    def wait() -> None:
        try:
            set_up.alone(env, "kernels", "another")
        except set_up.SetUpError as error:
            ended.append(type(error).__name__)

    with set_up.alone(env, "kernels", "another"), pytest.raises(KeyboardInterrupt):
        set_up.at_once(env, [interrupt, wait])
    assert ended == ["SetUpStoppedError"]
    set_up.alone(set_up.Environment(tmp_path, "kilted", ""), "kernels", "another").close()


def test_a_lock_is_taken_as_soon_as_it_is_free(tmp_path, monkeypatch):
    set_up = tool("set_up")
    monkeypatch.setattr(set_up, "ROOT", tmp_path)
    env = set_up.Environment(tmp_path, "kilted", "")
    first = set_up.alone(env, "kernels", "another")
    monkeypatch.setattr(set_up, "say", lambda text: first.close())
    with set_up.alone(env, "kernels", "another") as second:
        assert first.closed
        assert not second.closed


def test_ctrl_c_ends_what_is_made_at_the_same_time(tmp_path):
    set_up = tool("set_up")
    env = set_up.Environment(tmp_path, "kilted", "")
    ended = []

    def interrupt() -> None:
        while not env.running:
            threading.Event().wait(0.01)
        raise KeyboardInterrupt

    def compile_long() -> None:
        try:
            env.run("sleep", "600")
        except set_up.SetUpError as error:
            ended.append(type(error).__name__)

    with pytest.raises(KeyboardInterrupt):
        set_up.at_once(env, [interrupt, compile_long])
    assert ended == ["SetUpStoppedError"]


def test_byte_code_is_made_for_what_nodes_load_and_for_nothing_else():
    byte_code = tool("byte_code")
    found = {byte_code.normal(each.metadata["Name"]): each for each in byte_code.distributions()}
    chosen = {
        byte_code.normal(each.metadata["Name"])
        for each in byte_code.required({"numba", "ros-rclpy", "rich"}, found)
    }
    assert {"numba", "llvmlite", "numpy", "rich", "ros-rclpy", "ros-rcutils"} <= chosen
    assert not chosen & {"pytest", "mypy", "hypothesis", "setuptools"}
