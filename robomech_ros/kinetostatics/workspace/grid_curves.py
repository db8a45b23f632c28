"""Curves on which det J21 changes sign, found on the lines of a grid and joined cell by cell."""

from collections import defaultdict

import numpy as np

from robomech_ros.kinetostatics.workspace.deflated_determinant import DeflatedDeterminant
from robomech_ros.kinetostatics.workspace.refinement import bisected
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.typing import Array

# Direction of a grid line, and the node before the root on it.
_Key = tuple[int, int, int]

# Lines of the grid in each direction.
LINES = 320
# The grid keeps off the ends of a range by this share, so that a root at the end is no crossing.
INWARD = 1e-7
# Offset of a grid all round, in cells: no root that symmetry puts somewhere falls on a line.
OFFSET = 0.38196601125
NEWTON = 8


def grid_curves(deflated: DeflatedDeterminant) -> list[Array]:
    """Find the curves (k, 2) on which a determinant vanishes, as values of joints 2 and 3.

    Every vertex is a root on a line of the grid.  Angles are unwrapped; a closed curve ends where
    it began, up to turns.
    """
    section = deflated.section
    lines = [_lines(section, j) for j in (1, 2)]
    roots = _grid_roots(deflated, lines)
    paths = _joined(_segments(section, lines, roots))
    return [_unwrapped(section, np.array([roots[key] for key in path])) for path in paths]


def _lines(section: WorkspaceSection, joint: int) -> Array:
    """Return the grid's values of joint 2 (1) or 3 (2)."""
    lower, upper = section.lower[joint], section.upper[joint]
    if section.round[joint]:
        return lower + (upper - lower) * (np.arange(LINES) + OFFSET) / LINES
    margin = INWARD * (upper - lower)
    return np.linspace(lower + margin, upper - margin, LINES)


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
        step = 2.0 * np.pi / LINES if section.round[axis + 1] else lines[axis][1] - lines[axis][0]
        high[:, axis] += step
        root = 0.5 * np.add(*bisected(lambda rows: deflated.positive(*rows.T), low, high))
        for (i, j), (x, y) in zip(index.tolist(), root.tolist(), strict=True):
            roots[axis, i, j] = (x, y)
    return roots


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
            beside = (i, LINES - 1) if axis == 0 else (LINES - 1, j)
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
    centre = critical_point(section, np.array(roots[bottom]))
    value = section.determinant(centre[0], centre[1])
    corner = section.determinant(lines[0][i], lines[1][j])
    size = np.abs(corner)
    if abs(value) <= 1e-6 * size:
        return [(bottom, top), (left, right)]
    # The corner's region and that of the saddle's value are one where the signs agree.
    if (value >= 0.0) == (corner >= 0.0):
        return [(bottom, right), (left, top)]
    return [(bottom, left), (right, top)]


def critical_point(section: WorkspaceSection, start: Array) -> Array:
    """Find where the gradient of det J21 vanishes, near a point."""
    point = start.copy()
    h = 1e-30
    for _ in range(NEWTON):
        _, fu, fv = section.determinant_gradient(point[0], point[1])
        gu = section.determinant_gradient(point[0] + 1j * h, point[1])
        gv = section.determinant_gradient(point[0], point[1] + 1j * h)
        H = np.array([[gu[1].imag, gv[1].imag], [gu[2].imag, gv[2].imag]]) / h
        step = np.linalg.lstsq(H, np.array([float(fu), float(fv)]), rcond=None)[0]
        point -= step
    return point


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


def cell_size(section: WorkspaceSection) -> Array:
    """Return the size (2,) of a cell of the grid (rad or m)."""
    return (section.upper[1:] - section.lower[1:]) / LINES
