"""The tables that kernels read of the bodies of a scene; see `_kernels.collision.tables`."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from robomech_ros._kernels.collision.grids import CELLS
from robomech_ros._kernels.collision.shapes import DRIVE, GAIN, KIND, PARENT, SPHERES
from robomech_ros._kernels.collision.tables import Tables
from robomech_ros.collision.placed_bodies import PlacedBody
from robomech_ros.collision.robot_bodies import as_row
from robomech_ros.typing import Array, IntArray

_NO_PAIRS = np.empty((0, 5))
# Most scenes of a robot with kept bounds; they differ in joints beside the chain.
_MOST_KNOWN = 4


def fill_tables(
    joints: Array, placed: Sequence[PlacedBody], pairs: Array, grids: tuple[Array, Array]
) -> Tables:
    """Return the tables of the kernels.

    Parameters
    ----------
    joints : ndarray, shape (m, 17)
        The tree of joints; see `robot_bodies`.
    placed : sequence of PlacedBody
        Bodies with spheres first.
    pairs : ndarray, shape (p, 5)
        As from `list_pairs`.
    grids : tuple of ndarray
        As from `group_grids`.
    """
    spheres, bodies, first, corner = [np.empty((0, 8))], [], 0, 0
    for one in placed:
        count = len(one.spheres)
        kind = SPHERES if count else one.body.kind
        row = [one.frame, first, first + count, kind, one.body.exact]
        bodies.append([*row, corner, one.body.radius, one.body.hull_kind])
        moved = one.spheres.copy()
        for column in (0, 4):
            moved[:, column : column + 3] = _moved(one.pose, one.spheres[:, column : column + 3])
        spheres.append(moved)
        first += count
        corner += len(one.body.corners)
    around = [[*_moved(one.pose, one.around[:3]), one.around[3]] for one in placed]
    shapes = [[*as_row(one.pose @ one.body.pose), *one.body.sizes] for one in placed]
    tables = Tables(
        joints,
        np.array(bodies, dtype=np.float64).reshape(-1, 8),
        np.array(around).reshape(-1, 4),
        np.concatenate(spheres),
        np.array(shapes).reshape(-1, 15),
        np.array([as_row(one.pose) for one in placed]).reshape(-1, 12),
        pairs,
        *_hulls(placed),
        np.zeros((len(pairs), 5)),
        *grids,
    )
    # The first search for a plane between a pair begins at the first corner of each body.
    tables.axes[:, 3:] = tables.bodies[pairs[:, :2].astype(np.int64), 5]
    return tables


def list_pairs(
    joints: Array,
    placed: Sequence[PlacedBody],
    checked: Callable[[PlacedBody, PlacedBody], bool],
    padding: float,
) -> Array:
    """List the pairs (p, 5) of bodies that move against each other; see `Tables`."""
    above = {0: {0}}
    order: dict[int, list[int]] = {0: [0]}
    for i, parent in enumerate(joints[:, 0].astype(int).tolist()):
        order[i + 1] = [i + 1, *order[parent]]
        above[i + 1] = set(order[i + 1])
    rows, owners = [], []
    for i, one in enumerate(placed):
        if not len(one.spheres):
            break
        for j in range(i + 1, len(placed)):
            other = placed[j]
            if one.frame == other.frame or not checked(one, other):
                continue
            common = next(k for k in order[one.frame] if k in above[other.frame])
            rows.append((i, j, common, 0.0 if len(other.spheres) else padding))
            owners.append((one.owner, other.owner))
    groups = {two: k for k, two in enumerate(dict.fromkeys(owners))}
    numbered = [(*row, groups[two]) for row, two in zip(rows, owners, strict=True)]
    numbered.sort(key=lambda row: row[4])
    return np.array(numbered, dtype=np.float64) if rows else _NO_PAIRS


def group_grids(
    joints: Array,
    placed: Sequence[PlacedBody],
    pairs: Array,
    groups: list[int],
    known: dict[bytes, Array],
) -> tuple[Array, Array]:
    """Return the grids (g, 5) of the groups of pairs, and their cells; see `Tables`."""
    numbers = pairs.astype(np.int64)
    grids, size = np.full((len(groups) - 1, 5), -1.0), 0
    chosen = [np.empty((0, 2), dtype=np.int64)]
    for g, (first, last) in enumerate(itertools.pairwise(groups)):
        grids[g, 3:] = first, last
        a, b, common = numbers[first, :3].tolist()
        if placed[a].is_carried or placed[b].is_carried or not len(placed[b].spheres):
            continue
        drives = _two_drives(joints, (placed[a].frame, placed[b].frame), common)
        if not drives:
            continue
        grids[g, :3] = drives[0], drives[-1] if len(drives) == 2 else -1, size
        size += CELLS ** len(drives)
        chosen.append(numbers[first:last, :2])
    bodies = np.concatenate(chosen)
    poses = b"".join(placed[k].pose.tobytes() for k in np.unique(bodies).tolist())
    key = b"".join((joints.tobytes(), bodies.tobytes(), poses))
    cells = known.get(key)
    if cells is None:
        for oldest in list(known)[: max(len(known) + 1 - _MOST_KNOWN, 0)]:
            known.pop(oldest, None)
        cells = known[key] = np.zeros(size)
    return grids, cells


def _two_drives(joints: Array, frames: tuple[int, int], common: int) -> list[int]:
    """Return the drives of the joints between two frames if these are one or two that turn."""
    drives = []
    for frame in frames:
        while frame != common:
            row = joints[frame - 1]
            if row[KIND] != 0.0 or abs(row[GAIN]) != 1.0:
                return []
            drives.append(int(row[DRIVE]))
            frame = int(row[PARENT])
    return drives if len(set(drives)) == len(drives) <= 2 else []


def _hulls(placed: Sequence[PlacedBody]) -> tuple[Array, IntArray]:
    """Return the corners (k, 5) of all bodies in their frames, and their neighbours."""
    rows, neighbours, count, first = [np.empty((0, 5))], [np.empty(0, dtype=np.int64)], 0, 0
    for one in placed:
        size = len(one.body.corners)
        starts, targets = one.body.edges[: size + 1], one.body.edges[size + 1 :]
        where = np.column_stack([starts[:-1], starts[1:]]) + count
        rows.append(np.column_stack([_moved(one.pose, one.body.corners), where]))
        neighbours.append(targets + first)
        count += len(targets)
        first += size
    return np.ascontiguousarray(np.concatenate(rows)), np.concatenate(neighbours)


def _moved(pose: Array, points: Array) -> Array:
    moved: Array = points @ pose[:3, :3].T + pose[:3, 3]
    return moved
