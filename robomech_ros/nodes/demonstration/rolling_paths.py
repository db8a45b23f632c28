"""Closed paths for rolling robots, and how fast they go along them."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.demonstration.closed_paths import (
    ClosedPath,
    figure_of_eight,
    rounded_square,
)
from robomech_ros.rolling import CommandLimiter, RollingBase, RollingRobot

# Of the least radius that the base can turn at, and of its length: the radius of the paths.
_WIDER, _OF_LENGTH = 1.3, 1.0
# Parts of the limits of velocity and of the others that are used; what is too fast is slowed down.
_OF_VELOCITY, _USED, _SLOWER = 0.7, 0.5, 0.9
# The least speed that is driven (m/s).
_LEAST = 1e-3


def paths_for(base: RollingBase) -> tuple[float, tuple[ClosedPath, ClosedPath]]:
    """Return the paths of a base, and the radius at which they turn (m)."""
    places = np.array([wheel.position for wheel in base.wheels])
    size = max(float(np.ptp(places, axis=0).max()), float(base.radii.max()))
    radius = max(_OF_LENGTH * size, _WIDER * max(abs(1.0 / value) for value in base.curvatures))
    turning = base.axle is None
    square = rounded_square(radius, turning=turning)
    return radius, (square, figure_of_eight(radius, looking_ahead=not turning))


def speed_on(robot: RollingRobot, path: ClosedPath, radius: float) -> tuple[float, float]:
    """Return a speed (m/s) and an acceleration (m/s^2) on a path, well within all limits.

    Raises
    ------
    BadValueError
        The limits do not let the base go along the path.
    """
    base, limits = robot.base, robot.limits
    assert limits.acceleration is not None
    assert limits.deceleration is not None
    assert limits.jerk is not None
    used = slice(1, 2) if base.axle is not None else slice(1, 3)
    slowest = np.minimum(limits.acceleration, limits.deceleration)[used]
    acceleration = _USED * min(1.0, float(slowest.min()))
    jerk = _USED * float(limits.jerk[used].min())
    speed = min(2.0, math.sqrt(acceleration * radius), (jerk * radius**2) ** (1.0 / 3.0))
    for wheel in base.wheels:
        if wheel.kind == "steered":
            far = max(float(np.hypot(*wheel.position)), radius)
            speed = min(speed, _USED * wheel.max_steering_rate * radius**2 / far)
    limiter, twists = CommandLimiter(base, limits, 0.01), path.twists()
    while limiter.allowed(twists * speed / _OF_VELOCITY)[1]:
        speed *= _SLOWER
        if speed < _LEAST:
            raise BadValueError("limits", base.name, f"some that allow {path.name} at {_LEAST} m/s")
    return speed, 0.5 * acceleration
