"""A thread that looks at what a running robot says while somebody looks at the page."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

if TYPE_CHECKING:
    from robomech_ros.rvs.page.live.live_page import LivePage

# How often it is looked whether somebody looks (s).
_IDLE = 0.2


class PollThread(ABC):
    """A thread that looks again and again, as long as somebody watches a view.

    Parameters
    ----------
    view : object
        Says by ``wait_for_viewer`` whether somebody looks.
    rate : float
        Looks per second.
    logger : rclpy logger

    Attributes
    ----------
    condition : str
        What is wrong with what the robot says; empty for nothing, or if nobody looks.
    """

    def __init__(self, view: LivePage, rate: float, logger: Any) -> None:
        self._seen, self._period, self._log = view, 1.0 / rate, ThrottledLog(logger)
        self.condition = ""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="states", daemon=True)

    def begin(self) -> None:
        """Start the thread."""
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        self._closing.set()
        self._thread.join()

    @abstractmethod
    def look(self, now: float) -> None:
        """Read what has come and show it, at a time of the monotonic clock (s)."""

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closing.is_set():
            if not self._seen.wait_for_viewer(_IDLE):
                self.condition = ""
                continue
            now = time.monotonic()
            try:
                self.look(now)
            except Exception as error:
                # The thread goes on: it also says that states are old.
                self.condition = f"The robot cannot be shown: {error!r}."
                self._log.error(self.condition)
            # What was missed is not made up for.
            due = max(due + self._period, now)
            self._closing.wait(max(due - time.monotonic(), 0.0))
