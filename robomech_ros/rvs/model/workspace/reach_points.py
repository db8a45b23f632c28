"""Displayed points of a reach map: positions, colours, and their legend."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.kinematics.posture_samples import reach_bound
from robomech_ros.kinetostatics import ReachMap, reach_map
from robomech_ros.kinetostatics.maps.engines import as_workers
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.workspace.workspace_views import is_in_opening
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

ORIENTATIONS = ("64 spread evenly", "the present one")
# Points along each side of the cube.
DENSITIES = {"coarse": 11, "medium": 17, "fine": 25}
MEASURES = ("share of orientations", "postures", "conditioning index")
# Red, green and blue at even steps of the scale (viridis).
_SCALE = np.array((
    (68, 1, 84), (71, 44, 122), (59, 81, 139), (44, 113, 142), (33, 144, 141),
    (39, 173, 129), (92, 200, 99), (170, 220, 50), (253, 231, 37),
))  # fmt: skip


@dataclass(frozen=True, eq=False)
class ReachPoints:
    """Reached points of a map.

    - ``low``, ``high``: the ends of the scale.
    """

    #: Positions in the base (m), shape (k, 3).
    points: Array
    #: Measured values, shape (k,).
    values: Array
    low: float
    high: float
    #: Unit of the values; empty if they count postures.
    unit: str
    #: Distance between neighbours (m).
    spacing: float

    @property
    def colours(self) -> NDArray[np.uint8]:
        """Red, green and blue of each, 0 to 255, shape (k, 3)."""
        return scale_colours((self.values - self.low) / max(self.high - self.low, 1e-12))


def scale_colours(parts: ArrayLike) -> NDArray[np.uint8]:
    """Return the colours (k, 3) of parts (k,) of the scale, 0 to 1."""
    at, wanted = np.linspace(0.0, 1.0, len(_SCALE)), np.asarray(parts, dtype=np.float64)
    channels = [np.interp(wanted, at, channel) for channel in _SCALE.T]
    return np.stack(channels, axis=-1).astype(np.uint8)


def computed_map(
    chain: SerialChain,
    orientations: str,
    density: str,
    T: Array,
    progress: Callable[[int, int], None],
) -> ReachMap:
    """Compute the map of the cube around the workspace of an arm.

    - ``orientations``: one of ``ORIENTATIONS``.
    - ``density``: one of ``DENSITIES``.
    - ``T``: with the present orientation, shape (4, 4).
    - ``progress``: as for :func:`reach_map`; what it raises ends the computation.
    """
    as_choice("orientations", orientations, ORIENTATIONS)
    count = DENSITIES[as_choice("points", density, tuple(DENSITIES))]
    tried = 64 if orientations == ORIENTATIONS[0] else T[None, :3, :3]
    reach = reach_bound(chain)
    # One processor remains for the page.
    workers = max(1, as_workers(None) - 1)
    return reach_map(
        chain, [-reach] * 3, [reach] * 3, shape=count, orientations=tried, workers=workers,
        progress=progress,
    )  # fmt: skip


def reach_points(found: ReachMap, measure: str, *, cut: bool) -> ReachPoints:
    """Return the reached points, with the measure there.

    - ``measure``: one of ``MEASURES``.
    - ``cut``: whether points in the open sector about z are left out.
    """
    as_choice("coloured by", measure, MEASURES)
    reached = found.reached.ravel() > 0
    points = found.grid.points(np.arange(found.grid.cells))
    if cut:
        reached &= ~is_in_opening(np.arctan2(points[:, 1], points[:, 0]))
    low, high, unit = 0.0, 100.0, "%"
    if measure == MEASURES[0]:
        values = 100.0 * found.dexterity
    elif measure == MEASURES[1]:
        values = found.solutions.astype(np.float64)
        low, high, unit = 1.0, float(max(2, found.solutions.max())), ""
    else:
        values = 100.0 * found.conditioning
        high = math.ceil(float(np.nanmax(values, initial=1.0)))
    x, _, _ = found.grid.axes
    spacing = float(x[1] - x[0])
    return ReachPoints(points[reached], values.ravel()[reached], low, high, unit, spacing)
