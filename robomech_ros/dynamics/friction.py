"""Friction of the drives, and the power that it takes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from robomech_ros._kernels.chain.serial import NOT_FINITE
from robomech_ros.dynamics.model import raise_outcome
from robomech_ros.kinematics.joint_values import as_finite_values
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike


@lru_cache(maxsize=256)
def friction_model(chain: SerialChain) -> Array:
    """Return viscous, Coulomb, excess at rest and one over its rate, shape (4, n).

    The excess of the static friction over that of motion decays with the square of the rate times
    the last row.
    """
    rows = np.zeros((4, chain.n))
    for i, drive in enumerate(chain.drives):
        rows[:2, i] = drive.viscous, drive.coulomb
        if drive.static > drive.coulomb:
            rows[2:, i] = drive.static - drive.coulomb, 1.0 / drive.stribeck_velocity
    rows.setflags(write=False)
    return rows


def friction_torque(chain: SerialChain, qd: ArrayLike) -> Array:
    r"""Compute the torques that the drives need to overcome their friction.

    .. math:: \tau = \beta v + \left( c + (s - c)\, e^{-(v / v_s)^2} \right) \mathrm{sgn}\, v

    at rate v, with the viscous coefficient :math:`\beta`, the Coulomb friction c and the static
    friction s of :class:`Drive`, and 0 at rest, where friction takes any value up to s.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    qd : array_like, shape (n,) or (..., n)
        Joint rates (rad/s or m/s).

    Returns
    -------
    ndarray, of the same shape
        To be added to :func:`inverse_dynamics` (N m or N); of the sign of the rate.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.8; Armstrong-Helouvry,
    Dupont, Canudas de Wit, Automatica 30, 1994, for the decay of static friction.
    """
    qd = as_finite_values(chain, qd, "qd")
    with np.errstate(over="ignore"):
        return _finite(chain, qd, friction_of_rates(friction_model(chain), qd))


def friction_of_rates(rows: Array, qd: Array, senses: Array | None = None) -> Array:
    """Compute the friction of joints by the rows of :func:`friction_model`; senses are signs."""
    viscous, coulomb, excess, decay = rows
    dry = coulomb + excess * np.exp(-(np.minimum(np.abs(qd) * decay, 30.0) ** 2))
    return viscous * qd + dry * (np.sign(qd) if senses is None else senses)


def dissipation(chain: SerialChain, qd: ArrayLike) -> Array:
    r"""Compute the dissipation function, whose derivative by the rates is the friction torque.

    .. math::

       \Delta = \sum \left( \tfrac12 \beta v^2 + c\, |v|
       + (s - c)\, v_s \frac{\sqrt\pi}{2}\, \mathrm{erf} \frac{|v|}{v_s} \right)

    Parameters
    ----------
    chain, qd
        As for :func:`friction_torque`.

    Returns
    -------
    ndarray, shape () or (...,)
        In W.  Of a viscous joint half the power that is lost, of a dry one all of it.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.8.
    """
    from scipy.special import erf

    qd = np.abs(as_finite_values(chain, qd, "qd"))
    viscous, coulomb, excess, decay = friction_model(chain)
    scale = np.divide(excess, decay, out=np.zeros(chain.n), where=decay > 0.0)
    with np.errstate(over="ignore"):
        terms = 0.5 * viscous * qd**2 + coulomb * qd
        fading = scale * (0.5 * np.sqrt(np.pi)) * erf(qd * decay)
        return _finite(chain, qd, np.sum(terms + fading, axis=-1))


def dissipated_power(chain: SerialChain, qd: ArrayLike) -> Array:
    """Compute the power that friction turns into heat, ``qd . friction_torque(qd)``.

    Parameters
    ----------
    chain, qd
        As for :func:`friction_torque`.

    Returns
    -------
    ndarray, shape () or (...,)
        In W, never negative.
    """
    qd = as_finite_values(chain, qd, "qd")
    with np.errstate(over="ignore"):
        return _finite(chain, qd, np.sum(qd * friction_torque(chain, qd), axis=-1))


def _finite(chain: SerialChain, qd: Array, result: Array) -> Array:
    if not np.isfinite(result).all():
        raise_outcome(chain, NOT_FINITE, qd=qd)
    return result
