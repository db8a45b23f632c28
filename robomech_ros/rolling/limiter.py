"""Commands to a base, kept within limits from the first period to the last."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.rolling import limiting as kernels
from robomech_ros.errors import LimitExceededError, WrongSizeError
from robomech_ros.rolling.argument_checks import bounded, one_vector
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.constraints import direction_rows
from robomech_ros.rolling.limits import AXES, MotionLimits
from robomech_ros.spatial.arrays import check_kind, real_within
from robomech_ros.typing import Array, ArrayLike

# A limit that leaves more than this part of a command does not shorten it.
_WHOLE = 1.0 - 1e-12
# Wheels with limits, at most: the kernel has so much room.
_MOST_STEERED = 50


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """State of a limited motion.

    Attributes
    ----------
    twist : ndarray, shape (3,)
        ``[omega, v_x, v_y]`` (rad/s, m/s).
    acceleration : ndarray, shape (3,)
        That led to it in the last period (rad/s^2, m/s^2).
    steering : ndarray, shape (s,)
        Angles of the steered wheels (rad).
    saturated : tuple of str
        Axes and wheels whose limits shortened the command, such as ``linear.x``; ``curvature``
        where it turned more sharply than steering allows.
    ahead : ndarray, shape (3,)
        Twist at which the base would be without further commands, once its acceleration is gone.
    directions : ndarray, shape (s, 2)
        In which the steered wheels roll.
    """

    twist: Array
    acceleration: Array
    steering: Array
    saturated: tuple[str, ...]
    ahead: Array
    directions: Array


class CommandLimiter:
    """Keeps the commands of a base within limits, period by period.

    A command beyond a limit of velocity, of an axis or of a wheel, is shortened as a whole, so that
    its curvature stays.  From rest the base follows the ray of the command: its curvature is right
    from the first moment.  On the way from one twist to another, accelerations and jerks are within
    limits in every period, at the ends of ramps, too; twists between allowed ones are allowed.
    Steered wheels turn to their directions before the base starts, and a base whose wheels have to
    turn on the way takes the time for it.

    Parameters
    ----------
    base : RollingBase
    limits : MotionLimits
        Limits of the axes; those of wheels belong to the wheels.
    period : float
        Period of the commands (s).

    Notes
    -----
    Ruckig has no limit of velocity when it controls velocity, and none that axes share, such as
    that of a wheel.  Both hold here since all twists between two of an allowed set are in it.

    Examples
    --------
    A circle, from standstill, in a tenth of a second:

    >>> from robomech_ros.rolling import CommandLimiter, MotionLimits, differential_drive
    >>> limits = MotionLimits(acceleration=[3.0, 0.5, 1.0], jerk=[20.0, 5.0, 5.0])
    >>> limiter = CommandLimiter(differential_drive(0.1, 0.4), limits, period=0.01)
    >>> motion = limiter.at_rest()
    >>> for _ in range(10):
    ...     motion = limiter.step(motion, [0.5, 0.5, 0.0])
    >>> motion.twist.round(9).tolist(), motion.acceleration.round(9).tolist()
    ([0.0275, 0.0275, 0.0], [0.5, 0.5, 0.0])
    """

    def __init__(self, base: RollingBase, limits: MotionLimits, period: float) -> None:
        check_kind("base", base, RollingBase, "a RollingBase")
        check_kind("limits", limits, MotionLimits, "MotionLimits")
        time = real_within("period", period, "a time from 1e-4 to 1 s", 1e-4, 1.0)
        if len(base.steered) > _MOST_STEERED:
            raise WrongSizeError("steered wheels", len(base.steered), f"up to {_MOST_STEERED}")
        self.base, self.limits, self.period = base, limits, time
        self._axes = self._packed_axes()
        # A base that can turn on the spot need not stop to drive the other way.
        forward = np.zeros(3)
        if base.axle is not None and np.isfinite(base.curvatures).any():
            forward = direction_rows(base.axle[None, :2], base.axle[2:])[0]
        self._forward = np.array([*forward, time])
        self._pivots = self._packed_pivots()
        self._bounds = self._packed_bounds()

    def at_rest(self, steering: ArrayLike | None = None) -> BaseMotion:
        """Return the motion of a base that stands.

        Parameters
        ----------
        steering : array_like, shape (s,), optional
            Angles of the steered wheels (rad).  Default 0.

        Raises
        ------
        LimitExceededError
            Not angles within their limits.
        """
        names = self.base.steered
        angles = np.zeros(len(names))
        if steering is not None:
            angles = one_vector("steering", steering, len(names)).copy()
        for name, angle, pivot in zip(names, angles.tolist(), self._pivots, strict=True):
            for limit, over in ((pivot[3], pivot[3] - angle), (pivot[4], angle - pivot[4])):
                if over > 0.0:
                    raise LimitExceededError("steering angle", name, angle, limit, "rad")
        world = angles + np.array([wheel.heading for wheel in self.base.steered_wheels])
        directions = np.stack([np.cos(world), np.sin(world)], axis=-1)
        zero = np.zeros(3)
        return BaseMotion(zero, zero, angles, (), zero, directions)

    def allowed(self, command: ArrayLike) -> tuple[Array, tuple[str, ...]]:
        """Shorten commands to what the base may do for long.

        Parameters
        ----------
        command : array_like, shape (..., 3)
            ``[omega, v_x, v_y]`` (rad/s, m/s).

        Returns
        -------
        twist : ndarray, shape (..., 3)
            That the wheels can give (:meth:`RollingBase.feasible`), within all velocities.
        saturated : tuple of str
            Axes and wheels whose limits shortened a command, and ``curvature`` where it turned
            more sharply than steering allows.
        """
        given = bounded("command", command, 3)
        names, rows, least, most = self._bounds
        # Forbidden axes are left out; the others go on.
        barred = np.where(given > 0.0, most[:3], least[:3]) == 0.0
        wanted = self.base.feasible(np.where(barred, 0.0, given))
        values = np.einsum("ij,...j->...i", rows, wanted)
        speeds, most_speeds, pivot_names = self._pivot_speeds(wanted)
        with np.errstate(divide="ignore", invalid="ignore"):
            over = np.fmax(values / most, -values / least)
        over = np.concatenate([np.fmax(over, 0.0), speeds / most_speeds], axis=-1)
        worst = np.maximum(over.max(axis=-1, initial=0.0), 1.0)
        limits = np.array([*names, *pivot_names])
        which = (over * _WHOLE > 1.0) & (over >= worst[..., None] * _WHOLE)
        saturated = tuple(limits[which.reshape(-1, len(limits)).any(axis=0)].tolist())
        if (wanted[..., 0] != given[..., 0]).any() and not barred[..., 0].any():
            saturated = (*saturated, "curvature")
        return wanted / worst[..., None], saturated

    def step(self, motion: BaseMotion, command: ArrayLike) -> BaseMotion:
        """Move on by one period.

        Parameters
        ----------
        motion : BaseMotion
            Where the base is; it stays as it is.
        command : array_like, shape (3,)
            ``[omega, v_x, v_y]`` (rad/s, m/s); zeros to brake.
        """
        return self.run(motion, one_vector("command", command, 3)[None])[2]

    def run(self, motion: BaseMotion, commands: ArrayLike) -> tuple[Array, Array, BaseMotion]:
        """Move on by many periods.

        Parameters
        ----------
        motion : BaseMotion
            Where the base is; it stays as it is.
        commands : array_like, shape (n, 3)
            One for each period.

        Returns
        -------
        twists : ndarray, shape (n, 3)
            After each period (rad/s, m/s).
        steering : ndarray, shape (n, s)
            Angles after each period (rad).
        motion : BaseMotion
            After the last; ``saturated`` is of all commands.
        """
        check_kind("motion", motion, BaseMotion, "a BaseMotion, such as that of at_rest()")
        given = bounded("commands", commands, 3)
        if given.ndim != 2:
            raise WrongSizeError("commands", given.shape, "(n, 3)")
        return self._stream(motion, *self.allowed(given))

    def approach(
        self, motion: BaseMotion, target: Array, saturated: tuple[str, ...] = ()
    ) -> BaseMotion:
        """Move on by one period towards a twist that :meth:`allowed` has given.

        Parameters
        ----------
        motion : BaseMotion
            Where the base is; it stays as it is.
        target : ndarray, shape (3,)
            ``[omega, v_x, v_y]`` (rad/s, m/s); not checked again.
        saturated : tuple of str
            What :meth:`allowed` says with it.
        """
        return self._stream(motion, target[None], saturated)[2]

    def _stream(
        self, motion: BaseMotion, targets: Array, saturated: tuple[str, ...]
    ) -> tuple[Array, Array, BaseMotion]:
        """Move on by a period for each of the targets (n, 3)."""
        pivots = self._pivots.copy()
        pivots[:, kernels.ANGLE] = motion.steering
        pivots[:, kernels.COSINE : kernels.SINE + 1] = motion.directions
        state = np.array([motion.twist, motion.acceleration, motion.ahead])
        twists, angles = np.empty((len(targets), 3)), np.empty((len(targets), len(pivots)))
        kernels.limited_stream(targets, self._axes, self._forward, pivots, state, twists, angles)
        steering = pivots[:, kernels.ANGLE].copy()
        directions = pivots[:, kernels.COSINE : kernels.SINE + 1].copy()
        end = BaseMotion(state[0], state[1], steering, saturated, state[2], directions)
        return twists, angles, end

    def _packed_axes(self) -> Array:
        limits = self.limits
        forth, back = limits.acceleration, limits.backward_acceleration
        slow_forth, slow_back = limits.deceleration, limits.backward_deceleration
        stops = (forth != slow_back) | (slow_forth != back)
        rows = [forth, slow_forth, back, slow_back, limits.jerk, stops]
        return np.array(rows, dtype=np.float64)

    def _packed_pivots(self) -> Array:
        wheels = self.base.steered_wheels
        packed = np.zeros((len(wheels), kernels.PIVOT_COLUMNS))
        for row, wheel in zip(packed, wheels, strict=True):
            turn = wheel.max_steering_rate * self.period
            row[:5] = *wheel.position, turn, *wheel.steering_limits
        return packed

    def _packed_bounds(self) -> tuple[list[str], Array, Array, Array]:
        """Rows that give the velocities of axes and wheels, and their limits."""
        base, limits = self.base, self.limits
        names, rows = list(AXES), [*np.eye(3)]
        least = [*limits.backward_velocity]  # type: ignore[misc]
        most = [*limits.velocity]  # type: ignore[misc]
        for name, wheel, row in zip(base.names, base.wheels, base.rate_rows(), strict=True):
            if wheel.kind in ("fixed", "omni") and math.isfinite(wheel.max_rate):
                names.append(name)
                rows.append(row)
                least.append(wheel.max_rate)
                most.append(wheel.max_rate)
        return names, np.array(rows), np.array(least), np.array(most)

    def _pivot_speeds(self, twists: Array) -> tuple[Array, Array, list[str]]:
        """Return the greatest rolling speeds (rad/s) of pivoting wheels, their limits and names."""
        kinds = ("steered", "caster")
        turning = [w for w in self.base.wheels if w.kind in kinds and math.isfinite(w.max_rate)]
        places = np.array([w.position for w in turning]).reshape(-1, 2)
        both = [direction_rows(places, np.full(len(turning), a)) for a in (0.0, 0.5 * math.pi)]
        x, y = (np.einsum("ij,...j->...i", rows, twists) for rows in both)
        radii = np.array([w.radius for w in turning])
        most = np.array([w.max_rate for w in turning])
        return np.hypot(x, y) / radii, most, [w.name for w in turning]
