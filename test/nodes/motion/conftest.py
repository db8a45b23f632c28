"""The simulated robot and the trajectory publisher, in this process or in one of their own."""

import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from drivers import Driver, PlatformDriver, Suite
from servo_operator import START, Operator
from simulated_time import SimulatedTime

from robomech_ros.nodes.common import status_report


@pytest.fixture(autouse=True)
def prompt_status(monkeypatch):
    """Let nodes of this process tell how they are more often, so that tests wait less."""
    monkeypatch.setattr(status_report, "PERIOD", 0.1)


@pytest.fixture
def suite(graph):
    """Start a publisher with these parameters, and a simulated PUMA 560."""
    return lambda **parameters: Suite(graph, **parameters)


@pytest.fixture
def drive(graph):
    """Start a simulated robot with these parameters."""
    return lambda **parameters: Driver(graph, graph.start, **parameters)


@pytest.fixture
def arm(drive):
    """A simulated PUMA 560."""
    return drive()


@pytest.fixture
def platform(graph):
    """Start a simulated parallel robot with these parameters."""
    return lambda name, **parameters: PlatformDriver(
        graph, graph.start, robot_description=name, **parameters
    )


@pytest.fixture
def operator(drive, graph):
    """Start a simulated robot, with parameters `arm`, and a servo with the others."""
    started = []

    def start(arm=None, **parameters):
        robot = drive(initial_positions=START, **(arm or {}))
        started.append(Operator(robot, graph, **parameters))
        return started[-1]

    return start


@pytest.fixture
def simulated_time(graph):
    """A clock that runs at twice the speed of time, and jumps."""
    return SimulatedTime(graph.client)


@pytest.fixture
def follower(graph):
    """Start a simulated robot of three joints with these parameters."""
    from follow_cases import Follower

    return lambda **parameters: Follower(graph, graph.start, **parameters)


@pytest.fixture
def process():
    """Start a node as a process of its own; it is gone at the end of the test."""
    started = []

    def start(node, namespace="", **parameters):
        arguments = [f"{name}:={value}" for name, value in parameters.items()]
        command = [sys.executable, "-m", node.__module__, "--ros-args"]
        command += [word for argument in arguments for word in ("-p", argument)]
        started.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True))
        return started[-1]

    yield start
    for child in started:
        child.kill()
        child.communicate()


@pytest.fixture
def drive_process(graph, process):
    """A simulated PUMA 560 in a process of its own: its driver, and the process."""
    started = []
    driver = Driver(graph, lambda *args, **given: started.append(process(*args, **given)))
    return driver, started[0]


@pytest.fixture
def browse():
    """Open pages of nodes; all are closed at the end."""
    from browsers import Browser

    opened = []

    def start(node):
        opened.append(Browser(node))
        return opened[-1]

    yield start
    for one in opened:
        one.close()
