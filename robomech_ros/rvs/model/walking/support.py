"""Support of a walking machine: standing feet, and distance from tipping."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.rvs.model.kinds.mobile_robot import on_ground
from robomech_ros.typing import Array, BoolArray
from robomech_ros.walking import stability_margin, support_polygon


@dataclass(frozen=True, eq=False)
class Support:
    """Feet, and the mass centre above them."""

    #: Their names.
    legs: tuple[str, ...]
    #: Over the ground (m), shape (k, 3).
    feet: Array
    #: Mask (k,) of standing feet; at least one.
    contacts: BoolArray
    #: The mass centre, projected to the ground (m), shape (2,).
    centre: Array

    @cached_property
    def corners(self) -> Array:
        """Corners of the support polygon, counter-clockwise, shape (m, 2) (m)."""
        return support_polygon(self.feet[self.contacts, :2])

    @property
    def margin(self) -> float:
        """Distance of the mass centre to the border (m), negative outside."""
        return float(stability_margin(self.centre, self.feet[self.contacts, :2]))

    @cached_property
    def _nearest(self) -> tuple[int, Array]:
        """The first corner of the nearest edge, and its nearest point."""
        begins = self.corners
        along = np.roll(begins, -1, axis=0) - begins
        length = np.maximum(np.einsum("ij,ij->i", along, along), np.finfo(float).tiny)
        part = np.einsum("ij,ij->i", self.centre - begins, along) / length
        points = begins + np.clip(part, 0.0, 1.0)[:, None] * along
        edge = int(np.argmin(np.linalg.norm(points - self.centre, axis=1)))
        return edge, points[edge]

    @property
    def edge(self) -> tuple[str, str]:
        """The legs of the nearest edge."""
        first = self._nearest[0]
        ends = self.corners[[first, (first + 1) % len(self.corners)]]
        return self._leg_at(ends[0]), self._leg_at(ends[1])

    def _leg_at(self, corner: Array) -> str:
        away = np.linalg.norm(self.feet[:, :2] - corner, axis=1)
        return self.legs[int(np.argmin(np.where(self.contacts, away, np.inf)))]

    def facts(self, margin: str) -> list[tuple[str, str]]:
        """Describe the stability, with a remark on the margin."""
        down = [leg for leg, stands in zip(self.legs, self.contacts, strict=True) if stands]
        return [
            ("stability margin", margin),
            ("nearest edge", " to ".join(self.edge)),
            ("feet that stand", ", ".join(down)),
        ]

    def border(self) -> Array:
        """Return the border of the polygon, closed, on the ground, shape (m + 1, 3) (m)."""
        return on_ground(np.vstack([self.corners, self.corners[:1]]))

    def shortest_path(self) -> Array:
        """Return the line from the mass centre to the nearest edge, on the ground, (2, 3) (m)."""
        return on_ground(np.vstack([self.centre, self._nearest[1]]))
