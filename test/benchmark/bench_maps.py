"""Dexterity maps: a million poses on two cores, and a pose beside EAIK with NumPy."""

from __future__ import annotations

import statistics
import time

import inverse_peers
import numpy as np
from inverse_peers import available
from table import Row
from timing import Work, interleave

from robomech_ros.kinetostatics import jacobian, reach_map, uniform_rotations
from robomech_ros.kinetostatics.maps.box_grid import as_grid
from robomech_ros.kinetostatics.maps.cells import map_cells
from robomech_ros.kinetostatics.maps.request import MapRequest, identity_of
from robomech_ros.robots import SerialChain, load_robot

LENGTH = 0.283
BOX = ([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0])
SHAPE, ORIENTATIONS, WORKERS = 25, 64, 2
SECONDS = 20.0
REPEATS = 3
# Of the small map: 30 poses, all inside the reach, for works of some hundred microseconds.
NEAR, NEAR_SHAPE, NEAR_ORIENTATIONS = ([0.45, -0.2, 0.0], [0.65, 0.2, 0.2]), (1, 3, 2), 5
ROUNDS = 101


def rows() -> tuple[list[Row], list[str]]:
    """Measure maps of the PUMA 560; return the rows of the table and remarks."""
    chain = load_robot("puma560")
    small, small_remarks = _a_pose(chain)
    reach_map(chain, *BOX, shape=2, orientations=1, length=LENGTH)
    walls, busy = [], []
    for _ in range(REPEATS):
        wall, cpu = time.perf_counter(), time.process_time()
        found = reach_map(
            chain, *BOX, shape=SHAPE, orientations=ORIENTATIONS, length=LENGTH, workers=WORKERS
        )
        walls.append(time.perf_counter() - wall)
        busy.append(time.process_time() - cpu)
    what = f"puma560, dexterity map of {found.request.poses:,} poses, {WORKERS} threads"
    remark = f"{what}: {found.share_reached:.1%} reached"
    large = [
        Row(what, statistics.median(walls), unit="s", limit=SECONDS),
        Row(f"{what}, CPU", statistics.median(busy), unit="s"),
    ]
    return [*large, *small], [remark, *small_remarks]


def _a_pose(chain: SerialChain) -> tuple[list[Row], list[str]]:
    """Time a small map without limits, beside EAIK's solutions and NumPy's condition numbers."""
    low, high = NEAR
    grid = as_grid([0.5 * (low[0] + high[0]), *low[1:]], [0.5 * (low[0] + high[0]), *high[1:]],
                   None, NEAR_SHAPE)  # fmt: skip
    turns = uniform_rotations(NEAR_ORIENTATIONS)
    request = MapRequest(identity_of(chain), grid, turns, False, LENGTH, "pose")
    targets = [_pose(R, p) for p in grid.points(np.arange(grid.cells)) for R in turns]
    scale = np.repeat((1.0, 1.0 / LENGTH), 3)[:, None]
    peers = available(inverse_peers.eaik(chain))

    def ours() -> object:
        return map_cells(chain, request, 0, grid.cells)

    def theirs() -> list[float]:
        best = []
        for T in targets:
            q = peers[0].read(peers[0].call(T))
            J = jacobian(chain, q) * scale
            best.append(float(np.linalg.cond(J).min()) if len(q) else np.nan)
        return best

    works = {"ours": Work(ours, len(targets))}
    if peers:
        works["theirs"] = Work(theirs, len(targets))
    timings = interleave(works, rounds=ROUNDS)
    what = "puma560, map without limits, one thread, a pose"
    mine = timings["ours"]
    if not peers:
        return [Row(what, mine.median, spread=mine.spread)], []
    cells, best = map_cells(chain, request, 0, grid.cells), np.array(theirs())
    least = np.fmin.reduce(best.reshape(grid.cells, -1), axis=1)
    apart = float(np.nanmax(np.abs(cells["condition"] / least - 1.0)))
    remark = f"{what}: least condition numbers are those of EAIK's solutions to {apart:.1e}"
    row = Row(what, mine.median, peer=timings["theirs"].median, peer_name="EAIK + NumPy",
              spread=mine.spread)  # fmt: skip
    return [row], [remark]


def _pose(R: np.ndarray, p: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T
