"""A chain on a free base as a system that returns the efforts of its drives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from robomech_ros.dynamics.chain_dynamics import ChainDynamics
from robomech_ros.dynamics.drive_control import CompiledServo, ServoLaw
from robomech_ros.dynamics.floating.chain import FloatingChain
from robomech_ros.dynamics.floating.equations import WEIGHTLESS
from robomech_ros.dynamics.payload import with_payload
from robomech_ros.errors import BadValueError
from robomech_ros.robots.bodies import Body
from robomech_ros.spatial.arrays import as_single, check_kind
from robomech_ros.typing import Array, ArrayLike


class FloatingDynamics(ChainDynamics):
    """A chain on a free base by the names of :class:`DynamicSystem`.

    States are those of the joints; momentum gives the twist of the base, and no wrench acts on it.
    A uniform gravity accelerates all bodies alike, and takes no effort.

    Parameters
    ----------
    robot : FloatingChain
        Chain of n joints.
    momentum : array_like, shape (6,), optional
        Angular momentum about the mass centre (kg m^2/s), then linear momentum (kg m/s), in the
        axes of the base.  Default zero.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.dynamics import FloatingChain, FloatingDynamics
    >>> from robomech_ros.robots import Body, load_robot
    >>> craft = Body(200.0, [0.0, 0.0, 0.0], 30.0 * np.eye(3))
    >>> system = FloatingDynamics(FloatingChain(load_robot("ur5e"), craft))
    >>> q, still = system.chain.midrange(), np.zeros(6)
    >>> bool(np.abs(system.inverse(q, still, still)).max() < 1e-12)
    True
    """

    def __init__(self, robot: FloatingChain, momentum: ArrayLike | None = None) -> None:
        check_kind("robot", robot, FloatingChain, "a FloatingChain")
        super().__init__(robot.chain)
        self.robot = robot
        self.momentum = np.zeros(6) if momentum is None else as_single("momentum", momentum, (6,))

    @property
    def mass(self) -> float:
        """Mass of base and links (kg)."""
        return self.robot.mass

    def tip_twist(self, q: Array, rates: Array) -> Array:
        """Return the twist [omega; v] (6,) of the tip in inertial space, in axes of the base."""
        return np.asarray(self.robot.tip_jacobian(q) @ self._rates(q, rates))

    def inverse(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = WEIGHTLESS,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the torques (..., n) of a motion while the base floats."""

        def torques(q: Array, qd: Array, qdd: Array, wrench: Array) -> Array:
            robot = self.robot
            change = np.concatenate((np.zeros(6), qdd))
            u = self._rates(q, qd)
            held = robot.inverse(q, u, change, gravity=gravity, tip_wrench=wrench)
            H = robot.mass_matrix(q)
            return held[6:] - H[6:, :6] @ np.linalg.solve(H[:6, :6], held[:6])

        return self._each(torques, q, rates, accelerations, tip_wrench)

    def forward(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        efforts: ArrayLike,
        *,
        gravity: ArrayLike = WEIGHTLESS,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the accelerations (..., n) of the joints while the base floats."""

        def accelerations(q: Array, qd: Array, tau: Array, wrench: Array) -> Array:
            given, u = np.concatenate((np.zeros(6), tau)), self._rates(q, qd)
            return self.robot.forward(q, u, given, gravity=gravity, tip_wrench=wrench)[6:]

        return self._each(accelerations, q, rates, efforts, tip_wrench)

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute the inertia (..., n, n) of the joints with the base free to react."""

        def reduced(values: Array) -> Array:
            H = self.robot.mass_matrix(values)
            return H[6:, 6:] - H[6:, :6] @ np.linalg.solve(H[:6, :6], H[:6, 6:])

        return np.apply_along_axis(reduced, -1, q) if np.ndim(q) > 1 else reduced(np.asarray(q))

    def kinetic_energy(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute the kinetic energy of base and links (J)."""

        def energy(q: Array, qd: Array, *_: Array) -> Array:
            return np.array([self.robot.kinetic_energy(q, self._rates(q, qd))])

        return self._each(energy, q, rates, rates, None)[..., 0]

    def compiled_forward(
        self, gravity: ArrayLike, tip_wrench: ArrayLike | None
    ) -> Callable[[Array, Array, Array, Array], int]:
        """Return :meth:`forward` of single states: accelerations into the last argument."""

        def forward(q: Array, rates: Array, efforts: Array, out: Array) -> int:
            out[:] = self.forward(q, rates, efforts, gravity=gravity, tip_wrench=tip_wrench)
            return 0

        return forward

    def compiled_servo(self, plant: ChainDynamics, law: ServoLaw) -> CompiledServo:
        """Refuse: drives of a free chain are not simulated."""
        raise self._unknown("a controller of drives")

    def coriolis_matrix(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Refuse: the joints alone have no such matrix if there is momentum."""
        raise self._unknown("a Coriolis matrix")

    def potential_energy(self, q: ArrayLike, *, gravity: ArrayLike = WEIGHTLESS) -> Array:
        """Refuse: the height of the base is not a state of the joints."""
        raise self._unknown("potential energy")

    def _unknown(self, what: str) -> BadValueError:
        return BadValueError("robot", self.name, f"a robot on a fixed base for {what}")

    def with_payload(self, payload: Body) -> FloatingDynamics:
        """Return the chain that carries a load, on the same base."""
        chain = with_payload(self.chain, payload)
        return FloatingDynamics(FloatingChain(chain, self.robot.base), self.momentum)

    def without_momentum(self) -> FloatingDynamics:
        """Return the same system at zero momentum."""
        return FloatingDynamics(self.robot)

    def _rates(self, q: Array, qd: Array) -> Array:
        return self.robot.rates(q, qd, self.momentum)

    def _each(
        self, compute: Any, q: ArrayLike, rates: ArrayLike, third: ArrayLike, wrench: Any
    ) -> Array:
        """Compute rows for states with leading axes."""
        load = np.zeros(6) if wrench is None else np.asarray(wrench, dtype=np.float64)
        given = [np.asarray(one, dtype=np.float64) for one in (q, rates, third, load)]
        shape = np.broadcast_shapes(*(one.shape[:-1] for one in given))
        rows = [np.broadcast_to(one, (*shape, one.shape[-1])) for one in given]
        flat = [one.reshape(-1, one.shape[-1]) for one in rows]
        found = [compute(*one) for one in zip(*flat, strict=True)]
        width = len(found[0]) if found else self.robot.n
        return np.array(found).reshape(*shape, width)
