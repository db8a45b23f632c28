"""Accelerations: how the Jacobian changes in time, of the tip, and of the joints."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels import jacobian_rates
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.robots.chain import SerialChain

__all__ = ["bias_acceleration", "jacobian_rate"]

Array = NDArray[np.float64]


def jacobian_rate(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    """Compute the time derivative of :func:`jacobian`.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    qd : array_like, of the same shape
        Joint rates (rad/s or m/s).

    Returns
    -------
    ndarray, shape (6, n) or (..., 6, n)
        Angular rows first, at the tip's origin, in the axes of the base (1/s and m/s).

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        q or qd is not an array of n finite real numbers or of rows of them, or they differ in
        shape.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.5.
    """
    q, qd = as_joint_values(chain, q), as_joint_values(chain, qd, "qd")
    if qd.shape != q.shape:
        raise WrongSizeError("qd", qd.shape, f"{q.shape}, that of q")
    if not np.isfinite(qd).all():
        raise_not_finite(chain, qd, "qd")
    rows = as_rows(q)
    out = np.empty((len(rows), 6, chain.n))
    J, pose = np.empty((6, chain.n)), np.empty((4, 4))
    if jacobian_rates.jacobian_rate(chain.packed, rows, as_rows(qd), J, pose, out):
        raise_not_finite(chain, q)
    return out.reshape(*q.shape[:-1], 6, chain.n)


def bias_acceleration(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    """Compute the part of the tip's twist rate that does not come from joint accelerations.

    The twist rate is ``J qdd`` plus this: the rate of J times qd.

    Parameters
    ----------
    chain, q, qd
        As for :func:`jacobian_rate`.

    Returns
    -------
    ndarray, shape (6,) or (..., 6)
        Angular (rad/s^2), then of the tip's origin (m/s^2), in the axes of the base.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`jacobian_rate`.
    """
    rate = jacobian_rate(chain, q, qd)
    bias: Array = np.einsum("...ij,...j->...i", rate, np.asarray(qd, dtype=np.float64))
    return bias
