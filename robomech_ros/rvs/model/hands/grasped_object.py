"""Objects that fingers touch: their bodies, and where and how they are touched."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.rvs.model.solids import Solid, box, cylinder, sphere
from robomech_ros.typing import Array

SHAPES = ("ball", "cylinder", "box")


@dataclass(frozen=True)
class HeldObject:
    """An object, its centre at the origin of its frame.

    Parameters
    ----------
    shape : str
        One of ``SHAPES``.
    size : float
        Radius of a ball or of a cylinder, which is as high as it is wide, or half the side of a
        box, a cube (m).
    """

    shape: str
    size: float

    @property
    def solid(self) -> Solid:
        """Its surface."""
        width = 2.0 * self.size
        if self.shape == "ball":
            return sphere(self.size)
        return cylinder(self.size, width) if self.shape == "cylinder" else box(width, width, width)

    def touched(self, angle: float, height: float) -> tuple[Array, Array]:
        """Return a place of the surface and the normal into the object, each shape (3,).

        Parameters
        ----------
        angle : float
            About z, from x (rad).
        height : float
            Along z, from -1 to 1 times the size.
        """
        outwards = np.array([math.cos(angle), math.sin(angle), 0.0])
        if self.shape == "ball":
            outwards = math.sqrt(max(1.0 - height**2, 0.0)) * outwards + [0.0, 0.0, height]
            return self.size * outwards, -outwards
        place, normal = outwards, outwards
        if self.shape == "box":
            side = int(np.argmax(np.abs(outwards)))
            place = outwards / abs(outwards[side])
            normal = np.zeros(3)
            normal[side] = math.copysign(1.0, outwards[side])
        return self.size * (place + [0.0, 0.0, height]), -normal
