"""Detects that its process was held up, and how old unstamped commands may then be."""

import math

# After so long (s) without a look, waiting commands may come from a user who has let go since.
HELD_UP = 0.5
# For so long (s) after that such commands may still come out of the middleware.
_BACKLOG = 0.2


class StallMonitor:
    """Looks at a clock again and again, where commands are taken."""

    def __init__(self) -> None:
        self._looked_at = math.inf
        # The last hold-up: since when nobody looked, and until when what came then may come out.
        self._since = self._until = -math.inf

    def look(self, now: float, most: float = HELD_UP) -> bool:
        """Say whether more than `most` (s) have gone by since the last look."""
        held_up = now > self._looked_at + most
        if held_up:
            self._since, self._until = self._looked_at, now + _BACKLOG
        self._looked_at = now
        return held_up

    def age(self, now: float) -> float:
        """How old (s) what comes now without a stamp may be; 0 where nobody was held up lately."""
        return max(now - self._since, 0.0) if now < self._until else 0.0
