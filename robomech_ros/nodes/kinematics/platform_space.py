"""Reach of the platform of a parallel robot in the orientations of the requested poses."""

import time
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.parallel import (
    Mechanism,
    ParallelRobot,
    Planar3RPR,
    Planar3RRR,
    platform_position_workspace,
)
from robomech_ros.parallel.kinetostatics.workspace_surface import (
    WorkspaceSurface,
    workspace_surface,
)
from robomech_ros.typing import Array, BoolArray

# Digits by which orientations are told apart, and how many are kept.
_DIGITS, _KEPT = 9, 256
# Directions in which the boundary is looked for: in the space, in a plane, and of limbs of any
# kind, each pose of which takes a hundred times as long.
_DIRECTIONS, _ROUND, _FEW = 256, 96, 48
# Facets are flat: the part of the reach by which they may miss the boundary.
_ROUGH = 0.04


class PlatformSpace:
    """Cache of boundaries of a platform's positions by orientation, for one thread at a time."""

    def __init__(self, robot: ParallelRobot | Mechanism) -> None:
        self._robot: Any = robot
        planar = isinstance(robot, Planar3RPR | Planar3RRR)
        self._directions = _ROUND if planar else _DIRECTIONS
        if isinstance(robot, Mechanism):
            self._directions = _FEW
        self._home = robot.mechanism.pose(robot.mechanism.home())
        self._known: dict[bytes, WorkspaceSurface] = {}

    async def distances(
        self, worker: Worker, T: Array, reachable: BoolArray, until: float
    ) -> Array:
        """Measure how far poses (m, 4, 4) are from the boundary, (m,) (m); NaN where not known.

        Positive where the platform gets to, negative elsewhere.  What is not begun before a time
        of the monotonic clock (s) is left.
        """
        found = np.full(len(T), np.nan)
        for k, (pose, inside) in enumerate(zip(T, reachable.tolist(), strict=True)):
            if time.monotonic() > until:
                break
            if _key(pose) in self._known:
                found[k] = self._distance(pose, inside)
            else:
                found[k] = await worker.do(partial(self._distance, pose, inside))
        return found

    def _distance(self, T: Array, inside: bool) -> float:
        space, point = self.surface(T), T[None, :3, 3]
        if space is None:
            return float("nan")
        distance = float(space.distance(point)[0])
        if (distance > 0.0) == inside:
            return distance
        if abs(distance) <= _ROUGH * space.reach:
            return 0.0
        # The pose is in another part of the workspace, behind what ends that around home.
        own = self._around(T) if inside else None
        return float("nan") if own is None else float(own.distance(point)[0])

    def surface(self, T: Array | None = None) -> WorkspaceSurface | None:
        """Return the boundary for the orientation of a pose, by default that of home.

        It is explored from home, or from the pose where the platform cannot turn so at home; None
        where it can be in neither, and for robots that only turn.
        """
        pose = self._home if T is None else T
        key = _key(pose)
        if key not in self._known:
            centre = pose.copy()
            centre[:3, 3] = self._home[:3, 3]
            around = self._around(centre) or self._around(pose)
            if around is None:
                return None
            if len(self._known) >= _KEPT:
                self._known.pop(next(iter(self._known)))
            self._known[key] = around
        return self._known[key]

    def _around(self, centre: Array) -> WorkspaceSurface | None:
        try:
            found = platform_position_workspace(self._robot, centre, directions=self._directions)
        except RobomechError:
            return None
        return workspace_surface(found)

    def reach(self) -> tuple[float, float]:
        """Return the least and the greatest distance (m) of the platform from the base's origin.

        With the orientation of home; NaN where that is not known.
        """
        space = self.surface()
        if space is None:
            return float("nan"), float("nan")
        away = float(space.distance(np.zeros((1, 3)))[0])
        corners = np.linalg.norm(space.facets, axis=-1)
        return max(0.0, -away), float(corners.max()) if space.ended.all() else float("inf")


def _key(T: Array) -> bytes:
    """Tell orientations apart."""
    return (np.round(T[:3, :3], _DIGITS) + 0.0).tobytes()
