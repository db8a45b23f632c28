"""Check of the cubics between the knots of a stream against all limits."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.servo.look_ahead import cubics_inside
from robomech_ros.servo.limits import RATE_ROUNDING, ServoLimits
from robomech_ros.typing import Array

_cubics_inside = direct(cubics_inside)

# Parameters of the points that determine a curve of degree 5, and the matrix to its coefficients.
FITTED: Array = np.linspace(0.0, 1.0, 6)
_FIT = np.linalg.inv(
    [[math.comb(5, k) * t**k * (1.0 - t) ** (5 - k) for k in range(6)] for t in FITTED.tolist()]
)

# By so much a joint that stands at the end of its range may move in rounding (rad or m).
_ROUNDING = 1e-12


def end_of_cubic(width: float, q: Array, v: Array) -> Array:
    """Return acceleration and jerk (2, n) at the end of a cubic of q (2, n), v (2, n)."""
    middle = 3.0 * (q[1] - q[0]) / width - v[0] - v[1]
    start, end = 2.0 * (middle - v[0]) / width, 2.0 * (v[1] - middle) / width
    return np.array((end, (end - start) / width))


def bernstein(times: Array, q: Array, v: Array) -> Array:
    """Return the coefficients (k - 1, 4, n) of the cubics that join knots.

    Positions and velocities (k, n) are in rad or m, and per s, the times (k,) in s.
    """
    third = np.diff(times)[:, None] / 3.0
    return np.stack((q[:-1], q[:-1] + third * v[:-1], q[1:] - third * v[1:], q[1:]), axis=1)


def fitted(q: Array) -> Array:
    """Return the Bernstein coefficients (6, n) of the curve through points (6, n) at `FITTED`."""
    coefficients: Array = _FIT @ q
    # The curve begins exactly at the first point, without rounding.
    coefficients[0] = q[0]
    return coefficients


class CubicResult(NamedTuple):
    """Return whether cubics keep all limits, and the joints that exceed their ranges."""

    inside: bool
    bound: Sequence[int]


class CubicCheck:
    """Checks knots against limits of n joints; one that begins outside its range may go inwards."""

    def __init__(self, limits: ServoLimits) -> None:
        inside = 1.0 - RATE_ROUNDING
        rates = inside * limits.velocity, inside * limits.acceleration, inside * limits.jerk
        self._limits: Array = np.array((*limits.inside, *rates))
        self._lower, self._upper = limits.inside
        self._out = np.zeros(len(limits.joint_names), dtype=np.int64)

    def of(self, widths: Array, q: Array, v: Array, reached: Array) -> CubicResult:
        """Check knots (k, n) of positions and velocities (rad or m, and per s).

        The widths (k - 1,) are the times between them (s); the first was reached with acceleration
        and jerk (2, n), per s^2 and s^3.
        """
        self._limits[0], self._limits[1] = self._lower, self._upper
        low, high = q[0] < self._lower, q[0] > self._upper
        if low.any() or high.any():
            self._limits[0, low] = q[0, low] - _ROUNDING
            self._limits[1, high] = q[0, high] + _ROUNDING
        status = _cubics_inside(widths, q, v, reached, self._limits, self._out)
        return CubicResult(not status, self._out.nonzero()[0].tolist() if status > 1 else ())
