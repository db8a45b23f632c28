"""Past positions of a robot on the ground."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.typing import Array

# Places that are kept, apart by so much (m, rad) at least.
MOST_PLACES, APART = 2000, 0.01
# Over the ground (m): a line on it would be lost in it.
LIFT = 0.004


class Trail:
    """Places where a robot was; the oldest ones are forgotten."""

    def __init__(self) -> None:
        self._places: deque[Array] = deque(maxlen=MOST_PLACES)

    def add(self, pose: ArrayLike) -> None:
        """Add a place x, y (m), heading (rad), unless it is where the last one is."""
        place = np.array(pose, dtype=np.float64)
        if not self._places or np.abs(self._places[-1] - place).max() > APART:
            self._places.append(place)

    def clear(self) -> None:
        """Begin anew."""
        self._places.clear()

    @property
    def points(self) -> Array:
        """The places, on the ground, shape (m, 3) (m)."""
        return on_ground(np.array(self._places).reshape(-1, 3))


def on_ground(places: Array) -> Array:
    """Return points on the ground, just above it, for places (m, 2 or more) (m)."""
    return np.column_stack([places[:, :2], np.full(len(places), LIFT)])
