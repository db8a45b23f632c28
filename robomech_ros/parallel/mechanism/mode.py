"""Postures spread over the assembly mode of home."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros.parallel.mechanism.model import Mechanism

__all__ = ["half_ways"]

Array = NDArray[np.float64]


def half_ways(mechanism: Mechanism, ends: Array) -> Array:
    """Go from home half the ways to where the drives are at the ends (k, m); give postures (k, n).

    Where the mode ends on the first half, in a singular posture, half of the part before it.
    """
    home = mechanism.home()
    start, rows = home[mechanism.drive_index], []
    for end in ends:
        way = 0.5 * (end - start)
        closed = mechanism.close(start + way, home)
        if closed.status:
            closed = mechanism.close(start + 0.5 * closed.part * way, home)
        rows.append(closed.q)
    return np.array(rows)
