"""Triangles of the simple bodies."""

from typing import NamedTuple

import numpy as np

from robomech_ros.typing import Array, IntArray

# Sides of cylinders, and of spheres from pole to pole.
SIDES, RINGS = 24, 12


class Solid(NamedTuple):
    """A closed surface of triangles.

    Parameters
    ----------
    vertices : ndarray, shape (k, 3)
        m.
    faces : ndarray of int, shape (m, 3)
        Counter-clockwise from outside.
    """

    vertices: Array
    faces: IntArray


def box(x: float, y: float, z: float) -> Solid:
    """Make a box of these sizes (m) about the origin."""
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Solid(0.5 * signs * (x, y, z), _triangles(quads))


def cylinder(radius: float, length: float) -> Solid:
    """Make a cylinder along z about the origin (m)."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
    half = np.full((SIDES, 1), 0.5 * length)
    ends = [[0.0, 0.0, -0.5 * length], [0.0, 0.0, 0.5 * length]]
    vertices = np.vstack([np.hstack([ring, -half]), np.hstack([ring, half]), ends])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    bottom, top = np.full(SIDES, 2 * SIDES), np.full(SIDES, 2 * SIDES + 1)
    faces = [
        np.column_stack([here, there, there + SIDES]),
        np.column_stack([here, there + SIDES, here + SIDES]),
        np.column_stack([bottom, there, here]),
        np.column_stack([top, here + SIDES, there + SIDES]),
    ]
    return Solid(vertices, np.vstack(faces))


def cone(radius: float, height: float) -> Solid:
    """Make a cone along z, its tip at the origin and its base at the height (m)."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    x, y = radius * np.cos(angles), radius * np.sin(angles)
    ring = np.column_stack([x, y, np.full(SIDES, height)])
    vertices = np.vstack([ring, [[0.0, 0.0, 0.0], [0.0, 0.0, height]]])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    tip, middle = np.full(SIDES, SIDES), np.full(SIDES, SIDES + 1)
    faces = [np.column_stack([tip, there, here]), np.column_stack([middle, here, there])]
    return Solid(vertices, np.vstack(faces))


def sphere(radius: float) -> Solid:
    """Make a sphere about the origin (m)."""
    turns = 2.0 * np.pi * np.arange(SIDES) / SIDES
    heights = np.pi * np.arange(1, RINGS) / RINGS
    rings = np.stack(
        [
            np.outer(np.sin(heights), np.cos(turns)),
            np.outer(np.sin(heights), np.sin(turns)),
            np.outer(np.cos(heights), np.ones(SIDES)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = radius * np.vstack([rings, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    last = SIDES * (RINGS - 2)
    north, south = np.full(SIDES, len(rings)), np.full(SIDES, len(rings) + 1)
    faces = [np.column_stack([north, here, there])]
    for first in range(0, last, SIDES):
        a, b = first + here, first + there
        faces += [np.column_stack([a, a + SIDES, b]), np.column_stack([b, a + SIDES, b + SIDES])]
    faces.append(np.column_stack([south, last + there, last + here]))
    return Solid(vertices, np.vstack(faces))


def _triangles(quads: list[tuple[int, int, int, int]]) -> IntArray:
    return np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
