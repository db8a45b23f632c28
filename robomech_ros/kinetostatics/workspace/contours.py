"""Curves in the plane of two joint values on which det J21 vanishes, followed in all branches.

Every root on the lines of a grid is found and refined, the crossings of a cell are joined, and
the polylines are made finer until their images are smooth; every vertex is a root.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from robomech_ros.kinetostatics.workspace.deflated_determinant import DeflatedDeterminant
from robomech_ros.kinetostatics.workspace.grid_curves import (
    INWARD,
    LINES,
    NEWTON,
    OFFSET,
    cell_size,
    critical_point,
    grid_curves,
)
from robomech_ros.kinetostatics.workspace.refinement import bisected, onto_zeros, refined
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.typing import Array, BoolArray

# Within so many cells of a crossing of branches no vertex is kept but the crossing.
_CORNER = 1.6
_EDGE_VERTICES = 65


@dataclass(frozen=True, eq=False)
class Contour:
    """A curve (k, 2) of values of joints 2 and 3 (rad or m) on which the arm is singular.

    The joint is 1 or 2 (from 0) where its value is constant along it, else 0.  Angles are
    unwrapped; a closed curve ends where it began, up to turns.
    """

    joint: int
    q: Array


def singular_contours(section: WorkspaceSection) -> list[Contour]:
    """Follow det J21 = 0 inside the ranges of joints 2 and 3."""
    deflated = DeflatedDeterminant(section)
    found = grid_curves(deflated)
    crossings = _crossings(section, found)
    straight = []
    for joint, value in deflated.lines:
        curve, on_line = _straight(section, joint, value)
        straight.append(Contour(joint, refined(section, curve, None)))
        crossings = np.concatenate((crossings, on_line))
    result = []
    for curve in found:
        ends = _to_the_ends(section, _with_crossings(section, curve, crossings))
        if len(ends) > 1:
            result.append(
                Contour(0, refined(section, ends, partial(onto_zeros, deflated.gradient)))
            )
    return result + straight


def _straight(section: WorkspaceSection, joint: int, value: float) -> tuple[Array, Array]:
    """Return a line of constant joint value, and the points on it in which others cross it."""
    other = 3 - joint
    along = np.linspace(section.lower[other], section.upper[other], 2 * LINES + 1)
    along += 0.0 if not section.round[other] else OFFSET * (along[1] - along[0])
    curve = np.empty((len(along), 2))
    curve[:, joint - 1], curve[:, other - 1] = value, along

    def rises(rows: Array) -> BoolArray:
        return section.determinant_gradient(rows[:, 0], rows[:, 1])[joint] > 0.0

    change = np.flatnonzero(np.diff(rises(curve)))
    low, _ = bisected(rises, curve[change], curve[change + 1])
    return np.insert(curve, change + 1, low, axis=0), low


def _crossings(section: WorkspaceSection, curves: list[Array]) -> Array:
    """Find the points (k, 2) in which branches cross, from where the gradient is least on them."""
    found: list[Array] = []
    for curve in curves:
        _, *gradient = section.determinant_gradient(curve[:, 0], curve[:, 1])
        steep = np.hypot(*gradient)
        padded = np.concatenate(([np.inf], steep, [np.inf]))
        low = (steep <= padded[:-2]) & (steep <= padded[2:]) & (steep < 0.1 * steep.max())
        for start in curve[low]:
            point = critical_point(section, start)
            near = np.abs(point - start).max() < 4.0 * cell_size(section).max()
            crosses = near and abs(section.determinant(*point)) <= 1e-14 * section.size**3
            if crosses and all(_apart(section, point, other).max() > 1e-6 for other in found):
                found.append(point)
    return np.array(found).reshape(-1, 2)


def _apart(section: WorkspaceSection, points: Array, other: Array) -> Array:
    """Return the differences of points, without whole turns (rad or m)."""
    turn = 2.0 * np.pi * section.round[1:]
    apart = other - points
    return np.abs(apart - turn * np.round(apart / (2.0 * np.pi)))


def _with_crossings(section: WorkspaceSection, curve: Array, crossings: Array) -> Array:
    """Lead a curve through the points near it in which branches cross.

    The grid joins the branches there as it happens; led through the crossing, the vertices of a
    path are on its branches all the same.
    """
    cell = cell_size(section)
    for crossing in crossings:
        near = (_apart(section, curve, crossing) / cell).max(axis=1) < _CORNER
        if near.all():
            continue
        rows: list[Array] = []
        for k, vertex in enumerate(curve):
            if not near[k]:
                rows.append(vertex)
            elif k == 0 or not near[k - 1]:
                turns = np.round((vertex - crossing) / (2.0 * np.pi)) * section.round[1:]
                rows.append(crossing + 2.0 * np.pi * turns)
        curve = np.array(rows)
    return curve


def _to_the_ends(section: WorkspaceSection, curve: Array) -> Array:
    """Continue an open curve onto the ends of the ranges, from which the grid keeps off."""
    added = []
    for vertex in (curve[0], curve[-1]):
        end = vertex
        for axis in (0, 1):
            if section.round[axis + 1]:
                continue
            lower, upper = section.lower[axis + 1], section.upper[axis + 1]
            near = 2.0 * INWARD * (upper - lower)
            for bound in (lower, upper):
                if abs(vertex[axis] - bound) < near:
                    end = _on_edge(section, vertex, axis, bound)
        added.append(end)
    closed = np.abs(curve[0] - curve[-1]).max() < 1e-9
    rows = curve if closed else np.concatenate((added[:1], curve, added[1:]))
    apart = np.abs(np.diff(rows, axis=0)).max(axis=1) > 1e-13
    return rows[np.concatenate(([True], apart))]


def _on_edge(section: WorkspaceSection, vertex: Array, axis: int, bound: float) -> Array:
    """Move a vertex along the curve onto the end of a range; as it is where that leads away."""
    point = vertex.copy()
    point[axis] = bound
    other = 1 - axis
    for _ in range(NEWTON):
        f, *gradient = section.determinant_gradient(point[0], point[1])
        if gradient[other] == 0.0:
            break
        point[other] -= f / gradient[other]
    room = 100.0 * INWARD * (section.upper[axis + 1] - section.lower[axis + 1])
    return point if np.abs(point - vertex).max() < room else vertex


def edges_of_box(section: WorkspaceSection) -> list[tuple[int, bool, Array]]:
    """Return the curves on which joint 2 or 3 is at a limit.

    Each comes with the joint (1 or 2, from 0), whether it is at its upper limit, and (k, 2) values.
    """
    edges = []
    for joint in (1, 2):
        if section.round[joint]:
            continue
        other = 3 - joint
        along = np.linspace(section.lower[other], section.upper[other], _EDGE_VERTICES)
        for is_upper, bound in ((False, section.lower[joint]), (True, section.upper[joint])):
            curve = np.empty((_EDGE_VERTICES, 2))
            curve[:, joint - 1] = bound
            curve[:, other - 1] = along
            edges.append((joint, is_upper, refined(section, curve, None)))
    return edges
