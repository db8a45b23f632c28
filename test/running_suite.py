"""The installed suite as processes, in a domain of its own, for programs that work against it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_ros.nodes.middleware.queue_depth import ask
from robomech_ros.nodes.process.discovery_range import stay_on_this_machine
from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.nodes.process.nodes_by_kind import KIND_NODES
from robomech_ros.robots.robot_kinds import kind_of

__all__ = ["NODES", "RunningSuite", "running_suite"]

PATIENCE = 60.0
# Nodes may have to compile their kernels first, beside others that do.
_STARTING = 300.0
# The node that calibrates sensors is among them: it hears poses on topics, which nobody publishes.
NODES = LaunchOptions(calibration=True).nodes
_SAMPLED = {
    "robot_topic": "hand_pose",
    "tracking_topic": "target_pose",
    "tracking_base_frame": "camera",
    "sample_timeout": "0.5",
}
# The last service that the suite offers: the servo computes a while before it serves.
_LAST = "/servo/pause_servo"


class RunningSuite:
    """All nodes of one robot, started by `robomech bringup`.

    Parameters
    ----------
    process : subprocess.Popen
        The command that started them.
    nodes : sequence of str
        Their names.

    Attributes
    ----------
    exit_code : int or None
        Of the command, when the suite has been taken down.
    """

    def __init__(self, process: subprocess.Popen[bytes], nodes: Sequence[str]) -> None:
        self._process, self.nodes = process, nodes
        self.exit_code: int | None = None

    def alive(self) -> bool:
        """Say whether all nodes run: the command ends with the first of them."""
        return self._process.poll() is None

    def processes(self) -> dict[str, int]:
        """Return the process of each node."""
        pid, found = self._process.pid, {}
        for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
            words = Path(f"/proc/{child}/cmdline").read_bytes().decode().split("\0")
            found.update({node: int(child) for node in self.nodes if node in words})
        return found

    def wait_until_ready(self, node: Node) -> None:
        """Wait until every node serves, seen by somebody in the same domain whom nobody spins."""
        deadline = time.monotonic() + _STARTING
        for name in self.nodes:
            client = ask(node, Trigger, f"{name}/ready")
            # What a node offers may be known before its name.
            while not (client.service_is_ready() and name in node.get_node_names()):
                assert self.alive() and time.monotonic() < deadline, f"{name} does not come up"
                time.sleep(0.1)
            answer = client.call_async(Trigger.Request())
            rclpy.spin_until_future_complete(node, answer, timeout_sec=PATIENCE)
            assert answer.done() and answer.result().success, f"{name} does not serve"
            node.destroy_client(client)
        while "servo" in self.nodes and _LAST not in dict(node.get_service_names_and_types()):
            assert self.alive() and time.monotonic() < deadline, f"no {_LAST}"
            time.sleep(0.1)

    def take_down(self) -> None:
        """End all nodes as Ctrl-C does."""
        if self.alive():
            self._process.send_signal(signal.SIGINT)
        self.exit_code = self._process.wait(PATIENCE)


@contextmanager
def running_suite(robot: str, *, log: str = os.devnull) -> Iterator[RunningSuite]:
    """Bring the suite up in a free domain, which this process is put into, and take it down.

    Parameters
    ----------
    robot : str
        As for ``robomech bringup --robot``.
    log : str
        File for what the nodes say.
    """
    stay_on_this_machine()
    command = [str(Path(sys.executable).parent / "robomech"), "bringup", "--robot", robot]
    with (
        free_domain() as domain,
        open(log, "w", encoding="utf-8") as stream,
        TemporaryDirectory() as folder,
    ):
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        nodes, kind = NODES, kind_of(robot)
        if kind in KIND_NODES:
            nodes = LaunchOptions(kind=kind).nodes
        elif kind:
            nodes = LaunchOptions(servo=False).nodes
        else:
            command += ["--calibration", "--ros-args"]
            for name, value in {**_SAMPLED, "folder": folder}.items():
                command += ["-p", f"calibration:{name}:={value}"]
        suite = RunningSuite(subprocess.Popen(command, stdout=stream, stderr=stream), nodes)
        try:
            yield suite
        finally:
            suite.take_down()
