"""The Jacobian of any point of the tip link, in the axes of any frame."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial import as_rotation
from robomech_ros.spatial.arrays import as_finite

__all__ = ["point_jacobian"]

Array = NDArray[np.float64]


def point_jacobian(
    chain: SerialChain, q: ArrayLike, point: ArrayLike, axes: ArrayLike | None = None
) -> Array:
    """Compute the matrix that maps joint rates to the twist of a point of the tip link.

    ``v_P = v + omega x r`` with r from the tip's origin to P, then both turned into the axes.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    q : array_like, shape (n,)
        Joint values (rad or m).
    point : array_like, shape (3,)
        P, fixed to the tip link, in the frame of the tip link (m).
    axes : array_like, shape (3, 3), optional
        Rotation ``R_base_axes`` of the frame in whose axes the twist is expressed; default the
        base.

    Returns
    -------
    ndarray, shape (6, n)
        Angular rows first (1 and m).

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`jacobian`, and for a point that is not three finite numbers or axes that are
        no rotation.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 5.
    """
    J = jacobian(chain, q)
    if J.ndim != 2:
        raise WrongSizeError("q", np.shape(q), (chain.n,))
    arm = as_finite("point", point, (3,))
    if arm.ndim != 1:
        raise WrongSizeError("point", arm.shape, (3,))
    r = forward_kinematics(chain, q)[:3, :3] @ arm
    omega, v = J[:3], J[3:] + np.cross(J[:3], r, axisa=0, axisc=0)
    if axes is None:
        return np.concatenate((omega, v))
    turn = as_rotation(axes, what="axes")
    if turn.ndim != 2:
        raise WrongSizeError("axes", turn.shape, (3, 3))
    turn = turn.T
    return np.concatenate((turn @ omega, turn @ v))
