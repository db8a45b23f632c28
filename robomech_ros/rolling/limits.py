"""Limits of the motion of a base, axis by axis."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import real_array
from robomech_ros.spatial.arrays import of_shape
from robomech_ros.typing import Array

AXES = ("angular.z", "linear.x", "linear.y")
_OF = {
    "backward_velocity": "velocity",
    "deceleration": "acceleration",
    "backward_acceleration": "acceleration",
    "backward_deceleration": "deceleration",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionLimits:
    """Limits of the twist ``[omega, v_x, v_y]`` of a base; infinite where there is none.

    Parameters
    ----------
    velocity : array_like, shape (3,), optional
        Largest velocities (rad/s, m/s).
    backward_velocity : array_like, shape (3,), optional
        Largest magnitudes of negative velocities.  Default as forward.
    acceleration, deceleration : array_like, shape (3,), optional
        Largest magnitudes (rad/s^2, m/s^2) while a positive velocity grows, and while it falls; the
        deceleration is by default the acceleration.
    backward_acceleration, backward_deceleration : array_like, shape (3,), optional
        The same of negative velocities.  Default as forward.
    jerk : array_like, shape (3,), optional
        Largest magnitudes (rad/s^3, m/s^3).

    Examples
    --------
    >>> from robomech_ros.rolling import MotionLimits
    >>> limits = MotionLimits(velocity=[2.0, 1.0, 0.0], acceleration=[3.0, 0.5, 1.0])
    >>> limits.backward_deceleration.tolist()
    [3.0, 0.5, 1.0]
    """

    velocity: Array | None = None
    backward_velocity: Array | None = None
    acceleration: Array | None = None
    deceleration: Array | None = None
    backward_acceleration: Array | None = None
    backward_deceleration: Array | None = None
    jerk: Array | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            name = field.name
            value = getattr(self, name)
            if value is None:
                other = _OF.get(name)
                value = getattr(self, other) if other else np.full(3, np.inf)
            array = of_shape(name, np.array(real_array(name, value)), (3,))
            zero = name.endswith("velocity")
            if not ((array >= 0.0) if zero else (array > 0.0)).all():
                what = f"three numbers {'from' if zero else 'above'} 0, for {', '.join(AXES)}"
                raise BadValueError(name, array.tolist(), what)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
