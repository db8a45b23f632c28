"""Rolling robots on any set of wheels: rates of the wheels from the base's twist, and back."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robomech_ros.rolling.arcs import moved
from robomech_ros.rolling.argument_checks import bounded, duration, shared_batch
from robomech_ros.rolling.constraints import (
    checked_mobility,
    checked_wheels,
    drive_rows,
    side_rows,
    wheel_names,
)
from robomech_ros.rolling.steering import (
    axle_of,
    check_span,
    curvature_range,
    feasible_twists,
    require_feasible,
    steering_for,
)
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.typing import Array, ArrayLike


class RollingBase:
    """A base on wheels of any kinds.

    Twists are ``[omega, v_x, v_y]`` (rad/s, m/s) of the base at its origin, in its own axes, x
    forward and y left.  Rates are those of the driven wheels, steering angles those of the steered
    ones, bracket angles those of the casters, each in the order of the wheels.

    Parameters
    ----------
    wheels : list of Wheel
        In any order, at least one of them driven.
    name : str, optional
        What it is called.

    Attributes
    ----------
    wheels : tuple of Wheel
    driven, steered, casters : tuple of str
        Names of the wheels that are.
    steered_wheels : list of Wheel
    driven_rows : ndarray, shape (k, 3)
        Rates of the driven wheels (rad/s) by twists, with steering angles of 0.
    mobility : Mobility
        Degrees of mobility and of steerability.
    radii, driven_radii : ndarray
        Of all wheels and of the driven ones (m).
    axle : ndarray, shape (3,), or None
        Axle of fixed wheels: its point nearest to the origin (m) and their heading (rad).
    curvatures : tuple of float
        Least and largest turn for each metre forward (rad/m) that steering allows; infinite where
        the base can turn on the spot.

    Raises
    ------
    InconsistentDataError
        Fixed wheels that cannot all roll.
    UnderdeterminedError
        Driven wheels that leave a twist free, which ``.free`` has.
    BadValueError
        No wheels, or two in one place or of one name.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.5.
    Campion, Bastin and d'Andrea-Novel, IEEE Trans. Robotics and Automation 12 (1996), pp. 47-62.

    Examples
    --------
    >>> from robomech_ros.rolling import load_rolling
    >>> base = load_rolling("mecanum")
    >>> base.mobility.type
    '(3,0)'
    >>> twist, slip = base.body_twist(base.wheel_rates([0.2, 1.0, 0.5]))
    >>> twist.round(9).tolist(), round(float(slip), 9)
    ([0.2, 1.0, 0.5], 0.0)
    """

    def __init__(self, wheels: Sequence[Wheel], *, name: str = "base") -> None:
        check_kind("name", name, str, "a text")
        self.name = name
        self.wheels = checked_wheels(wheels)
        self.mobility = checked_mobility(self.wheels)
        self.names = wheel_names(self.wheels)
        kinds = np.array([wheel.kind for wheel in self.wheels])
        self._drives = np.array([wheel.driven for wheel in self.wheels])
        self._turns = kinds == "steered"
        self._trails = kinds == "caster"
        self._held = (kinds == "fixed") | self._turns
        names = np.array(self.names)
        self.driven: tuple[str, ...] = tuple(names[self._drives].tolist())
        self.steered: tuple[str, ...] = tuple(names[self._turns].tolist())
        self.casters: tuple[str, ...] = tuple(names[self._trails].tolist())
        self.radii = np.array([wheel.radius for wheel in self.wheels])
        self.driven_radii = self.radii[self._drives]
        self._headings = np.array([wheel.heading for wheel in self.wheels])
        self.steered_wheels = [wheel for wheel in self.wheels if wheel.kind == "steered"]
        fixed = [wheel for wheel in self.wheels if wheel.kind == "fixed"]
        self.axle = axle_of(fixed[0]) if fixed else None
        self.curvatures = (-math.inf, math.inf)
        if self.axle is not None:
            self.curvatures = curvature_range(self.steered_wheels, self.axle)
        else:
            check_span(self.steered_wheels)
        self._fixed_rows = self.measured_rows()
        self.driven_rows = self.rate_rows()[self._drives]
        self._solver = None if self.steered_wheels else np.linalg.pinv(self._fixed_rows)

    def feasible(self, twist: ArrayLike) -> Array:
        """Return the twist that the wheels can give and that is nearest to a command.

        A fixed axle takes the sideways velocity along itself, and limits of steering take the turn
        that is too sharp; rates forwards stay as they are, and so does the turn of a base that can
        turn on the spot.

        Parameters
        ----------
        twist : array_like, shape (..., 3)
            ``[omega, v_x, v_y]`` (rad/s, m/s).

        Returns
        -------
        ndarray, shape (..., 3)
        """
        given = bounded("twist", twist, 3)
        if self.axle is None:
            return given.copy()
        return feasible_twists(self.axle, self.curvatures, given)

    def wheel_rates(self, twist: ArrayLike, steering: ArrayLike | None = None) -> Array:
        """Compute the rates of the driven wheels.

        Parameters
        ----------
        twist : array_like, shape (..., 3)
            ``[omega, v_x, v_y]`` (rad/s, m/s).
        steering : array_like, shape (..., s), optional
            Present steering angles (rad).  The twist decides at which angles wheels roll; of these
            those nearest to the present ones are taken, and by default to 0: see
            :meth:`steering_angles`.

        Returns
        -------
        ndarray, shape (..., k)
            In rad/s, of ``driven``.

        Raises
        ------
        BadValueError
            The wheels cannot give the twist; the message has the nearest that they can.
        LimitExceededError
            A wheel would have to be steered beyond its limits.
        """
        given = self._checked_twist(twist)
        if not self.steered_wheels and steering is None:
            return np.asarray(given @ self.driven_rows.T)
        angles = self._rolling_directions(self.steering_angles(given, steering))
        return self._rolled(given, angles)[..., self._drives]

    def rolling_rates(
        self, twist: ArrayLike, steering: ArrayLike | None = None, brackets: ArrayLike | None = None
    ) -> Array:
        """Compute the rates of all wheels, driven or not.

        Parameters
        ----------
        twist, steering : array_like
            As for :meth:`wheel_rates`.
        brackets : array_like, shape (..., c), optional
            Angles of the casters' brackets (rad).  Default 0.

        Returns
        -------
        ndarray, shape (..., n)
            In rad/s, in the order of ``wheels``.

        Raises
        ------
        LimitExceededError
            As :meth:`wheel_rates`.
        """
        given = self._checked_twist(twist)
        beta = self.steering_angles(given, steering)
        count = len(self.casters)
        psi = np.zeros(count) if brackets is None else bounded("brackets", brackets, count)
        batch = shared_batch(("twist", given), ("steering", beta), ("brackets", psi))
        angles = np.broadcast_to(self._headings, (*batch, len(self.wheels))).copy()
        angles[..., self._turns] += beta
        angles[..., self._trails] += psi
        return self._rolled(given, angles)

    def steering_angles(self, twist: ArrayLike, near: ArrayLike | None = None) -> Array:
        """Compute the steering angles at which the wheels roll.

        Parameters
        ----------
        twist : array_like, shape (..., 3)
            ``[omega, v_x, v_y]`` (rad/s, m/s).
        near : array_like, shape (..., s), optional
            Angles (rad) to stay near to: a wheel may turn the other way instead of half a turn, and
            one that does not move stays.  Default 0.

        Returns
        -------
        ndarray, shape (..., s)
            In rad.

        Raises
        ------
        LimitExceededError
            A wheel would have to be steered beyond its limits.
        """
        given, start = bounded("twist", twist, 3), self._steering(near)
        shared_batch(("twist", given), ("steering", start))
        return steering_for(self.steered_wheels, given, start)

    def caster_rates(self, twist: ArrayLike, brackets: ArrayLike) -> Array:
        """Compute the rates of the casters' brackets, relative to the base.

        Parameters
        ----------
        twist : array_like, shape (..., 3)
            ``[omega, v_x, v_y]`` (rad/s, m/s).
        brackets : array_like, shape (..., c)
            Angles from the casters' headings to the rolling directions of their wheels (rad); a
            wheel trails behind its pivot.

        Returns
        -------
        ndarray, shape (..., c)
            In rad/s.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.5.1.
        """
        given = bounded("twist", twist, 3)
        psi = bounded("brackets", brackets, len(self.casters))
        shared_batch(("twist", given), ("brackets", psi))
        casters = [wheel for wheel in self.wheels if wheel.kind == "caster"]
        trails = np.array([wheel.trail for wheel in casters])
        rows = side_rows(casters, psi + self._headings[self._trails])
        sideways = np.einsum("...ij,...j->...i", rows, given)
        return np.asarray(sideways / trails - given[..., :1])

    def body_twist(
        self, rates: ArrayLike, steering: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Find the twist that fits the rates of the driven wheels best, and the slip that is left.

        Conventional wheels, driven or not, also say that they do not slip sideways.  What all of
        them say is met with the least sum of squares of velocities at the ground.

        Parameters
        ----------
        rates : array_like, shape (..., k)
            Rates of the driven wheels (rad/s).
        steering : array_like, shape (..., s), optional
            Steering angles (rad).  Default 0.

        Returns
        -------
        twist : ndarray, shape (..., 3)
            ``[omega, v_x, v_y]`` (rad/s, m/s).
        slip : ndarray, shape (...,)
            Root of the sum of squares of the slip velocities (m/s): 0 where wheels agree.
        """
        given = bounded("rates", rates, len(self.driven))
        speeds = given * self.driven_radii
        if self._solver is None:
            shared_batch(("rates", given), ("steering", self._steering(steering)))
            told = self.measured_rows(steering)
            solver = np.linalg.pinv(told)
        else:
            told, solver = self._fixed_rows, self._solver
        zeros = np.zeros((*speeds.shape[:-1], told.shape[-2] - speeds.shape[-1]))
        said = np.concatenate([speeds, zeros], axis=-1)
        twist = np.einsum("...ij,...j->...i", solver, said)
        left = said - np.einsum("...ij,...j->...i", told, twist)
        return twist, np.asarray(np.linalg.norm(left, axis=-1))

    def integrate(
        self, pose: ArrayLike, rates: ArrayLike, dt: float, steering: ArrayLike | None = None
    ) -> Array:
        """Move a pose by constant rates of the wheels: exactly, on the arc of a circle.

        Parameters
        ----------
        pose : array_like, shape (..., 3)
            x, y (m) and heading (rad) of the base in the frame of odometry.
        rates : array_like, shape (..., k)
            Rates of the driven wheels (rad/s).
        dt : float
            How long (s).
        steering : array_like, shape (..., s), optional
            Steering angles (rad).  Default 0.

        Returns
        -------
        ndarray, shape (..., 3)
            x, y and heading, which counts whole turns.

        Examples
        --------
        >>> from robomech_ros.rolling import differential_drive
        >>> base = differential_drive(radius=0.1, track=0.4)
        >>> base.integrate([0, 0, 0], [3.0, 7.0], 1.0).round(6).tolist()
        [0.420735, 0.229849, 1.0]
        """
        start = bounded("pose", pose, 3)
        time = duration("dt", dt)
        twist, _ = self.body_twist(rates, steering)
        shared_batch(("rates", twist), ("pose", start))
        return moved(start, twist * time)

    def measured_rows(self, steering: ArrayLike | None = None) -> Array:
        """Return wheel equations of the twist, (..., k + c, 3), as :meth:`body_twist` uses.

        A twist times a row is the velocity (m/s) at which a driven wheel rolls, in the first k
        rows, or slips sideways, in those of the conventional wheels behind them.
        """
        angles = self._rolling_directions(self._steering(steering))
        rolling = drive_rows(self.wheels, angles)[..., self._drives, :]
        sides = side_rows(self.wheels, angles)[..., self._held, :]
        return np.concatenate([rolling, sides], axis=-2)

    def rate_rows(self) -> Array:
        """Return the rates of all wheels for units of the twist, (n, 3), at zero angles."""
        return np.asarray(drive_rows(self.wheels, self._headings) / self.radii[:, None])

    def driven_rate_rows(self, steering: Array) -> Array:
        """Return the rates of the driven wheels for units of the twist, (k, 3), at angles (s,)."""
        rows = drive_rows(self.wheels, self._rolling_directions(steering))
        return np.asarray(rows / self.radii[:, None])[self._drives]

    def _rolling_directions(self, steering: Array) -> Array:
        angles = np.broadcast_to(self._headings, (*steering.shape[:-1], len(self.wheels))).copy()
        angles[..., self._turns] += steering
        return angles

    def _rolled(self, twist: Array, angles: Array) -> Array:
        rows = drive_rows(self.wheels, angles)
        return np.asarray(np.einsum("...ij,...j->...i", rows, twist) / self.radii)

    def _checked_twist(self, twist: ArrayLike) -> Array:
        given = bounded("twist", twist, 3)
        if self.axle is None:
            return given
        require_feasible("twist", given, feasible_twists(self.axle, self.curvatures, given))
        return given

    def _steering(self, steering: ArrayLike | None) -> Array:
        count = len(self.steered_wheels)
        return np.zeros(count) if steering is None else bounded("steering", steering, count)
