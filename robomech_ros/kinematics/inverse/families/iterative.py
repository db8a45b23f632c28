"""The iterative solver, for chains without a closed form: its constants."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.inverse.iterative import layout as at
from robomech_ros._kernels.tolerances import ORIENTATION_TOLERANCE, POSITION_TOLERANCE
from robomech_ros.kinematics.inverse.request.task import FULL_TASK, Task
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides, reach_bound
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array

# An attempt is given up when six steps have not lowered the squared error by this factor.
STALLED = 0.5
# Steps of an attempt at most; those that succeed need 8 in the middle, 30 at the most.
ATTEMPT_ITERATIONS = 40
# Attempts for one target: nine in ten targets need one or two, the worst of thousands some 100;
# without success they take some 10 ms.
ITERATIVE_RESTARTS = 400
# Attempts without a new solution after which the search ends.
ITERATIVE_PATIENCE = 60
# Samples of a continuum of solutions: number, and distance (rad or m).
ITERATIVE_WANTED_REDUNDANT = 8
ITERATIVE_APART_REDUNDANT = 0.1
# Isolated solutions nearer to each other than this (rad or m) are one, found at the accuracy
# that a singular posture leaves at the default tolerances.  Of solutions that only hold looser
# ones it goes with their square root, as that accuracy does, up to a value that still tells
# postures apart.
ITERATIVE_APART = 1e-4
ITERATIVE_APART_MOST = 0.5


MAX_SOLUTIONS = 16


class SearchGoal(NamedTuple):
    """Goal of a search, bounded by the position limits if they are respected.

    The task says which components of the pose count: x, y, z, then the components of the rotation
    vector of the error, all in the base frame. Errors up to the tolerances (m, rad) are accepted.
    It stops after the wanted number of solutions; by default all of 16 where they are isolated, few
    where they form a continuum.
    """

    respect_limits: bool = True
    task: Task = FULL_TASK
    position_tolerance: float = POSITION_TOLERANCE
    orientation_tolerance: float = ORIENTATION_TOLERANCE
    wanted: int | None = None


_USUAL = SearchGoal()


@lru_cache(maxsize=64)
def iterative_data(chain: SerialChain, goal: SearchGoal = _USUAL) -> Array:
    """Lay out the constants of a search as ``_kernels.inverse.iterative.layout`` says."""
    n = chain.n
    redundant = n > sum(goal.task)
    wanted = goal.wanted
    if wanted is None:
        wanted = ITERATIVE_WANTED_REDUNDANT if redundant else MAX_SOLUTIONS
    size = max(reach_bound(chain), 1e-3)
    turns = chain.turns
    lower, upper, start, end = _box(chain, goal.respect_limits, size)
    data = np.zeros(at.ROWS + at.N_ROWS * n + chain.packed.size)
    data[at.WIDTH] = chain.packed.shape[1]
    data[at.JOINTS], data[at.UNIT] = n, (2.0 / size) ** 2
    tolerances = goal.position_tolerance, goal.orientation_tolerance
    data[at.POSITION_TOLERANCE], data[at.ORIENTATION_TOLERANCE] = tolerances
    data[at.ITERATIONS], data[at.RESTARTS] = ATTEMPT_ITERATIONS, ITERATIVE_RESTARTS
    data[at.MAX_SOLUTIONS], data[at.PATIENCE] = wanted, ITERATIVE_PATIENCE
    data[at.STALL] = STALLED
    sharp = ITERATIVE_APART_REDUNDANT if redundant else ITERATIVE_APART
    data[at.MIN_SHARP_DISTANCE] = sharp
    data[at.MIN_DISTANCE] = max(sharp, _neighbourhood(*tolerances))
    sliding = (chain.types == PRISMATIC) & np.isinf(upper - lower)
    data[at.FAR_LENGTH] = size if sliding.any() else np.inf
    data[at.WEIGHTS : at.WEIGHTS + 6] = np.roll(np.asarray(goal.task, dtype=float), 3)
    rows = np.stack([lower, upper, start, end - start, low_discrepancy_strides(n), turns])
    data[at.ROWS : at.ROWS + at.N_ROWS * n] = rows.ravel()
    data[at.ROWS + at.N_ROWS * n :] = chain.packed.ravel()
    data.setflags(write=False)
    return data


def _box(
    chain: SerialChain, respect_limits: bool, size: float
) -> tuple[Array, Array, Array, Array]:
    """Return the bounds of a search, and between which joint values its starts are spread."""
    turns = chain.turns
    lower = np.where(respect_limits, chain.lower, -np.inf)
    upper = np.where(respect_limits, chain.upper, np.inf)
    # A joint that can turn all the way round reaches every angle within its limits.
    all_round = turns & (upper - lower >= 2.0 * np.pi)
    lower, upper = np.where(all_round, -np.inf, lower), np.where(all_round, np.inf, upper)
    half = np.where(chain.types == PRISMATIC, size, np.pi)
    start = np.where(
        np.isfinite(lower), lower, np.where(np.isfinite(upper), upper - 2.0 * half, -half)
    )
    end = np.where(np.isfinite(upper), upper, start + 2.0 * half)
    return lower, upper, start, end


def _neighbourhood(position_tolerance: float, orientation_tolerance: float) -> float:
    """Return the distance (rad or m) below which solutions that just hold these are one."""
    loose = max(
        position_tolerance / POSITION_TOLERANCE, orientation_tolerance / ORIENTATION_TOLERANCE, 1.0
    )
    return min(ITERATIVE_APART * math.sqrt(loose), ITERATIVE_APART_MOST)


def task_data(chain: SerialChain, T: Array, goal: SearchGoal) -> tuple[Array, Array]:
    """Lay out a search for a task along and about the axes of its target T (4, 4) (m).

    The components of a search are those of the base; so the base is turned until its axes are
    those of the target.  Returns the constants, and the target in the base as it was turned (m).
    """
    data = iterative_data(chain, goal)
    if goal.task == FULL_TASK:
        return data, T
    turned = data.copy()
    base = packed_chain(turned)[0, 1:]
    back = T[:3, :3].T
    base[:9] = (back @ base[:9].reshape(3, 3)).ravel()
    base[9:12] = back @ base[9:12]
    target = np.eye(4)
    target[:3, 3] = back @ T[:3, 3]
    return turned, target


def packed_chain(data: Array) -> Array:
    """Return the packed chain that stands in the constants of a search."""
    n = int(data[at.JOINTS])
    return data[at.ROWS + at.N_ROWS * n :].reshape(-1, int(data[at.WIDTH]))
