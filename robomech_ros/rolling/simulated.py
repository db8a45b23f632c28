"""The base that is simulated: it does as commanded, or what its motors can do."""

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.rolling.arcs import moved
from robomech_ros.rolling.library import RollingRobot
from robomech_ros.rolling.limiter import BaseMotion
from robomech_ros.typing import Array

# How fast the speed control of the motors takes differences away (1/s).
_GAIN = 20.0
# A twist below this (rad/s, m/s) is rest, where rest is commanded.
_REST = 1e-9
# How far a bracket turns in a step (rad), and so many steps a period has at most.
_LONGEST_TURN, _MOST_CUT = 0.3, 100


class SimulatedBase:
    """Simulated state of a base and its wheels, moved by torques of its motors if it is dynamic.

    It has the pose (3,), x, y (m) and heading (rad), from where it began, and the twist (3,),
    ``[omega, v_x, v_y]``; positions and rates of all wheels (n,), of which some are driven; the
    angles of steered wheels (s,), and those of the casters' brackets (c,) with their rates; the
    torques of driven wheels (k,), N m, None where it is not dynamic; and the wheels whose motors
    are saturated.
    """

    def __init__(self, robot: RollingRobot, dynamic: bool, wheel_position: float) -> None:
        base = robot.base
        if dynamic and robot.dynamics is None:
            expected = "kinematic: this robot's document has no bodies"
            raise BadValueError("simulation", "dynamic", expected)
        self._base, self._dynamics = base, robot.dynamics if dynamic else None
        self.pose, self.twist = np.zeros(3), np.zeros(3)
        self.positions = np.full(len(base.wheels), wheel_position)
        self.rates = np.zeros(len(base.wheels))
        self.steering = np.zeros(len(base.steered))
        self.driven = np.array([wheel.driven for wheel in base.wheels])
        self.brackets, self.bracket_rates = np.zeros(len(base.casters)), np.zeros(len(base.casters))
        self.torques: Array | None = np.zeros(len(base.driven)) if dynamic else None
        self.saturated: tuple[str, ...] = ()

    def advance(self, motion: BaseMotion, period: float) -> None:
        """Move on by a period (s), towards the twist and steering of a limited motion."""
        self.steering = motion.steering
        self.twist = self._moved_by_motors(motion, period) if self._dynamics else motion.twist
        near = self.steering if len(self.steering) else None
        self.rates = self._base.rolling_rates(self.twist, near, self.brackets)
        self.positions = self.positions + period * self.rates
        if len(self.brackets):
            self._turn_brackets(period)
        self.pose = moved(self.pose, period * self.twist)

    def _turn_brackets(self, period: float) -> None:
        """Let casters trail behind; a step that goes far is cut, so that none turns over."""
        before, time = self.brackets, period
        for _ in range(_MOST_CUT):
            rates = self._base.caster_rates(self.twist, self.brackets)
            far = float(np.abs(rates).max()) * period
            step = period if far <= _LONGEST_TURN else period * _LONGEST_TURN / far
            self.brackets = self.brackets + step * rates
            period -= step
            if period <= 0.0:
                break
        self.bracket_rates = (self.brackets - before) / time

    def _moved_by_motors(self, motion: BaseMotion, period: float) -> Array:
        """Return the twist after a period under the torques that the motors give."""
        dynamics = self._dynamics
        assert dynamics is not None
        off = motion.twist - self.twist
        if not motion.twist.any() and np.abs(self.twist).max() < _REST:
            self.torques, self.saturated = np.zeros(len(self._base.driven)), ()
            return np.zeros(3)
        gain = min(_GAIN, 0.5 / period)
        wanted = self._base.feasible(motion.acceleration + gain * off)
        torques = dynamics.inverse(self.twist, wanted, self.brackets)
        self.torques, self.saturated = dynamics.within_limits(torques)
        change = dynamics.forward(self.twist, self.torques, self.brackets)
        return self._base.feasible(self.twist + period * change)
