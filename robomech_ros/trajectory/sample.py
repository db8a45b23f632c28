"""State of a trajectory at one or many instants."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from robomech_ros.errors import NonFiniteError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.typing import Array, ArrayLike, BoolArray


class Sample(NamedTuple):
    """State of all joints at one instant, or at many; unpacks in this order.

    Attributes
    ----------
    position, velocity, acceleration, jerk : ndarray, shape (n,) or (m, n)
        Joint values (rad or m) and their first three derivatives with respect to time (s); one
        row for each instant where an array of instants was asked for.
    """

    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array


class Trajectory(Protocol):
    """Anything that lasts a while and can be sampled, from t = 0 to t = duration (s)."""

    @property
    def duration(self) -> float:
        """Time from start to end, in s."""

    def sample(self, t: ArrayLike) -> Sample:
        """Sample at time t (s), a scalar or an array of shape (m,)."""


def checked_times(t: ArrayLike) -> Array:
    """Turn instants into a float array of dimension 0 or 1; refuse NaN and infinity."""
    times = real_array("time", t)
    if times.ndim > 1:
        times = times.ravel()
    if not np.isfinite(times).all():
        raise NonFiniteError("time", times if times.ndim else float(times))
    return times


def held_outside(sample: Sample, outside: BoolArray) -> Sample:
    """Put the instants outside a trajectory at rest at the position of its nearest end."""
    if not outside.any():
        return sample
    for rate in (sample.velocity, sample.acceleration, sample.jerk):
        rate[outside] = 0.0
    return sample
