"""Kane's equations: generalised active and inertia forces by partial velocities.

In the frames of the bodies: the velocities that a unit rate of one joint gives to a body are its
partial velocities, and for each joint the sum over the bodies of ``partial angular velocity .
(n - I alpha - omega x I omega) + partial velocity . (f - m a)`` vanishes.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.3.3.
Kane and Levinson, Dynamics: theory and applications, McGraw-Hill 1985, ch. 4 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import as_screw, as_vector, finite_result, finite_states
from robomech_ros.dynamics.complement.stacking import solve, times
from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.dynamics.posed_bodies import body_moments, reflected_inertias
from robomech_ros.kinematics.forward_uncompiled import link_transforms
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class PartialVelocities:
    """Derivatives of the velocities of bodies by the joint rates, in the frames of the bodies.

    Parameters
    ----------
    angular : ndarray, shape (..., m, n, 3)
        ``[..., i, j, :]`` of the angular velocity of body i by the rate of drive j.
    linear : ndarray, shape (..., m, n, 3)
        The same of the velocity of the mass centre.
    """

    angular: Array
    linear: Array


def partial_velocities(chain: SerialChain, q: ArrayLike) -> PartialVelocities:
    """Compute the partial velocities of all bodies: what unit rates of the joints give.

    Parameters
    ----------
    chain : SerialChain
        Chain of m joints moved by n drives, with the inertia of all its bodies.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).

    Raises
    ------
    MissingInertiaError
        Of some joints nothing is known that moves with them.
    """
    (q,) = finite_states(chain, q=q)
    return _partial_velocities(chain, _steps(chain, q))


@finite_result
def inverse_dynamics_by_kane(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
) -> Array:
    r"""Compute the torques with which Kane's equations hold.

    For each joint j, with all wrenches on the bodies that work,

    .. math::

       \sum_i \left[ \frac{\partial \omega_i}{\partial \dot q_j} \cdot
       (n_i - I_i \dot\omega_i - \omega_i \times I_i \omega_i)
       + \frac{\partial \dot c_i}{\partial \dot q_j} \cdot (f_i - m_i \ddot c_i) \right] = 0.

    Without the friction of the drives, as :func:`inverse_dynamics`: add :func:`friction_torque`.

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
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.3.3.
    """
    q, qd, qdd = finite_states(chain, q=q, qd=qd, qdd=qdd)
    steps = _steps(chain, q)
    partial = _partial_velocities(chain, steps)
    inertia_forces = _inertia_forces(chain, steps, partial, qd, qdd)
    active = _active_forces(chain, steps, partial, gravity, tip_wrench)
    rotors = reflected_inertias(chain) * qdd
    return rotors - inertia_forces - active


@finite_result
def forward_dynamics_by_kane(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
) -> Array:
    """Solve Kane's equations for the joint accelerations, in which they are linear.

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
    steps = _steps(chain, q)
    partial = _partial_velocities(chain, steps)
    active = tau + _active_forces(chain, steps, partial, gravity, tip_wrench)
    active = active + _inertia_forces(chain, steps, partial, qd, np.zeros_like(qd))
    masses, _, inertias = body_moments(chain)
    turning = np.einsum("...ija,iab,...ikb->...jk", partial.angular, inertias, partial.angular)
    moving = np.einsum("...ija,i,...ika->...jk", partial.linear, masses, partial.linear)
    coefficients = turning + moving + np.diag(reflected_inertias(chain))
    return solve(coefficients, active)


@dataclass(frozen=True, eq=False)
class _Steps:
    """Frames of neighbours seen from each other: R (..., m, 3, 3) from i to i - 1, o in i - 1.

    ``base`` (..., m, 3, 3) are the axes of the frames in the base, ``tip`` is the tip's origin in
    the last of them.
    """

    R: Array
    o: Array
    base: Array
    tip: Array


def _steps(chain: SerialChain, q: Array) -> _Steps:
    T = link_transforms(chain, q)
    before = np.empty_like(T)
    before[..., 0, :, :] = np.eye(4)
    before[..., 1:, :, :] = T[..., :-1, :, :]
    turned = np.swapaxes(before[..., :3, :3], -1, -2)
    R = turned @ T[..., :3, :3]
    o = np.einsum("...ij,...j->...i", turned, T[..., :3, 3] - before[..., :3, 3])
    return _Steps(R[..., :-1, :, :], o[..., :-1, :], T[..., :-1, :3, :3], o[..., -1, :])


