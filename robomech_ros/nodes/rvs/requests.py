"""Requests to services, none of which waits for its answer for ever."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.client import Client
from rclpy.node import Node
from rclpy.task import Future


@dataclass(frozen=True, eq=False)
class _Request:
    """A request whose answer has not come, until when it may (s), and what then."""

    client: Client
    future: Future
    until: float
    give_up: Callable[[str], None]


class Requests:
    """Sends requests from any thread, and gives up those that nobody answers."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._lock = threading.Lock()
        self._waiting: list[_Request] = []

    def name(self, client: Client) -> str:
        """Return the full name of a service, quoted."""
        return f"'{self._node.resolve_service_name(client.srv_name)}'"

    def send(
        self,
        client: Client,
        request: Any,
        take: Callable[[Any], None],
        give_up: Callable[[str], None],
        patience: float,
    ) -> None:
        """Send a request; one of two callables is called afterwards, on the thread of the node.

        - ``client``: client of an available service.
        - ``take``: called with the answer.
        - ``give_up``: called with the reason as text, if no answer comes.
        - ``patience``: longest wait for the answer (s).
        """
        future = client.call_async(request)
        one = _Request(client, future, time.monotonic() + patience, give_up)
        with self._lock:
            self._waiting.append(one)

        def answered(future: Future) -> None:
            if self._drop(one):
                take(future.result())

        future.add_done_callback(answered)

    def look(self) -> None:
        """Drop requests that took too long, and those to servers that are gone."""
        with self._lock:
            waiting = list(self._waiting)
        now = time.monotonic()
        for one in waiting:
            gone = not one.client.service_is_ready()
            if (gone or now > one.until) and self._drop(one):
                one.client.remove_pending_request(one.future)
                why = "is gone" if gone else "does not answer"
                one.give_up(f"{self.name(one.client)} {why}")

    def _drop(self, one: _Request) -> bool:
        """Wait no longer; says whether it was waited for."""
        with self._lock:
            if one not in self._waiting:
                return False
            self._waiting.remove(one)
            return True
