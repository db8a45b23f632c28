"""Distances of the bodies of a scene at a posture."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from robomech_ros._kernels.collision.bounds import frames_at, near_pairs
from robomech_ros._kernels.collision.grids import CELLS
from robomech_ros._kernels.collision.shapes import DRIVE, GAIN, KIND, PARENT, SPHERES
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.collision.libraries import coal
from robomech_ros.collision.robot_bodies import as_row
from robomech_ros.collision.shapes import Body
from robomech_ros.typing import Array, IntArray

_near_pairs, _frames_at = direct(near_pairs), direct(frames_at)
_NO_PAIRS = np.empty((0, 5))
# Tolerance of the search for the nearest points (m): the default of 1e-6 would show between round
# bodies.  Below 1e-11 it fails at times, and so does that for depths below its 1e-6.
_TOLERANCE = 1e-10
# Scenes of a robot that differ in joints beside the chain, whose bounds are kept.
_MOST_KNOWN = 4


class PlacedBody(NamedTuple):
    """A body of a link or an object.

    Attributes
    ----------
    owner : str
        The link or object.
    frame : int
        The frame that it moves with; 0 for the base.
    pose : ndarray, shape (4, 4)
        In that frame (m).
    body : Body
    spheres : ndarray, shape (s, 8)
        What covers it, in its own frame; without rows where it belongs to the world.
    around : ndarray, shape (4,)
    is_carried : bool
        Whether it is an object that a link carries.
    """

    owner: str
    frame: int
    pose: Array
    body: Body
    spheres: Array
    around: Array
    is_carried: bool = False


class Clearance(NamedTuple):
    """The least distance between bodies that may not touch.

    Attributes
    ----------
    distance : float
        m; negative where they overlap, by the depth.
    bodies : tuple of str
        The two links or objects; empty names where there are none that could touch.
    points : ndarray, shape (2, 3)
        The nearest (or deepest) points of both, in the base (m).
    """

    distance: float
    bodies: tuple[str, str]
    points: Array


class Distances:
    """Distances between pairs of bodies, as numbers for the kernels and as geometries of coal.

    Parameters
    ----------
    joints : ndarray, shape (m, 17)
        The tree of joints; see `robot_bodies`.
    placed : sequence of PlacedBody
        Those with spheres first.
    checked : callable
        Whether a pair of two of them is looked at.
    padding : float
        By how much links count as wider against objects (m).
    known : dict
        Bounds of distances between links, which other scenes of the robot share.
    """

    def __init__(
        self,
        joints: Array,
        placed: Sequence[PlacedBody],
        checked: Callable[[PlacedBody, PlacedBody], bool],
        padding: float,
        known: dict[bytes, Array],
    ) -> None:
        self.placed = placed
        spheres, bodies, first = [np.empty((0, 8))], [], 0
        corners, neighbours = _hulls(placed)
        corner = 0
        for one in placed:
            count = len(one.spheres)
            kind = SPHERES if count else one.body.kind
            row = [one.frame, first, first + count, kind, one.body.exact]
            bodies.append([*row, corner, one.body.radius, one.body.hull_kind])
            moved = one.spheres.copy()
            for column in (0, 4):
                moved[:, column : column + 3] = _moved(
                    one.pose, one.spheres[:, column : column + 3]
                )
            spheres.append(moved)
            first += count
            corner += len(one.body.corners)
        around = [[*_moved(one.pose, one.around[:3]), one.around[3]] for one in placed]
        shapes = [[*as_row(one.pose @ one.body.pose), *one.body.sizes] for one in placed]
        pairs = _pairs(joints, placed, checked, padding)
        # The first pair of each group, and the end of the last.
        starts = np.flatnonzero(np.diff(pairs[:, 4], prepend=-1.0, append=-2.0))
        self.groups: list[int] = starts.tolist()
        self.tables = (
            joints,
            np.array(bodies, dtype=np.float64).reshape(-1, 8),
            np.array(around).reshape(-1, 4),
            np.concatenate(spheres),
            np.array(shapes).reshape(-1, 15),
            np.array([as_row(one.pose) for one in placed]).reshape(-1, 12),
            pairs,
            corners,
            neighbours,
            np.zeros((len(pairs), 5)),
            *_grids(joints, placed, pairs, self.groups, known),
        )
        self.tables[9][:, 3:] = self.tables[1][pairs[:, :2].astype(np.int64), 5]
        self.numbers: IntArray = pairs[:, :2].astype(np.int64)
        self._functions: dict[int, Any] = {}
        self._request, self._result = coal().DistanceRequest(), coal().DistanceResult()
        self._request.gjk_tolerance = _TOLERANCE
        flag = coal().CollisionRequestFlag.NO_REQUEST
        self._contact_request = coal().CollisionRequest(flag, 1)
        self._contact_result = coal().CollisionResult()
        self._first, self._second = coal().Transform3s(), coal().Transform3s()
        count = len(pairs)
        self._limit, self._low = np.zeros(1), np.zeros(count + 1)
        self._found = np.zeros(count + 1, dtype=np.int64)
        self._poses = np.zeros((2 * count + 2, 12))
        self._turns, self._origins = self._poses[:, :9].reshape(-1, 3, 3), self._poses[:, 9:]

    def contact(self, q: Array, clearance: float) -> int | None:
        """Return a pair that is not farther apart than a clearance (m), or None."""
        count = self._near(q, False, clearance)
        if count < 0:
            return -1 - count
        for k in range(count):
            pair = int(self._found[k])
            if self.within(pair, clearance, self._turns, self._origins, 2 * k):
                return pair
        return None

    def within(self, pair: int, distance: float, turns: Array, origins: Array, row: int) -> bool:
        """Whether a pair whose poses are two rows of an array is as near as a distance (m)."""
        if self.of_hulls(pair, turns, origins, row) > distance:
            return False
        return pair not in self._surfaces or self.surfaces_within(
            pair, distance, turns, origins, row
        )

    def contacts(self, q: Array, pairs: Collection[int] | None = None) -> dict[int, float]:
        """Return the distances (m) of all, or of the given, pairs that touch at drives q (n,)."""
        distances = {}
        for k in range(self._near(q, True, 0.0)):
            pair = int(self._found[k])
            if pairs is None or pair in pairs:
                distances[pair] = self.exact(pair, self._turns, self._origins, 2 * k)
        return {pair: distance for pair, distance in distances.items() if distance <= 0.0}

    def pair_distance(self, pair: int, q: Array) -> float:
        """Compute the distance of one pair (m) at drives q (n,)."""
        frames = np.empty((len(self.tables[0]) + 1, 12))
        _frames_at(self.tables[0], q, frames)
        for k, number in enumerate(self.numbers[pair].tolist()):
            frame, pose = frames[self.placed[number].frame], self.placed[number].pose
            turn = frame[:9].reshape(3, 3)
            self._turns[k], self._origins[k] = turn @ pose[:3, :3], turn @ pose[:3, 3] + frame[9:]
        return self.exact(pair, self._turns, self._origins, 0)

    def nearest(self, q: Array) -> Clearance:
        """Find the least distance at drives q (n,)."""
        least, best = np.inf, -1
        points = np.full((2, 3), np.nan)
        for k in range(self._near(q, True, 0.0)):
            if best >= 0 and self._low[k] > max(least, 0.0):
                break
            pair = int(self._found[k])
            distance = self.exact(pair, self._turns, self._origins, 2 * k)
            if distance < least:
                least, best = distance, pair
                points[0], points[1] = (
                    self._result.getNearestPoint1(),
                    self._result.getNearestPoint2(),
                )
        return Clearance(least, self.names(best) if best >= 0 else ("", ""), points)

    def names(self, pair: int) -> tuple[str, str]:
        """Name the two bodies of a pair."""
        a, b = self.numbers[pair].tolist()
        return self.placed[a].owner, self.placed[b].owner

    def pairs_of(self, names: tuple[str, str]) -> Sequence[int]:
        """Return the pairs of bodies of two links or objects, in the order of `names`."""
        return self._pairs_of[names]

    @cached_property
    def _pairs_of(self) -> dict[tuple[str, str], list[int]]:
        found: dict[tuple[str, str], list[int]] = {}
        for pair in range(len(self.numbers)):
            found.setdefault(self.names(pair), []).append(pair)
        return found

    def exact(self, pair: int, turns: Array, origins: Array, row: int) -> float:
        """Compute the distance of a pair (m) whose poses are two rows of an array of poses.

        It is that of the convex hulls, or where these overlap and the surfaces do not, theirs.
        """
        distance = self.of_hulls(pair, turns, origins, row)
        if distance > 0.0 or pair not in self._surfaces:
            return distance
        if self.surfaces_within(pair, 0.0, turns, origins, row):
            return distance
        self._result.clear()
        function = self._surfaces[pair][0]
        apart: float = function(self._first, self._second, self._request, self._result)
        return apart - self.padding[pair]

    def of_hulls(self, pair: int, turns: Array, origins: Array, row: int) -> float:
        """Compute the distance of the convex hulls of a pair (m)."""
        function = self._functions.get(pair)
        if function is None:
            a, b = self.numbers[pair].tolist()
            geometries = self.placed[a].body.geometry, self.placed[b].body.geometry
            function = self._functions[pair] = coal().ComputeDistance(*geometries)
        first, second, result = self._first, self._second, self._result
        first.setRotation(turns[row])
        first.setTranslation(origins[row])
        second.setRotation(turns[row + 1])
        second.setTranslation(origins[row + 1])
        result.clear()
        distance: float = function(first, second, self._request, result)
        return distance - self.padding[pair]

    def has_surfaces(self, pair: int) -> bool:
        """Whether one of a pair is a mesh that is not convex."""
        return pair in self._surfaces

    def surfaces_within(
        self, pair: int, distance: float, turns: Array, origins: Array, row: int
    ) -> bool:
        """Whether the surfaces of a pair, as `of_hulls` has put them, are as near as this (m)."""
        function = self._surfaces[pair][1]
        self._contact_request.security_margin = distance + self.padding[pair]
        self._contact_result.clear()
        if function(self._first, self._second, self._contact_request, self._contact_result):
            return True
        bodies = [self.placed[k].body for k in self.numbers[pair].tolist()]
        for inner, outer in ((0, 1), (1, 0)):
            if bodies[outer].triangles is not None:
                point = origins[row + inner] + turns[row + inner] @ bodies[inner].corners[0]
                if bodies[outer].encloses(turns[row + outer].T @ (point - origins[row + outer])):
                    return True
        return False

    @cached_property
    def padding(self) -> list[float]:
        """By how much (m) each pair counts as nearer than it is."""
        padding: list[float] = self.tables[6][:, 3].tolist()
        return padding

    @cached_property
    def _surfaces(self) -> dict[int, tuple[Any, Any]]:
        """Distance and contact of pairs with a mesh that is not convex, by its triangles."""
        found = {}
        for pair, (a, b) in enumerate(self.numbers.tolist()):
            bodies = self.placed[a].body, self.placed[b].body
            if any(body.surface is not None for body in bodies):
                shapes = [body.surface or body.geometry for body in bodies]
                found[pair] = coal().ComputeDistance(*shapes), coal().ComputeCollision(*shapes)
        return found

    def _near(self, q: Array, nearest: bool, limit: float) -> int:
        self._limit[0] = limit
        count: int = _near_pairs(
            *self.tables, q, nearest, self._limit, self._found, self._low, self._poses
        )
        return count


def _moved(pose: Array, points: Array) -> Array:
    moved: Array = points @ pose[:3, :3].T + pose[:3, 3]
    return moved


def _hulls(placed: Sequence[PlacedBody]) -> tuple[Array, IntArray]:
    """Return the corners (k, 5) of all bodies in their frames, and which are neighbours."""
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


def _grids(
    joints: Array,
    placed: Sequence[PlacedBody],
    pairs: Array,
    groups: list[int],
    known: dict[bytes, Array],
) -> tuple[Array, Array]:
    """Return the grids (g, 5) of the groups of pairs, and their cells; see `_kernels`."""
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


def _pairs(
    joints: Array,
    placed: Sequence[PlacedBody],
    checked: Callable[[PlacedBody, PlacedBody], bool],
    padding: float,
) -> Array:
    """List pairs of bodies that move against each other, and against which frame."""
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
