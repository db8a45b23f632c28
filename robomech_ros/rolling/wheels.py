"""Wheels: fixed, steered, casters and omnidirectional ones."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError
from robomech_ros.rolling.argument_checks import above_zero, angle, length
from robomech_ros.spatial.arrays import (
    as_choice,
    as_flag,
    as_single,
    check_kind,
    of_shape,
    real_array,
    real_number,
)
from robomech_ros.typing import Array, ArrayLike

KINDS = ("fixed", "steered", "caster", "omni")
# Roller axes this near to right angles with the rolling direction would not drive (cosine).
_DRIVES = 1e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class Wheel:
    """One wheel of a rolling robot, in the base frame: x forward, y left, z up.

    Parameters
    ----------
    kind : str
        ``"fixed"`` and ``"steered"`` are conventional wheels; a ``"caster"`` turns about a pivot
        beside its axle; an ``"omni"`` wheel has rollers, as mecanum and Swedish wheels do.
    position : array_like, shape (2,)
        Position of the wheel's centre, of a caster that of its pivot (m).
    radius : float
        In m.
    heading : float
        From x to the direction in which the wheel rolls forward (rad); of a steered wheel and of a
        caster at the angle 0.
    roller : float
        From the rolling direction to the axis of the roller on the ground (rad): +-pi/4 for mecanum
        wheels, 0 where rollers turn about the rolling direction.  For omni wheels only.
    trail : float
        From the pivot back to the centre of the wheel (m).  For casters only.
    driven : bool, optional
        Whether its rate is commanded and measured.  Default all but casters.
    max_rate : float
        Largest rate (rad/s).  Default without a limit.
    steering_limits : tuple of float
        Least and largest steering angle (rad).  Default without limits.
    max_steering_rate : float
        In rad/s.  Default without a limit.
    name : str
        What it is called; by default by its number.

    References
    ----------
    Campion, Bastin and d'Andrea-Novel, Structural properties and classification of kinematic and
    dynamic models of wheeled mobile robots, IEEE Trans. Robotics and Automation 12 (1996), 47-62.
    """

    kind: str
    position: Array
    radius: float
    heading: float = 0.0
    roller: float = 0.0
    trail: float = 0.0
    driven: bool | None = None
    max_rate: float = math.inf
    steering_limits: tuple[float, float] = (-math.inf, math.inf)
    max_steering_rate: float = math.inf
    name: str = ""

    def __post_init__(self) -> None:
        keep = object.__setattr__
        keep(self, "kind", as_choice("kind", self.kind, KINDS))
        position = as_single("position", self.position, (2,)).copy()
        if np.abs(position).max() > LARGEST_LENGTH:
            what = f"coordinates up to {LARGEST_LENGTH:g} m"
            raise BadValueError("position", position.tolist(), what)
        position.setflags(write=False)
        keep(self, "position", position)
        keep(self, "radius", length("radius", self.radius))
        keep(self, "heading", angle("heading", self.heading))
        keep(self, "roller", angle("roller", self.roller))
        if abs(math.cos(self.roller)) < _DRIVES:
            what = "an angle that is not +-pi/2: the wheel could not drive"
            raise BadValueError("roller", self.roller, what)
        keep(self, "trail", real_number("trail", self.trail, "a length above 0 m"))
        if self.kind == "caster":
            keep(self, "trail", length("trail", self.trail))
        driven = self.kind != "caster" if self.driven is None else as_flag("driven", self.driven)
        keep(self, "driven", driven)
        for name, unit in (("max_rate", "rad/s"), ("max_steering_rate", "rad/s")):
            keep(self, name, above_zero(name, getattr(self, name), unit, math.inf))
        keep(self, "steering_limits", _range(self.steering_limits))
        check_kind("name", self.name, str, "a text")
        self._check_kind()

    def _check_kind(self) -> None:
        """Refuse what a wheel of this kind does not have."""
        limited = bool(np.isfinite(self.steering_limits).any())
        foreign = {
            "roller": self.kind != "omni" and self.roller != 0.0,
            "trail": self.kind != "caster" and self.trail != 0.0,
            "driven": self.kind == "caster" and self.driven,
            "steering_limits": self.kind != "steered" and limited,
            "max_steering_rate": self.kind != "steered" and math.isfinite(self.max_steering_rate),
        }
        for name, found in foreign.items():
            if found:
                what = f"none for a wheel of kind {self.kind!r}"
                raise BadValueError(name, getattr(self, name), what)


def _range(limits: ArrayLike) -> tuple[float, float]:
    expected = "a least angle up to 0 and a largest from 0 (rad)"
    given = of_shape("steering_limits", real_array("steering_limits", limits), (2,))
    lower, upper = given.tolist()
    if not (lower <= 0.0 <= upper and lower < upper):
        raise BadValueError("steering_limits", limits, expected)
    return lower, upper
