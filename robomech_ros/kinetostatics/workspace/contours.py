"""Curves in the plane of two joint values on which det J21 vanishes, followed in all branches.

Every root on the lines of a grid is found and refined, the crossings of a cell are joined, and
the polylines are made finer until their images are smooth; every vertex is a root.
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinetostatics.workspace.deflated_determinant import DeflatedDeterminant
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection

__all__ = ["Contour", "edges_of_box", "on_contour", "refined", "singular_contours"]

Array = NDArray[np.float64]

# Lines of the grid in each direction.
_LINES = 320
# The grid keeps off the ends of a range by this share, so that a root at the end is no crossing.
_INWARD = 1e-7
# Offset of a grid all round, in cells: no root that symmetry puts somewhere falls on a line.
_OFFSET = 0.38196601125
# Within so many cells of a crossing of branches no vertex is kept but the crossing.
_CORNER = 1.6
_BISECTIONS = 52
_NEWTON = 8
_PROJECTIONS = 12
# Images: longest chord, and farthest that a chord may be from the curve, over the arm's size.
_CHORD = 1.0 / 400.0
_SAGITTA = 1e-6
_HALVINGS = 14
_MOST_VERTICES = 60_000
_EDGE_VERTICES = 65


@dataclass(frozen=True, eq=False)
class Contour:
    """A curve in the joint plane on which the arm is singular.

    Parameters
    ----------
    joint : int
        1 or 2 where the value of this joint (from 0) is constant along it, else 0.
    q : ndarray, shape (k, 2)
        Values of joints 2 and 3 (rad or m), unwrapped; a closed curve ends where it began, up to
        turns.
    """

    joint: int
    q: Array


def singular_contours(section: WorkspaceSection) -> list[Contour]:
    """Follow det J21 = 0 inside the ranges of joints 2 and 3."""
    deflated = DeflatedDeterminant(section)
    lines = [_lines(section, j) for j in (1, 2)]
    roots = _grid_roots(deflated, lines)
    segments = _segments(section, lines, roots)
    found = [
        _unwrapped(section, np.array([roots[key] for key in path])) for path in _joined(segments)
    ]
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
            result.append(Contour(0, refined(section, ends, deflated.onto)))
    return result + straight


def _straight(section: WorkspaceSection, joint: int, value: float) -> tuple[Array, Array]:
    """Give a line of constant joint value, and the points on it in which others cross it."""
    other = 3 - joint
    along = np.linspace(section.lower[other], section.upper[other], 2 * _LINES + 1)
    along += 0.0 if not section.round[other] else _OFFSET * (along[1] - along[0])
    curve = np.empty((len(along), 2))
    curve[:, joint - 1], curve[:, other - 1] = value, along

    def slope(rows: Array) -> Array:
        _, *slopes = section.determinant_gradient(rows[:, 0], rows[:, 1])
        across: Array = slopes[joint - 1]
        return across

    values = slope(curve)
    change = np.flatnonzero((values[:-1] > 0.0) != (values[1:] > 0.0))
    low, high, positive = curve[change], curve[change + 1], values[change] > 0.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        left = (slope(middle) > 0.0) == positive
        low, high = np.where(left[:, None], middle, low), np.where(left[:, None], high, middle)
    return np.insert(curve, change + 1, low, axis=0), low


def _lines(section: WorkspaceSection, joint: int) -> Array:
    """Give the grid's values of joint 2 (1) or 3 (2)."""
    lower, upper = section.lower[joint], section.upper[joint]
    if section.round[joint]:
        whole: Array = lower + (upper - lower) * (np.arange(_LINES) + _OFFSET) / _LINES
        return whole
    margin = _INWARD * (upper - lower)
    return np.linspace(lower + margin, upper - margin, _LINES)


_Key = tuple[int, int, int]


def _grid_roots(
    deflated: DeflatedDeterminant, lines: list[Array]
) -> dict[_Key, tuple[float, float]]:
    """Find the sign changes between neighbouring nodes: (direction, i, j) -> the root."""
    section = deflated.section
    u, v = np.meshgrid(*lines, indexing="ij")
    positive = deflated.positive(u, v)
    roots: dict[_Key, tuple[float, float]] = {}
    for axis in (0, 1):
        beside = np.roll(positive, -1, axis)
        change = positive != beside
        if not section.round[axis + 1]:
            change[(-1,) if axis == 0 else (slice(None), -1)] = False
        index = np.argwhere(change)
        low = np.stack((lines[0][index[:, 0]], lines[1][index[:, 1]]), axis=1)
        high = low.copy()
        step = 2.0 * np.pi / _LINES if section.round[axis + 1] else lines[axis][1] - lines[axis][0]
        high[:, axis] += step
        root = _bisected(deflated, low, high, positive[tuple(index.T)])
        for (i, j), (x, y) in zip(index.tolist(), root.tolist(), strict=True):
            roots[axis, i, j] = (x, y)
    return roots


