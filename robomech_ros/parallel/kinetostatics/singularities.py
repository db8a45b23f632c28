"""Singular poses of parallel robots of both types: what is lost, what is free, and whose limb."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import WrongSizeError
from robomech_ros.parallel.kinetostatics.conditioning import inverse_condition, scaled_matrices
from robomech_ros.parallel.kinetostatics.limb_geometry import poses_of
from robomech_ros.parallel.library import AnyParallelRobot
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.typing import Array, ArrayLike, IntArray

_ANGULAR, _LINEAR = slice(0, 3), slice(3, 6)
# Least part of a limb in forces that balance each other, of their norm 1.
_TAKES_PART = 1e-4


@dataclass(frozen=True, eq=False)
class LoopSingularity:
    """Singularity analysis of the matrices of K t = J qd at a pose.

    Attributes
    ----------
    type : int
        0 where regular; 1 where J is singular: a limb is at an end of its reach, and the platform
        has lost motions; 2 where K is: the platform can move with locked drives; 3 where both are.
    always : bool
        Whether K is singular in every pose, by the architecture of the robot.
    distances : ndarray, shape (2,)
        From both types, as :func:`singularity_distances` has them.
    singular_values : ndarray, shape (m,)
        Of K, angular columns divided by the length, largest first.
    length : float
        By which they are divided (m).
    dexterity : float
        As the function of this name has it.
    condition_number : float
        Its reciprocal, infinite where singular.
    lost_directions : ndarray, shape (r, 6)
        Twists at the platform's origin that no drive rates give (type 1), as an orthonormal basis
        after division of their linear part by the length, angular first, in the base.
    idle_wrenches : ndarray, shape (r, 6)
        Wrenches on the platform that load no drive (type 1), moment first, orthonormal after
        division of the moment by the length.
    self_motions : ndarray, shape (r, m)
        Rates of drives that do not move the platform (type 1), an orthonormal basis.
    free_directions : ndarray, shape (s, 6)
        Twists that the platform can have with locked drives (type 2), as the lost ones.
    unresisted_wrenches : ndarray, shape (s, 6)
        Wrenches on the platform that no forces of the drives balance (type 2), as the idle ones.
    internal_forces : ndarray, shape (s, m)
        Forces along the limbs that balance each other (type 2), an orthonormal basis.
    limbs : tuple of tuple of int
        The limbs, from 1: of type 1 those that are at an end of their reach, of type 2 those whose
        forces depend on each other.
    summary : str
        In words.
    """

    type: int
    always: bool
    distances: Array
    singular_values: Array
    length: float
    dexterity: float
    condition_number: float
    lost_directions: Array
    idle_wrenches: Array
    self_motions: Array
    free_directions: Array
    unresisted_wrenches: Array
    internal_forces: Array
    limbs: tuple[tuple[int, ...], tuple[int, ...]]
    summary: str

    @property
    def singular(self) -> bool:
        """True if the pose is singular, of either type."""
        return self.type > 0

    @property
    def kinds(self) -> tuple[str, ...]:
        """Singularity descriptions, such as "type 2: limbs 1, 3"; empty if there is none."""
        return tuple(
            f"type {k + 1}: {_named(limbs)}" for k, limbs in enumerate(self.limbs) if limbs
        )


def loop_singularity(
    robot: AnyParallelRobot,
    T: ArrayLike,
    q: ArrayLike | None = None,
    *,
    length: float | None = None,
) -> LoopSingularity:
    """Say of which type a pose is singular, what the platform cannot do there or does by itself.

    Types 1, 2 and 3 are the first, second and third kind of Gosselin and Angeles: the end of the
    reach of a limb, where postures of the limbs meet; a pose that locked drives do not hold, where
    assembly modes meet; both at once.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR, Spherical3RRR or Mechanism
        Of m drives.
    T : array_like, shape (4, 4)
        ``T_base_platform``, or a shorter form as for :func:`velocity_matrices`.
    q : array_like, shape (m,)
        Angles of the drives there (rad), one of the postures that ``inverse`` finds; robots with
        legs need none.  Of a mechanism all joints (rad or m), shape (n,), with closed loops.
    length : float, optional
        What makes linear and angular motions comparable (m); default :func:`platform_length`.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.1.  Gosselin and
    Angeles, Singularity analysis of closed-loop kinematic chains, IEEE Trans. on Robotics and
    Automation 6(3), 1990, pp. 281-290.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import Planar3RPR, loop_singularity
    >>> corners = np.array([[0.0, 1.0], [-0.8, -0.6], [0.8, -0.6]])
    >>> robot = Planar3RPR(2.0 * corners, corners)
    >>> found = loop_singularity(robot, [0.0, 0.0, 0.0], length=1.0)
    >>> found.type, found.kinds
    (2, ('type 2: limbs 1, 2, 3',))
    >>> np.abs(found.free_directions).round(6) + 0.0
    array([[0., 0., 1., 0., 0., 0.]])
    """
    poses = poses_of(robot, T)
    if poses.ndim != 2:
        raise WrongSizeError("pose", poses.shape, (4, 4))
    found = scaled_matrices(robot, T, q, length)
    left, values, right = np.linalg.svd(found.K)
    at_end = np.flatnonzero(np.abs(found.J) <= RANK)
    rank = int((values > RANK * values[0]).sum())
    free, forces = right[rank:], left[:, rank:].T
    # Motions that limbs prevent in other postures are free without forces of drives in balance.
    forces = forces[np.abs(forces @ found.rows).max(axis=1, initial=0.0) <= RANK * values[0]]
    lost = _row_space(found.K[at_end])
    motions, L = found.motions, found.scale
    takes_part = (np.abs(forces) > _TAKES_PART).any(axis=0) | (len(forces) < len(free))
    limbs = _numbers(robot, at_end), _numbers(robot, np.flatnonzero(takes_part))
    closed = robot.robot if isinstance(robot, Mechanism) else robot
    always = isinstance(closed, StewartGough) and closed.always_singular
    index = float(inverse_condition(found))
    return LoopSingularity(
        type=(1 if len(at_end) else 0) + (2 if rank < len(values) else 0),
        always=always,
        distances=np.array([np.abs(found.J).min(), values[-1]]),
        singular_values=values,
        length=found.length,
        dexterity=index,
        condition_number=1.0 / index if index else math.inf,
        lost_directions=_six_entries(lost, motions, L, _LINEAR),
        idle_wrenches=_six_entries(lost, motions, L, _ANGULAR),
        self_motions=np.eye(len(values))[at_end],
        free_directions=_six_entries(free, motions, L, _LINEAR),
        unresisted_wrenches=_six_entries(free, motions, L, _ANGULAR),
        internal_forces=forces,
        limbs=limbs,
        summary=_summary(limbs, always, len(lost), len(free)),
    )


def _row_space(rows: Array) -> Array:
    if not len(rows):
        return rows
    values, basis = np.linalg.svd(rows, full_matrices=False)[1:]
    return np.asarray(basis[values > RANK * values[0]])


def _six_entries(scaled: Array, motions: Array, length: float, part: slice) -> Array:
    """Return rows (k, 6) of rows (k, m) of which a part is divided by the length."""
    out = np.asarray(scaled @ motions.T)
    out[:, part] *= length
    return out


def _numbers(robot: AnyParallelRobot, drives: IntArray) -> tuple[int, ...]:
    if isinstance(robot, Mechanism):
        where = robot.drive_index[drives]
        drives = np.unique(np.searchsorted(robot.loops.starts, where, side="right") - 1)
    return tuple(int(k) + 1 for k in drives)


def _named(limbs: tuple[int, ...]) -> str:
    return f"{'limb' if len(limbs) == 1 else 'limbs'} {', '.join(map(str, limbs))}"


def _summary(
    limbs: tuple[tuple[int, ...], tuple[int, ...]], always: bool, lost: int, free: int
) -> str:
    said = []
    if limbs[0]:
        said.append(
            f"type 1: {_named(limbs[0])} at an end of the reach, {lost} of the motions lost"
        )
    if limbs[1]:
        said.append(
            f"type 2: forces of {_named(limbs[1])} depend on each other, {free} of the motions "
            "free with locked drives"
        )
    if always:
        said.append("architecturally singular: type 2 in every pose")
    return "; ".join(said) or "regular"
