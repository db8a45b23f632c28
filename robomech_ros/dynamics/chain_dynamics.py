"""A serial chain as one of the systems that can be simulated and asked for their efforts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics.forward import forward_dynamics_one
from robomech_ros.dynamics.drive_control import CompiledServo, ServoLaw, chain_servo
from robomech_ros.dynamics.energy import kinetic_energy, potential_energy
from robomech_ros.dynamics.forward import forward_dynamics
from robomech_ros.dynamics.friction import friction_model
from robomech_ros.dynamics.inverse import inverse_dynamics
from robomech_ros.dynamics.matrices import coriolis_matrix, mass_matrix
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, surroundings
from robomech_ros.dynamics.payload import with_payload
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, check_chain, raise_not_finite
from robomech_ros.kinematics.posture_samples import sample_postures
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, IntArray

_forward_one = direct(forward_dynamics_one)


class ChainDynamics:
    """A serial chain by the names of :class:`DynamicSystem`: every joint has a drive.

    Its methods are the functions of :mod:`robomech_ros.dynamics`.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, with the bodies that they move.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.3.

    Examples
    --------
    >>> from robomech_ros.dynamics import ChainDynamics, gravity_torque
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> system, q, still = ChainDynamics(puma), puma.midrange(), [0.0] * 6
    >>> bool((system.inverse(q, still, still) == gravity_torque(puma, q)).all())
    True
    """

    def __init__(self, chain: SerialChain) -> None:
        check_chain(chain)
        self.chain, self.name = chain, chain.name
        self.joint_names = self.drive_names = chain.joint_names
        self.drives_at: IntArray = np.arange(chain.n)
        self.lower, self.upper = chain.lower, chain.upper
        self.effort, self.velocity = chain.effort, chain.velocity
        self.friction_rows = friction_model(chain)

    @property
    def mass(self) -> float:
        """Total moving mass (kg)."""
        return float(self.chain.packed_bodies[:, 0].sum())

    def checked_posture(self, q: ArrayLike, what: str = "q") -> Array:
        """Return joint values (n,) that are finite, or raise an error."""
        array = as_joint_values(self.chain, q, what)
        if array.ndim != 1:
            raise WrongSizeError(what, array.shape, f"({self.chain.n},)")
        if not np.isfinite(array).all():
            raise_not_finite(self.chain, array, what)
        return array

    def posture(self, values: Array, near: Array) -> Array:
        """Return the values: no joint follows from others."""
        return values

    def complement(self, q: Array) -> Array:
        """Return the unit matrix (n, n)."""
        return np.eye(self.chain.n)

    def joint_rates(self, q: Array, rates: Array) -> Array:
        """Return the rates."""
        return rates

    def tip_twist(self, q: Array, rates: Array) -> Array:
        """Return the twist [omega; v] (6,) of the tip in the base."""
        return np.asarray(jacobian(self.chain, q) @ rates)

    def inverse(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = GRAVITY,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute :func:`inverse_dynamics`."""
        return inverse_dynamics(
            self.chain, q, rates, accelerations, gravity=gravity, tip_wrench=tip_wrench
        )

    def forward(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        efforts: ArrayLike,
        *,
        gravity: ArrayLike = GRAVITY,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute :func:`forward_dynamics`."""
        return forward_dynamics(
            self.chain, q, rates, efforts, gravity=gravity, tip_wrench=tip_wrench
        )

    def compiled_forward(
        self, gravity: ArrayLike, tip_wrench: ArrayLike | None
    ) -> Callable[[Array, Array, Array, Array], int]:
        """Return :meth:`forward` of single states without checks: accelerations into the last."""
        model = dynamic_model(self.chain)
        around = surroundings((self.chain.n,), gravity, tip_wrench)

        def forward(q: Array, rates: Array, efforts: Array, out: Array) -> int:
            return int(_forward_one(model, q, rates, efforts, around, out))

        return forward

    def compiled_servo(self, plant: ChainDynamics, law: ServoLaw) -> CompiledServo:
        """Simulate a controller with the model of this chain on another chain."""
        return chain_servo(self.chain, plant.chain, law)

    def sampled_postures(self, count: int) -> Array:
        """Spread postures (count, n) over what the joints can take."""
        return sample_postures(self.chain, count)

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute :func:`mass_matrix`."""
        return mass_matrix(self.chain, q)

    def coriolis_matrix(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute :func:`coriolis_matrix`."""
        return coriolis_matrix(self.chain, q, rates)

    def kinetic_energy(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute :func:`kinetic_energy`."""
        return kinetic_energy(self.chain, q, rates)

    def potential_energy(self, q: ArrayLike, *, gravity: ArrayLike = GRAVITY) -> Array:
        """Compute :func:`potential_energy`."""
        return potential_energy(self.chain, q, gravity=gravity)

    def with_payload(self, payload: Body) -> ChainDynamics:
        """Return the chain that carries a load: :func:`with_payload`."""
        return ChainDynamics(with_payload(self.chain, payload))