def _bisected(
    deflated: DeflatedDeterminant, low: Array, high: Array, positive: NDArray[np.bool_]
) -> Array:
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        left = deflated.positive(middle[:, 0], middle[:, 1]) == positive
        low = np.where(left[:, None], middle, low)
        high = np.where(left[:, None], high, middle)
    return 0.5 * (low + high)


def _segments(
    section: WorkspaceSection, lines: list[Array], roots: dict[_Key, tuple[float, float]]
) -> list[tuple[_Key, _Key]]:
    """Join the roots around each cell in pairs."""
    cells: dict[tuple[int, int], list[_Key]] = defaultdict(list)
    for axis, i, j in roots:
        # Cell (i, j) has node (i, j) at its low corner; a root on a line belongs to two cells.
        cells[i, j].append((axis, i, j))
        beside = (i, j - 1) if axis == 0 else (i - 1, j)
        other = 1 - axis
        if beside[other] < 0 and section.round[other + 1]:
            beside = (i, _LINES - 1) if axis == 0 else (_LINES - 1, j)
        if beside[other] >= 0:
            cells[beside].append((axis, i, j))
    segments = []
    for (i, j), keys in cells.items():
        if len(keys) == 2:
            segments.append((keys[0], keys[1]))
        elif len(keys) == 4:
            segments.extend(_saddle(section, lines, i, j, keys, roots))
    return segments


def _saddle(
    section: WorkspaceSection,
    lines: list[Array],
    i: int,
    j: int,
    keys: list[_Key],
    roots: dict[_Key, tuple[float, float]],
) -> list[tuple[_Key, _Key]]:
    """Join the four roots around a cell across which two branches pass, or cross."""
    low = [key for key in keys if key in ((0, i, j), (1, i, j))]
    bottom, left = sorted(low)
    top = next(key for key in keys if key[0] == 0 and key != bottom)
    right = next(key for key in keys if key[0] == 1 and key != left)
    centre = _critical(section, np.array(roots[bottom]))
    value = section.determinant(centre[0], centre[1])
    corner = section.determinant(lines[0][i], lines[1][j])
    size = np.abs(corner)
    if abs(value) <= 1e-6 * size:
        return [(bottom, top), (left, right)]
    # The corner's region and that of the saddle's value are one where the signs agree.
    if (value >= 0.0) == (corner >= 0.0):
        return [(bottom, right), (left, top)]
    return [(bottom, left), (right, top)]


def _critical(section: WorkspaceSection, start: Array) -> Array:
    """Find where the gradient of det J21 vanishes, near a point."""
    point = start.copy()
    h = 1e-30
    for _ in range(_NEWTON):
        _, fu, fv = section.determinant_gradient(point[0], point[1])
        gu = section.determinant_gradient(point[0] + 1j * h, point[1])
        gv = section.determinant_gradient(point[0], point[1] + 1j * h)
        H = np.array([[gu[1].imag, gv[1].imag], [gu[2].imag, gv[2].imag]]) / h
        step = np.linalg.lstsq(H, np.array([float(fu), float(fv)]), rcond=None)[0]
        point -= step
    return point


def _crossings(section: WorkspaceSection, curves: list[Array]) -> Array:
    """Find the points (k, 2) in which branches cross, from where the gradient is least on them."""
    found: list[Array] = []
    for curve in curves:
        _, *gradient = section.determinant_gradient(curve[:, 0], curve[:, 1])
        steep = np.hypot(*gradient)
        padded = np.concatenate(([np.inf], steep, [np.inf]))
        low = (steep <= padded[:-2]) & (steep <= padded[2:]) & (steep < 0.1 * steep.max())
        for start in curve[low]:
            point = _critical(section, start)
            near = np.abs(point - start).max() < 4.0 * _cell(section).max()
            crosses = near and abs(section.determinant(*point)) <= 1e-14 * section.size**3
            if crosses and all(_apart(section, point, other).max() > 1e-6 for other in found):
                found.append(point)
    return np.array(found).reshape(-1, 2)


def _cell(section: WorkspaceSection) -> Array:
    spans: Array = (section.upper[1:] - section.lower[1:]) / _LINES
    return spans


def _apart(section: WorkspaceSection, points: Array, other: Array) -> Array:
    """Give the differences of points, without whole turns (rad or m)."""
    turn = 2.0 * np.pi * section.round[1:]
    apart = other - points
    result: Array = np.abs(apart - turn * np.round(apart / (2.0 * np.pi)))
    return result


def _with_crossings(section: WorkspaceSection, curve: Array, crossings: Array) -> Array:
    """Lead a curve through the points near it in which branches cross.

    The grid joins the branches there as it happens; led through the crossing, the vertices of a
    path are on its branches all the same.
    """
    cell = _cell(section)
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


