"""Triangles of the simple bodies."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robomech_ros.typing import Array, IntArray

# Sides of cylinders, and of spheres from pole to pole.
SIDES, RINGS = 24, 12


class Solid(NamedTuple):
    """A closed surface of triangles."""

    #: m, shape (k, 3).
    vertices: Array
    #: Counter-clockwise from outside, shape (m, 3).
    faces: IntArray


def box(x: float, y: float, z: float) -> Solid:
    """Make a box of these sizes (m) about the origin."""
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
    return Solid(0.5 * signs * (x, y, z), faces)


def cylinder(radius: float, length: float) -> Solid:
    """Make a cylinder along z about the origin (m)."""
    ends = (-0.5 * length, 0.5 * length)
    return _revolved((radius, radius), ends, ends)


def cone(radius: float, height: float) -> Solid:
    """Make a cone along z, its tip at the origin and its base at the height (m)."""
    return _revolved((radius,), (height,), (0.0, height))


def sphere(radius: float) -> Solid:
    """Make a sphere about the origin (m)."""
    angles = np.pi * np.arange(1, RINGS) / RINGS
    return _revolved(radius * np.sin(angles), -radius * np.cos(angles), (-radius, radius))


def capsule(radius: float, length: float) -> Solid:
    """Make a capsule along z about the origin: a cylinder of this length with round ends (m)."""
    half = RINGS // 2
    angles = np.pi * np.append(np.arange(1, half + 1), np.arange(half, RINGS)) / RINGS
    ends = 0.5 * length * np.append(-np.ones(half), np.ones(half))
    top = radius + 0.5 * length
    return _revolved(radius * np.sin(angles), ends - radius * np.cos(angles), (-top, top))


def _revolved(
    radii: Sequence[float] | Array, heights: Sequence[float] | Array, ends: tuple[float, float]
) -> Solid:
    """Join rings (m) from below to above, closed by a point of the axis at each end."""
    turns = 2.0 * np.pi * np.arange(SIDES) / SIDES
    x, y = (np.outer(radii, part).ravel() for part in (np.cos(turns), np.sin(turns)))
    rings = np.column_stack([x, y, np.repeat(heights, SIDES)])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    bottom, top = np.full(SIDES, len(rings)), np.full(SIDES, len(rings) + 1)
    last = len(rings) - SIDES
    faces = [np.column_stack([bottom, there, here])]
    for first in range(0, last, SIDES):
        a, b = first + here, first + there
        faces += [np.column_stack([a, b, b + SIDES]), np.column_stack([a, b + SIDES, a + SIDES])]
    faces.append(np.column_stack([top, last + here, last + there]))
    vertices = np.vstack([rings, [[0.0, 0.0, end] for end in ends]])
    return Solid(vertices, np.vstack(faces))
