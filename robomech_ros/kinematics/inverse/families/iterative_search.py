"""Searching for solutions from many starts, and for the least orientation error, in time."""

import math
import time
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.inverse.iterative import layout as at
from robomech_ros._kernels.inverse.iterative.solutions import search
from robomech_ros.kinematics.inverse.families.iterative import MAX_SOLUTIONS
from robomech_ros.typing import Array

# Attempts and steps in the search for the least orientation error, and the weight of the position
# there: so large that the position keeps its place to some 1e-6 of the arm's length.
REACH_ATTEMPTS = 40
REACH_ATTEMPT_ITERATIONS = 80
REACH_LAST_ITERATIONS = 1000
REACH_POSITION_WEIGHT = 1e6


# Attempts between two looks at the clock: at most so many, some 0.5 ms for ten joints, and of more
# than 25 joints so many over their square, since the work of an attempt grows like its cube.
_CHUNK = 8
_CHUNK_OF_MANY = 5000


@dataclass(frozen=True, eq=False)
class IterativeSearch:
    """Result of an iterative search: distinct solutions (k, n) in the order of their discovery.

    That from the seed is the first. ``best`` (n,) is the attempt with the least error, a solution
    or not, followed by its errors (m, rad) in the components of the task. So many starts were
    tried, and the time ran out before the search was over if it is ``timed_out``.
    """

    q: Array
    best: Array
    position_error: float
    orientation_error: float
    attempts: int
    timed_out: bool


def iterative_search(
    data: Array, T: Array, seed: Array, *, timeout: float | None = None
) -> IterativeSearch:
    """Search from the seed (n,) and from evenly spread starts, as long as the time (s) allows.

    The data is that of :func:`iterative_data`, T (4, 4) the pose of the tip in the base (m).
    Between attempts the search stops once the time is over; at least a first few are made. The
    result is the same for the same arguments, unless the time ran out.
    """
    n = int(data[at.JOINTS])
    restarts = int(data[at.RESTARTS])
    q = np.empty((MAX_SOLUTIONS, n))
    state = np.zeros(at.BEST_Q + n + MAX_SOLUTIONS)
    state[at.BEST_SCORE] = np.inf
    deadline = None if timeout is None else time.monotonic() + timeout
    chunk = restarts
    if deadline is not None:
        chunk = max(1, min(_CHUNK, _CHUNK_OF_MANY // n**2))
    found = 0
    done = 0
    timed_out = False
    while done < restarts:
        count = min(chunk, restarts - done)
        found = search(data, T, seed, done, count, q, found, state)
        done += count
        if found >= data[at.MAX_SOLUTIONS] or (found and state[at.IDLE] >= data[at.PATIENCE]):
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


def least_orientation_error(
    data: Array, T: Array, start: Array, deadline: float = math.inf
) -> float:
    """Minimise the orientation error (rad) over the postures that put the tip at T's position.

    Data and T are those of :func:`task_data`, for one solution and without limits; the posture
    ``start`` (n,) reaches the position. The angle is that of the components that the task counts;
    NaN after the deadline, by ``time.monotonic`` (s).
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
