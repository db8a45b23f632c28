"""The iterative solver for chains without a closed form: its constants, and searching in time."""

import math
import time
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.inverse.iterative import layout as at
from robomech_ros._kernels.inverse.iterative.solutions import search
from robomech_ros._kernels.tolerances import (
    ATTEMPT_ITERATIONS,
    ITERATIVE_APART,
    ITERATIVE_APART_MOST,
    ITERATIVE_APART_REDUNDANT,
    ITERATIVE_PATIENCE,
    ITERATIVE_RESTARTS,
    ITERATIVE_WANTED_REDUNDANT,
    ORIENTATION_TOLERANCE,
    POSITION_TOLERANCE,
    REACH_ATTEMPT_ITERATIONS,
    REACH_ATTEMPTS,
    REACH_LAST_ITERATIONS,
    REACH_POSITION_WEIGHT,
    STALLED,
)
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides, reach_bound
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC

__all__ = [
    "IterativeSearch",
    "attempts_between_looks",
    "iterative_data",
    "iterative_search",
    "least_orientation_error",
    "packed_chain",
    "task_data",
]

Array = NDArray[np.float64]

MAX_SOLUTIONS = 16
# Attempts between two looks at the clock: at most so many, some 0.5 ms for ten joints, and of more
# than 25 joints so many over their square, since the work of an attempt grows like its cube.
_CHUNK = 8
_CHUNK_OF_MANY = 5000
# The work of a step grows with the cube of the joints: of more, no time limit could be kept.
_MOST_JOINTS = 100
FULL_TASK = (True, True, True, True, True, True)
Task = tuple[bool, bool, bool, bool, bool, bool]


@dataclass(frozen=True, eq=False)
class IterativeSearch:
    """What a search found.

    Parameters
    ----------
    q : ndarray, shape (k, n)
        Distinct solutions in the order of their discovery: that from the seed first.
    best : ndarray, shape (n,)
        The attempt with the least error, a solution or not.
    position_error, orientation_error : float
        Its errors (m, rad) in the components of the task.
    attempts : int
        Starts tried.
    timed_out : bool
        Whether the time ran out before the search was over.
    """

    q: Array
    best: Array
    position_error: float
    orientation_error: float
    attempts: int
    timed_out: bool


@lru_cache(maxsize=64)
def iterative_data(
    chain: SerialChain,
    *,
    respect_limits: bool = True,
    task: Task = FULL_TASK,
    position_tolerance: float = POSITION_TOLERANCE,
    orientation_tolerance: float = ORIENTATION_TOLERANCE,
    wanted: int | None = None,
) -> Array:
    """Lay out the constants of a search as its kernel reads them.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    respect_limits : bool
        Whether the position limits bound the search.
    task : tuple of six bool
        Which components of the pose count: x, y, z, then the components of the rotation vector
        of the error, all in the base frame.
    position_tolerance : float
        Accepted position error (m).
    orientation_tolerance : float
        Accepted orientation error (rad).
    wanted : int, optional
        Number of solutions after which to stop; by default all of 16 where solutions are
        isolated, few where they form a continuum.

    Returns
    -------
    ndarray
        See ``_kernels.iterative_layout``.

    Raises
    ------
    BadValueError
        More than a hundred joints.
    """
    n = chain.n
    if n > _MOST_JOINTS:
        raise BadValueError("number of joints", n, f"at most {_MOST_JOINTS} for a search")
    redundant = n > sum(task)
    if wanted is None:
        wanted = ITERATIVE_WANTED_REDUNDANT if redundant else MAX_SOLUTIONS
    size = max(reach_bound(chain), 1e-3)
    turns = chain.types != PRISMATIC
    lower = np.where(respect_limits, chain.lower, -np.inf)
    upper = np.where(respect_limits, chain.upper, np.inf)
    # A joint that can turn all the way round reaches every angle within its limits.
    all_round = turns & (upper - lower >= 2.0 * np.pi)
    lower, upper = np.where(all_round, -np.inf, lower), np.where(all_round, np.inf, upper)
    half = np.where(turns, np.pi, size)
    start = np.where(
        np.isfinite(lower), lower, np.where(np.isfinite(upper), upper - 2.0 * half, -half)
    )
    end = np.where(np.isfinite(upper), upper, start + 2.0 * half)

    data = np.zeros(at.ROWS + at.N_ROWS * n + 13 * (n + 1))
    data[at.JOINTS], data[at.UNIT] = n, (2.0 / size) ** 2
    data[at.POSITION_TOLERANCE] = position_tolerance
    data[at.ORIENTATION_TOLERANCE] = orientation_tolerance
    data[at.ITERATIONS], data[at.RESTARTS] = ATTEMPT_ITERATIONS, ITERATIVE_RESTARTS
    data[at.WANTED], data[at.PATIENCE] = wanted, ITERATIVE_PATIENCE
    data[at.STALL] = STALLED
    sharp = ITERATIVE_APART_REDUNDANT if redundant else ITERATIVE_APART
    data[at.SHARP_APART] = sharp
    data[at.APART] = max(sharp, _neighbourhood(position_tolerance, orientation_tolerance))
    sliding = ~turns & np.isinf(upper - lower)
    data[at.OPEN] = size if sliding.any() else np.inf
    data[at.WEIGHTS : at.WEIGHTS + 6] = np.roll(np.asarray(task, dtype=float), 3)
    rows = np.stack([lower, upper, start, end - start, low_discrepancy_strides(n), turns])
    data[at.ROWS : at.ROWS + at.N_ROWS * n] = rows.ravel()
    data[at.ROWS + at.N_ROWS * n :] = chain.packed.ravel()
    data.setflags(write=False)
    return data


