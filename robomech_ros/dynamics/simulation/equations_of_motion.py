"""The equations of motion of a system, as an integrator asks for them."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from robomech_ros.dynamics.friction import friction_of_rates
from robomech_ros.dynamics.systems import CompiledForward, DynamicSystem, LostPostureError
from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.typing import Array, ArrayLike

Torque = Callable[[float, Array, Array], ArrayLike]

# Squares and quotients of what is larger overflow in the solvers.
_LARGEST_RATE = 1e100


class RunAwayError(Exception):
    """The state, or what acts on it, is no longer finite, or the posture is lost; it says so."""


@dataclass(frozen=True, eq=False)
class EquationsOfMotion:
    """Equations of motion of a system; the state has m drive values, their rates, work and heat.

    The posture is followed from ``start`` (n,); ``torque(t, q, qd)`` is that of the drives, for all
    joints.  Gravity (3,) and the wrench on the tip (6,), moment first, are in the base.  Within the
    ``rest_rate`` dry friction goes over from one direction to the other (rad/s or m/s).
    """

    system: DynamicSystem
    start: Array
    torque: Torque
    gravity: ArrayLike
    tip_wrench: Array | None
    rest_rate: float
    _forward: CompiledForward = field(init=False, repr=False)
    _followed: list[Array] = field(init=False, repr=False)
    _rough: bool = field(init=False, repr=False)

    def __post_init__(self) -> None:
        forward = self.system.compiled_forward(self.gravity, self.tip_wrench)
        object.__setattr__(self, "_forward", forward)
        object.__setattr__(self, "_followed", [self.start])
        object.__setattr__(self, "_rough", bool(self.system.friction_rows.any()))

    @property
    def m(self) -> int:
        """Number of drives."""
        return len(self.system.drive_names)

    def posture(self, values: Array) -> Array:
        """Return all joints (n,) for values of the drives (m,), near where they were last."""
        try:
            self._followed[0] = self.system.posture(values, self._followed[0])
        except LostPostureError as error:
            raise RunAwayError(str(error)) from None
        return self._followed[0]

    def all_joints(self, state: Array) -> Array:
        """Return joint values and rates, work and heat, (2 n + 2,), of a state (2 m + 2,)."""
        m = self.m
        q = self.posture(state[:m].copy())
        qd = self.system.joint_rates(q, state[m : 2 * m].copy())
        return np.concatenate((q, qd, state[2 * m :]))

    def friction_torque(self, q: Array, rates: Array) -> Array:
        """Return the efforts (m,) that the friction of all joints takes at rates (m,)."""
        if not self._rough:
            return np.zeros_like(rates)
        N = self.system.complement(q)
        qd = N @ rates
        senses = np.tanh(qd / self.rest_rate)
        return N.T @ friction_of_rates(self.system.friction_rows, qd, senses)

    def requested_torque(self, t: float, q: Array, rates: Array) -> Array:
        """Return the torques (m,) that are asked of the drives, finite or not."""
        qd = self.system.joint_rates(q, rates)
        tau = np.ascontiguousarray(real_array("torque", self.torque(t, q, qd)))
        if tau.shape != rates.shape:
            raise WrongSizeError("torque", tau.shape, rates.shape)
        return tau

    def drive_torque(self, t: float, q: Array, rates: Array) -> Array:
        """Return the torques (m,) of the drives; a RunAwayError where one is not finite."""
        tau = self.requested_torque(t, q, rates)
        if not np.isfinite(tau).all():
            raise RunAwayError(f"the motion ran away: the torque at {t:.6g} s is not finite")
        return tau

    def tip_power(self, q: Array, rates: Array) -> float:
        """Return the power of the wrench on the tip (W)."""
        if self.tip_wrench is None:
            return 0.0
        return float(self.tip_wrench @ self.system.tip_twist(q, rates))

    def rates(self, t: float, state: Array) -> Array:
        """Return the derivative of a state (2 m + 2,); a RunAwayError where there is none."""
        m = self.m
        if not np.isfinite(state).all():
            raise RunAwayError(f"the motion ran away: the state at {t:.6g} s is not finite")
        q, rates = self.posture(state[:m].copy()), state[m : 2 * m].copy()
        tau, lost = self.drive_torque(t, q, rates), self.friction_torque(q, rates)
        accelerations = np.empty(m)
        try:
            failed = self._forward(q, rates, tau - lost, accelerations)
        except LostPostureError as error:
            raise RunAwayError(str(error)) from None
        if failed:
            why = f"the accelerations at {t:.6g} s are not finite"
            raise RunAwayError(f"the motion ran away: {why}")
        power, loss = tau @ rates + self.tip_power(q, rates), lost @ rates
        derivative = np.concatenate((rates, accelerations, [power, loss]))
        if not np.abs(derivative).max() <= _LARGEST_RATE:
            why = f"accelerations or powers at {t:.6g} s exceed {_LARGEST_RATE:g}"
            raise RunAwayError(f"the motion ran away: {why}")
        return derivative
