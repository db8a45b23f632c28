"""The edges of convex hulls, along which a search for a farthest corner climbs."""

from collections.abc import Iterable

import numpy as np
from scipy.spatial import ConvexHull

from robomech_ros.typing import Array, IntArray


def joined(edges: Iterable[tuple[int, int]] | IntArray, count: int) -> IntArray:
    """List for each of the corners those that an edge joins to it.

    Parameters
    ----------
    edges : sequence of two int
        The ends of each edge, in any order.
    count : int
        Number of corners.

    Returns
    -------
    ndarray, shape (count + 1 + 2 e,)
        Index of the first neighbour of each corner, the end of the last range, and the
        neighbours.
    """
    pairs = np.array(list(edges), dtype=np.int64).reshape(-1, 2)
    both = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    starts = np.searchsorted(both[:, 0], np.arange(count + 1))
    return np.concatenate([starts, both[:, 1]]).astype(np.int64)


def hull_edges(points: Array) -> tuple[Array, IntArray]:
    """Return the corners (k, 3) of the hull of points, and their neighbours; see `joined`."""
    # A search could not leave points inside of the hull.
    kept, faces = np.unique(ConvexHull(points).simplices, return_inverse=True)
    edges = faces.reshape(-1, 3)[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return points[kept], joined(edges, len(kept))


def prism_edges(sides: int) -> IntArray:
    """List the neighbours of the corners of a prism: those below in order, then those above."""
    below = [(k, (k + 1) % sides) for k in range(sides)]
    above = [(a + sides, b + sides) for a, b in below]
    return joined([*below, *above, *((k, k + sides) for k in range(sides))], 2 * sides)


def pyramid_edges(sides: int) -> IntArray:
    """List the neighbours of the corners of a pyramid: those below in order, then its tip."""
    below = [(k, (k + 1) % sides) for k in range(sides)]
    return joined([*below, *((k, sides) for k in range(sides))], sides + 1)
