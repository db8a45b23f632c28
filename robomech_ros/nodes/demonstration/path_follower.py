"""Follows a closed path by commands of twists, from where odometry says that the base is."""

import math

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.demonstration.closed_paths import ClosedPath
from robomech_ros.typing import Array

# How fast differences are taken away (1/s), and in which part of the radius sideways.
_GAIN, _REACH = 2.0, 0.5
# The place on the path waits for a base that is off by this part of the radius.  One that cannot go
# sideways is never waited for beside it: it needs a way to come back, at this part of the speed.
_SLACK, _RETURN_SPEED = 0.25, 0.3
# After a longer silence (s) the base has braked: the place does not run ahead of it.
_MAX_STEP = 0.1
# Tolerances of arrival: m, and rad.
_ARRIVED, _ARRIVED_ANGLE = 1e-3, 2e-3
# Largest angle of an axle that points forward (rad).
_STRAIGHT = 1e-9


class PathFollower:
    """Follows a path: where it is to be goes on as long as the base is near.

    Clocks and delays do not matter: a base without commands for a while brakes, and goes on.

    - ``axle``: position (m) and heading (rad) of a fixed axle in the base, shape (3,); None for a
      base that can go sideways.
    - ``path``: path from the origin of odometry; a base with a fixed axle heads along it.
    - ``speed``: speed on the path (m/s).
    - ``acceleration``: acceleration on the path (m/s^2).
    - ``radius``: radius of the turns of the path (m).
    - ``gone``: length of the finished part of the path (m).
    - ``off``: greatest distance from the path so far (m).
    - ``arrived``: whether the base is at the end of the path.

    Raises BadValueError: the fixed axle does not point forward.
    """

    def __init__(
        self, axle: Array | None, path: ClosedPath, speed: float, acceleration: float, radius: float
    ) -> None:
        fixed = np.zeros(3) if axle is None else axle
        if abs(math.sin(fixed[2])) > _STRAIGHT or math.cos(fixed[2]) < 0.0:
            raise BadValueError("heading of the axle", float(fixed[2]), "0: wheels look forward")
        self._axle, self._sideways = fixed[:2], axle is None
        self._path, self._radius = path, radius
        self._speed, self._acceleration = speed, acceleration
        self._time, self._rate = math.nan, 0.0
        self.gone, self.off, self.arrived = 0.0, 0.0, False

    def command(self, time: float, pose: Array) -> Array:
        """Return the twist ``[omega, v_x, v_y]`` (rad/s, m/s) to command now.

        - ``time``: time stamp of the odometry (s).
        - ``pose``: x, y (m) and heading (rad) by odometry, shape (3,).
        """
        c, s = math.cos(pose[2]), math.sin(pose[2])
        to_base = np.array([[c, s], [-s, c]])
        # A fixed axle does not slip sideways, whatever is before it.
        place = pose[:2] + to_base.T @ self._axle - self._axle
        wanted, motion = self._path.at(self.gone)
        error = to_base @ (wanted[:2] - place)
        turned = math.remainder(wanted[2] - pose[2], 2.0 * math.pi)
        off, along = wanted[:2] - place, motion[1:]
        self.off = max(self.off, abs(float(along[0] * off[1] - along[1] * off[0])))
        self._go_on(time, error, turned)
        end = self.gone >= self._path.length
        near = abs(error[0]) if not self._sideways else float(np.hypot(*error))
        if end and near < _ARRIVED and (not self._sideways or abs(turned) < _ARRIVED_ANGLE):
            self.arrived = True
        if self.arrived:
            return np.zeros(3)
        if self._sideways:
            ahead = self._rate * (to_base @ motion[1:]) + _GAIN * error
            return np.array([self._rate * motion[0] + _GAIN * turned, *ahead])
        forward = self._rate * math.cos(turned) + _GAIN * error[0]
        reach = _REACH * self._radius
        bend = error[1] / reach**2 + 2.0 * math.sin(turned) / reach
        bend = min(max(bend, -1.0 / self._radius), 1.0 / self._radius)
        turn = forward * motion[0] + abs(forward) * bend
        return np.array([turn, forward + turn * self._axle[1], 0.0])

    def _go_on(self, time: float, error: Array, turned: float) -> None:
        """Move on along the path, the slower the further off the base is."""
        step = 0.0 if math.isnan(self._time) else min(max(time - self._time, 0.0), _MAX_STEP)
        self._time = time
        left = self._path.length - self.gone
        most = min(self._speed, math.sqrt(2.0 * self._acceleration * left) + 0.02 * self._speed)
        slack = _SLACK * self._radius
        behind, beside = abs(error[0]), abs(error[1]) + self._radius * abs(turned)
        if self._sideways:
            behind, beside = behind + beside, 0.0
        most *= max(1.0 - behind / slack, 0.0) * max(1.0 - beside / slack, _RETURN_SPEED)
        self._rate = min(most, self._rate + self._acceleration * step)
        self.gone = min(self.gone + self._rate * step, self._path.length)
        if self.gone >= self._path.length:
            self._rate = 0.0
