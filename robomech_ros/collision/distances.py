"""Distances of the bodies of a scene at a posture."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from robomech_ros._kernels.collision.bounds import frames_at, near_pairs
from robomech_ros._kernels.collision.tables import NearPairs
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.collision.kernel_tables import fill_tables, group_grids, list_pairs
from robomech_ros.collision.libraries import coal
from robomech_ros.collision.placed_bodies import PlacedBody
from robomech_ros.spatial.arrays import finite_within
from robomech_ros.typing import Array, IntArray

_near_pairs, _frames_at = direct(near_pairs), direct(frames_at)
# Tolerance of the search for the nearest points (m): the default of 1e-6 would show between round
# bodies.  Below 1e-11 it fails at times, and so does that for depths below its 1e-6.
_TOLERANCE = 1e-10


class Clearance(NamedTuple):
    """The least distance between bodies that may not touch.

    Attributes
    ----------
    distance : float
        m; minus the depth if they overlap.
    bodies : tuple of str
        The two links or objects; empty names if no pair is checked.
    points : ndarray, shape (2, 3)
        The nearest (or deepest) points of both, in the base (m).
    """

    distance: float
    bodies: tuple[str, str]
    points: Array


class Distances:
    """Distances between pairs of bodies, by kernels and by coal.

    Parameters
    ----------
    joints : ndarray, shape (m, 17)
        The tree of joints; see `robot_bodies`.
    placed : sequence of PlacedBody
        Bodies with spheres first.
    checked : callable
        Tells whether a pair of bodies is checked.
    padding : float
        Enlargement of links against objects (m).
    known : dict
        Bounds of distances between links; all scenes of the robot share them.
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
        pairs = list_pairs(joints, placed, checked, padding)
        # The first pair of each group, and the end of the last.
        starts = np.flatnonzero(np.diff(pairs[:, 4], prepend=-1.0, append=-2.0))
        self.groups: list[int] = starts.tolist()
        grids = group_grids(joints, placed, pairs, self.groups, known)
        self.tables = fill_tables(joints, placed, pairs, grids)
        self.numbers: IntArray = pairs[:, :2].astype(np.int64)
        self._functions: dict[int, Any] = {}
        self._request, self._result = coal().DistanceRequest(), coal().DistanceResult()
        self._request.gjk_tolerance = _TOLERANCE
        flag = coal().CollisionRequestFlag.NO_REQUEST
        self._contact_request = coal().CollisionRequest(flag, 1)
        self._contact_result = coal().CollisionResult()
        self._first, self._second = coal().Transform3s(), coal().Transform3s()
        count = len(pairs)
        self._limit, self._near = np.zeros(1), room_for_pairs(count + 1)
        self._turns, self._origins = rotations_and_origins(self._near)

    def contact(self, q: Array, clearance: float) -> int | None:
        """Return a pair that is not farther apart than a clearance (m), or None."""
        count = self._find_near(q, False, clearance)
        if count < 0:
            return -1 - count
        for k in range(count):
            pair = int(self._near.pairs[k])
            if self.within(pair, clearance, self._turns, self._origins, 2 * k):
                return pair
        return None

    def within(self, pair: int, distance: float, turns: Array, origins: Array, row: int) -> bool:
        """Return whether a pair with poses in two rows of arrays is within a distance (m)."""
        if self.of_hulls(pair, turns, origins, row) > distance:
            return False
        return pair not in self._surfaces or self.surfaces_within(
            pair, distance, turns, origins, row
        )

    def contacts(self, q: Array, pairs: Collection[int] | None = None) -> dict[int, float]:
        """Return the distances (m) of all, or of the given, pairs that touch at drives q (n,)."""
        distances = {}
        for k in range(self._find_near(q, True, 0.0)):
            pair = int(self._near.pairs[k])
            if pairs is None or pair in pairs:
                distances[pair] = self.exact(pair, self._turns, self._origins, 2 * k)
        return {pair: distance for pair, distance in distances.items() if distance <= 0.0}

    def pair_distance(self, pair: int, q: Array) -> float:
        """Compute the distance of one pair (m) at drives q (n,)."""
        frames = np.empty((len(self.tables.joints) + 1, 12))
        _frames_at(self.tables.joints, q, frames)
        for k, number in enumerate(self.numbers[pair].tolist()):
            frame, pose = frames[self.placed[number].frame], self.placed[number].pose
            turn = frame[:9].reshape(3, 3)
            self._turns[k], self._origins[k] = turn @ pose[:3, :3], turn @ pose[:3, 3] + frame[9:]
        return self.exact(pair, self._turns, self._origins, 0)

    def nearest(self, q: Array) -> Clearance:
        """Find the least distance at drives q (n,)."""
        least, best = np.inf, -1
        points = np.full((2, 3), np.nan)
        for k in range(self._find_near(q, True, 0.0)):
            if best >= 0 and self._near.low[k] > max(least, 0.0):
                break
            pair = int(self._near.pairs[k])
            distance = self.exact(pair, self._turns, self._origins, 2 * k)
            if distance < least:
                least, best = distance, pair
                points[0], points[1] = (
                    self._result.getNearestPoint1(),
                    self._result.getNearestPoint2(),
                )
        return Clearance(least, self.names(best) if best >= 0 else ("", ""), points)

    def nearest_in_batch(self, rows: Array) -> Clearance:
        """Find the least distances at drives (..., n), as arrays."""
        found = [self.nearest(row) for row in rows.reshape(-1, rows.shape[-1])]
        shape = rows.shape[:-1]
        distances = np.array([one.distance for one in found]).reshape(shape)
        points = np.array([one.points for one in found]).reshape(*shape, 2, 3)
        return Clearance(distances, [one.bodies for one in found], points)  # type: ignore[arg-type]

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
        """Compute the distance of a pair (m) with poses in two rows of arrays.

        It is that of the convex hulls; if only these overlap, it is that of the surfaces.
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
        """Return whether one body of a pair is a mesh that is not convex."""
        return pair in self._surfaces

    def surfaces_within(
        self, pair: int, distance: float, turns: Array, origins: Array, row: int
    ) -> bool:
        """Return whether surfaces of a pair, placed by `of_hulls`, are within a distance (m)."""
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
        """Padding of each pair (m), which its distance lacks."""
        padding: list[float] = self.tables.pairs[:, 3].tolist()
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

    def _find_near(self, q: Array, nearest: bool, limit: float) -> int:
        self._limit[0] = limit
        count: int = _near_pairs(self.tables, q, nearest, self._limit, self._near)
        return count


def room_for_pairs(count: int) -> NearPairs:
    """Make room for so many pairs found by kernels."""
    return NearPairs(np.zeros(count, dtype=np.int64), np.zeros(count), np.zeros((2 * count, 12)))


def rotations_and_origins(near: NearPairs) -> tuple[Array, Array]:
    """Return views (2 p, 3, 3) and (2 p, 3) of the poses of pairs found by kernels."""
    return near.poses[:, :9].reshape(-1, 3, 3), near.poses[:, 9:]


def checked_clearance(value: float) -> float:
    """Check a distance that bodies must keep (m)."""
    return finite_within("clearance", value, "0 to 10 m", 0.0, 10.0)
