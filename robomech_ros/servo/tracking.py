"""Check that the joints follow the stream."""

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from robomech_ros.typing import Array, BoolArray

# Fewer commands, or a way shorter than this (rad or m), say nothing of a lag.
_FEW, _CLEAR = 5, 0.01


class TrackedJoints(Protocol):
    """The n joints of a chain, or of all legs."""

    @property
    def joint_names(self) -> Sequence[str]:
        """Their names."""

    @property
    def units(self) -> Sequence[str]:
        """``"rad"`` or ``"m"``."""

    @property
    def continuous(self) -> BoolArray:
        """Joints that turn without limits."""


class Deviation(NamedTuple):
    """A joint that does not follow: how far it is off, and may be (rad or m)."""

    joint: str
    amount: float
    tolerance: float
    unit: str

    @property
    def text(self) -> str:
        """The same in words."""
        off, allowed = f"{self.amount:.4g} {self.unit}", f"{self.tolerance:.4g} {self.unit}"
        return f"joint '{self.joint}' is {off} off its command, the tolerance is {allowed}"


class Tracking:
    """Compares measured positions with those of a stream in the last while.

    Joints follow with a delay, at most this one (s): each may be anywhere between its commands of
    then and now, and off by a tolerance (rad or m). Those that turn without limits may be off by
    whole turns.
    """

    def __init__(self, joints: TrackedJoints, tolerance: float, delay: float) -> None:
        self._names, self._units = joints.joint_names, joints.units
        self._continuous = joints.continuous
        self._tolerance, self._delay = tolerance, delay
        self._told: deque[tuple[float, Array]] = deque()

    def begin(self) -> None:
        """Forget earlier commands."""
        self._told.clear()

    def tell(self, time: float, position: Array) -> None:
        """Note the commanded positions (n,) of the joints (rad or m) at a time (s)."""
        self._told.append((time, position))

    def lag(self, now: float, position: Array) -> float | None:
        """Return how long ago the joint that moves most was told to be where it is (s).

        None where none has moved by 0.01 rad or m in one direction, or it is nowhere there.
        """
        if len(self._told) < _FEW:
            return None
        times = np.array([time for time, _ in self._told])
        told = np.array([place for _, place in self._told])
        joint = int(np.argmax(np.abs(told[-1] - told[0])))
        way = (told[:, joint] - told[0, joint]) * np.sign(told[-1, joint] - told[0, joint])
        place = (position[joint] - told[0, joint]) * np.sign(told[-1, joint] - told[0, joint])
        if way[-1] < _CLEAR or (np.diff(way) <= 0.0).any() or not 0.0 < place < way[-1]:
            return None
        return float(now - np.interp(place, way, times))

    def deviation(self, now: float, position: Array) -> Deviation | None:
        """Find the joint that is farthest from its commands now (s), if that is too far."""
        while len(self._told) > 1 and self._told[1][0] < now - self._delay:
            self._told.popleft()
        if not self._told:
            return None
        told = np.array([place for _, place in self._told])
        low, high = told.min(axis=0), told.max(axis=0)
        turns = np.round((position - 0.5 * (low + high)) / math.tau)
        place = position - np.where(self._continuous, turns * math.tau, 0.0)
        off = np.maximum(low - place, place - high)
        worst = int(np.argmax(off))
        if off[worst] <= self._tolerance:
            return None
        unit = self._units[worst]
        return Deviation(self._names[worst], float(off[worst]), self._tolerance, unit)
