"""The dissipation function of the drives' friction.

The friction of joint i is ``-dDelta_i / dqd_i`` with ``Delta_i = viscous qd^2 / 2 + coulomb |qd|``
and, where the joint breaks away with more, ``(static - coulomb) times the integral of
exp(-(v / stribeck_velocity)^2)`` from 0 to ``|qd|``.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.8.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from robomech_ros.robots.chain import SerialChain

__all__ = ["dissipation_function", "dissipation_gradient", "reflected_inertias"]

Array = NDArray[np.float64]


def dissipation_function(chain: SerialChain, qd: Array) -> Array:
    """Compute Delta of all joints together (W), shape (...) for rates of shape (..., n)."""
    viscous, coulomb, extra, width = _coefficients(chain)
    rate = np.abs(qd)
    stribeck = extra * width * 0.5 * np.sqrt(np.pi) * erf(rate / width)
    total: Array = (0.5 * viscous * rate**2 + coulomb * rate + stribeck).sum(axis=-1)
    return total


def dissipation_gradient(chain: SerialChain, qd: Array) -> Array:
    """Compute the derivatives of Delta by the rates (N m or N), shape (..., n); 0 at rest.

    The torque of friction is its negative.
    """
    viscous, coulomb, extra, width = _coefficients(chain)
    gradient: Array = viscous * qd + np.sign(qd) * (coulomb + extra * np.exp(-((qd / width) ** 2)))
    return gradient


def reflected_inertias(chain: SerialChain) -> Array:
    """Give what the rotors add to the diagonal of the mass matrix (kg m^2 or kg), shape (n,)."""
    return np.array([drive.reflected_inertia for drive in chain.drives])


def _coefficients(chain: SerialChain) -> tuple[Array, Array, Array, Array]:
    drives = chain.drives
    viscous = np.array([drive.viscous for drive in drives])
    coulomb = np.array([drive.coulomb for drive in drives])
    extra = np.maximum(np.array([drive.static for drive in drives]) - coulomb, 0.0)
    width = np.array([drive.stribeck_velocity or 1.0 for drive in drives])
    return viscous, coulomb, extra, width
