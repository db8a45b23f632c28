"""Cached bounds of distances between links that one or two joints move against each other.

Such distances are the same in all scenes.  A row of ``grids`` (g, 7) starts, for a group of pairs,
with the drives of both joints (-1 if there is only one), its first cell in ``cells`` (-1 if it has
none), its first pair and the one after its last.  A cell holds a lower bound of the distance of the
group for all joint positions in the cell, or 0 if no bound is known yet.
"""

import math

from robomech_ros._kernels.collision.curves import drive_travel
from robomech_ros._kernels.compiling.jit import lean

# Number of cells in a turn of a joint, their size (rad), and the most that a motion may touch.
CELLS = 128
CELL = 2.0 * math.pi / CELLS
_MOST_TOUCHED = 8
# Results of `cells_apart` other than the index of a cell without a bound.
APART, UNDECIDED = -1, -2


@lean
def _cell_range(middle, travel):
    """Return the first cell and the number of cells within a travel (rad) from the middle."""
    reach = travel + 1e-9
    first = math.floor((middle - reach) / CELL)
    return int(first), int(math.floor((middle + reach) / CELL) - first) + 1


@lean
def _cell_number(grids, g, k, i):
    """Return the index of a cell of group g from its positions along both joints."""
    place = int(grids[g, 2]) + k % CELLS
    if grids[g, 1] >= 0.0:
        place += CELLS * (i % CELLS)
    return place


@lean
def known_apart(grids, cells, g, q, keep):
    """Return whether a group is known to be farther apart than a distance (m) at drives q."""
    if grids[g, 2] < 0.0:
        return False
    first, _ = _cell_range(q[int(grids[g, 0])], 0.0)
    second = 0
    if grids[g, 1] >= 0.0:
        second, _ = _cell_range(q[int(grids[g, 1])], 0.0)
    return cells[_cell_number(grids, g, first, second)] > keep


@lean
def cells_apart(grids, cells, g, curve, middle, keep):
    """Look up whether group g is farther apart than a distance (m) on a curve.

    Returns APART, UNDECIDED, or the index of a cell on the curve without a bound.
    """
    k, j = int(grids[g, 0]), int(grids[g, 1])
    first, along = _cell_range(middle[k], drive_travel(curve, middle, k))
    second, across = 0, 1
    if j >= 0:
        second, across = _cell_range(middle[j], drive_travel(curve, middle, j))
    if max(along, across) > _MOST_TOUCHED:
        return UNDECIDED
    unknown = APART
    for v in range(second, second + across):
        for u in range(first, first + along):
            cell = _cell_number(grids, g, u, v)
            if cells[cell] == 0.0:
                unknown = cell
            elif cells[cell] <= keep:
                return UNDECIDED
    return unknown
