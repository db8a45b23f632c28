"""The Jacobian of serial chains."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.chain import serial
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


def jacobian(chain: SerialChain, q: ArrayLike) -> Array:
    r"""Compute the matrix that maps joint rates to the twist of the tip.

    .. math::

       t = \begin{bmatrix} \omega \\ v \end{bmatrix} = J \dot q, \qquad
       j_i = \begin{bmatrix} e_i \\ e_i \times (p - o_i) \end{bmatrix} \text{ or }
       \begin{bmatrix} 0 \\ e_i \end{bmatrix}

    for a revolute and a prismatic joint: :math:`e_i` its axis, :math:`o_i` a point of it, p the
    tip's origin.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.

    Returns
    -------
    ndarray, shape (6, n) or (..., 6, n)
        Angular rows first; at the tip's origin, in the axes of the base (1 and m).

    See Also
    --------
    point_jacobian : at another point of the tip link, in other axes.
    task_jacobian : some of the rows.
    jacobian_rate : the time derivative.
    joint_rates : the rates that give a twist.
    joint_torques : the torques that give a wrench.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 5.2 and 5.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import jacobian
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> J = jacobian(puma, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2])
    >>> np.round(J[:3], 3) + 0.0
    array([[ 0.   ,  0.296,  0.296,  0.615,  0.557,  0.029],
           [ 0.   , -0.955, -0.955,  0.19 , -0.792, -0.284],
           [ 1.   ,  0.   ,  0.   ,  0.765, -0.251,  0.959]])
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
