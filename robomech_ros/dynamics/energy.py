"""Energy, momentum and power of serial chains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.dynamics import mass as kernels
from robomech_ros.dynamics.forward import forward_dynamics
from robomech_ros.dynamics.friction import friction_torque
from robomech_ros.dynamics.inverse import bias_torque, gravity_torque, inverse_dynamics
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, raise_outcome, surroundings
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, as_states
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


def kinetic_energy(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    r"""Compute the kinetic energy of bodies and rotors, the base at rest.

    .. math::

       T = \tfrac12 \sum_i (m_i\, \dot c_i \cdot \dot c_i + \omega_i \cdot I_i \omega_i)
       + \tfrac12 \sum_i J_i \dot q_i^2

    with the rotors' inertias :math:`J_i` reflected to the joints.

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
    ndarray, shape () or (...,)
        In J.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.3.1.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import kinetic_energy, mass_matrix
    >>> from robomech_ros.robots import load_robot
    >>> arm, q, qd = load_robot("planar3r"), [0.3, -0.7, 1.1], np.array([0.5, -1.2, 2.0])
    >>> bool(np.isclose(kinetic_energy(arm, q, qd), qd @ mass_matrix(arm, q) @ qd / 2.0))
    True
    """
    return _totals(chain, q, qd)[..., 10]


def momentum(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    r"""Compute the momentum of the bodies, the base at rest.

    .. math::

       \mu = \sum_i \begin{bmatrix} I_i \omega_i + c_i \times m_i \dot c_i \\
       m_i \dot c_i \end{bmatrix}

    Parameters
    ----------
    chain, q, qd
        As for :func:`kinetic_energy`.

    Returns
    -------
    ndarray, shape (6,) or (..., 6)
        Angular momentum about the origin of the base (kg m^2/s), then linear (kg m/s), in the axes
        of the base; the rotors' own spin is not in it.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.8.
    """
    return _totals(chain, q, qd)[..., 4:10]


def center_of_mass(chain: SerialChain, q: ArrayLike) -> Array:
    """Compute the mass centre of what the joints move.

    Parameters
    ----------
    chain, q
        As for :func:`kinetic_energy`.

    Returns
    -------
    ndarray, shape (3,) or (..., 3)
        In the base (m).
    """
    totals = _totals(chain, q, np.zeros(as_joint_values(chain, q).shape))
    return totals[..., 1:4] / totals[..., :1]


def potential_energy(chain: SerialChain, q: ArrayLike, *, gravity: ArrayLike = GRAVITY) -> Array:
    r"""Compute the potential energy of the bodies; it is 0 with their mass centre at the base.

    .. math:: V = -\sum_i m_i\, g \cdot c_i

    Parameters
    ----------
    chain, q
        As for :func:`kinetic_energy`.
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).

    Returns
    -------
    ndarray, shape () or (...,)
        In J.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.7.
    """
    q = as_joint_values(chain, q)
    upwards = surroundings(q.shape[-1:], gravity)[0, 6:9]
    moments = _totals(chain, q, np.zeros(q.shape))[..., 1:4]
    with np.errstate(over="ignore", invalid="ignore"):
        energy: Array = moments @ upwards
    if not np.isfinite(energy).all():
        largest = float(np.abs(upwards).max())
        raise BadValueError("largest of gravity", largest, "values with a finite result")
    return energy


def _totals(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    """Mass, first moment (3), momentum (6) and kinetic energy, shape (..., 11)."""
    q, qd = as_states(chain, ("q", "qd"), q, qd)
    rows = as_rows(q)
    out = np.empty((len(rows), 11))
    values, rates = chain.joint_values(rows), chain.joint_rates(as_rows(qd))
    status = kernels.totals(dynamic_model(chain), values, rates, out)
    if status:
        raise_outcome(chain, status, q=q, qd=qd)
    return out.reshape(*q.shape[:-1], 11)


@dataclass(frozen=True, eq=False)
class PowerBalance:
    """Balance of powers, each an array of shape () or (...,) in W.

    ``drives + tip = kinetic + potential + friction``.

    Attributes
    ----------
    drives : ndarray
        What the drives put in.
    tip : ndarray
        What the surroundings put in at the tip.
    kinetic, potential : ndarray
        Rates of the two energies.
    friction : ndarray
        What becomes heat.
    """

    drives: Array
    tip: Array
    kinetic: Array
    potential: Array
    friction: Array


def power_balance(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
) -> PowerBalance:
    """Compute where the power of the drives goes, with the friction of the joints.

    Parameters
    ----------
    chain, q, qd
        As for :func:`kinetic_energy`.
    tau : array_like, of the same shape
        Torques or forces of the drives, friction included (N m or N).
    gravity, tip_wrench
        As for :func:`inverse_dynamics`.
    """
    q, qd, tau = as_states(chain, ("q", "qd", "tau"), q, qd, tau)
    heat = friction_torque(chain, qd)
    qdd = forward_dynamics(chain, q, qd, tau - heat, gravity=gravity, tip_wrench=tip_wrench)
    nowhere = np.zeros(3)
    held = bias_torque(chain, q, qd, gravity=nowhere)
    pulled = bias_torque(chain, q, qd, gravity=nowhere, tip_wrench=tip_wrench)
    inert = inverse_dynamics(chain, q, qd, qdd, gravity=nowhere)
    weight = gravity_torque(chain, q, gravity=gravity)
    with np.errstate(over="ignore"):
        drives, tip, kinetic, potential, friction = (
            np.sum(qd * torque, axis=-1) for torque in (tau, held - pulled, inert, weight, heat)
        )
    return PowerBalance(drives, tip, kinetic, potential, friction)
