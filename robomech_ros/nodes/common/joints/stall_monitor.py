"""Detection of stalls of the process, and the age of unstamped commands afterwards."""

import math

# After this time (s) without a look, waiting commands may be outdated.
HELD_UP = 0.5
# Time (s) for which the middleware may still deliver such commands.
_BACKLOG = 0.2


class StallMonitor:
    """Detects stalls by repeated looks at a clock during reception of commands."""

    def __init__(self) -> None:
        self._looked_at = math.inf
        # The last stall: its start, and the end of the delivery of messages from it.
        self._since = self._until = -math.inf

    def look(self, now: float, most: float = HELD_UP) -> bool:
        """Return whether more than `most` (s) have passed since the last look."""
        held_up = now > self._looked_at + most
        if held_up:
            self._since, self._until = self._looked_at, now + _BACKLOG
        self._looked_at = now
        return held_up

    def age(self, now: float) -> float:
        """Possible age (s) of commands received now without a stamp; 0 without a recent stall."""
        return max(now - self._since, 0.0) if now < self._until else 0.0
