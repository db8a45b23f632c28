"""The nodes of a robot as processes that can be killed, ended, held up and started again."""

from __future__ import annotations

import signal
import time
from typing import IO

from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.nodes.process.process_group import ProcessGroup

__all__ = ["CONTROLLER", "PLANNER", "PUBLISHER", "Processes"]

CONTROLLER = "joint_trajectory_controller"
PLANNER, PUBLISHER = "trajectory_planner", "trajectory_publisher"
PATIENCE = 60.0


class Processes:
    """Nodes, each a process of its own.

    Parameters
    ----------
    options : LaunchOptions
        The robot and the parameters.
    nodes : sequence of str
        Which nodes there are.
    log : file
        What they say.
    """

    def __init__(self, options: LaunchOptions, nodes: tuple[str, ...], log: IO[bytes]) -> None:
        commands = options.commands()
        self._commands = {node: commands[node] for node in nodes}
        self._log = log
        self._groups: dict[str, ProcessGroup] = {}
        for node in nodes:
            self.start(node)

    @property
    def nodes(self) -> tuple[str, ...]:
        """Names of the nodes."""
        return tuple(self._commands)

    def start(self, node: str) -> None:
        """Start a node that does not run."""
        self._groups[node] = ProcessGroup({node: self._commands[node]}, log=self._log)

    def kill(self, node: str) -> None:
        """End a node without warning."""
        process = self._groups[node].processes[node]
        process.kill()
        process.wait(PATIENCE)

    def terminate(self, node: str) -> int:
        """Ask a node to end; returns its exit code."""
        process = self._groups[node].processes[node]
        process.send_signal(signal.SIGTERM)
        return process.wait(PATIENCE)

    def hold_up(self, node: str, seconds: float) -> None:
        """Stop a process for a while."""
        process = self._groups[node].processes[node]
        process.send_signal(signal.SIGSTOP)
        time.sleep(seconds)
        process.send_signal(signal.SIGCONT)

    def dead(self) -> list[str]:
        """Name the nodes that do not run."""
        return [node for node, group in self._groups.items() if group.dead()]

    def close(self) -> None:
        """End all nodes as Ctrl-C does."""
        for group in self._groups.values():
            group.stop()
