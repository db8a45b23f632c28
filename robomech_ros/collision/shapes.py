"""Simple shapes of bodies, and the geometry that distances need of any shape."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from robomech_ros._kernels.collision.hulls import HULL, ROUND
from robomech_ros._kernels.collision.shapes import BALL, BOX, CAPSULE, CYLINDER, HALF_SPACE, SPHERES
from robomech_ros.collision.hull_edges import joined, prism_edges, pyramid_edges
from robomech_ros.collision.libraries import coal
from robomech_ros.errors import BadValueError
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.spatial.arrays import as_single, finite_within
from robomech_ros.typing import Array, IntArray

# Lengths of shapes (m); others are hardly meant.
SMALLEST, LARGEST = 1e-6, 1e4
# Sides of the prism around a cylinder.
_SIDES = 16
# How far its corners are outside of the cylinder, relative to the radius.
EXCESS = 1.0 / math.cos(math.pi / _SIDES) - 1.0
_PRISM, _PYRAMID, _BAR, _DOT = (
    prism_edges(_SIDES),
    pyramid_edges(_SIDES),
    joined([(0, 1)], 2),
    joined([], 1),
)
_CUBE = joined([(i, i ^ bit) for i in range(8) for bit in (1, 2, 4)], 8)


class Body(NamedTuple):
    """Geometry of a shape for the computation of distances, in the frame of the shape (m).

    Attributes
    ----------
    geometry : coal.CollisionGeometry
    corners : ndarray, shape (k, 3)
        The body is inside their convex hull, or within ``radius`` of it.
    edges : ndarray of int
        Neighbours of the corners of the hull; see `hull_edges`.
    radius : float
    kind : int
        The simple shape that the body is, or that is around it; see `_kernels.collision`.
    sizes : tuple of three float
        Sizes of that shape.
    pose : ndarray, shape (4, 4)
        Pose of that shape.
    exact : bool
        Whether the body is that shape.
    surface : coal.CollisionGeometry or None
        Surface of a mesh that is not convex; it counts if the hull, ``geometry``, touches.
    triangles : ndarray, shape (m, 3, 3), or None
        Triangles of that surface (m).
    """

    geometry: Any
    corners: Array
    edges: IntArray
    radius: float = 0.0
    kind: int = SPHERES
    sizes: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pose: Array = np.eye(4)
    exact: bool = True
    surface: Any = None
    triangles: Array | None = None

    @property
    def hull_kind(self) -> float:
        """Kind of the body for the kernels: the hull of its corners, a cylinder, or neither."""
        if self.kind == CYLINDER and self.exact:
            return ROUND
        return HULL if self.kind in (BOX, BALL, CAPSULE) and self.surface is None else 0.0

    def encloses(self, point: Array) -> bool:
        """Return whether a surface of triangles encloses a point, by their solid angles."""
        if self.triangles is None:
            return False
        local = self.pose[:3, :3].T @ (point - self.pose[:3, 3])
        if (np.abs(local) > self.sizes).any():
            return False
        a, b, c = (self.triangles[:, k] - point for k in range(3))
        x, y, z = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", u, v) for u, v in ((a, b), (b, c), (c, a))]
        whole = x * y * z + dots[0] * z + dots[1] * x + dots[2] * y
        return abs(float(np.arctan2(volume, whole).sum())) > math.pi


class Shape(ABC):
    """A shape with a frame of its own."""

    @abstractmethod
    def body(self) -> Body:
        """Return what distances are computed from."""


@dataclass(frozen=True)
class Box(Shape):
    """A box about the origin, with its full lengths along x, y and z (m)."""

    x: float
    y: float
    z: float

    def __post_init__(self) -> None:
        _check_lengths(self, "x", "y", "z")

    def body(self) -> Body:
        """Return what distances are computed from."""
        half = 0.5 * np.array([self.x, self.y, self.z])
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        geometry = coal().Box(self.x, self.y, self.z)
        return Body(geometry, signs * half, _CUBE, 0.0, BOX, tuple(half.tolist()))


@dataclass(frozen=True)
class Sphere(Shape):
    """A sphere about the origin (m)."""

    radius: float

    def __post_init__(self) -> None:
        _check_lengths(self, "radius")

    def body(self) -> Body:
        """Return what distances are computed from."""
        geometry = coal().Sphere(self.radius)
        return Body(geometry, np.zeros((1, 3)), _DOT, self.radius, BALL, (self.radius, 0.0, 0.0))


@dataclass(frozen=True)
class Cylinder(Shape):
    """A cylinder along z, the origin in its middle (m)."""

    radius: float
    height: float

    def __post_init__(self) -> None:
        _check_lengths(self, "radius", "height")

    def body(self) -> Body:
        """Return what distances are computed from."""
        ring = _ring(self.radius, -0.5 * self.height)
        corners = np.concatenate([ring, ring + [0.0, 0.0, self.height]])
        geometry = coal().Cylinder(self.radius, self.height)
        return Body(geometry, corners, _PRISM, 0.0, CYLINDER, (self.radius, 0.5 * self.height, 0.0))


@dataclass(frozen=True)
class Capsule(Shape):
    """All points within a radius of a line along z, the origin in its middle (m).

    The height is that of the line, without the two half spheres.
    """

    radius: float
    height: float

    def __post_init__(self) -> None:
        _check_lengths(self, "radius", "height")

    def body(self) -> Body:
        """Return what distances are computed from."""
        half = 0.5 * self.height
        corners = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
        geometry = coal().Capsule(self.radius, self.height)
        return Body(geometry, corners, _BAR, self.radius, CAPSULE, (self.radius, half, 0.0))


@dataclass(frozen=True)
class Cone(Shape):
    """A cone along z, its tip up, the origin halfway up (m)."""

    radius: float
    height: float

    def __post_init__(self) -> None:
        _check_lengths(self, "radius", "height")

    def body(self) -> Body:
        """Return what distances are computed from."""
        half = 0.5 * self.height
        corners = np.concatenate([_ring(self.radius, -half), [[0.0, 0.0, half]]])
        geometry = coal().Cone(self.radius, self.height)
        sizes = (self.radius, half, 0.0)
        return Body(geometry, corners, _PYRAMID, 0.0, CYLINDER, sizes, exact=False)


@dataclass(frozen=True, eq=False)
class Plane(Shape):
    """All points x with ``normal . x <= offset`` (m): the floor has the normal (0, 0, 1)."""

    normal: Array
    offset: float = 0.0

    def __post_init__(self) -> None:
        normal = as_single("normal", self.normal, (3,))
        length = math.hypot(*normal)
        if not SMALLEST < length < LARGEST:
            expected = f"a vector with a length of {SMALLEST:g} to {LARGEST:g}"
            raise BadValueError("normal", normal.tolist(), expected)
        reach = LARGEST * min(length, 1.0)
        expected = f"at most {reach:g} to either side"
        offset = finite_within("offset", self.offset, expected, -reach, reach)
        object.__setattr__(self, "normal", normal / length)
        object.__setattr__(self, "offset", offset / length)

    def body(self) -> Body:
        """Return what distances are computed from."""
        pose = rotation_from_z(self.normal)
        pose[:3, 3] = self.offset * self.normal
        geometry = coal().Halfspace(self.normal, self.offset)
        return Body(geometry, pose[None, :3, 3], _DOT, 0.0, HALF_SPACE, pose=pose)


def _check_lengths(shape: Any, *names: str) -> None:
    for name in names:
        expected = f"{SMALLEST:g} to {LARGEST:g} m"
        value = finite_within(name, getattr(shape, name), expected, SMALLEST, LARGEST)
        object.__setattr__(shape, name, value)


def _ring(radius: float, height: float) -> Array:
    """Return the corners of a polygon around a circle."""
    turns = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    wider = radius * (1.0 + EXCESS)
    return np.column_stack([wider * np.cos(turns), wider * np.sin(turns), [height] * _SIDES])
