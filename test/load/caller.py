"""A client process: many calls of one service, or goals of one action, at once."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
import rclpy
from findings import code_of, fault_of
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from valid import ValidMaker

from robomech_ros.nodes.commands.message_yaml import interface_class
from robomech_ros.nodes.middleware.queue_depth import ask, ask_action
from robomech_ros.robots import load_robot

__all__ = ["AGAIN", "Burst", "Task", "serve_tasks"]

# Without any answer for so long, those that are missing do not come: others are answered first, s.
PATIENCE = 600.0
# The first answer to a new client may be lost, see doc/interfaces.md: then it asks again, s.
AGAIN = 5.0


@dataclass(frozen=True)
class Task:
    """Calls that a client must make.

    Attributes
    ----------
    name, kind : str
        Service or action, and its interface, such as ``robomech_interfaces/srv/SolveIK``.
    count : int
        How many calls or goals.
    """

    name: str
    kind: str
    count: int


@dataclass
class Burst:
    """Result of concurrent calls.

    Attributes
    ----------
    sent, answered : int
        Calls; of an action goals, asked results and cancellations.
    codes : Counter
        How often each code was answered.
    faults : set of str
        What no answer may be.
    seconds : float
        From the first call to the last answer.
    """

    sent: int = 0
    answered: int = 0
    codes: Counter[int] = field(default_factory=Counter)
    faults: set[str] = field(default_factory=set)
    seconds: float = 0.0

    def add(self, other: Burst) -> None:
        """Add what came of another client's calls at the same time."""
        self.sent += other.sent
        self.answered += other.answered
        self.codes += other.codes
        self.faults |= other.faults
        self.seconds = max(self.seconds, other.seconds)


def serve_tasks(pipe: Connection, robot: str, seed: int) -> None:
    """Do tasks that come by a pipe: get ready, say so, begin when told, and send the burst back."""
    rclpy.init(args=[])
    node = Node(f"caller_{seed}", start_parameter_services=False)
    caller = Caller(node, ValidMaker(load_robot(robot), np.random.default_rng(seed)))
    while (task := pipe.recv()) is not None:
        begin = caller.prepared(task)
        pipe.send("ready")
        pipe.recv()
        pipe.send(begin())
    node.destroy_node()
    rclpy.try_shutdown()


class Caller:
    """Sends many calls at once and waits for all answers.

    Parameters
    ----------
    node : Node
        Who calls.
    maker : ValidMaker
        Makes the requests.
    """

    def __init__(self, node: Node, maker: ValidMaker) -> None:
        self._node, self._maker = node, maker
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)
        self._burst, self._kind, self._last = Burst(), "", 0.0

    def prepared(self, task: Task) -> Callable[[], Burst]:
        """Make the requests of a task; gives what sends them."""
        kind = interface_class(task.kind)
        self._kind = task.kind
        if "/action/" in task.kind:
            goals = [self._maker.make(kind.Goal) for _ in range(task.count)]
            action = ask_action(self._node, kind, task.name)
            assert action.wait_for_server(PATIENCE), f"no {task.name}"
            handle = self._first(lambda: action.send_goal_async(kind.Goal()))
            if handle.accepted:
                self._first(handle.get_result_async)
                self._first(handle.cancel_goal_async)
            return lambda: self._put_goals(action, goals)
        requests = [self._maker.make(kind.Request) for _ in range(task.count)]
        client = ask(self._node, kind, task.name)
        assert client.wait_for_service(PATIENCE), f"no {task.name}"
        self._first(lambda: client.call_async(requests[0]))
        return lambda: self._call(client, requests)

    def _first(self, call: Callable[[], Future]) -> Any:
        """Return the first answer that comes."""
        calls = [call()]
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            self._executor.spin_until_future_complete(calls[-1], AGAIN)
            answered = [future for future in calls if future.done()]
            if answered:
                return answered[0].result()
            calls.append(call())
        raise AssertionError("no answer at all")

    def _call(self, client: Client, requests: list[Any]) -> Burst:
        began = self._begin()
        for request in requests:
            self._await(client.call_async(request), self._note)
        burst = self._end(began)
        self._node.destroy_client(client)
        return burst

    def _put_goals(self, client: ActionClient, goals: list[Any]) -> Burst:
        """Put goals, ask for all results, and cancel every other goal."""
        began = self._begin()
        for number, goal in enumerate(goals):
            cancelled = bool(number % 2)
            future = client.send_goal_async(goal)
            self._await(future, lambda handle, cancelled=cancelled: self._go_on(handle, cancelled))
        burst = self._end(began)
        client.destroy()
        return burst

    def _go_on(self, handle: Any, cancelled: bool) -> None:
        if not handle.accepted:
            self._burst.codes[-1] += 1
            return
        self._await(handle.get_result_async(), lambda answer: self._note(answer.result))
        if cancelled:
            self._await(handle.cancel_goal_async(), lambda answer: None)

    def _begin(self) -> float:
        self._burst, self._last = Burst(), time.monotonic()
        return self._last

    def _end(self, began: float) -> Burst:
        """Wait for all answers, for as long as there are some."""
        burst = self._burst
        while burst.answered < burst.sent and time.monotonic() - self._last < PATIENCE:
            self._executor.spin_once(0.1)
        burst.seconds = self._last - began
        return burst

    def _await(self, future: Future, take: Callable[[Any], None]) -> None:
        self._burst.sent += 1

        def came(done: Future) -> None:
            self._burst.answered += 1
            self._last = time.monotonic()
            take(done.result())

        future.add_done_callback(came)

    def _note(self, answer: Any) -> None:
        self._burst.codes[code_of(answer)] += 1
        if fault := fault_of(answer, self._kind):
            self._burst.faults.add(fault)
