"""Running the installed suite from outside: other processes, other environments, no shortcuts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml

sys.path.insert(0, str(Path(__file__).parent))

ROOT = Path(__file__).resolve().parents[2]

# What the wheels' start-up, colcon and an active environment leave in the environment.
_OF_THIS_ENVIRONMENT = (
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
    "AMENT_PREFIX_PATH",
    "CMAKE_PREFIX_PATH",
    "COLCON_PREFIX_PATH",
    "LD_LIBRARY_PATH",
    "PYTHONPATH",
    "VIRTUAL_ENV",
)
# Long, since a machine may be busy; nothing waits longer than it has to.
PATIENCE = 60.0


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark everything in this folder, so that the quick loop can leave it out."""
    here = Path(__file__).parent
    for item in items:
        if here in item.path.parents:
            item.add_marker(pytest.mark.installed)


class Installed:
    """An installation of the suite: the folder of its executables and the environment they need."""

    def __init__(self, executables: Path, environment: Mapping[str, str]) -> None:
        self.executables = executables
        self.environment = dict(environment)

    def run(
        self, name: str, *arguments: str, timeout: float = PATIENCE
    ) -> subprocess.CompletedProcess[str]:
        """Run an executable to its end, whatever its exit code."""
        return subprocess.run(
            [str(self.executables / name), *arguments],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    def call(self, service: str, request: Any) -> dict[str, Any]:
        """Call a service through `robomech call` and return the fields of its answer."""
        text = yaml.safe_dump(request, default_flow_style=True, width=1_000_000)
        options = ("--timeout", str(PATIENCE), "--full", "--digits", "17")
        done = self.run("robomech", "call", service, text, *options, timeout=2 * PATIENCE)
        assert done.returncode in (0, 1), f"robomech call {service}: {done.stderr}"
        return yaml.safe_load(done.stdout)

    @contextmanager
    def node(self, name: str, *ros_arguments: str) -> Iterator[subprocess.Popen[str]]:
        """Run a node as a process, and require that it ends cleanly when asked to."""
        arguments = ["--ros-args", *ros_arguments] if ros_arguments else []
        process = subprocess.Popen(
            [str(self.executables / name), *arguments], env=self.environment, text=True
        )
        try:
            yield process
            assert process.poll() is None, f"{name} ended by itself with {process.returncode}"
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0, f"{name} ended with {process.returncode}"
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()


def clean_environment(**more: str) -> dict[str, str]:
    """Return the environment of the shell that started the tests, with what is given on top."""
    kept = {name: value for name, value in os.environ.items() if name not in _OF_THIS_ENVIRONMENT}
    return {**kept, **more}


@pytest.fixture
def network(domain_id: int) -> dict[str, str]:
    """Return the variables that place a process in the test's own corner of the network."""
    return {"ROS_DOMAIN_ID": str(domain_id)}


@pytest.fixture
def domain_id() -> Iterator[int]:
    """Give a test a ROS domain that nobody else on this machine uses."""
    from robomech_ros.nodes.process.free_domain import free_domain

    with free_domain() as number:
        yield number


@pytest.fixture
def suite(network: Mapping[str, str]) -> Installed:
    """The suite as installed in the environment that the tests run in."""
    return Installed(Path(sys.prefix) / "bin", clean_environment(**network))


@pytest.fixture
def other_suite(network: Mapping[str, str]) -> Installed:
    """The suite in the environment of the other ROS distribution."""
    this = Path(sys.prefix).name
    distribution, folder = ("kilted", ".venv") if "jazzy" in this else ("jazzy", ".venv-jazzy")
    place = ROOT / folder / "bin"
    if not (place / "robomech").exists():
        pytest.fail(f"{folder} is missing; `make setup ROS_DISTRO={distribution}` makes it")
    middleware = "FASTDDS" if distribution == "kilted" else "FASTRTPS"
    profile = {f"{middleware}_DEFAULT_PROFILES_FILE": str(ROOT / "test" / "data" / "loopback.xml")}
    return Installed(place, clean_environment(**network, **profile))


@pytest.fixture(scope="session")
def installed_at() -> type[Installed]:
    """Return the installation whose executables lie in a folder."""
    return Installed


@pytest.fixture(scope="session")
def shell_environment() -> Callable[..., dict[str, str]]:
    """Return the environment of the shell that started the tests, with what is asked for on top."""
    return clean_environment


@pytest.fixture(scope="session")
def output_of() -> Callable[..., str]:
    """Run commands that must succeed."""

    def run(*command: str | Path, env: Mapping[str, str], cwd: Path = ROOT) -> str:
        done = subprocess.run(
            [str(part) for part in command],
            cwd=cwd,
            env=dict(env),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}"
        return done.stdout

    return run


@pytest.fixture(scope="session")
def repository() -> Path:
    """Name the folder of the repository."""
    return ROOT


@pytest.fixture
def outsider(domain_id: int) -> Iterator[Any]:
    """Yield somebody on the network, where ROS is."""
    from outsider import Outsider

    result = Outsider(domain_id)
    yield result
    result.close()


@contextmanager
def brought_up(
    suite: Installed, *arguments: str, end: signal.Signals = signal.SIGINT
) -> Iterator[subprocess.Popen[bytes]]:
    """Start `robomech bringup`, and require exit code 0 when it is told to end."""
    process = subprocess.Popen(
        [str(suite.executables / "robomech"), "bringup", *arguments], env=suite.environment
    )
    try:
        yield process
        assert process.poll() is None, f"bringup ended by itself with {process.returncode}"
        process.send_signal(end)
        assert process.wait(PATIENCE) == 0
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


@pytest.fixture
def bringup(suite: Installed) -> Callable[..., Any]:
    """Start `robomech bringup`, and require exit code 0 when it is told to end."""
    return partial(brought_up, suite)


class Running(NamedTuple):
    """A robot that is brought up: its suite, and somebody on its network."""

    suite: Installed
    outsider: Any


@pytest.fixture(scope="module")
def shared_bringup() -> Iterator[Callable[..., Running]]:
    """Bring a robot up for all tests of a module."""
    from outsider import Outsider

    from robomech_ros.nodes.process.free_domain import free_domain

    with ExitStack() as stack:

        def start(*arguments: str) -> Running:
            number = stack.enter_context(free_domain())
            environment = clean_environment(ROS_DOMAIN_ID=str(number))
            suite = Installed(Path(sys.prefix) / "bin", environment)
            outsider = Outsider(number)
            stack.callback(outsider.close)
            stack.enter_context(brought_up(suite, *arguments))
            return Running(suite, outsider)

        yield start
