"""Pauses of a coroutine while its node serves other requests."""

import math
import queue
import threading
import time
import weakref
from collections.abc import Callable, Generator
from typing import Any, TypeVar

from rclpy.callback_groups import CallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future
from rclpy.timer import Timer

from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.outcomes import Code

_T = TypeVar("_T")

# How long a pause takes, s.
_PAUSE = 0.02
# How long abandoned work may go on at the end, s.
_CLOSE_TIMEOUT = 1.0
# Longest work before other requests are served, s, besides one step of the work.
_TIME_SLICE = 0.005


class _Pauses:
    """All pauses of a node; they end together, since a thousand timers would be too slow."""

    def __init__(self, node: Node) -> None:
        self._over: Future = Future()
        group = ReentrantCallbackGroup()
        self._timer = steady_timer(node, _PAUSE, self._end, group, autostart=False)

    def begin(self) -> Future:
        """Return a future that is done when the pause is over."""
        if self._timer.is_canceled():
            self._timer.reset()
        return self._over

    def _end(self) -> None:
        self._timer.cancel()
        ended, self._over = self._over, Future()
        ended.set_result(None)


_pauses: weakref.WeakKeyDictionary[Node, _Pauses] = weakref.WeakKeyDictionary()


async def pause(node: Node) -> None:
    """Serve other callbacks for up to 20 ms."""
    if node not in _pauses:
        _pauses[node] = _Pauses(node)
    await _pauses[node].begin()


async def ended_within(node: Node, done: Future, seconds: float) -> None:
    """Wait for a future; set its result to None after a timeout by the machine's clock."""
    group = ReentrantCallbackGroup()
    timer = steady_timer(node, seconds, lambda: done.done() or done.set_result(None), group)
    await done
    node.destroy_timer(timer)


def steady_timer(
    node: Node,
    seconds: float,
    callback: Callable[[], object],
    group: CallbackGroup | None = None,
    **options: bool,
) -> Timer:
    """Create a timer by the machine's clock: simulated time may stand still."""
    clock = Clock(clock_type=ClockType.STEADY_TIME)
    return node.create_timer(seconds, callback, group, clock, **options)


def passing_timer(
    node: Node, seconds: float, callback: Callable[[], object], clock: Clock
) -> Timer:
    """Create a timer with a callback group of its own, for nodes that destroy timers.

    The callback group of the node would keep a trace of every destroyed timer
    (https://github.com/ros2/rclpy/issues/1356, open in November 2026; look again in May 2027).
    """
    return node.create_timer(seconds, callback, ReentrantCallbackGroup(), clock)


def wake(node: Node) -> None:
    """Resume coroutines that wait for results of another thread."""
    if node.executor is not None:
        node.executor.wake()


class Worker:
    """Thread for long jobs, one after the other, while the node serves other requests.

    - ``node``: the node whose callbacks hand over the work.
    """

    def __init__(self, node: Node) -> None:
        # The thread may outlive the node until its present work ends.
        self._node = weakref.ref(node)
        self._pieces: queue.SimpleQueue[tuple[Callable[[], Any], Future] | None]
        self._pieces = queue.SimpleQueue()
        self._closed = False
        self._awaited: set[Future] = set()
        self._refusal: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)
        self._thread.start()

    def begin(self, work: Callable[[], _T]) -> Future:
        """Queue work behind all earlier work; returns a future of its result."""
        done: Future = Future()
        self._pieces.put((work, done))
        return done

    async def do(self, work: Callable[[], _T], patience: float = math.inf) -> _T:
        """Return the result of work; raise its exception, or that of `give_up`.

        Work that waits for others for longer than ``patience`` (s) is left undone: TIMED_OUT.
        """
        if self._refusal is not None:
            raise self._refusal
        asked = time.monotonic()

        def in_time() -> _T:
            if (waited := time.monotonic() - asked) > patience:
                text = f"waited {waited:.3g} s for other requests, up to {patience:g} s are allowed"
                raise OutcomeError(Code.TIMED_OUT, f"{text}; ask again later")
            return work()

        done = self.begin(in_time)
        self._awaited.add(done)
        try:
            result: _T = await done
        finally:
            self._awaited.discard(done)
        return result

    def give_up(self, reason: str) -> None:
        """Reject all calls of `do`, with a reason; call it in the executor's thread."""
        refusal = OutcomeError(Code.REJECTED, reason)
        self._closed, self._refusal = True, refusal
        for done in self._awaited:
            if not done.done():
                done.set_exception(refusal)
        node = self._node()
        if node is not None:
            wake(node)

    def close(self) -> None:
        """Stop; work in progress gets a moment to end, and its result is dropped."""
        self._closed = True
        self._pieces.put(None)
        self._thread.join(_CLOSE_TIMEOUT)

    def _run(self) -> None:
        while (piece := self._pieces.get()) is not None and not self._closed:
            work, done = piece
            try:
                result = work()
            except Exception as error:
                self._resume(done.set_exception, error)
            else:
                self._resume(done.set_result, result)

    def _resume(self, set_outcome: Callable[[Any], None], what: object) -> None:
        """Ask the executor to resume the waiting coroutine."""
        node = self._node()
        executor = None if node is None else node.executor
        if executor is None or self._closed:
            return

        def resume() -> None:
            if self._refusal is None:
                set_outcome(what)
            # The executor resumes waiting tasks before new ones, but only after a wake-up.
            executor.wake()

        executor.create_task(resume)


class _NextTurn:
    """Makes the coroutine that awaits it go on in the executor's next turn."""

    def __await__(self) -> Generator[None, None, None]:
        yield


class TimeSlices:
    """Time slices of long work, with waiting requests served in between.

    - ``node``: the node whose callback does the work.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._began = time.monotonic()

    async def end_if_over(self) -> None:
        """Yield to others at the end of a time slice; to be awaited after every step."""
        executor = self._node.executor
        if executor is None or time.monotonic() - self._began <= _TIME_SLICE:
            return
        # After a wake-up, the executor does not block for new work.
        executor.wake()
        await _NextTurn()
        self._began = time.monotonic()
