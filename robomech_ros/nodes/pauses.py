"""Pauses of a coroutine in which its node goes on serving others."""

import threading
import time
from collections.abc import Callable, Generator
from contextlib import suppress

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future

__all__ = ["Turns", "beside", "pause", "wake"]

_STEADY = ClockType.STEADY_TIME
# How often it is looked whether work done beside is over, s.
_LOOK = 0.02
# Others are served after so long at the most, s, and one step of the work.
_TURN = 0.005


async def pause(node: Node, seconds: float) -> None:
    """Let others be served for a while, by the machine's clock: simulated time may stand still."""
    over: Future = Future()
    timer = node.create_timer(
        seconds,
        lambda: over.done() or over.set_result(None),
        clock=Clock(clock_type=_STEADY),
    )
    await over
    node.destroy_timer(timer)


async def beside(node: Node, work: Callable[[], object]) -> None:
    """Do work in a thread of its own while others are served; what it raises is lost."""
    thread = threading.Thread(target=_quietly, args=(work,), daemon=True)
    thread.start()
    while thread.is_alive():
        await pause(node, _LOOK)


def _quietly(work: Callable[[], object]) -> None:
    with suppress(Exception):  # who needs the result asks again and gets the error
        work()


def wake(node: Node) -> None:
    """Let coroutines go on that wait for what a thread other than the executor's has done."""
    if node.executor is not None:
        node.executor.wake()


class _NextTurn:
    """Makes the coroutine that awaits it go on in the executor's next turn."""

    def __await__(self) -> Generator[None, None, None]:
        yield


class Turns:
    """Long work in short turns, between which everybody is served who waits already.

    Parameters
    ----------
    node : Node
        Whose callback does the work.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._began = time.monotonic()

    async def end_if_over(self) -> None:
        """Let others work if the turn was long enough; to be awaited after every step."""
        executor = self._node.executor
        if executor is None or time.monotonic() - self._began <= _TURN:
            return
        # Woken, the executor does not wait for work beyond what there is.
        executor.wake()
        await _NextTurn()
        self._began = time.monotonic()
