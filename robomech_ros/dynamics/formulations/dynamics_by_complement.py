"""Inverse and forward dynamics by the natural orthogonal complement."""

from __future__ import annotations

import numpy as np

from robomech_ros.dynamics.checked_states import finite_result, finite_states
from robomech_ros.dynamics.complement.stacking import mass_roots, solve, transposed
from robomech_ros.dynamics.formulations.orthogonal_complement import (
    OrthogonalComplement,
    natural_orthogonal_complement,
)
from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.dynamics.posed_bodies import reflected_inertias
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


@finite_result
def inverse_dynamics_by_orthogonal_complement(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> Array:
    """Compute the torques of a motion from ``I qdd + C qd`` and what acts on the bodies.

    Without the friction of the drives, as :func:`inverse_dynamics`: add :func:`friction_torque`.

    Parameters
    ----------
    chain, q, qd, qdd, gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`inverse_dynamics`; each of the last three is the same in all states of a
        batch.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Torques or forces that the drives exert on the joints (N m or N).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5.
    """
    q, qd, qdd = finite_states(chain, q=q, qd=qd, qdd=qdd)
    motion = {"base_twist": base_twist, "base_twist_rate": base_twist_rate}
    model = natural_orthogonal_complement(chain, q, qd, **motion)
    return model.inverse(qdd, _applied(model, gravity, tip_wrench))


@finite_result
def forward_dynamics_by_cholesky(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> Array:
    r"""Compute joint accelerations by the Cholesky factors of the generalised inertia.

    .. math:: I = L L^T, \qquad L x = \tau - \bar\tau, \qquad L^T \ddot q = x

    Without the friction of the drives, as :func:`forward_dynamics`.

    Parameters
    ----------
    chain, q, qd, tau, gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`forward_dynamics`; each of the last three is the same in all states of a
        batch.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Accelerations (rad/s^2 or m/s^2).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.6.
    """
    q, qd, tau = finite_states(chain, q=q, qd=qd, tau=tau)
    motion = {"base_twist": base_twist, "base_twist_rate": base_twist_rate}
    model = natural_orthogonal_complement(chain, q, qd, **motion)
    return model.forward(tau, _applied(model, gravity, tip_wrench))


@finite_result
def forward_dynamics_by_reflections(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> Array:
    r"""Compute joint accelerations without the generalised inertia, whose condition is squared.

    .. math:: M = H^T H, \qquad P = H T, \qquad I = P^T P = U^T U

    with the upper triangle U that Householder's reflections make of P.  A rotor is one more row.

    Without the friction of the drives, as :func:`forward_dynamics`.

    Parameters
    ----------
    chain, q, qd, tau, gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`forward_dynamics`; each of the last three is the same in all states of a
        batch.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Accelerations (rad/s^2 or m/s^2).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.6.
    """
    q, qd, tau = finite_states(chain, q=q, qd=qd, tau=tau)
    motion = {"base_twist": base_twist, "base_twist_rate": base_twist_rate}
    model = natural_orthogonal_complement(chain, q, qd, **motion)
    bias = model.inverse(np.zeros_like(tau), _applied(model, gravity, tip_wrench))
    rotors = np.broadcast_to(np.diag(np.sqrt(reflected_inertias(chain))), (*q.shape, chain.n))
    P = np.concatenate((mass_roots(model.masses, model.inertias) @ model.T, rotors), axis=-2)
    U = np.asarray(np.linalg.qr(P, mode="r"), dtype=np.float64)
    return solve(U, solve(transposed(U), tau - bias))


def _applied(
    model: OrthogonalComplement, gravity: ArrayLike, tip_wrench: ArrayLike | None
) -> Array:
    """Wrenches on the bodies, of their weights and at the tip."""
    return model.gravity_wrenches(gravity) + model.tip_wrenches(tip_wrench)
