"""The tables that kernels read of the bodies of a scene; see `_kernels.collision.tables`."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from robomech_ros._kernels.collision.grids import CELLS
from robomech_ros._kernels.collision.shapes import DRIVE, GAIN, KIND, PARENT, SPHERES
from robomech_ros._kernels.collision.tables import Tables
from robomech_ros.collision.placed_bodies import PlacedBody
from robomech_ros.collision.sphere_cover import sphere_around
from robomech_ros.typing import Array, IntArray

_NO_SPHERES, _NO_CORNERS = np.empty((0, 8)), np.empty((0, 3))
_NO_NUMBERS = np.empty(0, dtype=np.int64)
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
    poses = np.array([one.pose for one in placed]).reshape(-1, 4, 4)
    covers = [one.spheres for one in placed]
    ends = np.cumsum([len(cover) for cover in covers], dtype=np.int64)
    spheres = np.concatenate([_NO_SPHERES, *covers])
    of_spheres = np.repeat(np.arange(len(placed)), np.diff(ends, prepend=0))
    for column in (0, 4):
        centres = slice(column, column + 3)
        spheres[:, centres] = _moved(poses[of_spheres], spheres[:, centres])
    around = np.array([one.around for one in placed]).reshape(-1, 4)
    around[:, :3] = _moved(poses, around[:, :3])
    bodies, corner = [], 0
    for one, end in zip(placed, ends.tolist(), strict=True):
        count = len(one.spheres)
        kind = SPHERES if count else one.body.kind
        row = [one.frame, end - count, end, kind, one.body.exact]
        bodies.append([*row, corner, one.body.radius, one.body.hull_kind])
        corner += len(one.body.corners)
    shapes = np.array([one.body.pose for one in placed]).reshape(-1, 4, 4)
    sizes = np.array([one.body.sizes for one in placed]).reshape(-1, 3)
    enclosing = _bodies_around_groups(placed, of_spheres, spheres, pairs, grids[0])
    tables = Tables(
        joints,
        np.concatenate([np.array(bodies, dtype=np.float64).reshape(-1, 8), enclosing[0]]),
        np.concatenate([around, enclosing[1]]),
        spheres,
        np.concatenate([_as_rows(poses @ shapes), sizes], axis=1),
        _as_rows(poses),
        pairs,
        *_hulls(placed),
        np.zeros((len(pairs), 5)),
        *grids,
    )
    # The first search for a plane between a pair begins at the first corner of each body.
    tables.axes[:, 3:] = tables.bodies[pairs[:, :2].astype(np.int64), 5]
    return tables


def _side(placed: Sequence[PlacedBody], k: int) -> tuple[str, int]:
    """Return the key of all bodies that stand on one side of a group together with body k."""
    one = placed[k]
    if not len(one.spheres):
        return "", -1 - k
    return (one.owner, one.frame) if one.is_carried else ("", one.frame)


def _bodies_around_groups(
    placed: Sequence[PlacedBody], of_spheres: IntArray, spheres: Array, pairs: Array, grids: Array
) -> tuple[Array, Array]:
    """Return rows of bodies and spheres around groups of pairs; write their numbers to grids."""
    sides = [_side(placed, k) for k in range(len(placed))]
    counts = Counter(sides)
    order = {side: i for i, side in enumerate(counts)}
    of_sides = np.array([order[side] for side in sides])[of_spheres]
    numbers: dict[tuple[str, int], int] = {}
    bodies, around = [np.empty((0, 8))], [np.empty((0, 4))]
    firsts = pairs[grids[:, 3].astype(int), :2].astype(int).tolist()
    for row, pair in zip(grids, firsts, strict=True):
        if row[4] == row[3] + 1:
            continue
        for i, k in enumerate(pair):
            alone = counts[sides[k]] == 1
            if not alone and sides[k] not in numbers:
                numbers[sides[k]] = len(placed) + len(numbers)
                covers = spheres[of_sides == order[sides[k]]]
                around.append(sphere_around(covers)[None])
                bodies.append(np.array([[placed[k].frame, 0, 0, SPHERES, 0, 0, 0, 0]], dtype=float))
            row[5 + i] = k if alone else numbers[sides[k]]
    return np.concatenate(bodies), np.concatenate(around)


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
    sides = [_side(placed, k) for k in range(len(placed))]
    parts: dict[tuple[str, int, bool], list[int]] = {}
    for k, one in enumerate(placed):
        parts.setdefault((one.owner, one.frame, len(one.spheres) > 0), []).append(k)
    firsts_of_rows, counts = list[int](), list[int]()
    rows, groups = [], dict[tuple[tuple[str, int], ...], int]()
    for firsts, seconds in itertools.combinations(parts.values(), 2):
        one, other = placed[firsts[0]], placed[seconds[0]]
        if not len(one.spheres) or one.frame == other.frame or not checked(one, other):
            continue
        common = next(k for k in order[one.frame] if k in above[other.frame])
        lost = 0.0 if len(other.spheres) else padding
        for j in seconds:
            group = groups.setdefault((sides[firsts[0]], sides[j]), len(groups))
            firsts_of_rows += firsts
            counts.append(len(firsts))
            rows.append((j, common, lost, group))
    others = np.array(rows, dtype=np.float64).reshape(-1, 4)
    pairs = np.column_stack([firsts_of_rows, np.repeat(others, counts, axis=0)])
    return pairs[np.argsort(pairs[:, 4], kind="stable")]


def group_grids(
    joints: Array,
    placed: Sequence[PlacedBody],
    pairs: Array,
    groups: list[int],
    known: dict[bytes, Array],
) -> tuple[Array, Array]:
    """Return the grids (g, 7) of the groups of pairs, and their cells; see `Tables`."""
    numbers = pairs.astype(np.int64)
    grids, size = np.full((len(groups) - 1, 7), -1.0), 0
    chosen = [np.empty((0, 2), dtype=np.int64)]
    for g, (first, last) in enumerate(itertools.pairwise(groups)):
        grids[g, 3:5] = first, last
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
    edges = [one.body.edges for one in placed]
    corners = [one.corners for one in placed]
    sizes = np.array([len(one) for one in corners], dtype=np.int64)
    lengths = np.array([len(one) for one in edges], dtype=np.int64) - sizes - 1
    of_corners = np.repeat(np.arange(len(placed)), sizes)
    rows = np.empty((len(of_corners), 5))
    rows[:, :3] = np.concatenate([_NO_CORNERS, *corners])
    before = (np.cumsum(lengths) - lengths)[of_corners]
    for column, first in ((3, 0), (4, 1)):
        starts = [one[first : first + size] for one, size in zip(edges, sizes, strict=True)]
        rows[:, column] = np.concatenate([_NO_NUMBERS, *starts]) + before
    targets = [one[size + 1 :] for one, size in zip(edges, sizes, strict=True)]
    shifts = np.repeat(np.cumsum(sizes) - sizes, lengths)
    return rows, np.concatenate([_NO_NUMBERS, *targets]) + shifts


def _moved(poses: Array, points: Array) -> Array:
    """Move each of the points (k, 3) by its pose (k, 4, 4)."""
    moved: Array = np.einsum("kij,kj->ki", poses[:, :3, :3], points) + poses[:, :3, 3]
    return moved


def _as_rows(poses: Array) -> Array:
    """Return poses (k, 4, 4) as the twelve numbers of the kernels (k, 12)."""
    return np.concatenate([poses[:, :3, :3].reshape(-1, 9), poses[:, :3, 3]], axis=1)
