"""The cells of a map: what an arm can do at each point of a grid, block by block."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS, UNDECIDED
from robomech_ros.kinematics.inverse.batch import family_within
from robomech_ros.kinematics.inverse.closed_form import solve_many
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.inverse_kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.redundant_arms.redundant_solutions import sample_self_motions
from robomech_ros.kinematics.inverse.request.request import as_request
from robomech_ros.kinematics.tolerances import MOST_SAMPLED
from robomech_ros.kinetostatics.indices import condition_number
from robomech_ros.kinetostatics.maps.request import MapRequest
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, IntArray

# Facts of a cell: number of orientations with a posture; number of their postures
# together; the least condition number of any of these, NaN where there is none; and the mean over
# the orientations reached of the reciprocal of the least condition number of each.
CELL = np.dtype(
    [("reached", "<i4"), ("solutions", "<i4"), ("condition", "<f8"), ("conditioning", "<f8")]
)
# In place of ``reached`` where nothing has been computed yet.
UNFINISHED = -1

# Poses that are worked on at once: all that is computed of them stays in the processor's cache.
_BLOCK = 512
# Poses that are handed to a worker at once: a tenth of a second where solutions are in closed form
# (some us a pose), and where they are not (some ms) as many as take no longer than a second.
_CHUNK, _CHUNK_SAMPLED, _CHUNK_ITERATIVE = 1 << 15, 1 << 11, 1 << 6


def chunk_cells(chain: SerialChain, orientations: int) -> int:
    """Choose how many cells a worker gets at once, by the number of orientations of each."""
    family = family_of(chain)
    poses = _CHUNK if family.lists_all else _CHUNK_SAMPLED
    if not family.closed_form:
        poses = _CHUNK_ITERATIVE
    return max(1, poses // orientations)


def map_cells(
    chain: SerialChain,
    request: MapRequest,
    first: int,
    last: int,
    stopped: Callable[[], bool] = lambda: False,
) -> NDArray | None:
    """Compute the cells from ``first`` to before ``last``, the same on every machine.

    Between blocks ``stopped`` is asked whether to leave off; the result is then None.
    """
    k = len(request.orientations)
    counts = np.empty((last - first) * k, np.int64)
    best = np.empty(counts.shape)
    for begin in range(0, len(counts), _BLOCK):
        if stopped():
            return None
        end = min(begin + _BLOCK, len(counts))
        T = _poses(request, first * k + begin, first * k + end)
        q, counts[begin:end] = _postures(chain, T, request.respect_limits)
        best[begin:end] = _least_conditions(chain, q, counts[begin:end], request)
    return _summarised(counts.reshape(-1, k), best.reshape(-1, k))


def _poses(request: MapRequest, first: int, last: int) -> Array:
    """Return the poses (m, 4, 4) from ``first`` to before ``last``: all orientations of a cell."""
    cells, turns = np.divmod(np.arange(first, last), len(request.orientations))
    return assembled(request.orientations[turns], request.grid.points(cells))


def _postures(chain: SerialChain, T: Array, respect_limits: bool) -> tuple[Array, IntArray]:
    """Return the postures (m, room, n) for the poses T (m, 4, 4), and how many each has.

    Of a redundant arm they are samples of the self-motion.
    """
    family, request = family_within(chain, respect_limits), as_request(chain, None, respect_limits)
    if family.redundant:
        q, counts, *_ = sample_self_motions(chain, T, family, request, MOST_SAMPLED, traced=False)
    else:
        q, counts, _ = solve_many(chain, T, family, request, MAX_SOLUTIONS)
        for index in np.flatnonzero(counts == UNDECIDED):
            found = inverse_kinematics(chain, T[index], respect_limits=respect_limits)
            counts[index] = min(len(found), MAX_SOLUTIONS)
            q[index, : counts[index]] = found.q[:MAX_SOLUTIONS]
    return q, np.maximum(counts, 0)


def _least_conditions(chain: SerialChain, q: Array, counts: IntArray, request: MapRequest) -> Array:
    """Return the least condition number of each pose's postures, NaN if there are none."""
    least = np.full(len(counts), np.nan)
    reached = counts > 0
    if reached.any():
        rows = q[np.arange(q.shape[1]) < counts[:, None]]
        values = condition_number(chain, rows, part=request.part, length=request.length)
        starts = np.cumsum(counts[reached]) - counts[reached]
        least[reached] = np.minimum.reduceat(values, starts)
    return least


def _summarised(counts: IntArray, best: Array) -> NDArray:
    """Gather the poses of cells (m, k) into cells (m,)."""
    cells = np.empty(len(counts), CELL)
    reached = counts > 0
    cells["reached"] = reached.sum(axis=1)
    cells["solutions"] = counts.sum(axis=1)
    cells["condition"] = np.fmin.reduce(best, axis=1)
    sums = np.where(reached, 1.0 / best, 0.0).sum(axis=1)
    with np.errstate(invalid="ignore"):
        cells["conditioning"] = sums / cells["reached"]
    return cells