def _outward(
    chain: SerialChain, steps: _Steps, qd: Array, qdd: Array
) -> tuple[Array, Array, Array, Array]:
    """Angular velocity, its rate, velocity and acceleration of the mass centres (..., m, 3)."""
    qd, qdd, chain = chain.joint_rates(qd), chain.joint_rates(qdd), chain.uncoupled
    _, centres, _ = body_moments(chain)
    omega, alpha, v, a = (np.zeros((*qd.shape[:-1], 3)) for _ in range(4))
    found = np.empty((4, *qd.shape, 3))
    z = np.array([0.0, 0.0, 1.0])
    for i in range(chain.n):
        back = np.swapaxes(steps.R[..., i, :, :], -1, -2)
        o = steps.o[..., i, :]
        v = times(back, v + np.cross(omega, o))
        a = times(back, a + np.cross(alpha, o) + np.cross(omega, np.cross(omega, o)))
        omega, alpha = times(back, omega), times(back, alpha)
        rate, acceleration = qd[..., i, None] * z, qdd[..., i, None] * z
        if chain.types[i] == REVOLUTE:
            alpha = alpha + np.cross(omega, rate) + acceleration
            omega = omega + rate
        else:
            a = a + 2.0 * np.cross(omega, rate) + acceleration
            v = v + rate
        c = centres[i]
        found[0, ..., i, :], found[1, ..., i, :] = omega, alpha
        found[2, ..., i, :] = v + np.cross(omega, c)
        found[3, ..., i, :] = a + np.cross(alpha, c) + np.cross(omega, np.cross(omega, c))
    return found[0], found[1], found[2], found[3]


def _partial_velocities(chain: SerialChain, steps: _Steps) -> PartialVelocities:
    batch = steps.o.shape[:-2]
    angular = np.empty((*batch, len(chain.bodies), chain.n, 3))
    linear = np.empty_like(angular)
    for j, unit in enumerate(np.eye(chain.n)):
        rates = np.broadcast_to(unit, (*batch, chain.n))
        omega, _, v, _ = _outward(chain, steps, rates, np.zeros_like(rates))
        angular[..., j, :], linear[..., j, :] = omega, v
    return PartialVelocities(angular, linear)


def _inertia_forces(
    chain: SerialChain, steps: _Steps, partial: PartialVelocities, qd: Array, qdd: Array
) -> Array:
    """Generalised inertia forces (..., n) of the bodies."""
    masses, _, inertias = body_moments(chain)
    omega, alpha, _, a = _outward(chain, steps, qd, qdd)
    spin = np.einsum("iab,...ib->...ia", inertias, omega)
    moments = np.einsum("iab,...ib->...ia", inertias, alpha) + np.cross(omega, spin)
    turning = np.einsum("...ija,...ia->...j", partial.angular, moments)
    moving = np.einsum("...ija,i,...ia->...j", partial.linear, masses, a)
    return -(turning + moving)


def _active_forces(
    chain: SerialChain,
    steps: _Steps,
    partial: PartialVelocities,
    gravity: ArrayLike,
    tip_wrench: ArrayLike | None,
) -> Array:
    """Generalised active forces (..., n) of weights and of the wrench at the tip."""
    masses, centres, _ = body_moments(chain)
    seen = np.swapaxes(steps.base, -1, -2)
    weights = masses[:, None] * (seen @ as_vector("gravity", gravity, 3))
    wrench = as_screw("tip_wrench", tip_wrench)
    moment, force = seen[..., -1, :, :] @ wrench[:3], seen[..., -1, :, :] @ wrench[3:]
    moment = moment + np.cross(steps.tip - centres[-1], force)
    return (
        np.einsum("...ija,...ia->...j", partial.linear, weights)
        + np.einsum("...ja,...a->...j", partial.angular[..., -1, :, :], moment)
        + np.einsum("...ja,...a->...j", partial.linear[..., -1, :, :], force)
    )
