"""Distance of a posture from a singularity, the lost directions, and the reasons."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.kinetostatics.posture_report import (
    FACTOR_ZERO,
    FACTORS,
    MOVING,
    posture_reports,
)
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.kinetostatics.point_jacobians import TIP, as_point
from robomech_ros.kinetostatics.singularities.determinant_factors import named_parts
from robomech_ros.kinetostatics.singularities.generic_rank import generic_motions, scaling_length
from robomech_ros.printing import Printed
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, BoolArray, IntArray

_compiled = direct(posture_reports)


@dataclass(frozen=True, eq=False)
class SingularityReport(Printed):
    """Report on the Jacobian of a posture.

    Attributes
    ----------
    singular_values : ndarray, shape (k,)
        Of the Jacobian with its linear rows divided by the length, largest first; k is the smaller
        of 6 and the number of joints.
    rank : int
        How many of them are more than 1e-6 of the largest.
    length : float
        By which linear rows are divided (m).
    manipulability : float
        Product of the singular values of the Jacobian in SI units; of an arm that has fewer
        directions than singular values in every posture, such as a planar one of four joints, of
        those that it has.
    condition_number : float
        Condition number of the Jacobian in SI units; infinite where singular.
    normalised_condition_number : float
        Largest over least of ``singular_values`` that the arm has; infinite where singular.
    lost_directions : ndarray, shape (r, 6)
        Twists at the point in base axes that no joint rates give, as an orthonormal basis after
        division of their linear part by the length, angular first (rad/s and m/s).
    idle_wrenches : ndarray, shape (r, 6)
        Wrenches at the point in base axes that load no joint, a basis, moment first (N m and N),
        orthonormal after division of the moment by the length.
    self_motions : ndarray, shape (s, n)
        Joint rates that do not move the tip, an orthonormal basis (rad/s and m/s).
    factors : dict
        From the name of a part of the arm, such as "elbow", to its factor of the determinant, 0
        where that part is singular.
    kinds : tuple of str
        The parts that are singular here; where none has a name, the joints whose axes depend on
        each other.
    """

    singular_values: Array
    rank: int
    length: float
    manipulability: float
    condition_number: float
    normalised_condition_number: float
    lost_directions: Array
    idle_wrenches: Array
    self_motions: Array
    factors: dict[str, float]
    kinds: tuple[str, ...]

    @property
    def singular(self) -> bool:
        """True if the tip has lost a motion that the arm has in other postures."""
        return bool(self.kinds)


@dataclass(frozen=True, eq=False)
class SingularityReports:
    """Reports on the Jacobians of many postures: the fields of :class:`SingularityReport`.

    ``reports[k]`` is the report on one posture, k an index of the leading axes of q.

    Attributes
    ----------
    singular_values : ndarray, shape (..., k)
    rank : ndarray of int, shape (...)
    length : float
    manipulability, condition_number, normalised_condition_number : ndarray, shape (...)
    lost_directions, idle_wrenches : ndarray, shape (..., 6, 6)
        Rows after the last of a posture are NaN.
    self_motions : ndarray, shape (..., n, n)
        The same.
    factors : dict
        From the name of a part of the arm to its factors, shape (...).
    kinds : ndarray of tuples of str, shape (...)
        Empty where a posture is not singular.
    """

    singular_values: Array
    rank: IntArray
    length: float
    manipulability: Array
    condition_number: Array
    normalised_condition_number: Array
    lost_directions: Array
    idle_wrenches: Array
    self_motions: Array
    factors: dict[str, Array]
    kinds: NDArray[np.object_]

    @property
    def singular(self) -> BoolArray:
        """True where the tip has lost a motion that the arm has in other postures, shape (...)."""
        return self.kinds.astype(bool)

    def __getitem__(self, index: int | tuple[int, ...]) -> SingularityReport:
        """Return the report on one posture."""
        rows = (self.lost_directions, self.idle_wrenches, self.self_motions)
        lost, idle, free = (one[index][~np.isnan(one[index][:, 0])] for one in rows)
        return SingularityReport(
            singular_values=self.singular_values[index],
            rank=int(self.rank[index]),
            length=self.length,
            manipulability=float(self.manipulability[index]),
            condition_number=float(self.condition_number[index]),
            normalised_condition_number=float(self.normalised_condition_number[index]),
            lost_directions=lost,
            idle_wrenches=idle,
            self_motions=free,
            factors={name: float(values[index]) for name, values in self.factors.items()},
            kinds=self.kinds[index],
        )


def singularity_report(
    chain: SerialChain, q: ArrayLike, *, point: ArrayLike = TIP, length: float | None = None
) -> SingularityReport | SingularityReports:
    r"""Say what the tip can do in a posture, or in each of many, and what not.

    .. math:: \mathrm{rank}\,J(q) < \max_q \mathrm{rank}\,J(q)

    The whole twist is judged: for an arm of three joints that only positions, see ``part`` of
    :func:`condition_number`.

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.
    point : array_like, shape (3,), optional
        Point of the tip link, in its frame (m), whose motion is judged; default the tip's origin.
    length : float, optional
        What makes linear and angular motions comparable (m); default the characteristic length,
        which takes a second or so to find and is kept, or the size of an arm that has none.

    Returns
    -------
    SingularityReport or SingularityReports
        The latter for a batch: the same fields with its leading axes.

    See Also
    --------
    nearest_singular_posture : the singular posture that is nearest.
    singularity_free : a proof for whole intervals.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 5.4 and 5.8.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import singularity_report
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> report = singularity_report(puma, [0.3, 0.5, -1.2, 0.4, 0.0, 0.2], length=0.283)
    >>> report.rank, report.kinds
    (5, ('wrist',))
    >>> postures = [[0.3, 0.5, -1.2, 0.4, 0.0, 0.2], [0.3, 0.5, -1.2, 0.4, 0.6, 0.2]]
    >>> reports = singularity_report(puma, postures, length=0.283)
    >>> reports.rank, reports.singular
    (array([5, 6]), array([ True, False]))
    """
    q = as_joint_values(chain, q)
    if q.ndim == 1:
        return posture_report(chain, q, point=point, length=length)
    return _many(chain, _measured(chain, q, point, length), q.shape[:-1])


def posture_report(
    chain: SerialChain, q: Array, *, point: ArrayLike = TIP, length: float | None = None
) -> SingularityReport:
    """Return :func:`singularity_report` of one posture, q (n,)."""
    found = _measured(chain, q, point, length)
    (values,), (numbers,), (twists,), (free,) = found[:4]
    rank, count = found.counts[0].tolist()
    singular = rank < found.rank
    manipulability, condition, normalised, *others = numbers.tolist()
    named = dict(zip(found.names, others[: MOVING - FACTORS], strict=False))
    return SingularityReport(
        singular_values=values,
        rank=rank,
        length=found.length,
        manipulability=manipulability,
        condition_number=math.inf if singular else condition,
        normalised_condition_number=math.inf if singular else normalised,
        lost_directions=twists[0, :count],
        idle_wrenches=twists[1, rank:],
        self_motions=free[rank:],
        factors=named,
        kinds=_kinds(chain, named, others[MOVING - FACTORS :]) if singular else (),
    )


class _Measured(NamedTuple):
    """Kernel results for m postures, and the arm's data that they used."""

    values: Array
    numbers: Array
    twists: Array
    free: Array
    counts: IntArray
    length: float
    rank: int
    names: tuple[str, ...]


