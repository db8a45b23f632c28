"""The Euler-Lagrange formulation, from the poses of the bodies and their derivatives alone.

With the pose ``A_i`` (4 x 4) of body i and its pseudo-inertia ``J_i``, the integral of p p^T dm
over its points ``p = (x, y, z, 1)``, the kinetic energy is the sum of ``tr(A_i' J_i A_i'^T) / 2``,
A_i' the rate of A_i.  Poses are differentiated exactly: ``dA_i/dq_j = S_j A_i`` for j <= i, S_j the
4 x 4 matrix of the axis.  No velocity or acceleration of a body is formed.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.3.2.
Uicker, On the dynamic analysis of spatial linkages using 4x4 matrices, Ph.D. thesis, Northwestern
University, 1965.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import as_screw, as_vector, finite_result, finite_states
from robomech_ros.dynamics.complement.stacking import solve, times
from robomech_ros.dynamics.model import GRAVITY, body_parameters
from robomech_ros.dynamics.posed_bodies import reflected_inertias
from robomech_ros.dynamics.pseudo_inertias import pseudo_inertia
from robomech_ros.kinematics.forward_uncompiled import link_transforms
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.spatial.cross_product import cross_product_matrix
from robomech_ros.typing import Array, ArrayLike


@finite_result
def mass_matrix_gradient(chain: SerialChain, q: ArrayLike) -> Array:
    """Differentiate the mass matrix by the joint values.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, with the inertia of all its bodies.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).

    Returns
    -------
    ndarray, shape (..., n, n, n)
        ``[..., i, j, k]`` is the derivative of entry (i, j) by q_k.

    Raises
    ------
    MissingInertiaError
        Of some joints nothing is known that moves with them.
    """
    (q,) = finite_states(chain, q=q)
    return _gradient(_derivatives(chain, q))


@finite_result
def christoffel_symbols(chain: SerialChain, q: ArrayLike) -> Array:
    r"""Compute the Christoffel symbols of the first kind of the mass matrix.

    .. math::

       c_{ijk} = \frac12 \left( \frac{\partial M_{ij}}{\partial q_k}
       + \frac{\partial M_{ik}}{\partial q_j} - \frac{\partial M_{jk}}{\partial q_i} \right)

    Entry (i, j) of the Coriolis matrix is the sum of :math:`c_{ijk}\, \dot q_k` over k.

    Parameters
    ----------
    chain, q
        As for :func:`mass_matrix_gradient`.

    Returns
    -------
    ndarray, shape (..., n, n, n)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.3.2.
    """
    return _symbols(mass_matrix_gradient(chain, q))


@finite_result
def inverse_dynamics_by_lagrange(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
) -> Array:
    r"""Compute torques from the energies, by the Euler-Lagrange equations.

    .. math::

       \tau = \frac{d}{dt} \frac{\partial T}{\partial \dot q} - \frac{\partial T}{\partial q}
       + \frac{\partial V}{\partial q}

    with the kinetic and potential energies T and V.

    Without the friction of the drives, as :func:`inverse_dynamics`: add :func:`friction_torque`,
    the derivative of :func:`dissipation` by the rates.

    Parameters
    ----------
    chain, q, qd, qdd, gravity, tip_wrench
        As for :func:`inverse_dynamics`; the wrench is the same in all states of a batch.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Torques or forces that the drives exert on the joints (N m or N).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.3.2.
    """
    q, qd, qdd = finite_states(chain, q=q, qd=qd, qdd=qdd)
    derivatives = _derivatives(chain, q)
    bias = _bias(derivatives, qd, gravity, tip_wrench)
    return times(_mass_matrix(chain, derivatives), qdd) + bias


@finite_result
def forward_dynamics_by_lagrange(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
) -> Array:
    """Solve the Euler-Lagrange equations for the joint accelerations.

    Without the friction of the drives, as :func:`forward_dynamics`.

    Parameters
    ----------
    chain, q, qd, tau, gravity, tip_wrench
        As for :func:`forward_dynamics`; the wrench is the same in all states of a batch.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Accelerations (rad/s^2 or m/s^2).
    """
    q, qd, tau = finite_states(chain, q=q, qd=qd, tau=tau)
    derivatives = _derivatives(chain, q)
    moving = tau - _bias(derivatives, qd, gravity, tip_wrench)
    return solve(_mass_matrix(chain, derivatives), moving)


@dataclass(frozen=True, eq=False)
class _Derivatives:
    """Poses by the drives, once (..., i, j, 4, 4) and twice (..., i, j, k, 4, 4), and the rest.

    ``screws`` are the matrices S_j (..., n, 4, 4), ``tip`` the tip's origin (..., 3).
    """

    once: Array
    twice: Array
    screws: Array
    tip: Array
    pseudo: Array


def _derivatives(chain: SerialChain, q: Array) -> _Derivatives:
    pseudo = pseudo_inertia(body_parameters(chain))
    A, types = link_transforms(chain, q), chain.uncoupled.types
    m, batch = len(types), q.shape[:-1]
    S = np.zeros((*batch, m, 4, 4))
    for j in range(m):
        e, o = A[..., j, :3, 2], A[..., j, :3, 3]
        if types[j] == REVOLUTE:
            S[..., j, :3, :3] = cross_product_matrix(e)
            S[..., j, :3, 3] = np.cross(o, e)
        else:
            S[..., j, :3, 3] = e
    once = np.zeros((*batch, m, m, 4, 4))
    twice = np.zeros((*batch, m, m, m, 4, 4))
    for i in range(m):
        for j in range(i + 1):
            once[..., i, j, :, :] = S[..., j, :, :] @ A[..., i, :, :]
        for k in range(i + 1):
            for j in range(k + 1):
                product = S[..., j, :, :] @ once[..., i, k, :, :]
                twice[..., i, j, k, :, :] = twice[..., i, k, j, :, :] = product
    if chain.coupling is not None:
        by_drive = chain.coupling.matrix
        S = np.einsum("...jab,jk->...kab", S, by_drive)
        once = np.einsum("...ijab,jk->...ikab", once, by_drive)
        twice = np.einsum("...ijkab,jr,ks->...irsab", twice, by_drive, by_drive, optimize=True)
    return _Derivatives(once, twice, S, A[..., m, :3, 3], pseudo)


def _mass_matrix(chain: SerialChain, derivatives: _Derivatives) -> Array:
    once, J = derivatives.once, derivatives.pseudo
    matrix = np.einsum("...ijab,ibc,...ikac->...jk", once, J, once, optimize=True)
    return matrix + np.diag(reflected_inertias(chain))


def _gradient(derivatives: _Derivatives) -> Array:
    half = np.einsum(
        "...mikab,mbc,...mjac->...ijk",
        derivatives.twice,
        derivatives.pseudo,
        derivatives.once,
        optimize=True,
    )
    return half + np.swapaxes(half, -3, -2)


def _symbols(gradient: Array) -> Array:
    """Return c_ijk from D_ijk = dI_ij/dq_k: (D_ijk + D_ikj - D_jki) / 2."""
    swapped = np.swapaxes(gradient, -1, -2)
    return 0.5 * (gradient + swapped - np.moveaxis(gradient, -1, -3))


def _bias(
    derivatives: _Derivatives, qd: Array, gravity: ArrayLike, tip_wrench: ArrayLike | None
) -> Array:
    """Torques for vanishing accelerations: of rates, weight and the tip's wrench."""
    symbols = _symbols(_gradient(derivatives))
    coriolis = np.einsum("...ijk,...j,...k->...i", symbols, qd, qd)
    # V is the sum of -g . (mass times mass centre), and the last column of J_i is the latter.
    moments = np.einsum(
        "...ijab,ib->...ja", derivatives.once[..., :3, :], derivatives.pseudo[:, :, 3]
    )
    weight = -moments @ as_vector("gravity", gravity, 3)
    wrench = as_screw("tip_wrench", tip_wrench)
    S, point = derivatives.screws, derivatives.tip
    velocity = np.einsum("...jab,...b->...ja", S[..., :3, :3], point) + S[..., :3, 3]
    turn = np.stack((S[..., 2, 1], S[..., 0, 2], S[..., 1, 0]), axis=-1)
    given = turn @ wrench[:3] + velocity @ wrench[3:]
    return coriolis + weight - given
