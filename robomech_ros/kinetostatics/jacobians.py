"""The Jacobian of serial chains."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.chain import serial
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.robots.chain import SerialChain

__all__ = ["jacobian"]

Array = NDArray[np.float64]


def jacobian(chain: SerialChain, q: ArrayLike) -> Array:
    """Compute the matrix that maps joint rates to the twist of the tip.

    ``[omega; v] = J qd`` with column ``[e; e x (p - o)]`` for a revolute and ``[0; e]`` for a
    prismatic joint: e its axis, o a point of it, p the tip's origin.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.

    Returns
    -------
    ndarray, shape (6, n) or (..., 6, n)
        Angular rows first; at the tip's origin, in the axes of the base (1 and m).

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        q is not an array of n finite real numbers, or of rows of them.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 5.
    """
    q = as_joint_values(chain, q)
    pose = np.empty((4, 4))
    if q.ndim == 1:
        J = np.empty((6, chain.n))
        if serial.jacobian_one(chain.packed, q, J, pose):
            raise_not_finite(chain, q)
        return J
    rows = as_rows(q)
    matrices = np.empty((len(rows), 6, chain.n))
    if serial.jacobian(chain.packed, rows, matrices, pose):
        raise_not_finite(chain, q)
    return matrices.reshape(*q.shape[:-1], 6, chain.n)