def _measured(chain: SerialChain, q: Array, point: ArrayLike, length: float | None) -> _Measured:
    """Measure postures (..., n) in one compiled loop."""
    arm, metres = as_point(point), scaling_length(chain, length)
    (rank, motions), parts, n = generic_motions(chain), named_parts(chain), chain.n
    rows = q[None] if q.ndim == 1 else as_rows(q)
    m, place = len(rows), np.array((*arm.tolist(), metres, parts.size))
    out = (np.empty((m, min(6, n))), np.empty((m, MOVING + n)), np.empty((m, 2, 6, 6)))
    free, counts = np.empty((m, n, n)), np.empty((m, 2), np.int64)
    constants = (place, parts.joints, motions, rank)
    if _compiled(chain.packed, rows, *constants, *out, free, counts):
        raise_not_finite(chain, q)
    return _Measured(*out, free, counts, metres, rank, parts.names)


def _many(chain: SerialChain, found: _Measured, batch: tuple[int, ...]) -> SingularityReports:
    values, numbers, twists, free, counts, metres, generic, names = found
    m, n = len(values), chain.n
    rank, count = counts.T
    singular = rank < generic
    manipulability, condition, normalised = numbers[:, :FACTORS].T
    condition = np.where(singular, math.inf, condition)
    normalised = np.where(singular, math.inf, normalised)
    factors = dict(zip(names, numbers[:, FACTORS:MOVING].T, strict=False))
    kinds = np.empty(m, dtype=object)
    for k in range(m):
        here = {name: float(one[k]) for name, one in factors.items()} if singular[k] else {}
        kinds[k] = _kinds(chain, here, numbers[k, MOVING:].tolist()) if singular[k] else ()
    return SingularityReports(
        singular_values=values.reshape(*batch, values.shape[1]),
        rank=rank.reshape(batch),
        length=metres,
        manipulability=manipulability.reshape(batch),
        condition_number=condition.reshape(batch),
        normalised_condition_number=normalised.reshape(batch),
        lost_directions=_padded(twists[:, 0], np.zeros(m, np.int64), count, batch),
        idle_wrenches=_padded(twists[:, 1], rank, np.full(m, 6), batch),
        self_motions=_padded(free, rank, np.full(m, n), batch),
        factors={name: one.reshape(batch) for name, one in factors.items()},
        kinds=kinds.reshape(batch),
    )


def _padded(rows: Array, first: IntArray, end: IntArray, batch: tuple[int, ...]) -> Array:
    """Move rows from the first to before the end (m,) of each of (m, k, w) up, and add NaN."""
    k = rows.shape[1]
    index = first[:, None] + np.arange(k)
    moved = np.take_along_axis(rows, np.minimum(index, k - 1)[:, :, None], axis=1)
    padded: Array = np.where((index < end[:, None])[:, :, None], moved, np.nan)
    return padded.reshape(*batch, *rows.shape[1:])


def _kinds(chain: SerialChain, factors: dict[str, float], moving: list[float]) -> tuple[str, ...]:
    """Name the parts that are singular, or else the joints that depend on each other."""
    zero = tuple(name for name, value in factors.items() if abs(value) < FACTOR_ZERO)
    if zero:
        return zero
    pairs = zip(chain.joint_names, moving, strict=True)
    names = [name for name, most in pairs if most > FACTOR_ZERO]
    return (f"joints {', '.join(names)} depend on each other",)
