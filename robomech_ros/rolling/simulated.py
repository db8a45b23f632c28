"""The base that is simulated: it does as commanded, or what its motors can do."""

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.rolling.arcs import moved
from robomech_ros.rolling.library import RollingRobot
from robomech_ros.rolling.limiter import BaseMotion
from robomech_ros.rolling.motor_control import DrivenBase, MotorControl
from robomech_ros.rolling.steering_motion import SteeringMotion
from robomech_ros.typing import Array

# How far a bracket turns in a step (rad), and so many steps a period has at most.
_LONGEST_TURN, _MOST_CUT = 0.3, 100


class SimulatedBase:
    """Simulated state of a base and its wheels, moved by torques of its motors if it is dynamic.

    It has the pose (3,), x, y (m) and heading (rad), from where it began, and the twist (3,),
    ``[omega, v_x, v_y]``; positions and rates of all wheels (n,), of which some are driven; the
    angles of steered wheels (s,), and those of the casters' brackets (c,) with their rates; the
    torques of the motors (k + s,), of driven wheels and of those that steer, N m, None where it is
    not dynamic; and the motors that are saturated.
    """

    def __init__(self, robot: RollingRobot, dynamic: bool, wheel_position: float) -> None:
        base = robot.base
        if dynamic and robot.dynamics is None:
            expected = "kinematic: this robot's document has no bodies"
            raise BadValueError("simulation", "dynamic", expected)
        self._base = base
        self._control = MotorControl(robot.dynamics) if dynamic and robot.dynamics else None
        self.pose, self.twist = np.zeros(3), np.zeros(3)
        self.positions = np.full(len(base.wheels), wheel_position)
        self.rates = np.zeros(len(base.wheels))
        self.steering = np.zeros(len(base.steered))
        self.driven = np.array([wheel.driven for wheel in base.wheels])
        self.brackets, self.bracket_rates = np.zeros(len(base.casters)), np.zeros(len(base.casters))
        self.torques: Array | None = None
        if dynamic:
            self.torques = np.zeros(len(base.driven) + len(base.steered))
        self._steering = SteeringMotion(self.steering)
        self.saturated: tuple[str, ...] = ()

    def advance(self, motion: BaseMotion, period: float) -> None:
        """Move on by a period (s), towards the twist and steering of a limited motion."""
        before = self.twist
        self.steering, self.twist = motion.steering, motion.twist
        if self._control is not None:
            assert self.torques is not None
            now = DrivenBase(before, self._steering, self.torques)
            moved_on = self._control.advance(now, self.brackets, motion, period)
            self.twist, self._steering, self.torques, self.saturated = moved_on
            self.steering = self._steering.angles
        near = self.steering if len(self.steering) else None
        self.rates = self._base.rolling_rates(self.twist, near, self.brackets)
        self.positions = self.positions + period * self.rates
        if len(self.brackets):
            self._turn_brackets(period)
        self.pose = moved(self.pose, period * self.twist)

    def _turn_brackets(self, period: float) -> None:
        """Trail casters behind; a long step is cut so that none turns over."""
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
