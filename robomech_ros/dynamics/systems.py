"""Systems that can be simulated and return efforts: chains, and objects with this interface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from robomech_ros.dynamics.chain_dynamics import ChainDynamics
from robomech_ros.dynamics.drive_control import CompiledServo, ServoLaw
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, IntArray

# From q (n,), rates and efforts (m,) to accelerations (m,), written to the last: not 0 for none.
CompiledForward = Callable[[Array, Array, Array, Array], int]


class LostPostureError(RobomechError):
    """No posture in the same assembly mode belongs to values of the drives; it says why."""


class DynamicSystem(Protocol):
    """Bodies with n joints, of which m have drives, whose rates determine all others.

    Of a chain all joints are driven, ``m = n`` (:class:`ChainDynamics`); of a parallel robot some
    (``ParallelDynamics``).  Joint values q, shape (..., n), close all loops; rates, accelerations
    and efforts, shape (..., m), are those of the drives.

    Attributes
    ----------
    name : str
        The robot.
    joint_names, drive_names : tuple of str
        All n joints, and the m of them with drives.
    drives_at : ndarray of int, shape (m,)
        Where these are among the joints.
    lower, upper : ndarray, shape (n,)
        Position limits (rad or m).
    effort, velocity : ndarray, shape (m,)
        Limits of the drives (N m or N; rad/s or m/s), NaN where there is none.
    friction_rows : ndarray, shape (4, n)
        Viscous, Coulomb, excess at rest and one over its rate.
    """

    name: str
    joint_names: tuple[str, ...]
    drive_names: tuple[str, ...]
    drives_at: IntArray
    lower: Array
    upper: Array
    effort: Array
    velocity: Array
    friction_rows: Array

    @property
    def mass(self) -> float:
        """Total moving mass (kg)."""

    def checked_posture(self, q: ArrayLike, what: str) -> Array:
        """Return joint values (n,) that are finite and close all loops, or raise an error."""

    def posture(self, values: Array, near: Array) -> Array:
        """Return all joints (n,) for values of the drives (m,), in the assembly mode of ``near``.

        Raises
        ------
        LostPostureError
            There is none.
        """

    def complement(self, q: Array) -> Array:
        """Return N (..., n, m), from the rates of the drives to those of all joints."""

    def joint_rates(self, q: Array, rates: Array) -> Array:
        """Return the rates of all joints (..., n)."""

    def tip_twist(self, q: Array, rates: Array) -> Array:
        """Return the twist [omega; v] (6,) of the tip in the base."""

    def inverse(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = ...,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the efforts of the drives (..., m) that a motion takes, without friction."""

    def forward(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        efforts: ArrayLike,
        *,
        gravity: ArrayLike = ...,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the accelerations of the drives (..., m), without friction."""

    def compiled_forward(self, gravity: ArrayLike, tip_wrench: ArrayLike | None) -> CompiledForward:
        """Return :meth:`forward` of single states without checks."""

    def compiled_servo(self, plant: Any, law: ServoLaw) -> CompiledServo:
        """Simulate a controller with the model of this system on another system."""

    def sampled_postures(self, count: int) -> Array:
        """Spread postures (k, n), at most count, over what the drives can take."""

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute the generalised inertia (..., m, m)."""

    def coriolis_matrix(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute C (..., m, m) of which the rate of the inertia less 2 C is skew."""

    def kinetic_energy(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute the kinetic energy, shape () or (...,) (J)."""

    def potential_energy(self, q: ArrayLike, *, gravity: ArrayLike = ...) -> Array:
        """Compute the potential energy, shape () or (...,) (J)."""

    def with_payload(self, payload: Body) -> DynamicSystem:
        """Return the system that carries a load, seen in the frame of the tip."""


def dynamic_system(robot: Any) -> DynamicSystem:
    """Return what was given, with a chain as a system."""
    if isinstance(robot, SerialChain):
        return ChainDynamics(robot)
    if not isinstance(robot, type) and hasattr(robot, "compiled_forward"):
        return robot
    raise BadValueError("chain", robot, "a SerialChain, or a system such as ParallelDynamics")
