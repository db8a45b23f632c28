"""Convex parts that together hold a closed mesh, for bodies that are nearly convex."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from robomech_ros.typing import Array, BoolArray

# Least reduction of the hulls by a cut, relative to the whole volume.
_WORTH = 0.005
# Least half thickness (m) of a hull, and its share of a length above 1 m: coal breaks below.
_THIN = 1e-6
# Parts are cut at these shares of their corners, along their three axes.
_PLACES = (0.35, 0.5, 0.65)


class _Part(NamedTuple):
    triangles: Array
    corners: Array
    volume: float


def convex_parts(triangles: Array, most: int) -> list[Array]:
    """Cut a mesh by planes into parts that fill their convex hulls better.

    Parameters
    ----------
    triangles : ndarray, shape (m, 3, 3)
        m.
    most : int
        The most parts there may be.

    Returns
    -------
    list of ndarray, shape (k, 3)
        Corners of the hulls; all that the mesh encloses is in one of them.
    """
    whole = _part(triangles)
    parts: list[_Part] = []
    waiting = [whole]
    while waiting:
        waiting.sort(key=lambda part: part.volume)
        widest = waiting.pop()
        halves = _best_cut(widest) if len(parts) + len(waiting) + 2 <= most else []
        saved = widest.volume - sum(one.volume for one in halves)
        if not halves or saved < _WORTH * whole.volume:
            parts.append(widest)
        else:
            waiting += halves
    return [part.corners for part in parts]


def convex_hull(points: Array) -> ConvexHull:
    """Return the hull of points (k, 3); raise ValueError if it is nearly flat."""
    hull = ConvexHull(points)
    if hull.volume < _THIN * max(1.0, float(np.ptp(points, axis=0).max())) * hull.area:
        raise ValueError("nearly flat")
    return hull


def is_closed(triangles: Array) -> bool:
    """Return whether each edge of a mesh (m, 3, 3) joins two triangles of opposite direction."""
    flat = triangles.reshape(-1, 3)
    size = float(np.ptp(flat, axis=0).max())
    _, numbers = np.unique(np.round(flat / size, 6), axis=0, return_inverse=True)
    corners = numbers.reshape(-1, 3)
    corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    forth, back = (np.unique(pairs, axis=0) for pairs in (edges, edges[:, ::-1]))
    return len(forth) == len(edges) and np.array_equal(forth, back)


def _part(triangles: Array) -> _Part:
    points = np.unique(triangles.reshape(-1, 3), axis=0)
    hull = convex_hull(points)
    return _Part(triangles, points[hull.vertices], float(hull.volume))


def _best_cut(part: _Part) -> list[_Part]:
    best: list[_Part] = []
    middle = part.corners.mean(axis=0)
    for axis in np.linalg.svd(part.corners - middle, full_matrices=False)[2]:
        along = part.corners @ axis
        for place in _PLACES:
            try:
                halves = _cut(part.triangles, axis, float(np.quantile(along, place)))
            except (QhullError, ValueError):
                continue
            if not best or sum(one.volume for one in halves) < sum(one.volume for one in best):
                best = halves
    return best


def _cut(triangles: Array, axis: Array, height: float) -> list[_Part]:
    """Cut a mesh at a plane; both halves get a face there, the hull of the cut."""
    away = triangles @ axis - height
    crossing = (away > 0.0).any(axis=1) & (away < 0.0).any(axis=1)
    corners, heights = triangles[crossing], away[crossing]
    after, below = np.roll(corners, -1, axis=1), np.roll(heights, -1, axis=1)
    crossed = heights * below < 0.0
    share = np.divide(heights, heights - below, out=np.zeros_like(heights), where=crossed)
    places = corners + share[:, :, None] * (after - corners)
    # Each corner, then the crossing of the plane and the edge to the next corner.
    points = np.stack([corners, places], axis=2).reshape(-1, 6, 3)
    face = _face(np.concatenate([places[crossed], triangles[away == 0.0]]), axis)
    halves = []
    for side in (1.0, -1.0):
        whole = triangles[~crossing & (side * away >= 0.0).all(axis=1)]
        valid = np.stack([side * heights >= 0.0, crossed], axis=2).reshape(-1, 6)
        halves.append(_part(np.concatenate([whole, _fans(points, valid), face])))
    return halves


def _face(points: Array, axis: Array) -> Array:
    """Return triangles that fill the hull of points of a plane."""
    across = np.linalg.svd(axis[None])[2][1:]
    hull = ConvexHull(points @ across.T)
    corners = points[hull.vertices]
    last = np.arange(2, len(corners))
    triangles: Array = np.stack([corners[0 * last], corners[last - 1], corners[last]], axis=1)
    return triangles


def _fans(points: Array, valid: BoolArray) -> Array:
    """Divide polygons, whose corners are some of six points (m, 6, 3), into triangles."""
    numbers = np.where(valid, np.arange(6), -1)
    # A point that is no corner stands for the corner before it, or for the first one.
    numbers = np.maximum.accumulate(numbers, axis=1)
    numbers = np.where(numbers < 0, np.argmax(valid, axis=1)[:, None], numbers)
    fans = np.stack([numbers[:, [0] * 4], numbers[:, 1:5], numbers[:, 2:6]], axis=2)
    rows = np.arange(len(points))[:, None, None]
    distinct = (fans != np.roll(fans, 1, axis=2)).all(axis=2)
    triangles: Array = points[rows, fans][distinct]
    return triangles