def _joined(segments: list[tuple[_Key, _Key]]) -> list[list[_Key]]:
    """Join segments to paths; a closed one ends with the key it began with."""
    at: dict[_Key, list[int]] = defaultdict(list)
    for k, (a, b) in enumerate(segments):
        at[a].append(k)
        at[b].append(k)
    used = [False] * len(segments)

    def follow(start: _Key) -> list[_Key]:
        path = [start]
        while True:
            following = next((k for k in at[path[-1]] if not used[k]), None)
            if following is None:
                return path
            used[following] = True
            a, b = segments[following]
            path.append(b if a == path[-1] else a)

    ends = [key for key, links in at.items() if len(links) == 1]
    paths = [follow(key) for key in ends]
    paths += [follow(segments[k][0]) for k in range(len(segments)) if not used[k]]
    return [path for path in paths if len(path) > 1]


def _unwrapped(section: WorkspaceSection, curve: Array) -> Array:
    """Add turns so that neighbouring vertices are near each other."""
    result = curve.copy()
    for axis in (0, 1):
        if section.round[axis + 1]:
            result[:, axis] = np.unwrap(result[:, axis])
    return result


def _to_the_ends(section: WorkspaceSection, curve: Array) -> Array:
    """Continue an open curve onto the ends of the ranges, from which the grid keeps off."""
    added = []
    for vertex in (curve[0], curve[-1]):
        end = vertex
        for axis in (0, 1):
            if section.round[axis + 1]:
                continue
            lower, upper = section.lower[axis + 1], section.upper[axis + 1]
            near = 2.0 * _INWARD * (upper - lower)
            for bound in (lower, upper):
                if abs(vertex[axis] - bound) < near:
                    end = _on_edge(section, vertex, axis, bound)
        added.append(end)
    closed = np.abs(curve[0] - curve[-1]).max() < 1e-9
    rows = curve if closed else np.concatenate((added[:1], curve, added[1:]))
    apart = np.abs(np.diff(rows, axis=0)).max(axis=1) > 1e-13
    result: Array = rows[np.concatenate(([True], apart))]
    return result


def _on_edge(section: WorkspaceSection, vertex: Array, axis: int, bound: float) -> Array:
    """Move a vertex along the curve onto the end of a range; as it is where that leads away."""
    point = vertex.copy()
    point[axis] = bound
    other = 1 - axis
    for _ in range(_NEWTON):
        f, *gradient = section.determinant_gradient(point[0], point[1])
        if gradient[other] == 0.0:
            break
        point[other] -= f / gradient[other]
    room = 100.0 * _INWARD * (section.upper[axis + 1] - section.lower[axis + 1])
    return point if np.abs(point - vertex).max() < room else vertex


def on_contour(section: WorkspaceSection, rows: Array, steps: int = _PROJECTIONS) -> Array:
    """Move points (k, 2) of the joint plane onto det J21 = 0 along its gradient, in some steps."""
    rows = rows.copy()
    for _ in range(steps):
        f, fu, fv = section.determinant_gradient(rows[:, 0], rows[:, 1])
        square = fu * fu + fv * fv
        share = np.divide(f, square, out=np.zeros_like(f), where=square > 0.0)
        rows[:, 0] -= share * fu
        rows[:, 1] -= share * fv
    return rows


def refined(
    section: WorkspaceSection, curve: Array, onto: Callable[[Array], Array] | None
) -> Array:
    """Add vertices until the chords of the image are short and near it.

    Parameters
    ----------
    section : WorkspaceSection
    curve : ndarray, shape (k, 2)
        Joint values (rad or m).
    onto : callable, optional
        Puts points between vertices back on the curve; default where straight lines are.

    Returns
    -------
    ndarray, shape (m, 2)
    """
    chord, sagitta = _CHORD * section.size, _SAGITTA * section.size
    settled = np.zeros(len(curve) - 1, dtype=bool)
    for _ in range(_HALVINGS):
        if settled.all() or len(curve) > _MOST_VERTICES:
            break
        open_ = np.flatnonzero(~settled)
        a, b = curve[open_], curve[open_ + 1]
        middle = 0.5 * (a + b)
        if onto is not None:
            middle = onto(middle)
        lengths = np.linalg.norm(b - a, axis=1)
        astray = np.linalg.norm(middle - 0.5 * (a + b), axis=1) > 0.6 * lengths
        x, y, m = (section.image(rows[:, 0], rows[:, 1]) for rows in (a, b, middle))
        long = np.linalg.norm(y - x, axis=1) > chord
        bent = np.linalg.norm(m - 0.5 * (x + y), axis=1) > sagitta
        split = (long | bent) & ~astray
        settled[open_[~split]] = True
        where = open_[split] + 1
        curve = np.insert(curve, where, middle[split], axis=0)
        settled = np.insert(settled, where - 1, False)
    return curve


def edges_of_box(section: WorkspaceSection) -> list[tuple[int, bool, Array]]:
    """Give the curves on which joint 2 or 3 is at a limit.

    Returns
    -------
    list of (int, bool, ndarray)
        The joint (1 or 2, from 0), whether it is at its upper limit, and vertices (k, 2).
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
