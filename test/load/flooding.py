"""Floods of every topic that nodes listen to, and how the nodes bear them."""

from __future__ import annotations

import multiprocessing
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from caller import AGAIN
from flood import Flood, serve_floods
from memory import Usage
from rclpy.node import Node
from running_suite import NODES, RunningSuite
from std_srvs.srv import Trigger
from valid import ValidMaker

from robomech_interfaces.srv import SolveIK
from robomech_ros.nodes.middleware.queue_depth import ask

__all__ = ["Asker", "Bearing", "Flooding", "flood_all", "flooder", "topics"]

PATIENCE = 60.0
_ACTION = "/_action/"
# Requests for the time without a flood.
_QUIET = 50


class Asker:
    """Calls services of a suite, one at a time, while somebody else spins its node."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._clients: dict[str, Any] = {}
        self._answered: set[str] = set()

    def __call__(self, service: str, kind: Any, request: Any) -> Any:
        """Return the answer; None where none comes."""
        if service not in self._clients:
            self._clients[service] = ask(self._node, kind, service)
            assert self._clients[service].wait_for_service(PATIENCE), f"no {service}"
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            done = threading.Event()
            future = self._clients[service].call_async(request)
            future.add_done_callback(lambda _, done=done: done.set())
            if done.wait(PATIENCE if service in self._answered else AGAIN):
                self._answered.add(service)
                return future.result()
        return None


@dataclass(frozen=True)
class Bearing:
    """How the nodes bore a flood.

    Attributes
    ----------
    sent : int
        Messages.
    times : list of float
        Of SolveIK requests meanwhile (s), one after the other.
    silent : list of str
        Services that did not answer.
    """

    sent: int
    times: list[float]
    silent: list[str]

    def __str__(self) -> str:
        return f"{self.sent} messages; solve_ik {milliseconds(self.times)}"


def milliseconds(times: list[float]) -> str:
    """Return the median and the longest of some times (s) as a text."""
    if not times:
        return "not asked"
    return f"{1e3 * float(np.median(times)):.1f} ms, at most {1e3 * max(times):.0f} ms"


@contextmanager
def flooder(robot: str) -> Iterator[Connection]:
    """Start a process that floods topics, in the domain of this process, and end it."""
    start = multiprocessing.get_context("spawn")
    here, there = start.Pipe()
    process = start.Process(target=serve_floods, args=(there, robot, 0), daemon=True)
    process.start()
    there.close()
    try:
        yield here
        here.send(None)
        process.join()
    finally:
        process.kill()


def topics(node: Node) -> list[tuple[str, str]]:
    """Name all topics that a node of the suite listens to, with their types."""
    found = {
        name: kinds[0]
        for owner in NODES
        for name, kinds in node.get_subscriber_names_and_types_by_node(owner, node.get_namespace())
    }
    return sorted((name, kind) for name, kind in found.items() if _ACTION not in name)


class Flooding:
    """Floods, one after the other.

    Parameters
    ----------
    suite : RunningSuite
        Who is flooded.
    pipe : Connection
        To the process that does it.
    ask : Asker
        Asks the nodes meanwhile.
    maker : ValidMaker
        Makes its requests.
    """

    def __init__(
        self, suite: RunningSuite, pipe: Connection, ask: Asker, maker: ValidMaker
    ) -> None:
        self._suite, self._pipe, self._ask, self._maker = suite, pipe, ask, maker

    def bear(self, flood: Flood) -> Bearing:
        """Ask all nodes whether they serve, and one for solutions, until a flood is over."""
        self._pipe.send(flood)
        times: list[float] = []
        silent = [
            service
            for service in (f"{name}/ready" for name in NODES)
            if self._ask(service, Trigger, Trigger.Request()) is None
        ]
        while not self._pipe.poll() and not silent:
            seconds = self.solve()
            if seconds is None:
                silent.append("kinematics/solve_ik")
            else:
                times.append(seconds)
        return Bearing(self._pipe.recv(), times, silent)

    def solve(self) -> float | None:
        """Solve one pose; gives how long that took (s), None where no answer came."""
        request, began = self._maker.make(SolveIK.Request), time.perf_counter()
        answer = self._ask("kinematics/solve_ik", SolveIK, request)
        return None if answer is None else time.perf_counter() - began

    def memory(self) -> dict[str, float]:
        """Return what each node has allocated (MB)."""
        return {name: Usage.of(pid).own for name, pid in self._suite.processes().items()}


def flood_all(floods: list[Flood], flooding: Flooding, most: float) -> list[str]:
    """Flood topics, print how it was borne, and name faults.

    Parameters
    ----------
    floods : list of Flood
        There are two rounds of them: after the first all queues are as large as they get.
    flooding : Flooding
    most : float
        What a node may have allocated more after the second round than after the first (MB).
    """
    quiet = [time for _ in range(_QUIET) if (time := flooding.solve()) is not None]
    print(f"without a flood: solve_ik {milliseconds(quiet)}")
    faults: list[str] = []
    before: dict[str, float] = {}
    for _ in range(2):
        before = flooding.memory()
        for flood in floods:
            bearing = flooding.bear(flood)
            print(f"{flood.topic}, {flood.way}: {bearing}", flush=True)
            faults += [f"{name} silent, {flood.way} on {flood.topic}" for name in bearing.silent]
    for name, now in flooding.memory().items():
        print(f"{name}: {before[name]:.1f} MB after the first round, {now:.1f} MB after the second")
        if now - before[name] > most:
            faults.append(f"{name} has allocated {now - before[name]:.1f} MB more")
    return faults
