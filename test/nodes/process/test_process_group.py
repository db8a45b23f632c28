"""Child processes: watched together, ended together."""

import os
import signal
import subprocess
import sys

import pytest
from waiting import until

from robomech_ros.nodes.process.entry_points import NODE_MODULES
from robomech_ros.nodes.process.process_group import ProcessGroup, node_command

START_MODULE = "robomech_ros.nodes.process.entry_points"
WAITS = [sys.executable, "-c", "import signal; signal.sigwait({signal.SIGINT})"]
FAILS = [sys.executable, "-c", "raise SystemExit(7)"]
DEAF = [
    sys.executable,
    "-c",
    "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN);"
    "signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM}); print('.', flush=True);"
    "time.sleep(60)",
]


def test_the_first_to_end_is_named_and_the_others_are_stopped():
    group = ProcessGroup({"patient": WAITS, "hasty": FAILS})
    assert group.wait_for_end() == ("hasty", 7)
    assert group.dead() == {"hasty": 7}
    group.stop()
    assert set(group.dead()) == {"patient", "hasty"}


def test_waiting_can_be_interrupted():
    group = ProcessGroup({"patient": WAITS})
    group.interrupt_wait()
    assert group.wait_for_end() is None
    group.stop()


def test_a_signal_before_the_child_can_answer_waits_for_it():
    slow = f"import time; time.sleep(0.5); from {START_MODULE} import main; main(['?'])"
    group = ProcessGroup({"node": [sys.executable, "-c", slow]})
    assert group.stop() == {"node": 0}


# Sends itself a signal when a library is imported that takes its time.
HASTY = """
import os, sys
class Hasty:
    def find_spec(self, name, path=None, target=None):
        if name == {library!r}:
            print("importing", flush=True)
            os.kill(os.getpid(), {number})
sys.meta_path.insert(0, Hasty())
import {module} as entry
sys.argv = ["robomech", "bringup", "--robot", "puma560"]
entry.{function}()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("module", "function", "library"),
    [
        (START_MODULE, "kinematics_node", "numpy"),
        (START_MODULE, "trajectory_planner_node", "rclpy"),
        (START_MODULE, "trajectory_publisher_node", "rclpy"),
        (START_MODULE, "servo_node", "numpy"),
        (START_MODULE, "joint_state_simulator_node", "rclpy"),
        ("robomech_ros.cli.main", "main", "numpy"),
    ],
)
def test_a_signal_during_the_imports_ends_with_0(module, function, library, number):
    program = HASTY.format(module=module, function=function, library=library, number=int(number))
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "importing\n", "")


def test_what_does_not_listen_is_killed(monkeypatch):
    monkeypatch.setattr("robomech_ros.nodes.process.process_group._STOP_SECONDS", 0.2)
    group = ProcessGroup({"deaf": DEAF}, log=subprocess.PIPE)
    # It says a word once it is deaf.
    group.processes["deaf"].stdout.read(1)
    assert group.stop() == {"deaf": -signal.SIGKILL}


HELD = """
import ctypes, os, signal
from rclpy.node import Node
from robomech_ros.nodes.process import run
from robomech_ros.stop_signals import leave_on_signals
leave_on_signals()
run._FAREWELL_SECONDS = 0.5
class Held(Node):
    def __init__(self):
        super().__init__("held")
        os.kill(os.getpid(), signal.SIGINT)
    def stop(self):
        print("stopped", flush=True)
    def destroy_node(self):
        # Not even other threads of the interpreter get a turn while a library hangs.
        ctypes.PyDLL(None).pause()
run.run_node(Held, ["held"])
"""


def test_a_node_that_its_middleware_does_not_let_go_is_ended_and_that_is_told(capfd):
    group = ProcessGroup({"held": [sys.executable, "-c", HELD]}, log=subprocess.PIPE)
    process = group.processes["held"]
    assert process.wait(60.0) == -signal.SIGALRM
    assert process.stdout.read() == b"stopped\n"
    assert group.stop() == {"held": 0}
    assert capfd.readouterr().err == "held: the middleware did not let it go; it was ended\n"


def test_children_die_with_a_parent_that_is_killed():
    program = (
        "import sys, time; from robomech_ros.nodes.process.process_group import ProcessGroup;"
        f" g = ProcessGroup({{'child': {DEAF!r}}}); print(g.processes['child'].pid, flush=True);"
        " time.sleep(60)"
    )
    parent = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    child = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    until(lambda: not _is_alive(child), "the child lives on")
    parent.stdout.close()


def _is_alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


START = [sys.executable, "-m", START_MODULE]


@pytest.mark.parametrize("streams", ["2>&1 >&-", "2>&-", ">&- 2>&-"])
def test_a_node_without_streams_gives_its_exit_code(streams):
    command = f'exec "$@" {streams}'
    done = subprocess.run(
        ["sh", "-c", command, "sh", *START, "trajectory_publisher", "--fast"],
        capture_output=True,
        text=True,
        check=False,
    )
    said = "trajectory_publisher: unknown argument '--fast'; see --help\n"
    # Python's errors go where the other stream does, if there is one.
    assert (done.returncode, done.stdout) == (2, "" if streams == ">&- 2>&-" else said)
    assert done.stderr == ""


def test_help_ends_well_when_its_reader_has_seen_enough():
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [*START, "servo", "--help"], stdout=write, stderr=subprocess.PIPE, check=False
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize("words", [[], ["kinematic"]])
def test_a_node_that_there_is_not_is_refused_with_those_there_are(words):
    done = subprocess.run([*START, *words], capture_output=True, text=True, check=False)
    name = words[0] if words else ""
    said = f"unknown node {name!r}; available: {', '.join(NODE_MODULES)}\n"
    assert (done.returncode, done.stdout, done.stderr) == (2, "", said)


def test_every_node_has_a_command():
    for node in NODE_MODULES:
        assert node_command(node) == [*START, node]
        assert node_command(node, ["-p", "a:=1"]) == [*START, node, "--ros-args", "-p", "a:=1"]
