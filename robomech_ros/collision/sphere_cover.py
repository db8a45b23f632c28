"""Spheres that cover a convex body, and spheres inside it."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from robomech_ros.typing import Array

# Steps towards the centre of the smallest ball around points; the ball is exact for its centre.
_BALL_STEPS = 60
# Largest ball (m), and largest ratio of its width to the thickness, of a piece that is not cut.
_SMALL, _ROUND = 0.02, 1.25
# Rounding error of points at a cut, relative to the size of the body.
_ROUNDING = 1e-9


def cover(points: Array, radius: float, most: int) -> tuple[Array, Array]:
    """Cover the convex hull of points, and all within a radius of it, by spheres.

    Parameters
    ----------
    points : ndarray, shape (k, 3)
        m.
    radius : float
        Distance of the surface of the body from the hull (m).
    most : int
        The most spheres there may be.

    Returns
    -------
    spheres : ndarray, shape (s, 8)
        Centre and radius of a sphere, then of one inside the part that it covers (m).
    around : ndarray, shape (4,)
        Centre and radius of a sphere around all.
    """
    pieces = [_Piece(points)]
    around = np.append(pieces[0].centre, pieces[0].radius + radius)
    while len(pieces) < most:
        widest = max(pieces, key=lambda piece: piece.radius if piece.divisible else -1.0)
        halves = widest.halves() if widest.divisible else ()
        if not halves:
            break
        pieces.remove(widest)
        pieces += halves
    rows = [[*one.centre, one.radius + radius, *one.middle, one.inner + radius] for one in pieces]
    spheres = np.array(rows)
    spheres[:, 3] *= 1.0 + _ROUNDING
    around[3] *= 1.0 + _ROUNDING
    return spheres, around


def sphere_around(spheres: Array) -> Array:
    """Return the centre and radius (4,) of a sphere around spheres (s, 8), as from `cover` (m)."""
    centres, radii = spheres[:, :3], spheres[:, 3]
    low, high = centres - radii[:, None], centres + radii[:, None]
    middle = 0.5 * (low.min(axis=0) + high.max(axis=0))
    radius = float((np.linalg.norm(centres - middle, axis=1) + radii).max())
    return np.append(middle, radius * (1.0 + _ROUNDING))


class _Piece:
    """The convex hull of points, with a ball around it and one inside."""

    def __init__(self, points: Array) -> None:
        self.points = points
        self.centre, self.radius = _ball(points)
        self.middle, self.inner = self.centre, 0.0
        self.divisible = False
        try:
            self.hull = ConvexHull(points)
        except (QhullError, ValueError):
            # Flat, a line, or a point: one ball is good enough, and nothing is inside.
            return
        corners = points[self.hull.vertices]
        self.middle = corners.mean(axis=0)
        planes = self.hull.equations
        self.inner = float(-(planes[:, :3] @ self.middle + planes[:, 3]).max())
        self.axes = np.linalg.svd(corners - self.middle, full_matrices=False)[2]
        along = corners @ self.axes.T
        extents = np.ptp(along, axis=0)
        self.longest = int(np.argmax(extents))
        self.cut = float(along[:, self.longest].min() + 0.5 * extents[self.longest])
        self.divisible = self.radius > max(_SMALL, _ROUND * 0.5 * float(extents.min()))

    def halves(self) -> tuple["_Piece", ...]:
        """Cut the piece across its longest extent."""
        heights = self.points @ self.axes[self.longest] - self.cut
        edges = self.hull.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        low, high = heights[edges[:, 0]], heights[edges[:, 1]]
        crossing = low * high < 0.0
        edges, low, high = edges[crossing], low[crossing], high[crossing]
        share = (low / (low - high))[:, None]
        section = self.points[edges[:, 0]] * (1.0 - share) + self.points[edges[:, 1]] * share
        corners = self.points[self.hull.vertices]
        side = heights[self.hull.vertices]
        below = np.concatenate([corners[side <= 0.0], section])
        above = np.concatenate([corners[side >= 0.0], section])
        if min(len(below), len(above)) < 4:
            return ()
        return _Piece(below), _Piece(above)


def _ball(points: Array) -> tuple[Array, float]:
    """Find a small ball around points, by Badoiu and Clarkson's steps towards the farthest."""
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    best, least = centre, float(np.linalg.norm(points - centre, axis=1).max())
    for k in range(_BALL_STEPS):
        away = points - centre
        squares = (away * away).sum(axis=1)
        farthest = int(np.argmax(squares))
        radius = float(np.sqrt(squares[farthest]))
        if radius < least:
            best, least = centre, radius
        centre = centre + away[farthest] / (k + 2.0)
    return best, least
