"""Complaints about what senders repeat, which must not fill a log."""

import time
from collections import deque
from collections.abc import Callable
from typing import Any

__all__ = ["SparingLog"]

# In so many seconds no complaint is logged twice, and at most so many are logged at all.
PERIOD, MOST = 10.0, 5


class SparingLog:
    """Logs complaints, each at most once in a while and only a few of all.

    Parameters
    ----------
    logger
        Of a node.
    clock : callable, optional
        Gives seconds; default the machine's monotonic time.
    """

    def __init__(self, logger: Any, clock: Callable[[], float] = time.monotonic) -> None:
        self._logger, self._clock = logger, clock
        self._said: deque[tuple[float, str]] = deque()
        self._left_out = 0

    def error(self, text: str) -> None:
        """Log a text as an error, unless it or enough others were logged a moment ago."""
        if line := self._line(text):
            self._logger.error(line)

    def warning(self, text: str) -> None:
        """Log a text as a warning, unless it or enough others were logged a moment ago."""
        # A line of its own for each severity: rclpy raises where one line of code logs with two.
        if line := self._line(text):
            self._logger.warning(line)

    def _line(self, text: str) -> str:
        """Give what is to be logged for a text now; empty for nothing."""
        now = self._clock()
        while self._said and now - self._said[0][0] >= PERIOD:
            self._said.popleft()
        if len(self._said) >= MOST or text in (said for _, said in self._said):
            self._left_out += 1
            return ""
        self._said.append((now, text))
        left_out, self._left_out = self._left_out, 0
        return f"{text} ({left_out} such lines left out)" if left_out else text
