"""A motion to be shown: joint positions over time, and what else would have led there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import RobotDescription, SerialChain
from robomech_ros.spatial.arrays import real_array
from robomech_ros.trajectory import PiecewisePolynomial, interpolant
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel import Mechanism


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
    chain : SerialChain, Mechanism or RobotDescription
        Chain of n joints; of a whole robot those are its ``joint_names``.
    times : ndarray, shape (m,)
        Increasing (s).
    q : ndarray, shape (m, n)
        rad or m.
    choices : tuple of Choice
        In the order of their times; without other postures where a whole robot moves.
    qd, qdd, qddd : ndarray, shape (m, n), optional
        Velocities, accelerations and jerks, rad or m over s, s^2 and s^3, where they are known.
    tau : ndarray, shape (m, n), optional
        Torques or forces of the joints (N m or N), where they are known.

    Raises
    ------
    BadValueError, WrongSizeError
        No time, times that do not increase, arrays of another size or not finite, or other postures
        of a whole robot.
    """

    chain: SerialChain | Mechanism | RobotDescription
    times: Array
    q: Array
    choices: tuple[Choice, ...] = ()
    qd: Array | None = None
    qdd: Array | None = None
    qddd: Array | None = None
    tau: Array | None = None

    def __post_init__(self) -> None:
        # Each refuses what are no positions of its joints.
        if isinstance(self.chain, SerialChain):
            forward_kinematics(self.chain, self.q)
        elif isinstance(self.chain, RobotDescription):
            self._check_whole(self.chain)
        else:
            self.chain.pose(self.q)
        q = np.atleast_2d(np.asarray(self.q, dtype=np.float64))
        times = np.asarray(self.times, dtype=np.float64)
        if times.ndim != 1 or not len(times) or len(times) != len(q):
            raise BadValueError("times", times.shape, "one for each row of q")
        if not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
            raise BadValueError("times", times, "finite and increasing")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "q", q)
        for name in ("qd", "qdd", "qddd", "tau"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, _like_q(name, given, q.shape))

    @property
    def arm(self) -> SerialChain:
        """The chain, where that is what moves.

        Raises
        ------
        BadValueError
            It is a parallel robot, or a whole robot.
        """
        if not isinstance(self.chain, SerialChain):
            raise BadValueError("what moves", self.chain.name, "an arm, no other robot")
        return self.chain

    def _check_whole(self, robot: RobotDescription) -> None:
        rows = real_array("q", self.q)
        _like_q("q", rows, (*rows.shape[:-1], len(robot.joint_names)))
        others = next((choice.name for choice in self.choices if choice.others), None)
        if others is not None:
            raise BadValueError("choices", others, "none with other postures: a whole robot moves")

    @property
    def duration(self) -> float:
        """From the first to the last time (s)."""
        return float(self.times[-1] - self.times[0])

    def at(self, times: ArrayLike) -> Array:
        """Return positions (..., n) at times (...) in s, as a controller passes through q."""
        return self.curve.sample(np.asarray(times) - self.times[0]).position

    @cached_property
    def curve(self) -> PiecewisePolynomial:
        """The curve on which a controller passes through q, from 0 s on."""
        return interpolant(self.times - self.times[0], self.q, self.qd, self.qdd)

    def sampled(self, rate: float) -> tuple[Array, Array]:
        """Return times (k,) in s and positions (k, n) at a rate (Hz), the last one included."""
        first, last = float(self.times[0]), float(self.times[-1])
        count = max(round((last - first) * rate), 1)
        at = np.linspace(first, last, count + 1)
        return at, self.at(at)


def _like_q(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    rows = real_array(name, values)
    if rows.shape != shape:
        raise WrongSizeError(name, rows.shape, shape)
    if not np.isfinite(rows).all():
        raise NonFiniteError(name, rows)
    return rows
