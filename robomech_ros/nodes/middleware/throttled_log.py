"""Lines that senders cause again and again, which must not fill a log."""

import re
import time
from collections.abc import Callable
from typing import Any

# A kind of line is logged once in this time (s).
PERIOD = 1.0
# A new kind is logged unless there were so many in as many periods: senders can make up kinds.
MOST = 5
# Lines that differ in numbers alone are of one kind.
_NUMBER = re.compile(r"[-+]?\d[\d.e+-]*|nan|inf")


class ThrottledLog:
    """Logs each kind of line at most once a second, with the count of the lines left out.

    - ``clock``: gives seconds; default the machine's monotonic time.
    """

    def __init__(self, logger: Any, clock: Callable[[], float] = time.monotonic) -> None:
        self._logger, self._clock = logger, clock
        # When a line of each recent kind was logged.
        self._said: dict[str, float] = {}
        self._left_out = 0

    # A line of its own for each severity: rclpy raises where one line of code logs with two.
    def error(self, text: str) -> None:
        """Log a text as an error, unless one of its kind was logged a moment ago."""
        if line := self._line(text):
            self._logger.error(line)

    def warning(self, text: str) -> None:
        """Log a text as a warning, unless one of its kind was logged a moment ago."""
        if line := self._line(text):
            self._logger.warning(line)

    def info(self, text: str) -> None:
        """Log a text as information, unless one of its kind was logged a moment ago."""
        if line := self._line(text):
            self._logger.info(line)

    def _line(self, text: str) -> str:
        """Return what is to be logged for a text now; empty for nothing."""
        now, kind = self._clock(), _NUMBER.sub("", text)
        self._said = {k: at for k, at in self._said.items() if now - at < MOST * PERIOD}
        last = self._said.get(kind)
        if len(self._said) >= MOST if last is None else now - last < PERIOD:
            self._left_out += 1
            return ""
        self._said[kind] = now
        left_out, self._left_out = self._left_out, 0
        return f"{text} ({left_out} more lines left out)" if left_out else text
