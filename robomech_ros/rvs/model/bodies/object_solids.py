"""Triangles of the objects of a planning scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robomech_ros.collision import Box, Capsule, Cone, Cylinder, Mesh, Plane, SceneObject, Sphere
from robomech_ros.collision.shapes import Body, Shape
from robomech_ros.rvs.model.bodies.solids import Solid, box, capsule, cone, cylinder, sphere
from robomech_ros.typing import Array

# Thickness of the slab for a plane, and its depth below the plane, in parts of its side: the slab
# must not coincide with the ground of the page.
SLAB, BELOW = 1e-3, 1e-3


class ObjectPart(NamedTuple):
    """A shape of an object."""

    solid: Solid
    #: Pose in the object (m), shape (4, 4).
    pose: Array
    #: Whether it is a piece of a plane.
    endless: bool

    def corners(self, pose: Array | None = None) -> Array:
        """Return its vertices (k, 3) in the object, or where the object has a pose (4, 4) (m)."""
        T = self.pose if pose is None else pose @ self.pose
        corners: Array = self.solid.vertices @ T[:3, :3].T + T[:3, 3]
        return corners

    def is_same(self, other: ObjectPart) -> bool:
        """Return whether another part looks the same."""
        pairs = (*zip(self.solid, other.solid, strict=True), (self.pose, other.pose))
        return all(np.array_equal(mine, its) for mine, its in pairs)


def parts_of(one: SceneObject, side: float) -> tuple[ObjectPart, ...]:
    """Return the shapes of an object; planes end at a square of this side (m)."""
    return tuple(
        ObjectPart(_solid(shape, body, side), pose, isinstance(shape, Plane))
        for shape, body, pose in one.parts
    )


def middle_of(parts: Sequence[ObjectPart]) -> Array:
    """Return the middle of an object in its own frame, shape (3,) (m)."""
    corners = np.vstack([one.corners() for one in parts])
    middle: Array = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    return middle


def _solid(shape: Shape, body: Body, side: float) -> Solid:
    match shape:
        case Box():
            return box(shape.x, shape.y, shape.z)
        case Sphere():
            return sphere(shape.radius)
        case Cylinder():
            return cylinder(shape.radius, shape.height)
        case Capsule():
            return capsule(shape.radius, shape.height)
        case Cone():
            # The cone has its tip at the origin: turn it upright about its middle.
            upright = cone(shape.radius, shape.height)
            half = [0.0, 0.0, 0.5 * shape.height]
            return Solid(upright.vertices * [1.0, -1.0, -1.0] + half, upright.faces)
        case Plane():
            slab = box(side, side, SLAB * side)
            lowered = slab.vertices - [0.0, 0.0, (BELOW + 0.5 * SLAB) * side]
            return Solid(lowered @ body.pose[:3, :3].T + body.pose[:3, 3], slab.faces)
        case Mesh():
            return Solid(np.array(shape.vertices), shape.faces)
    raise TypeError(f"no triangles are known for a {type(shape).__name__}")
