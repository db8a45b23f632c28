"""Pauses of a coroutine in which its node goes on serving others."""

from collections.abc import Generator

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future

__all__ = ["give_way", "pause"]

_STEADY = ClockType.STEADY_TIME


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


class _NextTurn:
    """Makes the coroutine that awaits it go on in the executor's next turn."""

    def __await__(self) -> Generator[None, None, None]:
        yield


async def give_way(node: Node) -> None:
    """Let everybody be served who waits already."""
    if node.executor is not None:
        # Woken, the executor does not wait for work beyond what there is.
        node.executor.wake()
        await _NextTurn()
