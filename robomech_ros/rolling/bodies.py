"""Masses and inertias of rolling robots, and what their motors give."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError
from robomech_ros.rolling.argument_checks import above_zero, one_vector
from robomech_ros.spatial.arrays import real_number
from robomech_ros.typing import Array

# Masses (kg) and inertias (kg m^2) beyond this are none of a robot.
_HEAVIEST = 1e9


@dataclass(frozen=True, eq=False, kw_only=True)
class PlatformBody:
    """The platform, without wheels.

    Parameters
    ----------
    mass : float
        In kg.
    inertia : float
        About the vertical axis through its mass centre (kg m^2).
    centre : array_like, shape (2,), optional
        Mass centre in the base frame (m).  Default the origin.
    """

    mass: float
    inertia: float
    centre: Array = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", above_zero("mass", self.mass, "kg"))
        object.__setattr__(self, "inertia", above_zero("inertia", self.inertia, "kg m^2"))
        given = np.zeros(2) if self.centre is None else one_vector("centre", self.centre, 2).copy()
        if np.abs(given).max() > LARGEST_LENGTH:
            raise BadValueError("centre", given.tolist(), f"up to {LARGEST_LENGTH:g} m")
        given.setflags(write=False)
        object.__setattr__(self, "centre", given)


@dataclass(frozen=True, kw_only=True)
class WheelBody:
    """One wheel, and the bracket of a caster or of a steered wheel.

    Parameters
    ----------
    mass : float, optional
        Mass of the wheel (kg).
    spin, turn : float, optional
        Its inertia about its axle, with that of the motor, and about the vertical axis through its
        centre (kg m^2).
    bracket_mass, bracket_inertia : float, optional
        Of the bracket (kg); about the vertical axis through its mass centre, with that of the
        steering motor (kg m^2).
    bracket_centre : float, optional
        From the pivot back to the mass centre of the bracket (m).
    max_torque : float, optional
        Max torque of the motor, at the wheel (N m).  Default without a limit.
    max_steering_torque : float, optional
        Of the motor that steers the wheel, at its pivot (N m).  Default without a limit.
    """

    mass: float = 0.0
    spin: float = 0.0
    turn: float = 0.0
    bracket_mass: float = 0.0
    bracket_inertia: float = 0.0
    bracket_centre: float = 0.0
    max_torque: float = math.inf
    max_steering_torque: float = math.inf

    def __post_init__(self) -> None:
        units = {"mass": "kg", "bracket_mass": "kg", "bracket_centre": "m"}
        units |= {"max_torque": "N m", "max_steering_torque": "N m"}
        for name in self.__dataclass_fields__:
            expected = f"a number from 0 {units.get(name, 'kg m^2')}"
            value = real_number(name, getattr(self, name), expected)
            most = math.inf if name.endswith("torque") else _HEAVIEST
            if not 0.0 <= value <= most:
                raise BadValueError(name, value, f"{expected}, up to {most:g}")
            object.__setattr__(self, name, value)
