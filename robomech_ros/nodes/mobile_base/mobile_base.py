"""A simulated base that follows commands period by period; it knows neither ROS nor a clock."""

import math
from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.mobile_base.drives import Interface
from robomech_ros.rolling import CommandLimiter, Odometry, RollingRobot, advance_odometry
from robomech_ros.rolling.simulated import SimulatedBase
from robomech_ros.typing import Array


@dataclass(frozen=True, kw_only=True)
class BaseOptions:
    """Settings of a base: how it follows commands and reports its pose."""

    period: float  #: Period of updates (s).
    timeout: float  #: How long a command counts (s); for 0 see `Interface.at_zero`.
    open_loop: bool = False  #: Whether odometry is that of limited commands.
    by_position: bool = True  #: Whether odometry reads positions of wheels, not velocities.
    window: int = 1  #: Number of twists whose mean is published.
    dynamic: bool = False  #: Whether torques move the base.
    wheel_position: float = 0.0  #: Initial position of the wheels (rad).


class MobileBase:
    """A base on wheels, its limits, its simulation and its odometry.

    - ``interface``: topics and parameters of its kind of drive.
    """

    def __init__(self, robot: RollingRobot, interface: Interface, options: BaseOptions) -> None:
        self.robot, self.interface, self.options = robot, interface, options
        self.limiter = CommandLimiter(robot.base, robot.limits, options.period)
        #: Limited command: twist, acceleration, steering, and the limits that reduced it.
        self.motion = self.limiter.at_rest()
        self.simulated = SimulatedBase(robot, options.dynamic, options.wheel_position)
        self.odometry = Odometry.at()
        #: Commanded rates of the driven wheels (rad/s), shape (k,).
        self.wheel_rates = np.zeros(len(robot.base.driven))
        #: Steering rates of the steered wheels (rad/s), shape (s,).
        self.steering_rates = np.zeros(len(robot.base.steered))
        self.timed_out = True  #: Whether the base brakes or stands for lack of a command.
        self.time = 0.0  #: Time of the last update (s).
        self._target = self._standing = self.limiter.allowed(np.zeros(3))
        self._since, self._used = -math.inf, True
        # The first reading: odometry begins where the encoders happen to be.
        self._read = self.simulated.positions.copy()
        self._twists: deque[Array] = deque(maxlen=options.window)

    def take(self, command: ArrayLike, age: float) -> None:
        """Follow a command from the next update on.

        - ``command``: ``[omega, v_x, v_y]`` (rad/s, m/s), shape (3,); components that the drive
          cannot give are ignored.
        - ``age``: age of the command (s); a negative age counts as 0.

        Raises BadValueError: the command is older than the time-out. RobomechError: it does not
        consist of three finite numbers.
        """
        timeout = self.options.timeout
        if age > timeout > 0.0:
            if self.interface.forget_at_stale:
                self._since = -math.inf
            raise BadValueError("age of the command", age, f"up to {timeout:g} s, the time-out")
        wanted = np.array(command, dtype=np.float64)
        if self.robot.base.axle is not None:
            wanted[2] = 0.0
        self._target, self._used = self.limiter.allowed(wanted), False
        self._since = self.time - max(age, 0.0)

    def update(self) -> None:
        """Move on by one period."""
        base, options = self.robot.base, self.options
        self.timed_out = not self._counts()
        before = self.simulated.steering
        self._used = True
        target = self._standing if self.timed_out else self._target
        self.motion = self.limiter.approach(self.motion, *target)
        self.time += options.period
        self.wheel_rates = base.wheel_rates(self.motion.twist, self.motion.steering)
        self.simulated.advance(self.motion, options.period)
        self.steering_rates = (self.simulated.steering - before) / options.period
        known = self.motion if options.open_loop else self.simulated
        steering = known.steering if base.steered else None
        self.odometry = advance_odometry(
            base, self.odometry, self._measured(), options.period, steering=steering
        )
        self._twists.append(self.odometry.twist)

    @property
    def mean_twist(self) -> Array:
        """Mean of the latest twists, ``[omega, v_x, v_y]`` (rad/s, m/s)."""
        return np.mean(self._twists, axis=0) if self._twists else np.zeros(3)

    def place(self, pose: ArrayLike) -> None:
        """Go on with odometry at a pose that is known: x, y (m), heading (rad).

        The base moves on as it does.

        Raises RobomechError: not three finite numbers.
        """
        begun = Odometry.at(pose)
        self.odometry = replace(self.odometry, pose=begun.pose, covariance=begun.covariance)

    def _counts(self) -> bool:
        """Return whether there is a command that still counts."""
        timeout = self.options.timeout
        if self._since == -math.inf:
            return False
        if timeout > 0.0:
            # Updates add up periods: rounding must not take one off.
            return self.time - self._since <= timeout + 1e-9
        rule = self.interface.at_zero
        return rule == "for ever" or (rule == "once" and not self._used)

    def _measured(self) -> Array:
        """Rates of the driven wheels as odometry takes them (rad/s)."""
        driven = self.simulated.driven
        before, self._read = self._read, self.simulated.positions.copy()
        if self.options.open_loop:
            return self.wheel_rates
        if self.options.by_position:
            return np.asarray((self._read - before)[driven] / self.options.period)
        return np.asarray(self.simulated.rates[driven])
