"""Whether the cubics that join the knots of a stream are inside all limits."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.servo.look_ahead import cubics_inside
from robomech_ros.servo.limits import RATE_ROUNDING, ServoLimits

__all__ = ["CubicCheck", "Verdict"]

Array = NDArray[np.float64]

_cubics_inside = direct(cubics_inside)


class Verdict(NamedTuple):
    """What was found of cubics.

    Attributes
    ----------
    inside : bool
        Whether they keep all limits.
    bound : sequence of int
        The joints that exceed their ranges.
    """

    inside: bool
    bound: Sequence[int]


class CubicCheck:
    """Checks knots against limits of n joints.

    Parameters
    ----------
    limits : ServoLimits
        Of the joints.
    """

    def __init__(self, limits: ServoLimits) -> None:
        inside = 1.0 - RATE_ROUNDING
        rates = inside * limits.velocity, inside * limits.acceleration, inside * limits.jerk
        self._limits: Array = np.array((*limits.inside, *rates))
        self._out = np.zeros(len(limits.names), dtype=np.int64)

    def of(self, widths: Array, q: Array, v: Array) -> Verdict:
        """Check knots (k, n) of positions and velocities (rad or m, and per s).

        Parameters
        ----------
        widths : ndarray, shape (k - 1,)
            Time between each two (s).
        """
        status = _cubics_inside(widths, q, v, self._limits, self._out)
        return Verdict(not status, self._out.nonzero()[0].tolist() if status > 1 else ())
