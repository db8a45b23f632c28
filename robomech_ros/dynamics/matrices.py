"""The mass matrix and the Coriolis matrix of serial chains."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics import mass as kernels
from robomech_ros.dynamics.model import dynamic_model, raise_outcome
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, as_states
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike

_mass_one = direct(kernels.mass_matrix_one)


def mass_matrix(chain: SerialChain, q: ArrayLike) -> Array:
    r"""Compute the mass matrix M, the generalised inertia, which gives the kinetic energy.

    .. math:: T = \tfrac12\, \dot q^T M(q)\, \dot q

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, with the bodies that they move.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.

    Returns
    -------
    ndarray, shape (n, n) or (..., n, n)
        Symmetric (kg m^2, kg m or kg), with the rotors' inertia reflected to the joints on the
        diagonal.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5; Walker, Orin, ASME J.
    Dynamic Systems, Measurement and Control 104, 1982.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import mass_matrix
    >>> from robomech_ros.robots import load_robot
    >>> np.round(mass_matrix(load_robot("planar3r"), [0.3, -0.7, 1.1]), 3)
    array([[6.994, 2.526, 0.404],
           [2.526, 1.225, 0.174],
           [0.404, 0.174, 0.083]])
    """
    q = as_joint_values(chain, q)
    model, n = dynamic_model(chain), chain.n
    if q.ndim == 1:
        M = np.empty((n, n))
        status = _mass_one(model, q, M)
    else:
        rows = as_rows(q)
        M = np.empty((len(rows), n, n))
        status = kernels.mass_matrix(model, rows, M)
        M = M.reshape(*q.shape, n)
    if status:
        raise_outcome(chain, status, q=q)
    return M


def coriolis_matrix(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    r"""Compute the matrix C of the Coriolis and centrifugal torques ``C qd``.

    Of the many with this product it is the one by Christoffel's symbols, with which the rate of the
    mass matrix less 2 C is skew.

    .. math::

       C_{ij} = \frac12 \sum_k \left( \frac{\partial M_{ij}}{\partial q_k}
       + \frac{\partial M_{ik}}{\partial q_j} - \frac{\partial M_{jk}}{\partial q_i} \right)
       \dot q_k

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, with the bodies that they move.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    qd : array_like, of the same shape
        Joint rates (rad/s or m/s).

    Returns
    -------
    ndarray, shape (n, n) or (..., n, n)

    References
    ----------
    Echeandia, Wensing, ASME J. Computational and Nonlinear Dynamics 16, 2021; Angeles, Fundamentals
    of Robotic Mechanical Systems, 4th ed., section 7.5.
    """
    q, qd = as_states(chain, ("q", "qd"), q, qd)
    rows = as_rows(q)
    model = dynamic_model(chain)
    C = np.empty((len(rows), len(model) - 1, len(model) - 1))
    rates = chain.joint_rates(as_rows(qd))
    status = kernels.coriolis_matrix(model, chain.joint_values(rows), rates, C)
    if status:
        raise_outcome(chain, status, q=q, qd=qd)
    return chain.drive_matrix(C).reshape(*q.shape, chain.n)
