"""Workspace of a robot, computed once, in a separate thread, on the first request."""

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.kinetostatics import Workspace, characteristic_length, reach_limits
from robomech_ros.kinetostatics.workspace.boundary import positioning_boundary
from robomech_ros.kinetostatics.workspace.positioning_part import positioning_part
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class ReachableSpace:
    """Reach of a robot, the same for all poses.

    Parameters
    ----------
    least, greatest : float
        Distance of the tip from the first joint (m).
    length : float
        Characteristic length (m); NaN for an arm that has none.
    boundary : Workspace or None
        None for an arm without a positioning part.
    centre : ndarray, shape (3,)
        The point that this part places, in the frame of the tip (m).
    """

    least: float
    greatest: float
    length: float
    boundary: Workspace | None
    centre: Array


def reachable_space(chain: SerialChain) -> ReachableSpace:
    """Find what holds for all poses of a robot; this takes some seconds."""
    try:
        length = float(characteristic_length(chain))
    except RobomechError:
        length = math.nan
    boundary, centre = None, np.zeros(3)
    try:
        boundary, centre = positioning_boundary(chain), positioning_part(chain).in_tip
        boundary.distance(np.zeros(3))  # what is the same for all points is found now
    except RobomechError:
        boundary = None
    return ReachableSpace(*reach_limits(chain), length, boundary, centre)


class SpaceFinder:
    """Finds the reachable space of a chain once.

    Parameters
    ----------
    worker : Worker
        Of the node, which serves others meanwhile.
    chain : SerialChain
        Of one joint or more.
    """

    def __init__(self, worker: Worker, chain: SerialChain) -> None:
        self._worker, self._chain = worker, chain
        self._found: ReachableSpace | None = None

    async def get(self) -> ReachableSpace:
        """Return the space; the first call takes some seconds."""
        if self._found is None:
            return await self._worker.do(self._find)
        return self._found

    def _find(self) -> ReachableSpace:
        # Others may have asked while the worker was busy with the first request.
        found = self._found or reachable_space(self._chain)
        self._found = found
        return found
