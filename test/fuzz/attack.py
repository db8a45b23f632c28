"""Random requests, goals, messages and bytes to all nodes of a running suite."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from findings import code_of, fault_of
from messages import MessageMaker
from probes import LONGEST, Probes, ProgressExecutor
from raw_writer import RawWriter
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.action import get_action_server_names_and_types_by_node
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rclpy.task import Future
from robot_watch import STRANGER, Resets

from robomech_ros.nodes.commands.message_yaml import interface_class
from robomech_ros.nodes.middleware.queue_depth import ask, ask_action

__all__ = ["ODDS", "WITH_FAULTS", "Attack", "Outcome"]

WINDOW = 100
# When nothing at all has been answered for so long, what is missing does not come, s.
PATIENCE = 60.0
# Services that every node has from rclpy, and topics that all nodes share.
_PLUMBING = ("parameter", "type_description", "/_action/")
_STATES = "/joint_states"
_SHARED = ("/parameter_events", "/rosout", "/clock", _STATES)
# Where bytes of joint states begin behind which they may be flipped: time and frame stay.
_MARKED = 32
# Services of this name put the robot home.
_RESET = "/reset"
# Those who want latched messages hear no others; all others hear these, too.
_LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
ODDS = {"request": 0.8, "message": 0.12, "bytes": 0.05, "goal": 0.03}
WITH_FAULTS = {**ODDS, "request": 0.78, "fault": 0.02}
# Faults of the simulated robot, and how bad they may be.
_SIMULATED = "joint_trajectory_controller"
_FAULTS = {"fault_noise": 0.5, "fault_dropped_commands": 1.0, "fault_delay": 0.5}


@dataclass
class Outcome:
    """Result of an attack.

    Attributes
    ----------
    codes : mapping of str to Counter
        Of each service and action how often each code was answered.
    faults : list of str
        What no answer may be.
    unanswered : Counter
        Requests without an answer, by service.
    messages : int
        Sent to topics.
    raw : int
        Byte strings sent that are no message.
    """

    codes: dict[str, Counter[int]] = field(default_factory=lambda: defaultdict(Counter))
    faults: list[str] = field(default_factory=list)
    unanswered: Counter[str] = field(default_factory=Counter)
    messages: int = 0
    raw: int = 0

    @property
    def answered(self) -> int:
        """How many requests and goals were answered."""
        return sum(counts.total() for counts in self.codes.values())


class Attack:
    """Sends random things to some nodes, a window of requests at a time.

    Parameters
    ----------
    node : Node
        The attacker.
    names : sequence of str
        The nodes that are attacked.
    maker : MessageMaker
    rng : numpy.random.Generator
    alive : callable
        Says whether the nodes still run.
    odds : mapping, optional
        How often what is sent.

    Attributes
    ----------
    outcome : Outcome
    resets : Resets
        When the attack may have put the robot home.
    """

    def __init__(
        self,
        node: Node,
        names: list[str],
        maker: MessageMaker,
        rng: np.random.Generator,
        alive: Callable[[], bool],
        odds: Mapping[str, float] = ODDS,
    ) -> None:
        self.outcome, self.resets, self._odds = Outcome(), Resets(), dict(odds)
        self._node, self._maker, self._rng, self._alive = node, maker, rng, alive
        self._executor = ProgressExecutor(node.context)
        self._executor.add_node(node)
        # Each with whose it is, and what takes it.
        self._waiting: dict[Future, tuple[str, Callable[[Any], None]]] = {}
        self._probes = Probes(node, names)
        self._find(names)
        self._parameters = None
        if _SIMULATED in names:
            self._parameters = ask(node, SetParameters, f"{_SIMULATED}/set_parameters")

    def _find(self, names: list[str]) -> None:
        node, own = self._node, self._node.get_namespace()
        self._services, self._raw, self._topics, self._actions = [], [], [], []
        taken = [dict(node.get_subscriber_names_and_types_by_node(name, own)) for name in names]
        for name, topics in zip(names, taken, strict=True):
            for service, kinds in node.get_service_names_and_types_by_node(name, own):
                if not any(part in service for part in _PLUMBING):
                    kind = interface_class(kinds[0])
                    self._services.append((service, kinds[0], kind, ask(node, kind, service)))
                    self._raw.append(RawWriter(node, kind, service))
            for action, kinds in get_action_server_names_and_types_by_node(node, name, own):
                kind = interface_class(kinds[0])
                client = ask_action(node, kind, action)
                assert client.wait_for_server(PATIENCE), f"no {action}"
                self._actions.append((action, kinds[0], kind, client))
            for topic, kinds in topics.items():
                if topic not in _SHARED and "/_action/" not in topic:
                    kind = interface_class(kinds[0])
                    publisher = node.create_publisher(kind, topic, _LATCHED)
                    self._topics.append((kind, publisher))
        states = interface_class("sensor_msgs/msg/JointState")
        self._states = states, node.create_publisher(states, "joint_states", 10)
        self._heeded = any(_STATES in topics for topics in taken)

    def run(self, count: int) -> None:
        """Send so many things, and wait for all answers."""
        ways = dict(zip(WITH_FAULTS, self._ways(), strict=True))
        for way in self._rng.choice(list(self._odds), count, p=list(self._odds.values())):
            ways[str(way)]()
            self._executor.spin_once(0.0)
            while len(self._waiting) > WINDOW:
                self._listen()
            if not self._alive():
                self.outcome.faults.append("a node has ended")
                return
        self.settle()

    def _ways(self) -> Iterator[Callable[[], None]]:
        yield from (self._request, self._message, self._bytes, self._goal, self._fault)

    @property
    def topics(self) -> list[tuple[Any, Any]]:
        """Types of the topics that the nodes listen to, each with its publisher."""
        return self._topics

    def settle(self) -> None:
        """End all motions, and wait until nothing is unanswered."""
        self._probes.restart()
        while self._waiting:
            for service, _, kind, client in self._services:
                if service.endswith(("/cancel", "/hold", "/resume")):
                    client.call_async(kind.Request())
            until = self._executor.progress + 1.0
            while self._waiting and self._executor.progress < until:
                self._listen()

    def call(self, service: str, kind: Any, request: Any) -> Any:
        """Call one service and give its answer; None where none comes."""
        client = ask(self._node, kind, service)
        future = client.call_async(request)
        self.wait_for(future)
        self._node.destroy_client(client)
        return future.result()

    def wait_for(self, future: Future) -> None:
        """Go on until an answer is there, or for as long as one may take."""
        self._probes.restart()
        while not (future.done() or self._probes.over(PATIENCE)):
            self._wait()

    def spin_once(self, seconds: float) -> None:
        """Wait for one event, for so long at the most."""
        self._executor.spin_once(seconds)

    def _wait(self) -> None:
        # Always for the same time: with another one the executor begins its pass anew.
        before = self._executor.progress
        self._executor.spin_once(LONGEST)
        if self._executor.progress > before:
            self._probes.count(self._executor.progress - before)

    def _listen(self) -> None:
        """Wait for an answer, and give up all that are missing when none comes."""
        self._wait()
        if self._probes.over(PATIENCE):
            silent = ", ".join(self._probes.silent(PATIENCE)) or "no node"
            self.outcome.faults.append(f"answers are missing; {silent} ignored a probe, too")
            self.outcome.unanswered.update(service for service, _ in self._waiting.values())
            self._waiting.clear()
            self._probes.restart()

    def _await(self, future: Future, name: str, take: Callable[[Any], None]) -> None:
        if len(self._waiting) <= 1:
            self._probes.restart()
        self._waiting[future] = name, take
        future.add_done_callback(self._came)

    def _came(self, future: Future) -> None:
        if future in self._waiting:
            _, take = self._waiting.pop(future)
            self._probes.restart()
            take(future.result())

    def _note(self, name: str, kind: str, answer: Any) -> None:
        """Count what a request or a goal came to."""
        self.outcome.codes[name][code_of(answer)] += 1
        fault = fault_of(answer, kind)
        if fault:
            self.outcome.faults.append(f"{name}: {fault}")

    def _pick(self, entries: list[Any]) -> Any:
        return entries[int(self._rng.integers(len(entries)))]

    def _request(self) -> None:
        entry = self._pick(self._services)
        self._ask(entry, self._begin_reset(entry[0]))

    def _begin_reset(self, service: str) -> Callable[[], None]:
        """Begin a reset, if a service is one; the function that is returned ends it."""
        return self.resets.begin() if service.endswith(_RESET) else lambda: None

    def _ask(self, entry: Any, end_reset: Callable[[], None]) -> None:
        service, name, kind, client = entry

        def take(answer: Any) -> None:
            end_reset()
            self._note(service, name, answer)

        self._await(client.call_async(self._maker.make(kind.Request)), service, take)

    def _goal(self) -> None:
        if not self._actions:
            return
        action, name, kind, client = self._pick(self._actions)
        cancelled = self._rng.random() < 0.5

        def end(answer: Any) -> None:
            self._note(action, name, answer.result)

        def go_on(handle: Any) -> None:
            if not handle.accepted:
                self.outcome.codes[action][-1] += 1
                return
            self._await(handle.get_result_async(), f"{action}: result", end)
            if cancelled:
                self._await(handle.cancel_goal_async(), f"{action}: cancellation", lambda _: None)

        self._await(client.send_goal_async(self._maker.make(kind.Goal)), f"{action}: goal", go_on)

    def mend(self) -> None:
        """End all faults of the simulated robot."""
        for name in _FAULTS:
            self._set_fault(name, 0.0)
        self.settle()

    def _fault(self) -> None:
        """Give the simulated robot a fault, or end it."""
        name = str(self._rng.choice(list(_FAULTS)))
        self._set_fault(name, float(self._rng.choice([0.0, 1e-4, self._rng.uniform(), 1.0])))

    def _set_fault(self, name: str, part: float) -> None:
        if self._parameters is not None:
            value = ParameterValue(type=3, double_value=part * _FAULTS[name])
            parameters = [Parameter(name=name, value=value)]
            answer = self._parameters.call_async(SetParameters.Request(parameters=parameters))
            self._await(answer, f"{_SIMULATED}/set_parameters", lambda _: None)

    def _message(self) -> None:
        if not self._topics:
            return
        kind, publisher = self._pick(self._topics)
        publisher.publish(self._maker.make(kind))
        self.outcome.messages += 1

    def _bytes(self) -> None:
        """Send a message cut, with flipped bits, or random numbers.

        None announces millions of entries: nodes are not guarded against these.
        """
        others, asked = [*self._topics, *[self._states] * self._heeded], None
        if not others or self._rng.random() < 0.5:
            k = int(self._rng.integers(len(self._services)))
            asked = self._services[k]
            write, kind = self._raw[k].write, asked[2].Request
        else:
            kind, publisher = self._pick(others)
            write = partial(_published, publisher)
        message, first = self._maker.make(kind), 4
        if kind is self._states[0]:
            message.header.frame_id, first = STRANGER, _MARKED
        data = bytearray(serialize_message(message))
        way = self._rng.integers(3)
        if way == 0:
            del data[int(self._rng.integers(len(data) + 1)) :]
        elif way == 1:
            for place in self._rng.integers(first, max(first + 1, len(data)), 8):
                at = min(place, len(data) - 1)
                # The high bytes of a count are zero, and stay so.
                data[at] ^= int(self._rng.integers(1, 256)) if data[at] else 0
        else:
            numbers = self._rng.integers(256, size=int(self._rng.integers(50)), dtype=np.uint32)
            data[4:] = numbers.tobytes()
        end_reset = self._begin_reset(asked[0] if asked else "")
        self.outcome.raw += write(bytes(data))
        if asked and asked[0].endswith(_RESET):
            # Bytes get no answer, and this request comes behind them.
            self._ask(asked, end_reset)


def _published(publisher: Any, data: bytes) -> bool:
    """Publish bytes; says whether the middleware sends such bytes."""
    try:
        publisher.publish(data)
    except rclpy_implementation.RCLError:
        return False
    return True
