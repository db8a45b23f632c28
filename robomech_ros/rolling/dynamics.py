"""Dynamics of rolling robots by the natural orthogonal complement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robomech_ros.dynamics.complement.constrained_bodies import ConstrainedBodies
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.rolling.argument_checks import check_entries, one_vector
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.bodies import PlatformBody, WheelBody
from robomech_ros.rolling.steering import free_twists, require_feasible
from robomech_ros.rolling.twist_shaping import shaped_twists
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.typing import Array, ArrayLike

# A torque beyond its limit by no more than this part of it is at the limit.
_WHOLE = 1.0 - 1e-12


class RollingDynamics:
    r"""Torques and motions of a base without steered wheels, on level ground.

    The bodies are the platform, the wheels, and the brackets of casters; rollers have no mass.
    Independent rates u are those of the twist that the wheels leave free: the turn and the velocity
    forward of a base with a fixed axle, else the whole twist.  Wheels roll, so that

    .. math::

       I \dot u + C u = K^T \tau + B^T w

    with the torques :math:`\tau` of the driven wheels, whose rates are :math:`K u`, and a wrench w
    on the platform.

    Parameters
    ----------
    base : RollingBase
        Without steered wheels.
    platform : PlatformBody
    wheels : sequence of WheelBody
        One for each wheel of the base, in their order.

    Attributes
    ----------
    free : ndarray, shape (3, m)
        B: the twist for units of u.
    drives : ndarray, shape (k, m)
        K: the rates of the driven wheels for units of u.

    Raises
    ------
    BadValueError, WrongSizeError
        A base with steered wheels, or not as many bodies as wheels.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.5.
    Saha and Angeles, Dynamics of nonholonomic mechanical systems using a natural orthogonal
    complement, ASME J. Applied Mechanics 58 (1991), pp. 238-243.

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
        if base.steered:
            raise BadValueError("base", ", ".join(base.steered), "a base without steered wheels")
        check_kind("platform", platform, PlatformBody, "a PlatformBody")
        check_entries("wheels", wheels, WheelBody, "a list of WheelBody")
        if len(wheels) != len(base.wheels):
            raise WrongSizeError("wheels", len(wheels), len(base.wheels))
        self.base, self.platform, self.wheels = base, platform, tuple(wheels)
        self.free = free_twists(base.axle)
        self.drives = base.driven_rows @ self.free
        pairs = zip(base.wheels, wheels, strict=True)
        self.max_torques = np.array([body.max_torque for wheel, body in pairs if wheel.driven])
        self._least_norm = np.linalg.pinv(self.drives.T)
        self._coordinates = np.linalg.pinv(self.free)

    def bodies(self, twist: ArrayLike, brackets: ArrayLike | None = None) -> ConstrainedBodies:
        """Return the bodies in their motion, and with them inertia, coupling and energy.

        Parameters
        ----------
        twist : array_like, shape (3,)
            ``[omega, v_x, v_y]`` (rad/s, m/s), which the wheels can give.
        brackets : array_like, shape (c,), optional
            Angles of the casters' brackets (rad).  Default 0.

        Returns
        -------
        ConstrainedBodies
            The platform, then the wheels in their order, each caster with its bracket; in a frame
            at rest with the axes that the base has now.
        """
        given = self._twist(twist)
        count = len(self.base.casters)
        psi = np.zeros(count) if brackets is None else one_vector("brackets", brackets, count)
        pairs = list(zip(self.base.wheels, self.wheels, strict=True))
        masses, inertias, T, T_dot = shaped_twists(self.platform, pairs, given, psi)
        return ConstrainedBodies(
            masses=masses,
            inertias=inertias,
            T=T @ self.free,
            T_dot=T_dot @ self.free,
            rates=self._coordinates @ given,
        )

    def inverse(
        self,
        twist: ArrayLike,
        acceleration: ArrayLike,
        brackets: ArrayLike | None = None,
        *,
        wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the torques of the driven wheels that a motion takes.

        Parameters
        ----------
        twist, acceleration : array_like, shape (3,)
            ``[omega, v_x, v_y]`` and the rates of these components (rad/s^2, m/s^2), which the
            wheels can give.
        brackets : array_like, shape (c,), optional
            Angles of the casters' brackets (rad).  Default 0.
        wrench : array_like, shape (3,), optional
            ``[n, f_x, f_y]`` on the platform at the origin, in the axes of the base (N m, N).

        Returns
        -------
        ndarray, shape (k,)
            In N m.  Of more driven wheels than needed, those with the least sum of squares.
        """
        bodies = self.bodies(twist, brackets)
        rates = self._coordinates @ self._twist(acceleration, "acceleration")
        return np.asarray(self._least_norm @ (bodies.inverse(rates) - self._pushed(wrench)))

    def forward(
        self,
        twist: ArrayLike,
        torques: ArrayLike,
        brackets: ArrayLike | None = None,
        *,
        wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the acceleration that torques cause.

        Parameters
        ----------
        twist, brackets, wrench : array_like
            As for :meth:`inverse`.
        torques : array_like, shape (k,)
            Of the driven wheels (N m).

        Returns
        -------
        ndarray, shape (3,)
            Rates of the components of the twist (rad/s^2, m/s^2).
        """
        given = one_vector("torques", torques, len(self.drives))
        efforts = self.drives.T @ given + self._pushed(wrench)
        return np.asarray(self.free @ self.bodies(twist, brackets).forward(efforts))

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
            More driven wheels than independent rates.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.5.
        """
        k, m = self.drives.shape
        if k != m:
            raise BadValueError("driven wheels", k, f"{m}, as many as independent rates")
        bodies = self.bodies(twist, brackets)
        back = np.linalg.inv(self.drives)
        return back.T @ bodies.generalised_inertia @ back, back.T @ bodies.inverse(np.zeros(m))

    def kinetic_energy(self, twist: ArrayLike, brackets: ArrayLike | None = None) -> float:
        """Compute the kinetic energy of all bodies (J); arguments as for :meth:`inverse`."""
        return float(self.bodies(twist, brackets).kinetic_energy)

    def within_limits(self, torques: ArrayLike) -> tuple[Array, tuple[str, ...]]:
        """Shorten torques as a whole to what the motors give.

        Parameters
        ----------
        torques : array_like, shape (k,)
            Of the driven wheels (N m).

        Returns
        -------
        torques : ndarray, shape (k,)
            In the same ratios.
        saturated : tuple of str
            Wheels whose limits shortened them.
        """
        given = one_vector("torques", torques, len(self.drives))
        with np.errstate(divide="ignore", invalid="ignore"):
            over = np.nan_to_num(np.abs(given) / self.max_torques, nan=0.0, posinf=np.inf)
        worst = max(1.0, float(over.max()))
        which = (over * _WHOLE > 1.0) & (over >= worst * _WHOLE)
        names = tuple(name for name, at in zip(self.base.driven, which, strict=True) if at)
        return given / worst, names

    def _pushed(self, wrench: ArrayLike | None) -> Array:
        if wrench is None:
            return np.zeros(self.free.shape[1])
        return np.asarray(self.free.T @ one_vector("wrench", wrench, 3))

    def _twist(self, value: ArrayLike, what: str = "twist") -> Array:
        given = one_vector(what, value, 3)
        require_feasible(what, given, self.base.feasible(given))
        return given
