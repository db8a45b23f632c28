"""A motion to be shown: joint positions over time, and what else would have led there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import SerialChain

__all__ = ["Choice", "Motion", "NamedPosture"]

Array = NDArray[np.float64]


class NamedPosture(NamedTuple):
    """A posture (n,) in rad or m, and its name."""

    name: str
    q: Array


class Choice(NamedTuple):
    """A pose that one of several postures was taken for.

    Parameters
    ----------
    time : float
        From when on it counts (s).
    name : str
        Of what is done.
    taken : str
        Name of the posture that was taken.
    others : tuple of NamedPosture
        Those that were not.
    """

    time: float
    name: str
    taken: str
    others: tuple[NamedPosture, ...]


@dataclass(frozen=True, eq=False)
class Motion:
    """Joint positions over time.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    times : ndarray, shape (m,)
        Increasing (s).
    q : ndarray, shape (m, n)
        rad or m.
    choices : tuple of Choice
        In the order of their times.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        No time, times that do not increase, or positions of another size or not finite.
    """

    chain: SerialChain
    times: Array
    q: Array
    choices: tuple[Choice, ...] = ()

    def __post_init__(self) -> None:
        forward_kinematics(self.chain, self.q)
        times = np.asarray(self.times, dtype=np.float64)
        if times.ndim != 1 or not len(times) or len(times) != len(np.atleast_2d(self.q)):
            raise BadValueError("times", times.shape, "one for each row of q")
        if not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
            raise BadValueError("times", times, "finite and increasing")

    def sampled(self, rate: float) -> tuple[Array, Array]:
        """Give times (k,) in s and positions (k, n) at a rate (Hz), the last one included."""
        first, last = float(self.times[0]), float(self.times[-1])
        count = max(round((last - first) * rate), 1)
        at = np.linspace(first, last, count + 1)
        columns = [np.interp(at, self.times, column) for column in np.asarray(self.q).T]
        return at, np.column_stack(columns)
