"""The way of a trunk from one offset to another, at rest at both ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["PoseWay"]

Array = NDArray[np.float64]


class PoseWay(NamedTuple):
    """A trunk on its way to an offset.

    Attributes
    ----------
    start, end : ndarray, shape (6,)
        x, y, z (m) and roll, pitch, yaw (rad) beside the level pose.
    duration : float
        Of the whole way (s).
    passed : float
        How much of it is over (s).
    """

    start: Array
    end: Array
    duration: float
    passed: float = 0.0

    def after(self, time: float) -> PoseWay:
        """Give the way some time later (s)."""
        return self._replace(passed=self.passed + time)

    @property
    def over(self) -> bool:
        """Whether the trunk is there."""
        return self.passed >= self.duration

    @property
    def offset(self) -> Array:
        """Where the trunk is; its rates and their rates are zero at both ends."""
        part = min(1.0, self.passed / self.duration)
        smooth = part**3 * (10.0 + part * (6.0 * part - 15.0))
        return self.start + smooth * (self.end - self.start)
