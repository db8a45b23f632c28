"""Distances between links of a robot that one or two joints move against each other.

Such distances are the same in all scenes, so that bounds of them are kept.  Rows of ``grids``
(g, 5), one for each group of pairs, hold the drives of both joints (the second is -1 if there is
only one), where the cells of the group begin in ``cells`` (-1 if it has none), its first pair and
the one after its last.  A cell holds a lower bound of the distance of the group while each joint is
anywhere in the cell, or 0 where it is not known yet.
"""

import math

from robomech_ros._kernels.compiling.jit import lean

# Cells of a turn of a joint, their size (rad), and how many a motion may touch along each joint.
CELLS = 128
CELL = 2.0 * math.pi / CELLS
MOST_TOUCHED = 8


@lean
def cell_range(middle, rate):
    """Return the first cell that a joint touches within a rate (rad), and how many it touches."""
    reach = rate + 1e-9
    first = math.floor((middle - reach) / CELL)
    return int(first), int(math.floor((middle + reach) / CELL) - first) + 1


@lean
def cell_number(grids, g, k, i):
    """Return the place of a cell of group g among all cells, from its numbers along both joints."""
    place = int(grids[g, 2]) + k % CELLS
    if grids[g, 1] >= 0.0:
        place += CELLS * (i % CELLS)
    return place


@lean
def known_apart(grids, cells, g, q, keep):
    """Whether a group is known to be farther apart than a distance (m) at drives q."""
    if grids[g, 2] < 0.0:
        return False
    first, _ = cell_range(q[int(grids[g, 0])], 0.0)
    second = 0
    if grids[g, 1] >= 0.0:
        second, _ = cell_range(q[int(grids[g, 1])], 0.0)
    return cells[cell_number(grids, g, first, second)] > keep
