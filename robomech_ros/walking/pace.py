"""How fast a gait may go: the shortest cycle in which no joint comes near its limit of speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.walking import stepping
from robomech_ros.errors import BadValueError
from robomech_ros.walking.robot import LeggedRobot
from robomech_ros.walking.stride import Stride

__all__ = ["SHORTEST_SWING", "SPEED_PART", "fastest_twist", "suitable_cycle"]

Array = NDArray[np.float64]

# Part of the limits of speed that joints use at the longest stride.
SPEED_PART = 0.6
# A foot is in the air for at least this long (s).
SHORTEST_SWING = 0.3
_ADVANCE = direct(stepping.advance)
_AROUND = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
# Samples of a swing; those of the rest of the cycle are as far apart.
_SAMPLES = 32


def suitable_cycle(robot: LeggedRobot, stride: Stride, limits: Array, part: float) -> float:
    """Find the shortest cycle (s) for the longest stride, whatever the direction.

    Joint rates are in proportion to the frequency of the cycle, so that a cycle of 1 s tells them.

    Parameters
    ----------
    robot : LeggedRobot
    stride : Stride
        Its own cycle does not count.
    limits : ndarray, shape (k, 3, 3)
        Of the joints, as the kernel of walking reads them.
    part : float
        Part of the limits of speed that joints use.

    Raises
    ------
    BadValueError
        A leg does not reach all of its swing.
    """
    most = max(_fastest_joint(robot, stride, limits, angle) for angle in _AROUND)
    return max(SHORTEST_SWING / float(1 - stride.gait.duty), most / part)


def fastest_twist(stride: Stride) -> Array:
    """Give the greatest w, vx and vy (rad/s, m/s), each by itself, that feet can follow."""
    cycle, duty, _, radius = stride.settings[:4]
    speed = 2.0 * stepping.LANDING * radius / (duty * cycle)
    farthest = float(np.hypot(*stride.geometry[:, :2].T).max())
    return np.array([speed / farthest, speed, speed])


def _fastest_joint(robot: LeggedRobot, stride: Stride, limits: Array, angle: float) -> float:
    """Give the largest part of a joint's speed in a cycle of 1 s, in a direction (rad)."""
    settings = stride.settings.copy()
    settings[0], settings[5] = 1.0, 1.0
    duty = settings[1]
    time = (1.0 - duty) / _SAMPLES
    ahead = np.array([np.cos(angle), np.sin(angle)])
    half = stepping.LANDING * settings[3] * ahead
    twist = np.append(0.0, 2.0 * half / duty)
    body = np.zeros(15)
    body[3], body[10], body[12:] = stride.start(0.0), -1.0, twist
    feet = _under_way(stride, body[3], half)
    q = robot.home.reshape(-1, 3).copy()
    rates, trunk, report, most = np.empty_like(q), np.empty((4, 4)), np.empty(4), 0.0
    # A trunk that sways comes from the middle; all others need a step to where their joints are.
    settles = round(1.0 / time) if stride.gait.sways else 1
    for k in range(settles + round(1.0 / time)):
        old, old_feet, old_q = body, feet, q
        body, feet, q = np.empty_like(body), np.empty_like(feet), np.empty_like(q)
        lost = _ADVANCE(
            robot.packed, limits, stride.geometry, settings, twist, stride.level,
            old, old_feet, old_q, time, time, body, feet, q, rates, trunk, report,
        )  # fmt: skip
        if lost >= 0:
            wanted = f"one from which leg '{robot.leg_names[lost]}' reaches all of its swing"
            raise BadValueError("home of the robot", robot.home.tolist(), wanted)
        most = max(most, float(report[1])) if k >= settles else 0.0
    return most


def _under_way(stride: Stride, phase: float, half: Array) -> Array:
    """Give the feet of a robot that has walked for long, with half a stride (2,), at a phase."""
    duty, offsets = float(stride.gait.duty), stride.geometry[:, 2]
    since = (phase + offsets) % 1.0
    feet = np.zeros((len(offsets), 8))
    ahead = (1.0 - 2.0 * since / duty)[:, None] * half
    # Those in the air have been left behind where they were lifted.
    feet[:, :2] = feet[:, 3:5] = stride.geometry[:, :2] + ahead
    feet[:, 5:7] = half
    feet[:, 7] = since >= duty
    return feet
