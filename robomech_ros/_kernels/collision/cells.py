"""Bounds of the distance of two links in cells of the joint space that moves them."""

import math

from robomech_ros._kernels.collision.bounds import ROUNDING, UNCERTAIN, pair_bounds
from robomech_ros._kernels.collision.grids import CELL, CELLS, cells_apart
from robomech_ros._kernels.collision.hulls import hull_bounds
from robomech_ros._kernels.collision.shapes import DRIVE, place_frames
from robomech_ros._kernels.collision.travel import move_spheres, pair_travel
from robomech_ros._kernels.compiling.jit import flat, lean

# Margin (m) over the required distance at which the bound of a cell suffices.
_SPARE = 0.004


@lean
def _place_cell(grids, g, cell, q):
    """Set the drives q of group g to the middle of one of its cells."""
    place = cell - int(grids[g, 2])
    q[int(grids[g, 0])] = (place % CELLS + 0.5) * CELL
    if grids[g, 1] >= 0.0:
        q[int(grids[g, 1])] = (place // CELLS + 0.5) * CELL


@flat
def _cell_bound(tables, posture, g, q, keep):
    """Return a lower bound of the distance of group g in the cell around drives q."""
    joints, grids, pairs = tables.joints, tables.grids, tables.pairs
    place_frames(joints, q, posture.frames)
    for i in range(joints.shape[0]):
        turns = joints[i, DRIVE] == grids[g, 0] or joints[i, DRIVE] == grids[g, 1]
        posture.travels[i] = (0.5 + 1e-9) * CELL if turns else 0.0
    posture.ready[:] = 0
    least, enough = math.inf, keep + _SPARE
    for p in range(int(grids[g, 3]), int(grids[g, 4])):
        for i in range(2):
            move_spheres(tables, posture, int(pairs[p, i]))
        _, bound, _ = pair_bounds(tables, posture, p)
        if bound <= enough:
            travel = pair_travel(tables, posture, p)
            low, _ = hull_bounds(tables, posture.frames, p, keep, enough + travel)
            bound = max(bound, low - travel)
        least = min(least, bound - pairs[p, 3] - UNCERTAIN)
        if least <= 0.0:
            break
    return least


@flat
def fill_cells(tables, posture, g, curve, middle, q, keep):
    """Compute bounds of cells of group g on a curve until `cells_apart` decides; return that.

    The posture and its drives q (n,) are overwritten.
    """
    grids, cells = tables.grids, tables.cells
    cell = cells_apart(grids, cells, g, curve, middle, keep)
    while cell >= 0:
        for k in range(q.size):
            q[k] = middle[k]
        _place_cell(grids, g, cell, q)
        least = _cell_bound(tables, posture, g, q, keep)
        cells[cell] = least if least != 0.0 else -ROUNDING
        cell = cells_apart(grids, cells, g, curve, middle, keep)
    return cell