def _neighbourhood(position_tolerance: float, orientation_tolerance: float) -> float:
    """Give the distance (rad or m) below which solutions that just hold these are one."""
    loose = max(
        position_tolerance / POSITION_TOLERANCE, orientation_tolerance / ORIENTATION_TOLERANCE, 1.0
    )
    return min(ITERATIVE_APART * math.sqrt(loose), ITERATIVE_APART_MOST)


def task_data(
    chain: SerialChain,
    T: Array,
    *,
    task: Task,
    respect_limits: bool,
    position_tolerance: float = POSITION_TOLERANCE,
    orientation_tolerance: float = ORIENTATION_TOLERANCE,
    wanted: int | None = None,
) -> tuple[Array, Array]:
    """Lay out the constants of a search for a task along and about the axes of its target.

    The components of a search are those of the base; so the base is turned until its axes are
    those of the target.

    Parameters
    ----------
    chain : SerialChain
    T : ndarray, shape (4, 4)
        Target pose of the tip in the base (m).
    task, respect_limits, position_tolerance, orientation_tolerance, wanted
        As for :func:`iterative_data`.

    Returns
    -------
    data : ndarray
        See ``_kernels.iterative_layout``.
    target : ndarray, shape (4, 4)
        The target in the base as it was turned (m).
    """
    data = iterative_data(
        chain,
        respect_limits=respect_limits,
        task=task,
        position_tolerance=position_tolerance,
        orientation_tolerance=orientation_tolerance,
        wanted=wanted,
    )
    if task == FULL_TASK:
        return data, T
    turned = data.copy()
    base = packed_chain(turned)[0, 1:]
    back = T[:3, :3].T
    base[:9] = (back @ base[:9].reshape(3, 3)).ravel()
    base[9:] = back @ base[9:]
    target = np.eye(4)
    target[:3, 3] = back @ T[:3, 3]
    return turned, target


def packed_chain(data: Array) -> Array:
    """Give the packed chain, shape (n + 1, 13), that stands in the constants of a search."""
    n = int(data[at.JOINTS])
    return data[at.ROWS + at.N_ROWS * n :].reshape(n + 1, 13)


def iterative_search(
    data: Array, T: Array, seed: Array, *, timeout: float | None = None
) -> IterativeSearch:
    """Search from the seed and from evenly spread starts, as long as the time allows.

    Parameters
    ----------
    data : ndarray
        From :func:`iterative_data`.
    T : ndarray, shape (4, 4)
        Pose of the tip in the base (m).
    seed : ndarray, shape (n,)
        First start (rad or m).
    timeout : float, optional
        Time (s) after which to stop between attempts; at least a first few are made.

    Returns
    -------
    IterativeSearch
        The same for the same arguments, unless the time ran out.
    """
    n = int(data[at.JOINTS])
    restarts = int(data[at.RESTARTS])
    q = np.empty((MAX_SOLUTIONS, n))
    state = np.zeros(at.BEST_Q + n + MAX_SOLUTIONS)
    state[at.BEST_SCORE] = np.inf
    deadline = None if timeout is None else time.monotonic() + timeout
    chunk = restarts if deadline is None else attempts_between_looks(n)
    found = 0
    done = 0
    timed_out = False
    while done < restarts:
        count = min(chunk, restarts - done)
        found = search(data, T, seed, done, count, q, found, state)
        done += count
        if found >= data[at.WANTED] or (found and state[at.IDLE] >= data[at.PATIENCE]):
            break
        if deadline is not None and time.monotonic() >= deadline:
            timed_out = done < restarts
            break
    return IterativeSearch(
        q=q[:found].copy(),
        best=state[at.BEST_Q : at.BEST_Q + n].copy(),
        position_error=float(state[at.BEST_POSITION]),
        orientation_error=float(state[at.BEST_ORIENTATION]),
        attempts=done,
        timed_out=timed_out,
    )


def attempts_between_looks(n: int) -> int:
    """Give how many attempts at a chain of n joints are made between two looks at the clock."""
    return max(1, min(_CHUNK, _CHUNK_OF_MANY // n**2))


def least_orientation_error(
    data: Array, T: Array, start: Array, deadline: float = math.inf
) -> float:
    """Minimise the orientation error over the postures that put the tip at T's position.

    Parameters
    ----------
    data : ndarray
        From :func:`task_data`, for one solution and without limits.
    T : ndarray, shape (4, 4)
        The target from there (m); its position must be in reach.
    start : ndarray, shape (n,)
        A posture that reaches the position.
    deadline : float
        When to give up, by ``time.monotonic`` (s).

    Returns
    -------
    float
        The angle (rad), of the components that the task counts; NaN where the time ran out.
    """
    data = data.copy()
    data[at.UNIT] *= REACH_POSITION_WEIGHT
    data[at.POSITION_TOLERANCE] = data[at.ORIENTATION_TOLERANCE] = 1e-7
    data[at.ITERATIONS], data[at.RESTARTS] = REACH_ATTEMPT_ITERATIONS, REACH_ATTEMPTS
    data[at.STALL] = 1.0 - 1e-7
    left = None if deadline == math.inf else deadline - time.monotonic()
    rough = iterative_search(data, T, start, timeout=left)
    if rough.timed_out:
        return math.nan
    data[at.ITERATIONS], data[at.RESTARTS] = REACH_LAST_ITERATIONS, 1
    return iterative_search(data, T, rough.best).orientation_error
