"""Reachability and dexterity of an arm over a grid of positions and a set of orientations."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, MapFileError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics.maps.box_grid import BoxGrid, as_grid
from robomech_ros.kinetostatics.maps.cells import CELL, UNFINISHED, chunk_cells
from robomech_ros.kinetostatics.maps.engines import Chunk, Done, as_workers, by_dask, in_threads
from robomech_ros.kinetostatics.maps.map_file import as_path, check_writable, load_map, save_map
from robomech_ros.kinetostatics.maps.request import MapRequest, RobotIdentity, identity_of
from robomech_ros.kinetostatics.rotation_sets import as_orientations
from robomech_ros.kinetostatics.singularities.generic_rank import scaling_length
from robomech_ros.kinetostatics.task_parts import PARTS
from robomech_ros.numerics.memory import check_memory
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice, as_flag
from robomech_ros.typing import Array, ArrayLike, IntArray

# Seconds between two times that what is finished is written to the file.
_BETWEEN_SAVES = 60.0
# Numbers of points from which on messages show powers of ten.
_COUNTED = 10**12


@dataclass(frozen=True, eq=False)
class ReachMap:
    """Capabilities of an arm at each point of a grid.

    Parameters
    ----------
    request : MapRequest
        What the map is of.
    cells : ndarray, shape (cells,)
        One record for each point; the attributes below have its fields in the shape of the grid.
    """

    request: MapRequest
    cells: NDArray

    @property
    def robot(self) -> RobotIdentity:
        """The chain that the map was made for."""
        return self.request.robot

    @property
    def grid(self) -> BoxGrid:
        """The positions, in the base (m)."""
        return self.request.grid

    @property
    def finished(self) -> int:
        """Number of points that are computed."""
        return int(np.count_nonzero(self.cells["reached"] != UNFINISHED))

    @property
    def complete(self) -> bool:
        """True if all points are computed."""
        return self.finished == self.grid.cells

    @property
    def reached(self) -> IntArray:
        """Number of orientations with a posture, shape (nx, ny, nz); -1 if not computed."""
        return self._field("reached").astype(np.int64)

    @property
    def dexterity(self) -> Array:
        """Share of the orientations that have a posture, shape (nx, ny, nz); NaN if not computed.

        It is known as the reachability index, or dexterity index, too.
        """
        share = self.reached / len(self.request.orientations)
        return np.where(share < 0.0, np.nan, share)

    @property
    def solutions(self) -> IntArray:
        """Number of postures of all orientations together, shape (nx, ny, nz).

        For a redundant arm the number of samples that were taken of the self-motions.
        """
        return self._field("solutions").astype(np.int64)

    @property
    def condition_number(self) -> Array:
        """Least condition number of any posture, shape (nx, ny, nz); NaN where there is none."""
        return self._field("condition")

    @property
    def conditioning(self) -> Array:
        """Mean over the orientations reached of 1 / condition number, shape (nx, ny, nz).

        Of each orientation its best posture counts; NaN where none is reached.
        """
        return self._field("conditioning")

    @cached_property
    def share_reached(self) -> float:
        """Share of all poses computed that have a posture; NaN where none is computed."""
        poses = self.finished * len(self.request.orientations)
        return self._poses_reached / poses if poses else math.nan

    @cached_property
    def mean_conditioning(self) -> float:
        """Mean over all poses reached of 1 / condition number of the best posture of each."""
        reached = self.cells[self.cells["reached"] > 0]
        if not len(reached):
            return math.nan
        return float(reached["reached"] @ reached["conditioning"]) / self._poses_reached

    @cached_property
    def best_condition_number(self) -> float:
        """Least condition number of any posture of the map; NaN where there is no posture."""
        return float(np.fmin.reduce(self.cells["condition"]))

    @property
    def _poses_reached(self) -> int:
        return int(np.maximum(self.cells["reached"], 0).sum(dtype=np.int64))

    def _field(self, name: str) -> NDArray:
        return self.cells[name].reshape(self.grid.shape)

    def save(self, path: str | Path) -> Path:
        """Write the map to a file, npz.

        Raises
        ------
        BadValueError, MapFileError
            No path, or one that cannot be written.
        """
        place = as_path(path)
        save_map(place, self.request, self.cells)
        return place


def reach_map(
    chain: SerialChain,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    spacing: ArrayLike | None = None,
    shape: ArrayLike | None = None,
    orientations: ArrayLike = 64,
    respect_limits: bool = True,
    length: float | None = None,
    part: str = "pose",
    file: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ReachMap:
    """Compute which orientations an arm can take at each point of a grid, and how well.

    With a ``file`` what is finished is written there every minute, at the end, and when Ctrl-C
    (KeyboardInterrupt) or an error ends it; the same call then goes on from there.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    lower, upper : array_like, shape (3,)
        Corners of a box in the base (m); the first point is ``lower``.
    spacing : float or array_like, shape (3,), optional
        Distance between points (m).
    shape : int or array_like of int, shape (3,), optional
        Number of points along x, y and z, in place of the spacing; the last is at ``upper``.
    orientations : int or array_like, shape (k, 3, 3), optional
        ``R_base_tip`` to try at each point, or how many to spread evenly by
        :func:`uniform_rotations`.
    respect_limits : bool, optional
        Whether only postures inside the joint limits count.
    length : float, optional
        What the linear rows of the Jacobian are divided by (m); default the characteristic length.
    part : {"pose", "position", "orientation"}, optional
        Which rows of the Jacobian the condition number is of.
    file : str or Path, optional
        Where to keep the map, npz.
    workers : int, optional
        Threads; default one for each processor.  The map does not depend on it.
    scheduler : str, optional
        Address of a Dask scheduler whose workers compute the map instead, such as
        ``tcp://10.0.0.1:8786``.
    progress : callable, optional
        Called now and then with how many points are finished, and of how many.

    Raises
    ------
    NotEnoughMemoryError
        A grid that does not fit.
    MapFileError
        The file is of another map, damaged, or cannot be written.
    DaskUnavailableError
        A scheduler is given, and Dask is not installed.

    References
    ----------
    Zacharias, Borst and Hirzinger, Capturing robot workspace structure: representing robot
    capabilities, IEEE/RSJ Int. Conf. on Intelligent Robots and Systems, 2007.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import reach_map
    >>> from robomech_ros.robots import load_robot
    >>> corners = {"lower": [0.4, 0.0, 0.3], "upper": [2.0, 0.0, 0.3]}
    >>> found = reach_map(load_robot("puma560"), **corners, shape=2, orientations=8, length=0.3)
    >>> found.dexterity.shape
    (2, 2, 2)
    """
    check_chain(chain)
    grid, rotations = as_grid(lower, upper, spacing, shape), as_orientations(orientations)
    limited, rows = as_flag("respect_limits", respect_limits), as_choice("part", part, tuple(PARTS))
    threads, path = as_workers(workers), None if file is None else as_path(file)
    if progress is not None and not callable(progress):
        raise BadValueError("progress", progress, "a function of two whole numbers")
    _check_size(grid)
    if path is not None:
        check_writable(path)
    metres = scaling_length(chain, length)
    request = MapRequest(identity_of(chain), grid, rotations, limited, metres, rows)
    cells = _begun(path, request)
    todo = _unfinished(cells, chunk_cells(chain, len(rotations)))
    if scheduler is None:
        results = in_threads(chain, request, todo, threads)
    else:
        results = by_dask(chain, request, todo, scheduler)
    _fill(results, request, cells, path, progress or (lambda done, total: None))
    return ReachMap(request, cells)


def load_reach_map(path: str | Path, chain: SerialChain | None = None) -> ReachMap:
    """Read a map from a file, and where a chain is given refuse the map of another one.

    Parameters
    ----------
    path : str or Path
        As :meth:`ReachMap.save` or :func:`reach_map` has written it.
    chain : SerialChain, optional
        Which the map has to be of.

    Returns
    -------
    ReachMap
        Perhaps an unfinished one.

    Raises
    ------
    MapFileError
        Not a map, a damaged one, or that of another robot.
    NotEnoughMemoryError
        It does not fit.
    """
    request, cells = load_map(as_path(path))
    if chain is not None:
        check_chain(chain)
        wanted = identity_of(chain)
        if request.robot != wanted:
            raise MapFileError(str(path), f"it is of robot {request.robot}, not {wanted}")
    return ReachMap(request, cells)


def _check_size(grid: BoxGrid) -> None:
    shape = " x ".join(f"{count:,}" if count < _COUNTED else f"{count:.0e}" for count in grid.shape)
    # A half more is what checks and sums of all cells take besides.
    check_memory(f"a map of {shape} points", grid.cells * CELL.itemsize * 3 // 2)


def _begun(path: Path | None, request: MapRequest) -> NDArray:
    """Return the cells to fill: those of the file where there is one."""
    if path is not None and path.exists():
        before, cells = load_map(path)
        different = before.difference(request)
        if different:
            raise MapFileError(
                str(path), f"another map is there: {different}; name another file, or remove it"
            )
        return cells
    cells = np.zeros(request.grid.cells, CELL)
    cells["reached"] = UNFINISHED
    cells["condition"] = cells["conditioning"] = np.nan
    return cells


def _unfinished(cells: NDArray, count: int) -> Iterator[Chunk]:
    """Yield the chunks of this many cells with at least one unfinished."""
    for first in range(0, len(cells), count):
        last = min(first + count, len(cells))
        if (cells["reached"][first:last] == UNFINISHED).any():
            yield first, last


def _fill(
    results: Generator[Done, None, None],
    request: MapRequest,
    cells: NDArray,
    path: Path | None,
    progress: Callable[[int, int], None],
) -> None:
    """Put what is computed into the cells, and these into the file now and then and at the end."""
    before = done = int(np.count_nonzero(cells["reached"] != UNFINISHED))
    saved = time.monotonic()
    progress(done, len(cells))
    try:
        for (first, last), found in results:
            done += int(np.count_nonzero(cells["reached"][first:last] == UNFINISHED))
            cells[first:last] = found
            progress(done, len(cells))
            if path is not None and time.monotonic() - saved > _BETWEEN_SAVES:
                save_map(path, request, cells)
                saved = time.monotonic()
    finally:
        results.close()
        if path is not None and done > before:
            save_map(path, request, cells)
