"""Derivatives of inverse and of forward dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics import derivatives as kernels
from robomech_ros.dynamics.forward import forward_dynamics
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, raise_outcome, surroundings
from robomech_ros.kinematics.joint_values import as_rows, as_states
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike

_derivatives_one = direct(kernels.inverse_derivatives_one)


@dataclass(frozen=True, eq=False, slots=True)
class InverseDerivatives:
    """Derivatives of the torques by joint values, rates and accelerations.

    Attributes
    ----------
    matrices : ndarray, shape (3, n, n) or (3, ..., n, n)
        By each of them in turn: row i of a matrix is that of torque i.
    """

    matrices: Array

    @property
    def by_q(self) -> Array:
        """By joint values, shape (n, n) or (..., n, n)."""
        return self.matrices[0]

    @property
    def by_qd(self) -> Array:
        """By joint rates, shape (n, n) or (..., n, n)."""
        return self.matrices[1]

    @property
    def by_qdd(self) -> Array:
        """By accelerations, which is the mass matrix, shape (n, n) or (..., n, n)."""
        return self.matrices[2]


@dataclass(frozen=True, eq=False)
class ForwardDerivatives:
    """Derivatives of the accelerations, each of shape (n, n) or (..., n, n).

    Attributes
    ----------
    by_q, by_qd, by_tau : ndarray
        By joint values, rates and torques; the last is the inverse of the mass matrix.
    qdd : ndarray, shape (n,) or (..., n)
        The accelerations themselves.
    """

    by_q: Array
    by_qd: Array
    by_tau: Array
    qdd: Array


def inverse_dynamics_derivatives(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> InverseDerivatives:
    """Compute the derivatives of :func:`inverse_dynamics`, which leaves out friction.

    Parameters
    ----------
    chain, q, qd, qdd, gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`inverse_dynamics`; the wrench keeps its direction and goes with the tip.

    References
    ----------
    Singh, Russo, Wensing, IEEE Robotics and Automation Letters 7, 2022.
    """
    q, qd, qdd = as_states(chain, ("q", "qd", "qdd"), q, qd, qdd)
    model, shape = dynamic_model(chain), q.shape
    joint_states = chain.joint_values(q), chain.joint_rates(qd), chain.joint_rates(qdd)
    m = len(model) - 1
    around = surroundings(shape, gravity, tip_wrench, base_twist, base_twist_rate)
    if q.ndim == 1:
        matrices = np.empty((3, m, m))
        status = _derivatives_one(model, *joint_states, around, matrices)
    else:
        rows = [as_rows(values) for values in joint_states]
        matrices = np.empty((3, len(rows[0]), m, m))
        status = kernels.inverse_derivatives(model, *rows, around, matrices)
        matrices = matrices.reshape(3, *shape[:-1], m, m)
    if status:
        raise_outcome(chain, status, q=q, qd=qd, qdd=qdd)
    return InverseDerivatives(chain.drive_matrix(matrices))


def forward_dynamics_derivatives(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike,
    *,
    gravity: ArrayLike = GRAVITY,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> ForwardDerivatives:
    """Compute the derivatives of :func:`forward_dynamics`, which leaves out friction.

    Parameters
    ----------
    chain, q, qd, tau, gravity, tip_wrench, base_twist, base_twist_rate
        As for :func:`forward_dynamics`; the wrench keeps its direction and goes with the tip.

    References
    ----------
    Carpentier, Mansard, Analytical derivatives of rigid body dynamics algorithms, Robotics: Science
    and Systems 2018.
    """
    around: dict[str, Any] = {
        "gravity": gravity,
        "tip_wrench": tip_wrench,
        "base_twist": base_twist,
        "base_twist_rate": base_twist_rate,
    }
    qdd = forward_dynamics(chain, q, qd, tau, **around)
    torques = inverse_dynamics_derivatives(chain, q, qd, qdd, **around)
    by_tau: Array = np.linalg.inv(torques.by_qdd).astype(np.float64)
    return ForwardDerivatives(-by_tau @ torques.by_q, -by_tau @ torques.by_qd, by_tau, qdd)
