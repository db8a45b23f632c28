"""Fastest timing of a gait: the shortest cycle for joints and swaying trunk."""

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.walking import gait_step
from robomech_ros._kernels.walking.gait_step import Pattern, State, Step, StepReport
from robomech_ros.errors import BadValueError
from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.typing import Array
from robomech_ros.walking.robot import LeggedRobot
from robomech_ros.walking.stride import GRAVITY, Stride
from robomech_ros.walking.support import stability_margin

# Part of the limits of speed that joints use at the longest stride.
SPEED_PART = 0.6
# A foot is in the air for at least this long (s).
SHORTEST_SWING = 0.3
_ADVANCE = direct(gait_step.advance)
_AROUND = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
# Samples of a swing, those of the rest of the cycle being as far apart, and of a sway.
_SAMPLES = 32
_HALVINGS = 40


def suitable_cycle(robot: LeggedRobot, stride: Stride, limits: Array, part: float) -> float:
    """Find the shortest cycle (s) for the longest stride, whatever the direction.

    Joint rates are in proportion to the frequency of the cycle, so that a cycle of 1 s tells them.
    Joints use a part of the limits of speed in `limits` (k, 3, 3).
    """
    most = max(_fastest_joint(robot, stride, limits, angle) for angle in _AROUND)
    return max(SHORTEST_SWING / float(1 - stride.gait.duty), most / part, sway_cycle(stride))


def sway_cycle(stride: Stride) -> float:
    r"""Find the shortest cycle (s) in which swaying does not tip the robot, 0 without any sway.

    On all feet, the zero-moment point of the mass centre at the height h keeps the bound inside of
    them, with the feet anywhere in their circles and the trunk in any pose:

    .. math::

       p = c - \frac{h}{g} \ddot c

    References
    ----------
    Vukobratovic and Borovac, Zero-moment point: thirty five years of its life, International
    Journal of Humanoid Robotics 1 (2004), pp. 157-173.
    """
    if not stride.gait.sways:
        return 0.0
    feet, level = stride.geometry[:, :2], stride.level
    order = np.argsort((float(stride.gait.duty) - stride.geometry[:, 2]) % 1.0)
    sways = stride.geometry[order, 3:5]
    way = (np.roll(sways, -1, axis=0) - sways)[:, None]
    s = np.linspace(0.0, 1.0, _SAMPLES + 1)[None, :, None]
    centres = (
        level[9:11] + level[12:14] + sways[:, None] + s**3 * (10.0 + s * (6.0 * s - 15.0)) * way
    )
    # Rates of rates for sways that take 1 s.
    changes = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * way
    tilt = (level[11] + level[14]) / GRAVITY
    needed = stride.bound + stride.settings[3] + stride.spare + stride.lean

    # The shift grows with the square of the frequency, and the margin falls: it is concave.
    def is_stable(square: float) -> bool:
        return bool(np.min(stability_margin(centres - tilt * square * changes, feet)) >= needed)

    square, _ = bisected(0.0, 1e6, is_stable, _HALVINGS)
    return float(1.0 / (np.sqrt(square) * stride.settings[4])) if square > 0.0 else 0.0


def fastest_twist(stride: Stride) -> Array:
    """Return the greatest w, vx and vy (rad/s, m/s), each by itself, that feet can follow."""
    cycle, duty, _, radius = stride.settings[:4]
    speed = 2.0 * gait_step.LANDING * radius / (duty * cycle)
    farthest = float(np.hypot(*stride.geometry[:, :2].T).max())
    return np.array([speed / farthest, speed, speed])


def _fastest_joint(robot: LeggedRobot, stride: Stride, limits: Array, angle: float) -> float:
    """Return the largest part of a joint's speed in a cycle of 1 s, in a direction (rad)."""
    settings = stride.settings.copy()
    settings[0], settings[5] = 1.0, 1.0
    duty = settings[1]
    time = (1.0 - duty) / _SAMPLES
    ahead = np.array([np.cos(angle), np.sin(angle)])
    half = gait_step.LANDING * settings[3] * ahead
    twist = np.append(0.0, 2.0 * half / duty)
    body = np.zeros(15)
    body[3], body[10], body[12:] = stride.start(0.0), -1.0, twist
    q = robot.home.reshape(-1, 3).copy()
    state = State(body, _under_way(stride, body[3], half), q)
    seen, most = StepReport(np.empty_like(q), np.empty((4, 4)), np.empty(4)), 0.0
    pattern, step = Pattern(stride.geometry, settings), Step(twist, stride.level, time, time)
    # A trunk that sways comes from the middle; all others need a step to where their joints are.
    settles = round(1.0 / time) if stride.gait.sways else 1
    for k in range(settles + round(1.0 / time)):
        new = State(*(np.empty_like(one) for one in state))
        lost = _ADVANCE(robot.packed, limits, pattern, step, state, new, seen)
        state = new
        if lost >= 0:
            wanted = f"one from which leg '{robot.leg_names[lost]}' reaches all of its swing"
            raise BadValueError("home of the robot", robot.home.tolist(), wanted)
        most = max(most, float(seen.report[1])) if k >= settles else 0.0
    return most


def _under_way(stride: Stride, phase: float, half: Array) -> Array:
    """Return the feet of a robot that has walked for long, with half a stride (2,), at a phase."""
    duty, offsets = float(stride.gait.duty), stride.geometry[:, 2]
    since = (phase + offsets) % 1.0
    feet = np.zeros((len(offsets), 8))
    ahead = (1.0 - 2.0 * since / duty)[:, None] * half
    # Those in the air have been left behind where they were lifted.
    feet[:, :2] = feet[:, 3:5] = stride.geometry[:, :2] + ahead
    feet[:, 5:7] = half
    feet[:, 7] = since >= duty
    return feet
