"""Dynamics of rolling robots by the natural orthogonal complement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robomech_ros.dynamics.complement.constrained_bodies import ConstrainedBodies
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.rolling.argument_checks import check_entries, one_vector
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.bodies import PlatformBody, WheelBody
from robomech_ros.rolling.moving_bodies import MovingBodies
from robomech_ros.rolling.steering import free_twists, require_feasible
from robomech_ros.rolling.steering_motion import SteeringMotion, independent_rates, steering_along
from robomech_ros.rolling.twist_shaping import shaped_twists
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.typing import Array, ArrayLike

# A torque beyond its limit by no more than this part of it is at the limit.
_WHOLE = 1.0 - 1e-12


class RollingDynamics:
    r"""Torques and motions of a base on level ground.

    The bodies are the platform, the wheels, and the brackets of casters and steered wheels; rollers
    have no mass.  Independent rates u are those of the twist that the wheels leave free: the turn
    and the velocity forward of a base with a fixed axle, else the whole twist.  Steered wheels
    leave one centre of rotation; u then holds the size of the twist, and the rates at which
    steering moves this centre.  Wheels roll, so that

    .. math::

       I \dot u + C u = K^T \tau + B^T w

    with the torques :math:`\tau` of the motors, whose rates are :math:`K u`, and a wrench w on the
    platform.  Motors are those of the driven wheels, then those that steer.

    Parameters
    ----------
    base : RollingBase
        With steered wheels, it must have one degree of mobility, as a tricycle, a car or a swerve
        drive has.
    platform : PlatformBody
    wheels : sequence of WheelBody
        One for each wheel of the base, in their order.

    Attributes
    ----------
    motors : tuple of str
        Driven wheels, then the steered ones as ``<name>_steering``.
    free : ndarray, shape (3, m)
        The twist for units of u; that any steering allows, for a base with steered wheels.
    drives : ndarray, shape (k, m)
        The rates of the driven wheels for units of the twists ``free``, with steering angles of 0.
    max_torques : ndarray, shape (k + s,)
        Max torques of the motors (N m).

    Raises
    ------
    BadValueError, WrongSizeError
        Steered wheels that leave more than one centre, or not as many bodies as wheels.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.5.
    Saha and Angeles, Dynamics of nonholonomic mechanical systems using a natural orthogonal
    complement, ASME J. Applied Mechanics 58 (1991), pp. 238-243.
    Campion, Bastin and d'Andrea-Novel, IEEE Trans. Robotics and Automation 12 (1996), pp. 47-62.

    Examples
    --------
    >>> from robomech_ros.rolling import rolling_robot
    >>> moving = rolling_robot("mecanum").dynamics
    >>> torques = moving.inverse([0.0, 0.5, 0.0], [0.0, 1.0, 0.0])
    >>> torques.round(6).tolist()
    [0.336, 0.336, 0.336, 0.336]
    >>> round(float(moving.forward([0.0, 0.5, 0.0], torques)[1]), 9)
    1.0
    """

    def __init__(
        self, base: RollingBase, platform: PlatformBody, wheels: Sequence[WheelBody]
    ) -> None:
        check_kind("base", base, RollingBase, "a RollingBase")
        if base.steered and base.mobility.mobility != 1:
            expected = "(1,1) or (1,2), whose steered wheels leave one centre of rotation"
            raise BadValueError("type of the base", base.mobility.type, expected)
        check_kind("platform", platform, PlatformBody, "a PlatformBody")
        check_entries("wheels", wheels, WheelBody, "a list of WheelBody")
        if len(wheels) != len(base.wheels):
            raise WrongSizeError("wheels", len(wheels), len(base.wheels))
        self.base, self.platform, self.wheels = base, platform, tuple(wheels)
        self.motors = (*base.driven, *(f"{name}_steering" for name in base.steered))
        self.free = free_twists(base.axle)
        self.drives = base.driven_rows @ self.free
        self._pairs = list(zip(base.wheels, wheels, strict=True))
        driving = [body.max_torque for wheel, body in self._pairs if wheel.driven]
        turned = [body for wheel, body in self._pairs if wheel.kind == "steered"]
        self.max_torques = np.array([*driving, *(body.max_steering_torque for body in turned)])
        # Inertia of steered wheels about their pivots, with their brackets (kg m^2).
        self.pivot_inertias = np.array(
            [
                body.turn + body.bracket_inertia + body.bracket_mass * body.bracket_centre**2
                for body in turned
            ]
        )

    def bodies(
        self,
        twist: ArrayLike,
        brackets: ArrayLike | None = None,
        *,
        steering: SteeringMotion | None = None,
    ) -> ConstrainedBodies:
        """Return the bodies in their motion, and with them inertia, coupling and energy.

        Parameters
        ----------
        twist : array_like, shape (3,)
            ``[omega, v_x, v_y]`` (rad/s, m/s), which the wheels can give.
        brackets : array_like, shape (c,), optional
            Angles of the casters' brackets (rad).  Default 0.
        steering : SteeringMotion, optional
            Of the steered wheels.  Default at the angles of the twist, without rates.

        Returns
        -------
        ConstrainedBodies
            The platform, then the wheels in their order, each caster and steered wheel with its
            bracket; in a frame at rest with the axes that the base has now.
        """
        return self.moving(twist, brackets, steering).bodies

    def moving(
        self,
        twist: ArrayLike,
        brackets: ArrayLike | None = None,
        steering: SteeringMotion | None = None,
        *,
        strict: bool = True,
    ) -> MovingBodies:
        """Return the bodies in their motion with what leads to their motors.

        Parameters
        ----------
        twist, brackets, steering
            As for :meth:`bodies`.
        strict : bool, optional
            False: take the nearest motion that the wheels can give.
        """
        base = self.base
        given = self._twist(twist) if strict else np.asarray(twist)
        count = len(base.casters)
        psi = np.zeros(count) if brackets is None else one_vector("brackets", brackets, count)
        if steering is None:
            steering = SteeringMotion(base.steering_angles(given))
        check_kind("steering", steering, SteeringMotion, "a SteeringMotion")
        one_vector("steering angles", steering.angles, len(base.steered))
        found = independent_rates(base, given, steering, strict=strict)
        actual = found.shape @ found.rates
        masses, inertias, raw, raw_rate = shaped_twists(
            self.platform, self._pairs, actual[:3], SteeringMotion(steering.angles, actual[3:]), psi
        )
        bodies = ConstrainedBodies(
            masses=masses,
            inertias=inertias,
            T=raw @ found.shape,
            T_dot=raw_rate @ found.shape + raw @ found.shape_rate,
            rates=found.rates,
        )
        wheel_rates = base.driven_rate_rows(steering.angles) @ found.shape[:3]
        return MovingBodies(bodies, found, raw, np.concatenate([wheel_rates, found.shape[3:]]))

    def inverse(
        self,
        twist: ArrayLike,
        acceleration: ArrayLike,
        brackets: ArrayLike | None = None,
        *,
        steering: SteeringMotion | None = None,
        wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the torques of the motors that a motion takes.

        Parameters
        ----------
        twist, acceleration : array_like, shape (3,)
            ``[omega, v_x, v_y]`` and the rates of these components (rad/s^2, m/s^2), which the
            wheels can give.
        brackets : array_like, shape (c,), optional
            Angles of the casters' brackets (rad).  Default 0.
        steering : SteeringMotion, optional
            Of the steered wheels.  Default as :func:`steering_along` finds it.
        wrench : array_like, shape (3,), optional
            ``[n, f_x, f_y]`` on the platform at the origin, in the axes of the base (N m, N).

        Returns
        -------
        ndarray, shape (k + s,)
            In N m: of driven wheels, of more than needed those with the least sum of squares; then
            of steered wheels, each of which takes its own.
        """
        given = one_vector("acceleration", acceleration, 3)
        if not self.base.steered:
            require_feasible("acceleration", given, self.base.feasible(given))
        elif steering is None:
            steering = steering_along(self.base, twist, given)
        moving = self.moving(twist, brackets, steering)
        turns = steering.accelerations if steering else np.zeros(0)
        return moving.torques(np.concatenate([given, turns]), self._pushed(wrench))

    def forward(
        self,
        twist: ArrayLike,
        torques: ArrayLike,
        brackets: ArrayLike | None = None,
        *,
        steering: SteeringMotion | None = None,
        wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the acceleration that torques cause.

        The linkage or control that coordinates steered wheels does no work.

        Parameters
        ----------
        twist, brackets, wrench : array_like
            As for :meth:`inverse`.
        torques : array_like, shape (k + s,)
            Torques of the motors (N m).
        steering : SteeringMotion, optional
            Of the steered wheels.  Default at the angles of the twist, without rates.

        Returns
        -------
        ndarray, shape (3 + s,)
            Rates of the components of the twist (rad/s^2, m/s^2), then those of the steering rates
            (rad/s^2).
        """
        given = one_vector("torques", torques, len(self.motors))
        moving = self.moving(twist, brackets, steering)
        return moving.accelerations(given, self._pushed(wrench))

    def drive_model(
        self, twist: ArrayLike, brackets: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        r"""Return the model of the book in the rates of the drives: I and C times the rates.

        Parameters
        ----------
        twist, brackets : array_like
            As for :meth:`inverse`.

        Returns
        -------
        inertia : ndarray, shape (k, k)
            I of :math:`I \ddot\theta + C \dot\theta = \tau` (kg m^2).
        coupling : ndarray, shape (k,)
            :math:`C \dot\theta` (N m).

        Raises
        ------
        BadValueError
            Steered wheels, or more driven wheels than independent rates.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.5.
        """
        k, m = self.drives.shape
        if self.base.steered:
            raise BadValueError("base", ", ".join(self.base.steered), "one without steered wheels")
        if k != m:
            raise BadValueError("driven wheels", k, f"{m}, as many as independent rates")
        bodies = self.bodies(twist, brackets)
        back = np.linalg.inv(self.drives)
        return back.T @ bodies.generalised_inertia @ back, back.T @ bodies.inverse(np.zeros(m))

    def kinetic_energy(
        self,
        twist: ArrayLike,
        brackets: ArrayLike | None = None,
        *,
        steering: SteeringMotion | None = None,
    ) -> float:
        """Compute the kinetic energy of all bodies (J); arguments as for :meth:`bodies`."""
        return float(self.bodies(twist, brackets, steering=steering).kinetic_energy)

    def within_limits(self, torques: ArrayLike) -> tuple[Array, tuple[str, ...]]:
        """Shorten torques to what the motors give.

        Parameters
        ----------
        torques : array_like, shape (k + s,)
            Torques of the motors (N m).

        Returns
        -------
        torques : ndarray, shape (k + s,)
            Those of driven wheels in the same ratios, and so are those that steer.
        saturated : tuple of str
            Motors whose limits shortened them.
        """
        given = one_vector("torques", torques, len(self.motors))
        with np.errstate(divide="ignore", invalid="ignore"):
            over = np.nan_to_num(np.abs(given) / self.max_torques, nan=0.0, posinf=np.inf)
        driven = np.arange(len(given)) < len(self.base.driven)
        largest = [np.max(over, where=driven == at, initial=1.0) for at in driven]
        which = (over * _WHOLE > 1.0) & (over >= np.array(largest) * _WHOLE)
        names = tuple(name for name, at in zip(self.motors, which, strict=True) if at)
        return given / largest, names

    def _pushed(self, wrench: ArrayLike | None) -> Array:
        return np.zeros(3) if wrench is None else one_vector("wrench", wrench, 3)

    def _twist(self, value: ArrayLike) -> Array:
        given = one_vector("twist", value, 3)
        require_feasible("twist", given, self.base.feasible(given))
        return given
