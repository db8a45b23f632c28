"""The equations of motion of a chain, as an integrator asks for them."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics.forward import forward_dynamics_one
from robomech_ros.dynamics.friction import friction_model
from robomech_ros.dynamics.model import dynamic_model, surroundings
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_array

__all__ = ["EquationsOfMotion", "RunAwayError", "Torque"]

Array = NDArray[np.float64]
Torque = Callable[[float, Array, Array], ArrayLike]

_forward_one = direct(forward_dynamics_one)

# Squares and quotients of what is larger overflow in the solvers.
_LARGEST_RATE = 1e100


class RunAwayError(Exception):
    """The state, or what acts on it, is no longer finite."""


@dataclass(frozen=True, eq=False)
class EquationsOfMotion:
    """What moves a chain; a state is q, qd, work and heat.

    Parameters
    ----------
    chain : SerialChain
        Of n joints, with the bodies that they move.
    torque : callable
        ``torque(t, q, qd)`` of the drives (N m or N).
    gravity : array_like, shape (3,)
        In the axes of the base (m/s^2).
    tip_wrench : ndarray, shape (6,), or None
        What the surroundings exert on the tip, moment first (N m and N).
    rest_rate : float
        Rate within which dry friction goes over from one direction to the other (rad/s or m/s).
    """

    chain: SerialChain
    torque: Torque
    gravity: ArrayLike
    tip_wrench: Array | None
    rest_rate: float
    _model: Array = field(init=False, repr=False)
    _around: Array = field(init=False, repr=False)
    _friction: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        around = surroundings((self.chain.n,), self.gravity, self.tip_wrench)
        object.__setattr__(self, "_model", dynamic_model(self.chain))
        object.__setattr__(self, "_around", around)
        object.__setattr__(self, "_friction", friction_model(self.chain))

    def friction_torque(self, qd: Array) -> Array:
        """Give the torques that friction takes at rates (n,)."""
        viscous, coulomb, excess, decay = self._friction
        dry = coulomb + excess * np.exp(-(np.minimum(np.abs(qd) * decay, 26.0) ** 2))
        torque: Array = viscous * qd + dry * np.tanh(qd / self.rest_rate)
        return torque

    def requested_torque(self, t: float, q: Array, qd: Array) -> Array:
        """Give the torques (n,) that are asked of the drives, finite or not."""
        tau = np.ascontiguousarray(real_array("torque", self.torque(t, q, qd)))
        if tau.shape != q.shape:
            raise WrongSizeError("torque", tau.shape, q.shape)
        return tau

    def drive_torque(self, t: float, q: Array, qd: Array) -> Array:
        """Give the torques (n,) of the drives.

        Raises
        ------
        RunAwayError
            One is not finite.
        """
        tau = self.requested_torque(t, q, qd)
        if not np.isfinite(tau).all():
            raise RunAwayError(f"the torque at {t:.6g} s is not finite")
        return tau

    def rates(self, t: float, state: Array) -> Array:
        """Give the derivative of a state (2 n + 2,) by time.

        Raises
        ------
        RunAwayError
            It, or the state, is too large or not finite.
        """
        n = self.chain.n
        q, qd = state[:n].copy(), state[n : 2 * n].copy()
        if not np.isfinite(state).all():
            raise RunAwayError(f"the state at {t:.6g} s is not finite")
        tau, lost = self.drive_torque(t, q, qd), self.friction_torque(qd)
        qdd = np.empty(n)
        if _forward_one(self._model, q, qd, tau - lost, self._around, qdd):
            raise RunAwayError(f"the accelerations at {t:.6g} s are not finite")
        power, loss = tau @ qd, lost @ qd
        if self.tip_wrench is not None:
            power += self.tip_wrench @ (jacobian(self.chain, q) @ qd)
        rates = np.concatenate((qd, qdd, [power, loss]))
        if not np.abs(rates).max() <= _LARGEST_RATE:
            raise RunAwayError(f"accelerations or powers at {t:.6g} s exceed {_LARGEST_RATE:g}")
        return rates
