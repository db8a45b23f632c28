"""Objects of a scene: their shapes, and the spheres around them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels.collision.shapes import CYLINDER
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.collision.shapes import EXCESS, LARGEST, Body, Plane, Shape
from robomech_ros.collision.sphere_cover import cover
from robomech_ros.errors import BadValueError
from robomech_ros.spatial import as_pose
from robomech_ros.typing import Array

# Most spheres that cover a body of the robot: more fit its shape better, and take longer.
MOST_SPHERES = 12
_POINT = np.zeros(4)

Shapes = Shape | Sequence[tuple[Shape, npt.ArrayLike]]


@dataclass(frozen=True, eq=False)
class SceneObject:
    """An object of the world, or one that a link carries.

    Attributes
    ----------
    name : str
    parts : tuple of (Shape, Body, ndarray)
        Shapes and their poses (4, 4) in the object (m).
    pose : ndarray, shape (4, 4)
        In the base, or in the link that carries it (m).
    link : str
        Link that carries it; empty for an object of the world.
    touch_links : frozenset of str
        Links that may touch it.
    covers : tuple of (ndarray, ndarray)
        Spheres around each part of an attached object; see `covered`.
    """

    name: str
    parts: tuple[tuple[Shape, Body, Array], ...]
    pose: Array
    link: str = ""
    touch_links: frozenset[str] = frozenset()
    covers: tuple[tuple[Array, Array], ...] = ()


def read_parts(shape: Shapes) -> tuple[tuple[Shape, Body, Array], ...]:
    """Check the shapes of an object and their poses, and return them with their bodies."""
    given: list[Any] = [(shape, np.eye(4))] if isinstance(shape, Shape) else list(shape)
    parts = []
    for pair in given:
        one, pose = pair if isinstance(pair, Sequence) and len(pair) == 2 else (pair, None)
        if not isinstance(one, Shape) or pose is None:
            expected = "a Box, Sphere, Cylinder, Capsule, Cone, Plane or Mesh, or pairs with poses"
            raise BadValueError("shape", one, expected)
        parts.append((one, one.body(), as_object_pose(pose, "pose of a shape")))
    if not parts:
        raise BadValueError("shape", shape, "at least one")
    return tuple(parts)


def as_object_pose(pose: npt.ArrayLike, what: str = "pose") -> Array:
    """Check a pose (4, 4), and that its position allows accurate distances (m)."""
    checked = as_pose(pose, what=what)
    away = float(np.abs(checked[:3, 3]).max())
    if away > LARGEST_LENGTH:
        expected = f"at most {LARGEST_LENGTH:g} m from the origin"
        raise BadValueError(f"position of the {what}", away, expected)
    return checked


def carried_by(link: str, one: SceneObject) -> SceneObject:
    """Return an object that a link carries; refuse planes, which are infinite."""
    if any(isinstance(shape, Plane) for shape, _, _ in one.parts):
        raise BadValueError("object", one.name, "one without planes, which have no end")
    return replace(one, link=link, covers=tuple(covered(body) for _, body, _ in one.parts))


def covered(body: Body, most: int = MOST_SPHERES) -> tuple[Array, Array]:
    """Return the spheres (s, 8) that cover a body, and one around it (4,); see `cover`."""
    spheres, around = cover(body.corners, body.radius, most)
    if body.kind == CYLINDER:
        # The corners are outside of a round body, and so may be parts of the spheres inside them.
        spheres[:, 7] -= EXCESS * body.sizes[0]
    if body.surface is not None:
        # A point inside the hull may be outside of the surface.
        spheres[:, 7] = -LARGEST
    return spheres, around


def around_object(body: Body) -> Array:
    """Return the sphere around an object; for a simple shape a point, since none is needed."""
    if body.exact:
        return _POINT
    middle = 0.5 * (body.corners.min(axis=0) + body.corners.max(axis=0))
    return np.append(middle, np.linalg.norm(body.corners - middle, axis=1).max())
