"""The tables of a scene, with a row for each joint, body, sphere, pair and group of pairs.

Spheres cover a body, and as many spheres are inside it.  The body is inside the convex hull of its
corners, enlarged by its radius.  Each body belongs to a frame moved by a joint; its positions and
poses are in that frame (m).  Pairs of bodies of the same two links or objects form a group; they
are consecutive.
"""

from typing import Any, NamedTuple

from numba import types

from robomech_ros._kernels.compiling.types import IIN1, IN2, IOUT1, OUT1, OUT2


class Tables(NamedTuple):
    """Bodies of a scene, and pairs of bodies that must not touch.

    Attributes
    ----------
    joints : ndarray, shape (m, 17)
        The tree of joints; see `shapes`.
    bodies : ndarray, shape (b, 8)
        Frame, first sphere and the one after the last, kind of a simple shape that contains the
        body (``SPHERES`` for none), 1 if the body is exactly that shape, first corner, radius, and
        the kind of its hull; see `hulls`.  The last rows enclose all bodies of one side of a
        group; they have only a frame and a row in ``around``.
    around : ndarray, shape (b, 4)
        Centre and radius of a sphere around the body.
    spheres : ndarray, shape (s, 8)
        Centre and radius of a covering sphere, then of an inner one.
    shapes : ndarray, shape (b, 15)
        Pose and sizes of the simple shape.
    placed : ndarray, shape (b, 12)
        Pose of the body.
    pairs : ndarray, shape (p, 5)
        Two bodies, of which the first has spheres; the frame before the first joint that moves
        them against each other; padding (m), which reduces the distance; group.
    corners : ndarray, shape (k, 5)
        Corners of the hulls, and their ranges in ``neighbours``; see `hulls`.
    neighbours : ndarray of int, shape (e,)
    axes : ndarray, shape (p, 5)
        Start of the next search for a plane between a pair; see `hulls`.
    grids : ndarray, shape (g, 7)
        Cells of each group; see `grids`.  Then the two bodies that enclose the sides of the group,
        or -1 if it has only one pair.
    cells : ndarray, shape (c,)
        Known bounds of distances (m); see `grids`.
    """

    joints: Any
    bodies: Any
    around: Any
    spheres: Any
    shapes: Any
    placed: Any
    pairs: Any
    corners: Any
    neighbours: Any
    axes: Any
    grids: Any
    cells: Any


class NearPairs(NamedTuple):
    """Pairs that need exact distances, in order of their lower bounds.

    Attributes
    ----------
    pairs : ndarray of int, shape (p,)
    low : ndarray, shape (p,)
        Lower bounds of their distances (m).
    poses : ndarray, shape (2 p, 12)
        Poses of both bodies of each pair in the base.
    """

    pairs: Any
    low: Any
    poses: Any


TABLES = types.NamedTuple((IN2, IN2, IN2, IN2, IN2, IN2, IN2, IN2, IIN1, OUT2, IN2, OUT1), Tables)
NEAR_PAIRS = types.NamedTuple((IOUT1, OUT1, OUT2), NearPairs)
