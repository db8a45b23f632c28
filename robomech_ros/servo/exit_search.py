"""Getting joints at rest out of a singularity, a part of the work in each period."""

from collections.abc import Callable

import numpy as np

from robomech_ros.servo.line_path import LinePath
from robomech_ros.servo.singularity_exits import Start, departures
from robomech_ros.servo.twist_resolver import TwistResolver
from robomech_ros.typing import Array

# A way leads out if a joint moves by this much on it (rad or m).
_AWAY = 0.015
# How far joints may pass their limits on it (rad or m), and at how many places that is looked at.
_PAST, _PLACES = 1e-12, 33
# Twists with at least this cosine between them leave a singularity alike.
_ALIKE = 0.9


class SingularityExit:
    """Looks for the way of a twist out of a posture beyond the hard stop."""

    def __init__(self, resolver: TwistResolver) -> None:
        self._resolver = resolver
        self._posture, self._sought = np.zeros(0), np.zeros(0)
        self._starts: list[Start] = []
        self._path: LinePath | None = None
        # Whence a way leads out that passes limits.
        self._past: Start | None = None

    def begin(self) -> None:
        """Begin again, for another twist; where it may begin remains known if that is alike."""
        self._path = None

    def forget(self) -> None:
        """Forget where a way may begin."""
        self._posture, self._path, self._past = np.zeros(0), None, None

    def way(self, q: Array, twist: Array, lay: Callable[[Start], LinePath]) -> LinePath | None:
        """Return the way out; None if there is none, or it was not yet found.

        One that passes limits of joints is given only where there is no other. The joints rest at q
        (n,), the twist (6,) of the tip in base axes, angular first, is not zero; ``lay`` gives the
        way for it from a start.
        """
        sought = self._resolver.scaled(twist)
        sought /= np.linalg.norm(sought)
        if not np.array_equal(q, self._posture) or sought @ self._sought < _ALIKE:
            self.forget()
            self._posture, self._sought = q, sought
            # That takes a period.
            self._starts = departures(self._resolver, q, twist)
            return None
        start = self._starts[0] if self._starts else self._past
        if start is None:
            return None
        if self._path is None:
            self._path = lay(start)
        path = self._path
        path.begin_period()
        away = _AWAY / max(float(np.abs(path.slope(0.0)).max()), 1e-300)
        if path.reach(away):
            if not self._starts or self._inside(path, away):
                self.forget()
                return path
            self._past = self._past or start
        if not path.unfinished:
            self._path = None
            if self._starts:
                self._starts.pop(0)
            else:
                self._past = None
        return None

    def _inside(self, path: LinePath, away: float) -> bool:
        """Return whether joints keep their limits up to a position, mostly near the start."""
        places = away * np.linspace(0.0, 1.0, _PLACES) ** 2
        q, _ = path.at(places, np.ones(_PLACES))
        chain = self._resolver.chain
        return bool(((chain.lower - _PAST <= q) & (q <= chain.upper + _PAST)).all())
