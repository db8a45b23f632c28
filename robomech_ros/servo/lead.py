"""Lead of a stream over its time stamps, longer while points arrive late."""

import math
from collections import deque

# Time for which lateness counts (s), and time in which the lead then falls by one period (s).
_REMEMBERED, _FALL = 10.0, 1.0
# One that comes late is an accident; as many as these within that time are not.
_ACCIDENTS = 1
# A robot whose lag behind the stream grows by less than this part of a period is in time.
_GROWN = 1.0


class AdaptiveLead:
    """Follows the lateness of points, a period (s) apart, by a lead between bounds in periods.

    A point is late without disturbing the motion as long as the one before it is not over, which is
    one period less than the lead. ``periods`` is the present lead, ``latest`` the largest lateness
    so far (s).
    """

    def __init__(self, period: float, least: int, most: int) -> None:
        self._period, self._least, self._most = period, least, max(least, most)
        self.periods, self.latest = least, 0.0
        # When how many periods would have been enough.
        self._needs: deque[tuple[float, int]] = deque()
        self._fell_at = -math.inf
        self._lag: float | None = None

    @property
    def needed(self) -> int:
        """The lead (periods) for the largest lateness so far."""
        return math.ceil(self.latest / self._period - 1e-6) + 1

    def sent(self, now: float, late: float) -> None:
        """Note that a point was sent at a time (s), late by so much (s)."""
        if late > (self.periods - 1) * self._period:
            self._note(now, late)
        self._adapt(now)

    def begin(self) -> None:
        """Begin another stream, which the robot may follow with another lag."""
        self._lag = None

    def followed(self, now: float, lag: float) -> None:
        """Note how long after the stream the robot is where it should have been (s).

        Robots have lags of their own; only growth tells of points that came late.
        """
        if self._lag is None or lag < self._lag:
            self._lag = lag
        grown = lag - self._lag
        if grown >= _GROWN * self._period:
            self._note(now, (self.periods - 1) * self._period + grown)
            self._lag = lag

    def _note(self, now: float, late: float) -> None:
        self.latest = max(self.latest, late)
        self._needs.append((now, math.ceil(late / self._period - 1e-6) + 1))

    def _adapt(self, now: float) -> None:
        while self._needs and self._needs[0][0] < now - _REMEMBERED:
            self._needs.popleft()
        needs = sorted((need for _, need in self._needs), reverse=True)
        wanted = needs[_ACCIDENTS] if len(needs) > _ACCIDENTS else self._least
        wanted = min(max(wanted, self._least), self._most)
        if wanted >= self.periods:
            self.periods = wanted
        elif now > self._fell_at + _FALL:
            self.periods -= 1
        else:
            return
        self._fell_at = now
