"""The way of a trunk to an offset, at rest at its end, whatever way it was on before."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomech_ros.typing import Array

# Changes under way at one time; of more the last waits.
_MOST = 32


class _Change(NamedTuple):
    """A change of the offset: ``way`` (6,), its ``duration`` and how much of it is over (s)."""

    way: Array
    duration: float
    passed: float = 0.0

    def left(self, time: float) -> Array:
        """Return the remainder some time later; rates and their rates are zero at both ends."""
        part = min(1.0, (self.passed + time) / self.duration)
        smooth = part**3 * (10.0 + part * (6.0 * part - 15.0))
        return (1.0 - smooth) * self.way


class TrunkPath(NamedTuple):
    """A trunk on its way to an offset (6,) beside the level pose.

    Offsets are x, y, z (m), roll, pitch, yaw (rad). A new goal is added to the way there has been:
    what is left of that goes on beside it, so that position, rate and acceleration stay continuous.
    Where too many changes are under way, the last goal waits with its duration.
    """

    end: Array
    changes: tuple[_Change, ...] = ()
    waiting: tuple[tuple[Array, float], ...] = ()

    def to(self, end: Array, duration: float) -> TrunkPath:
        """Return the way to another offset, that takes so long (s)."""
        if len(self.changes) >= _MOST:
            return self._replace(waiting=((end, duration),))
        return TrunkPath(end, (*self.changes, _Change(end - self.end, duration)))

    def after(self, time: float) -> TrunkPath:
        """Return the way some time later (s)."""
        later = (one._replace(passed=one.passed + time) for one in self.changes)
        way = self._replace(changes=tuple(one for one in later if one.passed < one.duration))
        for end, duration in self.waiting:
            return way._replace(waiting=()).to(end, duration)
        return way

    @property
    def goal(self) -> Array:
        """Target of the path, shape (6,)."""
        return self.waiting[-1][0] if self.waiting else self.end

    @property
    def over(self) -> bool:
        """True if the trunk is there."""
        return not self.changes

    @property
    def rest(self) -> float:
        """Remaining time (s)."""
        return max((one.duration - one.passed for one in self.changes), default=0.0)

    @property
    def offset(self) -> Array:
        """Present offset of the trunk."""
        return self.ahead(0.0)

    def ahead(self, time: float) -> Array:
        """Return where the trunk will be some time later (s)."""
        return self.end - sum((one.left(time) for one in self.changes), np.zeros(6))
