"""Synchronous moves of all joints: check of both ends, and shortest duration."""

import math

from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import IN1, IN2, f8, i8


@kernel(i8(IN1, IN1, IN2))
def both_within(start, goal, ranges):
    """Return 1 if two positions (n,) are within ``ranges`` (2, n), else 0, also for NaN."""
    for j in range(start.shape[0]):
        low, high = ranges[0, j], ranges[1, j]
        if not (low <= start[j] <= high and low <= goal[j] <= high):
            return 0
    return 1


@kernel(f8(IN1, IN1, IN2, f8, f8, f8))
def shortest_duration(start, goal, inverses, velocity, acceleration, jerk):
    """Return the shortest duration (s) between positions (n,) for a law of motion within limits.

    ``inverses`` (3, n) are the inverse limits of velocity, acceleration and jerk; the last three
    arguments are the peaks of the law for a unit distance and duration.
    """
    first, second, third = 0.0, 0.0, 0.0
    for j in range(start.shape[0]):
        distance = abs(goal[j] - start[j])
        first = max(first, distance * inverses[0, j])
        second = max(second, distance * inverses[1, j])
        third = max(third, distance * inverses[2, j])
    curved = math.pow(third * jerk, 1.0 / 3.0)
    return max(first * velocity, math.sqrt(second * acceleration), curved)
