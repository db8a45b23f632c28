"""The posture that comes nearest to a pose that an arm cannot take."""

import time
from dataclasses import replace

import numpy as np

from robomech_ros._kernels.inverse.iterative import layout as at
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, iterative_data, task_data
from robomech_ros.kinematics.inverse.families.iterative_search import (
    IterativeSearch,
    iterative_search,
)
from robomech_ros.kinematics.inverse.families.selection import iterative_family
from robomech_ros.kinematics.inverse.request.request import Request
from robomech_ros.kinematics.inverse.result.result import InverseKinematicsResult
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinematics.inverse.solve_by_search import ranked_solutions
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

# The posture of least squares: starts, steps of each, and the part of the squared error that six
# steps may leave; convergence is linear where the error does not vanish.
LEAST_SQUARES_STARTS = 48
LEAST_SQUARES_ITERATIONS = 300
LEAST_SQUARES_STALL = 1.0 - 1e-9


_HOPELESS = (Status.OUT_OF_REACH, Status.ORIENTATION_UNREACHABLE, Status.NOT_CONVERGED)
# Tolerances far below what any attempt leaves, so that the search goes on to the best of all.
_NEVER = 1e-15


def add_nearest(
    chain: SerialChain, T: Array, request: Request, result: InverseKinematicsResult, started: float
) -> InverseKinematicsResult:
    """Add the posture nearest to the pose to a result without solutions.

    Of the local minima of angle^2 + (distance / half of the arm's length)^2 inside the limits, it
    is the one whose larger part is least. Only arms with fewer joints than conditions get one, for
    which a pose that cannot be taken is the rule, and only while the time asked for lasts, since
    the request came by ``time.monotonic`` (s).
    """
    if len(result) or chain.n >= sum(request.task) or result.status not in _HOPELESS:
        return result
    left = None
    if request.timeout is not None:
        left = request.timeout - (time.monotonic() - started)
        if left <= 0.0:
            return result
    search = least_squares_posture(chain, T, request, timeout=left)
    if (
        search.position_error <= request.position_tolerance
        and search.orientation_error <= request.orientation_tolerance
    ):
        data = iterative_data(chain, SearchGoal(request.respect_limits))
        one = replace(search, q=search.best[None])
        return ranked_solutions(chain, T, request, iterative_family(chain, data), one, False)
    reason = (
        f"{result.reason}; {counted(chain.n, 'joint')} for "
        f"{counted(sum(request.task), 'condition')}: the posture "
        f"nearest in the sense of least squares misses by {search.position_error:.6g} m and "
        f"{search.orientation_error:.6g} rad"
    )
    return replace(result, findings=replace(result.findings, reason=reason, nearest=search.best))


def least_squares_posture(
    chain: SerialChain,
    T: Array,
    request: Request,
    *,
    starts: int = LEAST_SQUARES_STARTS,
    timeout: float | None = None,
) -> IterativeSearch:
    """Search for the posture that misses a pose least, inside the limits if they are respected.

    The sum of angle^2 + (distance / half of the arm's length)^2 is made small from the seed and
    from evenly spread starts; ``best`` is the minimum whose larger part is least.
    """
    goal = SearchGoal(request.respect_limits, request.task, wanted=1)
    data, target = task_data(chain, T, goal)
    data = data.copy()
    half = 1.0 / float(np.sqrt(data[at.UNIT]))
    data[at.POSITION_TOLERANCE], data[at.ORIENTATION_TOLERANCE] = _NEVER * half, _NEVER
    data[at.ITERATIONS], data[at.RESTARTS] = LEAST_SQUARES_ITERATIONS, starts
    data[at.STALL] = LEAST_SQUARES_STALL
    return iterative_search(data, target, request.seed, timeout=timeout)
