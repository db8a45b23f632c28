"""Forces of the drives and the wrench of the platform."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.parallel.kinetostatics.limb_geometry import (
    limbs_holding,
    motion_basis,
    motion_entries,
)
from robomech_ros.parallel.kinetostatics.square_systems import one_each, solved_columns
from robomech_ros.parallel.library import AnyParallelRobot
from robomech_ros.typing import Array, ArrayLike

_WRENCH = 6


def drive_forces(
    robot: AnyParallelRobot, T: ArrayLike, exerted_wrench: ArrayLike, q: ArrayLike | None = None
) -> Array:
    r"""Compute the forces of the drives with which a resting platform exerts a wrench.

    .. math:: w = K^T \lambda, \qquad \tau = J^T \lambda

    In motion :math:`\tau \cdot \dot q = w \cdot t` is the power that goes to the surroundings.
    The weight of platform and limbs is not in it.  What a wrench has in directions in which the
    platform does not move is carried by the limbs and loads no drive.

    Parameters
    ----------
    robot, T, q
        As for :func:`velocity_matrices`.
    exerted_wrench : array_like, shape (..., 6)
        Moment about the platform's origin, then force, of the platform on its surroundings, in the
        base (N m and N); one for all poses or one for each.

    Returns
    -------
    ndarray, shape (..., m)
        Forces of legs, pushing, or torques (N or N m), as the drives exert them; NaN where the pose
        is singular, so that the limbs hold no wrench of some direction.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import drive_forces, load_parallel
    >>> hexapod, T = load_parallel("hexapod"), np.eye(4)
    >>> T[2, 3] = 0.508
    >>> np.round(drive_forces(hexapod, T, [0.0, 0.0, 0.0, 0.0, 0.0, 100.0]), 3)
    array([24.789, 24.789, 24.789, 24.789, 24.789, 24.789])
    """
    limbs = limbs_holding(robot, T, q)
    K, J = limbs.rows()
    w = one_each("exerted_wrench", exerted_wrench, _WRENCH, J)
    S = motion_basis(robot, limbs)
    square = np.swapaxes(K @ S, -1, -2)
    return np.asarray(J * solved_columns(square, (w[..., None, :] @ S)[..., 0, :], rows=True))


def platform_wrench(
    robot: AnyParallelRobot, T: ArrayLike, forces: ArrayLike, q: ArrayLike | None = None
) -> Array:
    """Compute the wrench that a resting platform exerts with given forces of the drives.

    The inverse of :func:`drive_forces`, for directions in which the platform moves.

    Parameters
    ----------
    robot, T, q
        As for :func:`velocity_matrices`.
    forces : array_like, shape (..., m)
        Forces of legs, pushing, or torques of the drives (N or N m).

    Returns
    -------
    ndarray, shape (..., 6)
        Moment about the platform's origin, then force, of the platform on its surroundings, in the
        base (N m and N); NaN where a limb is singular and would hold every load.
    """
    limbs = limbs_holding(robot, T, q)
    K, J = limbs.rows()
    tau = one_each("forces", forces, J.shape[-1], J)
    regular = (np.abs(J) > RANK * limbs.lever).all(axis=-1, keepdims=True)
    motions = list(motion_entries(robot, limbs))
    with np.errstate(divide="ignore", invalid="ignore"):
        carried = np.einsum("...ij,...i->...j", K[..., motions], tau / J)
    out = np.zeros((*J.shape[:-1], _WRENCH))
    out[..., motions] = np.where(regular, carried, np.nan)
    return out
