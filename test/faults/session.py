"""One running suite, the faults that happen to it, and what is seen of them from outside."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from callers import Caller
from faults import Fault
from processes import CONTROLLER, PATIENCE, PUBLISHER, Processes
from rclpy.node import Node
from samples import Jump, Ratios, Samples
from std_srvs.srv import Trigger

from robomech_ros.nodes.middleware.queue_depth import ask

__all__ = ["Finding", "Session", "Work"]

_LOOK = 0.01
# What no process has taken is asked again after so long, s.
_AGAIN = 1.0
# So often work is begun that is over too soon.
_TRIES = 5
# So many states of a new process have reached everybody.
_FEW = 50
# After so long without a state all of an ended process have come, s.
_SILENCE = 0.1


@dataclass(frozen=True)
class Finding:
    """Result of one fault.

    Attributes
    ----------
    node, fault, caller : str
        What happened to whom, and how somebody had asked for the motion or the computation.
    got : tuple of str
        What the caller heard, first and last.
    after : float
        How long after the fault that was, s.
    ratios : Ratios
        How the robot kept its limits from then until the end of the next motion.
    next : str
        What the next motion came to.
    """

    node: str
    fault: str
    caller: str
    got: tuple[str, ...]
    after: float
    ratios: Ratios
    next: str


@dataclass(frozen=True)
class Work:
    """Action during a fault.

    Attributes
    ----------
    caller : Caller
        Who asks for it.
    what : callable
        Makes what is asked for.
    on_the_way : callable
        Says whether it has begun and is not over.
    next : callable
        Has the robot moved afterwards; returns what came of it.
    """

    caller: Caller
    what: Callable[[], Any]
    on_the_way: Callable[[], bool]
    next: Callable[[], str]


class _Ear:
    """Listens for what a caller hears first, from the fault on.

    Parameters
    ----------
    caller : Caller
        What it has heard before does not count.

    Attributes
    ----------
    words : tuple or None
        What it has heard, and how long after the fault, s.
    """

    def __init__(self, caller: Caller) -> None:
        self.words: tuple[str, float] | None = None
        self._caller, self._before = caller, caller.heard()
        self._struck, self._enough = time.monotonic(), threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True)

    def __enter__(self) -> _Ear:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._enough.set()
        self._thread.join()

    @property
    def age(self) -> float:
        """How long ago the fault was, s."""
        return time.monotonic() - self._struck

    def heard(self) -> bool:
        """Whether the caller has heard anything."""
        return self.words is not None

    def _listen(self) -> None:
        while self.words is None and not self._enough.wait(_LOOK):
            text = self._caller.heard()
            if text and text != self._before:
                self.words = text, self.age


class Session:
    """A suite under attack.

    Parameters
    ----------
    node : Node
        The outsider's; somebody spins it.
    processes : Processes
        The suite.
    samples : Samples
        The joint states.
    jump : callable
        Has simulated time jump by so many s, and gives the time before (ns).
    """

    def __init__(
        self, node: Node, processes: Processes, samples: Samples, jump: Callable[[float], int]
    ) -> None:
        self.node, self.processes, self.samples, self._jump = node, processes, samples, jump

    def until(self, condition: Callable[[], Any], what: str) -> None:
        """Wait for a condition; it is named where it does not come."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, f"it never came: {what}"
            time.sleep(_LOOK)

    def call(self, kind: Any, service: str, request: Any, patience: float = PATIENCE) -> Any:
        """Call a service once; None where no answer comes."""
        client = ask(self.node, kind, service)
        done = threading.Event()
        try:
            assert client.wait_for_service(PATIENCE), f"no {service}"
            future = client.call_async(request)
            future.add_done_callback(lambda _: done.set())
            return future.result() if done.wait(patience) else None
        finally:
            self.node.destroy_client(client)

    def until_ready(self, name: str) -> None:
        """Wait until a node says that it serves."""

        def ready() -> bool:
            answer = self.call(Trigger, f"{name}/ready", Trigger.Request(), _AGAIN)
            return answer is not None and bool(answer.success)

        self.until(ready, f"{name} is ready")

    def strike(self, node: str, fault: Fault, work: Work) -> Finding:
        """Have a fault happen to a node in the midst of some work."""
        samples, caller = self.samples, work.caller
        self.until(lambda: samples.stands, "the robot stands")
        first = samples.count - 1
        resets: list[int] = []
        self._begin(work)
        with _Ear(caller) as ear:
            jump = self._happen(node, fault)
            if fault.ends:
                # Nobody says what became of the motion of a killed publisher.
                unheard = node == PUBLISHER and not fault.asked
                if not fault.at_once and not unheard:
                    self.until(ear.heard, f"{caller.name} hears of it")
                known = self._start_again(node, fault)
                if node == CONTROLLER:
                    # The simulated robot begins at home.
                    resets.append(known)
                if unheard:
                    caller.restarted()
                # Of a servo that was soon there again nothing need be heard.
                over = caller.over if caller.endless else ear.heard
                self.until(lambda: ear.heard() or over(), f"{caller.name} hears of it")
                caller.restarted()
            self.until(caller.over, f"{caller.name} hears the end of it")
            last_words, age = caller.over(), ear.age
        caller.end()
        first_words, after = ear.words or (last_words, age)
        came_of_it = work.next()
        self.until(lambda: samples.stands, "the robot stands")
        got = tuple(dict.fromkeys((first_words, last_words)))
        ratios = samples.ratios(first, resets, jump)
        return Finding(node, fault.name, caller.name, got, after, ratios, came_of_it)

    def _begin(self, work: Work) -> None:
        """Have some work begun, anew where it is over before anything can happen to it."""
        for _ in range(_TRIES):
            work.caller.begin(work.what())
            self.until(lambda: work.on_the_way() or work.caller.over(), "the work has begun")
            if work.caller.endless or not work.caller.over():
                return
        raise AssertionError(f"{work.caller.name} is over at once: {work.caller.over()}")

    def _start_again(self, node: str, fault: Fault) -> int:
        """Start a node that has ended; returns which state is the first one of its process."""
        if node == CONTROLLER:
            # The last states of the ended process may still be on their way.
            self.until(lambda: self.samples.silent > _SILENCE, "the last state of a process")
        known = self.samples.count
        if not fault.at_once:
            self.processes.start(node)
        self.until_ready(node)
        if node == CONTROLLER:
            self.until(lambda: self.samples.count > known + _FEW, "the robot is heard of")
        return known

    def _happen(self, node: str, fault: Fault) -> Jump | None:
        """Have it happen; returns the jump of the clock, if it is one."""
        if fault.jump:
            return Jump(self._jump(fault.jump), fault.jump)
        if fault.stop:
            self.processes.hold_up(node, fault.stop)
        elif fault.asked:
            code = self.processes.terminate(node)
            assert code == 0, f"{node} ended with {code} after SIGTERM"
        else:
            self.processes.kill(node)
        if fault.at_once:
            self.processes.start(node)
        return None
