"""Tolerances of the robot about its trajectory."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.typing import Array

DEFAULT = 0.0
NONE = -1.0


@dataclass(frozen=True, eq=False)
class Tolerances:
    """Tolerances of a motion, (n,) each; infinite, or None for the last three, for no limit.

    They are the largest distance from the path while moving and from the last point at the end (rad
    or m), the largest speed at the end (rad/s or m/s), and how long after the end the goal may
    still be reached (s); then the largest deviation from the velocity and acceleration of the path
    while moving, and the largest acceleration at the end.
    """

    path: Array
    goal: Array
    velocity: Array
    goal_time: float
    path_velocity: Array | None = None
    path_acceleration: Array | None = None
    goal_acceleration: Array | None = None


def override_tolerances(
    default: Array, asked: Sequence[float], order: Sequence[int], names: Sequence[str], what: str
) -> Array:
    """Replace defaults, in the order of the robot's joints, by tolerances of a goal.

    What is asked is empty, or one for each of the names in the order of the trajectory: 0 =
    default, -1 = none. The order is where each joint of the robot is in the trajectory; -1 =
    nowhere, it keeps its default. ``what`` names the tolerance in messages.
    """
    if not len(asked):
        return default
    if len(asked) != len(names):
        raise WrongSizeError(what, len(asked), f"0 or {len(names)}, one for every joint")
    values = np.array(asked, dtype=np.float64)
    for name, value in zip(names, values.tolist(), strict=True):
        if not np.isfinite(value):
            raise NonFiniteError(f"{what} of joint '{name}'", value)
        if value < 0.0 and value != NONE:
            expected = "positive, 0 (default) or -1 (none)"
            raise BadValueError(f"{what} of joint '{name}'", value, expected)
    values = np.where(np.array(order) < 0, DEFAULT, values[list(order)])
    return np.where(values == NONE, np.inf, np.where(values == DEFAULT, default, values))
