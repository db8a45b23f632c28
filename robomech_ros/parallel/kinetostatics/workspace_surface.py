"""The boundary of where a platform gets, as a surface or a polygon, and distances from it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import ConvexHull

from robomech_ros.parallel.kinetostatics.workspace import PlatformWorkspace
from robomech_ros.typing import Array, BoolArray, IntArray

# Least share of a direction that belongs to a facet: what is on an edge belongs to both sides.
_ON_EDGE = -1e-9
_TRIANGLE = 3
# Part of directions across a plane or a line that is rounding.
_FLAT = 1e-6


@dataclass(frozen=True, eq=False)
class WorkspaceSurface:
    """The facets between neighbouring directions of a workspace that was explored all round.

    From the centre (3,), facets (f, c, 3) are triangles in the space, lines in a plane or points of
    a line, in the base (m).  ``ended`` (f,) says whether something ends the workspace at a corner;
    others are as far as was looked.
    """

    centre: Array
    facets: Array
    ended: BoolArray

    @property
    def boundary(self) -> Array:
        """The facets at which something ends the workspace."""
        return self.facets[self.ended]

    @property
    def reach(self) -> float:
        """Distance of the farthest corner from the centre (m)."""
        return float(np.linalg.norm(self.facets - self.centre, axis=-1).max())

    def distance(self, points: Array) -> Array:
        """Measure how far points (k, 3) in the base are from the boundary, negative outside (m).

        It is infinite where nothing ends the workspace.  Facets are flat: it is exact to about a
        hundredth of the reach.
        """
        if not self.ended.any():
            return np.full(len(points), np.inf)
        least = np.array([self._nearest(point) for point in points])
        inside = np.array([self._is_inside(point) for point in points], dtype=bool)
        return np.where(inside, least, -least)

    @cached_property
    def _from_centre(self) -> Array:
        """Return for each facet the matrix from a point to its parts along the corners."""
        return np.asarray(np.linalg.pinv(np.swapaxes(self.facets - self.centre, -1, -2)))

    @cached_property
    def _on_facet(self) -> tuple[Array, Array]:
        """Return two sides of each boundary triangle, and the matrix from points to parts."""
        facets = self.boundary
        sides = np.stack((facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]), axis=-1)
        return sides, np.asarray(np.linalg.pinv(sides))

    def _is_inside(self, point: Array) -> bool:
        """Return whether a point is before the facet in whose direction it is from the centre."""
        parts = self._from_centre @ (point - self.centre)
        ahead = (parts >= _ON_EDGE).all(axis=1)
        total = parts.sum(axis=1)[ahead]
        return not len(total) or bool(total.min() <= 1.0)

    def _nearest(self, point: Array) -> float:
        """Return the distance (m) of a point (3,) from the facets of the boundary."""
        facets = self.boundary
        corners = facets.shape[1]
        edges = [_from_line(facets[:, k - 1], facets[:, k], point) for k in range(1, corners)]
        if corners == 1:
            return float(np.linalg.norm(facets[:, 0] - point, axis=1).min())
        if corners < _TRIANGLE:
            return float(np.min(edges))
        edges.append(_from_line(facets[:, 2], facets[:, 0], point))
        (sides, to_parts), away = self._on_facet, point - facets[:, 0]
        parts = (to_parts @ away[..., None])[..., 0]
        above = (parts >= 0.0).all(axis=1) & (parts.sum(axis=1) <= 1.0)
        height = np.linalg.norm(away - (sides @ parts[..., None])[..., 0], axis=1)
        return float(min(np.min(edges), height[above].min(initial=np.inf)))


def workspace_surface(space: PlatformWorkspace) -> WorkspaceSurface:
    """Join the ends of all directions of a workspace, evenly spread in space, a plane or a line."""
    pieces = neighbours(space.directions)
    ended = (space.causes[pieces] != "").any(axis=1)
    return WorkspaceSurface(space.centre[:3, 3], space.points[pieces], ended)


def neighbours(directions: Array) -> IntArray:
    """Find which directions (k, 3) all round are neighbours, shape (f, c).

    Three corners of triangles in the space, two ends of lines in a plane, or single ones of a line.
    """
    sizes, axes = np.linalg.svd(directions)[1:]
    freedoms = int((sizes > _FLAT * sizes[0]).sum())
    if freedoms == _TRIANGLE:
        return np.asarray(ConvexHull(directions).simplices, dtype=np.int64)
    if freedoms == 1:
        return np.arange(len(directions))[:, None]
    order = np.argsort(np.arctan2(*(directions @ axes[:2].T).T))
    return np.stack((order, np.roll(order, -1)), axis=1)


def _from_line(first: Array, last: Array, point: Array) -> Array:
    """Return the distances (f,) of a point from lines between ends (f, 3)."""
    way = last - first
    length = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    part = np.clip(((point - first) * way).sum(axis=1) / length, 0.0, 1.0)
    return np.asarray(np.linalg.norm(first + part[:, None] * way - point, axis=1))
