"""Distinguish nodes that do not answer from an attacker that does not get to their answers."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.nodes.middleware.queue_depth import ask

__all__ = ["LONGEST", "Probes", "ProgressExecutor"]

# The most that one pass of the executor counts, and the time between two probes (s).
LONGEST, _BETWEEN = 0.01, 1.0


class ProgressExecutor(SingleThreadedExecutor):
    """Measures time by its passes: in each it took the next answer of every client that had one.

    Attributes
    ----------
    progress : float
        Time of complete passes (s); of one that was held up no more than `LONGEST`.
    """

    def __init__(self, context: Context) -> None:
        super().__init__(context=context)
        self.progress, self._ended = 0.0, time.monotonic()

    def _wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Iterator[Any]:
        try:
            yield from super()._wait_for_ready_callbacks(*args, **kwargs)
        except TimeoutException:
            self._end_pass()
            raise
        self._end_pass()

    def _end_pass(self) -> None:
        now = time.monotonic()
        self.progress += min(now - self._ended, LONGEST)
        self._ended = now


class Probes:
    """Ask all nodes for no parameters, again and again, while other answers are missing.

    Time is the progress of the attacker's executor: a starved attacker makes little.

    Parameters
    ----------
    node : Node
        The attacker.
    names : sequence of str
        The nodes.
    """

    def __init__(self, node: Node, names: Sequence[str]) -> None:
        self._clients = {name: ask(node, GetParameters, f"{name}/get_parameters") for name in names}
        self._asked: dict[str, Future] = {}
        self.restart()

    def restart(self) -> None:
        """Begin to count, since something else was answered."""
        self._time = self._confirmed = self._probed = 0.0

    def count(self, seconds: float) -> None:
        """Count a time without an answer (s)."""
        self._time += seconds
        if self._missing():
            return
        self._confirmed = self._time
        if self._time >= self._probed + _BETWEEN:
            self._probed, request = self._time, GetParameters.Request()
            self._asked = {name: one.call_async(request) for name, one in self._clients.items()}

    def _missing(self) -> list[str]:
        return [name for name, answer in self._asked.items() if not answer.done()]

    def silent(self, seconds: float) -> list[str]:
        """Name the nodes that have left a probe unanswered for so long (s)."""
        return self._missing() if self._time - self._confirmed >= seconds else []

    def over(self, seconds: float) -> bool:
        """Whether a node is silent, or all answered nothing but probes, for so long (s)."""
        return self._confirmed >= seconds or bool(self.silent(seconds))
