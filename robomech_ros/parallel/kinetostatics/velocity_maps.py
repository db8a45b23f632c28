"""Velocities and accelerations between the drives and the platform: K t = J qd and its rate."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import BadValueError
from robomech_ros.parallel.kinetostatics.limb_geometry import (
    Limbs,
    limbs_holding,
    motion_basis,
    motion_entries,
    motions_of,
)
from robomech_ros.parallel.kinetostatics.limb_wrenches import Wrenches
from robomech_ros.parallel.kinetostatics.mechanism_motion import (
    mechanism_drive_accelerations,
    mechanism_matrix_rates,
    mechanism_platform_acceleration,
)
from robomech_ros.parallel.kinetostatics.square_systems import one_each, solved_columns
from robomech_ros.parallel.library import AnyParallelRobot
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.typing import Array, ArrayLike

_TWIST = 6
# Entries of a twist that are less than this, of the largest, are zero.
_ROUNDING = 1e-9
# Part of a motion that limbs prevent and that is rounding.
_PREVENTED = 1e-6


class VelocityMatrices(NamedTuple):
    """The matrices of K t = J qd, or their rates.

    Attributes
    ----------
    K : ndarray, shape (..., m, 6)
        Of the platform's twist [angular; linear] at its origin, in the base.
    J : ndarray, shape (..., m, m)
        Of the rates of the drives: diagonal, of a limb each.
    motions : tuple of int
        Entries of the twist that the platform has, m of them; the others are always zero.  With
        limbs of any kind more than m may depend on each other in a posture.
    """

    K: Array
    J: Array
    motions: tuple[int, ...]


def velocity_matrices(
    robot: AnyParallelRobot, T: ArrayLike, q: ArrayLike | None = None
) -> VelocityMatrices:
    r"""Find the matrices of :math:`K t = J \dot q`, a row for each limb.

    ========== ===================================== ===========================
    robot      row of K                              entry of J
    ========== ===================================== ===========================
    leg        :math:`[(R b_i \times n_i)^T, n_i^T]` 1
    two links  the same, :math:`n_i` of the second   :math:`n_i \cdot c_i'`
    two arcs   :math:`[(v_i \times w_i)^T, 0]`       :math:`e_i \cdot v_i \times w_i`
    ========== ===================================== ===========================

    with the directions :math:`n_i` of legs and second links, the derivatives :math:`c_i'` of the
    joints between the links by the drives, and the axes :math:`e_i, w_i, v_i` of a spherical limb;
    its row is divided by the sine of its second arc.

    Of a mechanism a row is, for each drive, the wrench on the platform that it bears: one that does
    no work on the other joints of its limb, of force 1, or of moment 1 if it is a couple, as it
    works on motions that the platform has.  Signs are such that no entry of J is negative.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR, Spherical3RRR or Mechanism
        Of m drives.
    T : array_like, shape (..., 4, 4)
        ``T_base_platform``; a Delta also takes positions (..., 3), planar robots x, y and the
        angle, and a spherical one rotations (..., 3, 3).
    q : array_like, shape (..., m)
        Angles of the drives there (rad), one of the postures that ``inverse`` finds; robots with
        legs need none.  Of a mechanism all joints (rad or m), shape (..., n), with closed loops.

    Raises
    ------
    BadValueError
        Not poses that the platform can have, or drives that do not hold it there: the drive and the
        amount are named.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.1.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import load_parallel, velocity_matrices
    >>> robot = load_parallel("delta")
    >>> K, J, motions = velocity_matrices(robot, [0, 0, -0.9], robot.inverse([0, 0, -0.9]).q[0])
    >>> np.round(np.linalg.solve(J, K[:, motions] @ [0.0, 0.0, 0.1]), 4)
    array([-0.2583, -0.2583, -0.2583])
    """
    limbs = limbs_holding(robot, T, q)
    K, J = limbs.rows()
    return VelocityMatrices(K, _diagonal(J), motion_entries(robot, limbs))


def velocity_matrix_rates(
    robot: AnyParallelRobot, T: ArrayLike, twist: ArrayLike, q: ArrayLike | None = None
) -> VelocityMatrices:
    r"""Find the time derivatives of both :func:`velocity_matrices` while the platform moves.

    .. math:: K \dot t + \dot K t = J \ddot q + \dot J \dot q

    Parameters
    ----------
    robot, T, q
        As for :func:`velocity_matrices`.
    twist : array_like, shape (..., 6)
        Angular velocity, then velocity of the platform's origin, in the base (rad/s and m/s).

    Returns
    -------
    VelocityMatrices
        NaN where a limb is singular, so that its drive has no rate.  Of a mechanism found by
        differences, to 1e-9 or so of the largest entry, and NaN in all singular postures.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.1.
    """
    limbs = limbs_holding(robot, T, q)
    K, J = limbs.rows()
    t = _twist(robot, "twist", twist, limbs)
    rates = _divided(_times(K, t), J, limbs.lever)
    if isinstance(limbs, Wrenches):
        assert isinstance(robot, Mechanism)
        dK, dJ = mechanism_matrix_rates(robot, np.asarray(q, dtype=float), rates)
    else:
        dK, dJ = limbs.row_rates(t, rates)
    return VelocityMatrices(dK, _diagonal(dJ), motion_entries(robot, limbs))


def drive_rates(
    robot: AnyParallelRobot, T: ArrayLike, twist: ArrayLike, q: ArrayLike | None = None
) -> Array:
    r"""Find the rates of the drives for a twist of the platform: :math:`\dot q = J^{-1} K t`.

    Parameters
    ----------
    robot, T, twist, q
        As for :func:`velocity_matrix_rates`.

    Returns
    -------
    ndarray, shape (..., m)
        In m/s or rad/s; NaN for a drive whose limb is singular.
    """
    limbs = limbs_holding(robot, T, q)
    K, J = limbs.rows()
    return _divided(_times(K, _twist(robot, "twist", twist, limbs)), J, limbs.lever)


def platform_twist(
    robot: AnyParallelRobot, T: ArrayLike, rates: ArrayLike, q: ArrayLike | None = None
) -> Array:
    r"""Find the platform's twist for rates of the drives: :math:`t = K^{-1} J \dot q`.

    Parameters
    ----------
    robot, T, q
        As for :func:`velocity_matrices`.
    rates : array_like, shape (..., m)
        Rates of the drives (m/s or rad/s).

    Returns
    -------
    ndarray, shape (..., 6)
        Angular velocity, then velocity of the platform's origin, in the base (rad/s and m/s); NaN
        where the pose is singular, so that the drives do not determine it.
    """
    limbs = limbs_holding(robot, T, q)
    J = limbs.rows()[1]
    return _solved(robot, limbs, J * one_each("rates", rates, J.shape[-1], J))


def drive_accelerations(
    robot: AnyParallelRobot,
    T: ArrayLike,
    twist: ArrayLike,
    twist_rate: ArrayLike,
    q: ArrayLike | None = None,
) -> Array:
    r"""Find the accelerations of the drives for those of the platform.

    .. math:: J \ddot q = K \dot t + \dot K t - \dot J \dot q

    Parameters
    ----------
    robot, T, twist, q
        As for :func:`velocity_matrix_rates`.
    twist_rate : array_like, shape (..., 6)
        Angular acceleration, then acceleration of the platform's origin (rad/s^2 and m/s^2).

    Returns
    -------
    ndarray, shape (..., m)
        In m/s^2 or rad/s^2; NaN for a drive whose limb is singular.
    """
    limbs = limbs_holding(robot, T, q)
    K, J = limbs.rows()
    t = _twist(robot, "twist", twist, limbs)
    if isinstance(limbs, Wrenches):
        dt = one_each("twist_rate", twist_rate, _TWIST, J)
        work = mechanism_drive_accelerations(robot, q, limbs, t, dt)
        return _divided(work, J, limbs.lever)
    dt = _twist(robot, "twist_rate", twist_rate, limbs)
    qd = _divided(_times(K, t), J, limbs.lever)
    dK, dJ = limbs.row_rates(t, qd)
    return _divided(_times(K, dt) + _times(dK, t) - dJ * qd, J, limbs.lever)


def platform_acceleration(
    robot: AnyParallelRobot,
    T: ArrayLike,
    rates: ArrayLike,
    accelerations: ArrayLike,
    q: ArrayLike | None = None,
) -> Array:
    r"""Find the platform's acceleration for rates and accelerations of the drives.

    .. math:: K \dot t = J \ddot q + \dot J \dot q - \dot K t

    Parameters
    ----------
    robot, T, rates, q
        As for :func:`platform_twist`.
    accelerations : array_like, shape (..., m)
        Accelerations of the drives (m/s^2 or rad/s^2).

    Returns
    -------
    ndarray, shape (..., 6)
        Angular acceleration, then acceleration of the platform's origin (rad/s^2 and m/s^2); NaN
        where the pose is singular.
    """
    limbs = limbs_holding(robot, T, q)
    J = limbs.rows()[1]
    qd = one_each("rates", rates, J.shape[-1], J)
    qdd = one_each("accelerations", accelerations, J.shape[-1], J)
    t = _solved(robot, limbs, J * qd)
    if isinstance(limbs, Wrenches):
        work, rest = mechanism_platform_acceleration(robot, q, limbs, t)
        return rest + _solved(robot, limbs, J * qdd + work)
    dK, dJ = limbs.row_rates(t, qd)
    return _solved(robot, limbs, J * qdd + dJ * qd - _times(dK, t))


def _diagonal(entries: Array) -> Array:
    return np.asarray(entries[..., None] * np.eye(entries.shape[-1]))


def _times(K: Array, t: Array) -> Array:
    return np.asarray((K @ t[..., None])[..., 0])


def _divided(values: Array, J: Array, lever: Array) -> Array:
    """Divide by the entries of J; NaN where a limb is singular."""
    regular = np.abs(J) > RANK * lever
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(regular, values / J, np.nan)


def _solved(robot: AnyParallelRobot, limbs: Limbs, values: Array) -> Array:
    """Solve K t = values for the motions that the platform has; NaN where it is singular."""
    S = motion_basis(robot, limbs)
    found = _times(S, solved_columns(limbs.rows()[0] @ S, values))
    found[..., ~np.isin(range(_TWIST), motion_entries(robot, limbs))] = 0.0
    return found


def _twist(robot: AnyParallelRobot, what: str, twist: ArrayLike, limbs: Limbs) -> Array:
    """Check twists: one for all poses or one for each, only with motions that there are."""
    t = one_each(what, twist, _TWIST, limbs.rows()[1])
    if isinstance(limbs, Wrenches):
        _check_allowed(what, t, limbs)
        return t
    motions = motions_of(robot)
    worst = float(np.abs(t[..., ~np.isin(range(_TWIST), motions)]).max(initial=0.0))
    if worst > _ROUNDING * float(np.abs(t).max(initial=0.0)):
        why = f"0 except in entries {', '.join(str(k + 1) for k in motions)}: the platform moves so"
        raise BadValueError(f"{what}, an entry of it", worst, why)
    return t


def _check_allowed(what: str, t: Array, limbs: Wrenches) -> None:
    scaled = t * np.repeat([limbs.size, 1.0], 3)
    S = limbs.motions(limbs.size)
    off = scaled - _times(S, _times(np.swapaxes(S, -1, -2), scaled))
    worst = float(np.abs(off).max(initial=0.0))
    if worst > _PREVENTED * float(np.abs(scaled).max(initial=0.0)):
        why = "0: the platform does not have it in this posture"
        raise BadValueError(f"{what}, the part of it that limbs prevent (m/s)", worst, why)
