"""Control of the motors of a simulated base: speed of driven wheels, angles of steered ones."""

import math
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import SingularPostureError
from robomech_ros.rolling.dynamics import RollingDynamics
from robomech_ros.rolling.limiter import BaseMotion
from robomech_ros.rolling.steering_motion import SteeringMotion, steering_along
from robomech_ros.typing import Array

# How fast the control of speed takes differences away, and that of angles (1/s).
_GAIN, _STEERING_GAIN = 20.0, 40.0
# Largest part of a difference that a period takes away.
_LARGEST_STEP = 0.5
# A twist below this (rad/s, m/s) is rest, where rest is commanded; steered wheels stick sooner.
_REST, _SLOW = 1e-9, 1e-3
# A direction that limits of steering change by more than this part is beyond them.
_AT_LIMIT = 1e-12
# Wheels this near to their angles (rad) let the base start.
_ALIGNED = 1e-3


class DrivenBase(NamedTuple):
    """Motion of a base under its motors.

    It has the twist (3,) (rad/s, m/s), the motion of steered wheels, the torques (k + s,) of all
    motors (N m), and the names of those that are saturated.
    """

    twist: Array
    steering: SteeringMotion
    torques: Array
    saturated: tuple[str, ...] = ()


class MotorControl:
    """Moves a base by the torques that its motors give, towards limited commands.

    Wheels steer while the base stands, each on its own; once they are aligned, the base starts.
    A moving base keeps one centre of rotation, which steering moves.
    """

    def __init__(self, dynamics: RollingDynamics) -> None:
        self._dynamics, self._base = dynamics, dynamics.base
        self._none = np.zeros(len(dynamics.motors))
        wheels = self._base.steered_wheels
        limits = np.array([wheel.steering_limits for wheel in wheels]).reshape(-1, 2)
        self._lower, self._upper = limits.T
        self._fastest = np.array([wheel.max_steering_rate for wheel in wheels])
        # Commands of the period before.
        self._twist, self._angles = np.zeros(3), np.zeros(len(limits))

    def advance(
        self, now: DrivenBase, brackets: Array, motion: BaseMotion, period: float
    ) -> DrivenBase:
        """Return the state after a period (s) towards a limited motion; brackets (c,) in rad."""
        steered, fastest = bool(self._base.steered), np.abs(now.twist).max()
        if not motion.twist.any() and fastest < (_SLOW if steered else _REST):
            now = now._replace(twist=np.zeros(3))
        if steered and not now.twist.any():
            found = self._steered_at_rest(now, motion, period)
        elif steered:
            found = self._steered(now, brackets, motion, period)
        elif not (now.twist.any() or motion.twist.any()):
            found = DrivenBase(now.twist, now.steering, self._none)
        else:
            found = self._driven(now, brackets, motion, period)
        self._twist, self._angles = motion.twist, motion.steering
        return found

    def _driven(
        self, now: DrivenBase, brackets: Array, motion: BaseMotion, period: float
    ) -> DrivenBase:
        """Move a base without steered wheels."""
        dynamics, base = self._dynamics, self._base
        gain = min(_GAIN, _LARGEST_STEP / period)
        wanted = base.feasible(motion.acceleration + gain * (motion.twist - now.twist))
        moving, none = dynamics.moving(now.twist, brackets), np.zeros(3)
        torques, saturated = dynamics.within_limits(moving.torques(wanted, none))
        twist = base.feasible(now.twist + period * moving.accelerations(torques, none))
        return DrivenBase(twist, now.steering, torques, saturated)

    def _steered_at_rest(self, now: DrivenBase, motion: BaseMotion, period: float) -> DrivenBase:
        """Turn wheels of a base that stands, and let it start when they are aligned."""
        off = np.remainder(motion.steering - now.steering.angles + 0.5 * math.pi, math.pi)
        off -= 0.5 * math.pi
        if motion.twist.any() and np.abs(off).max() < _ALIGNED:
            angles = self._base.steering_angles(motion.twist, now.steering.angles)
            aligned = now._replace(steering=SteeringMotion(angles))
            return self._steered(aligned, np.zeros(len(self._base.casters)), motion, period)
        rate = (motion.steering - self._angles) / period
        wanted = self._servo(off, rate, now.steering.rates, np.eye(len(off)), period)
        inertia = self._dynamics.pivot_inertias
        needed = np.concatenate([np.zeros(len(self._base.driven)), inertia * wanted])
        torques, saturated = self._dynamics.within_limits(needed)
        change = np.where(inertia > 0.0, torques[-len(off) :] / np.fmax(inertia, 1e-12), wanted)
        rates = now.steering.rates + period * change
        angles = now.steering.angles + period * rates
        held = np.clip(angles, self._lower, self._upper)
        steering = SteeringMotion(held, np.where(held == angles, rates, 0.0))
        return DrivenBase(now.twist, steering, torques, saturated)

    def _steered(
        self, now: DrivenBase, brackets: Array, motion: BaseMotion, period: float
    ) -> DrivenBase:
        """Move a base whose wheels steer on the way."""
        base = self._base
        try:
            moving = self._dynamics.moving(now.twist, brackets, now.steering, strict=False)
        except SingularPostureError:
            return self._stopped(now)
        found = moving.independent
        size, sigma = found.rates[0], found.rates[1:]
        rows = np.linalg.pinv(found.frame)
        goal, before, gain = rows @ motion.twist, rows @ self._twist, rows[0] @ motion.acceleration
        off = _turn(goal)
        rate = (off - _turn(before)) / period if goal[0] * before[0] > 0.0 else 0.0 * off
        speed_up = gain + min(_GAIN, _LARGEST_STEP / period) * (goal[0] - size)
        turns = self._servo(off, rate, sigma, found.shape[3:, 1:], period)
        wanted = np.concatenate([[speed_up], turns])
        needed = moving.torques_of(wanted, np.zeros(3))
        torques, saturated = self._dynamics.within_limits(needed)
        change = moving.bodies.forward(moving.motor_rates.T @ torques)
        size, sigma = size + period * change[0], sigma + period * change[1:]
        turn = period * float(np.linalg.norm(sigma))
        along = found.frame[:, 1:] @ sigma * period
        old = found.frame[:, 0]
        direction = math.cos(turn) * old + float(np.sinc(turn / math.pi)) * along
        turning = (math.cos(turn) * along - math.sin(turn) * turn * old) / period
        if np.abs(base.feasible(direction) - direction).max() > _AT_LIMIT:
            direction, turning = old, np.zeros(3)
        try:
            steering = steering_along(base, direction, turning, near=now.steering.angles)
        except SingularPostureError:
            return self._stopped(now)
        # Half a turn the other way would be the same direction: the wheel is at its limit.
        if np.abs(steering.angles - now.steering.angles).max() > 0.5 * math.pi:
            direction, steering = old, SteeringMotion(now.steering.angles)
        return DrivenBase(size * direction, steering, torques, saturated)

    def _stopped(self, now: DrivenBase) -> DrivenBase:
        """Stop a base whose centre of rotation has come to a pivot: its wheel must turn first."""
        return DrivenBase(np.zeros(3), SteeringMotion(now.steering.angles), self._none)

    def _servo(self, off: Array, ahead: Array, rates: Array, S: Array, period: float) -> Array:
        """Return the acceleration that takes differences of angles and rates away.

        ``ahead`` are rates of the goal; columns of S are rates of the wheels, which are limited.
        """
        gain = min(_STEERING_GAIN, _LARGEST_STEP / period)
        wanted = 0.5 * gain * off + ahead
        wanted = wanted / np.max(np.abs(S @ wanted) / self._fastest, initial=1.0)
        return np.asarray(2.0 * gain * (wanted - rates))


def _turn(goal: Array) -> Array:
    """Return the angle (m - 1,) from the present direction of a base to that of a goal (m,)."""
    across = float(np.linalg.norm(goal[1:]))
    if across == 0.0:
        return np.zeros(len(goal) - 1)
    return math.copysign(math.atan2(across, abs(goal[0])) / across, goal[0]) * goal[1:]
