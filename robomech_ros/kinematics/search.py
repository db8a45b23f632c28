"""Solutions by iteration: chains without a closed form, partial tasks, loose tolerances."""

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels import iterative_layout as at
from robomech_ros._kernels.inverse import MAX_SOLUTIONS
from robomech_ros._kernels.ranking import rank
from robomech_ros.kinematics.closed_form import rank_windings
from robomech_ros.kinematics.families import Family, iterative_family
from robomech_ros.kinematics.iterative import (
    FULL_TASK,
    IterativeSearch,
    iterative_data,
    iterative_search,
)
from robomech_ros.kinematics.outcome import (
    NO_EXCESS,
    NO_GAP,
    explain_limits,
    nothing,
    reach_outcome,
)
from robomech_ros.kinematics.reach import reach_gap
from robomech_ros.kinematics.request import Request
from robomech_ros.kinematics.result import InverseKinematicsResult
from robomech_ros.kinematics.status import Status
from robomech_ros.robots.chain import SerialChain

__all__ = ["solve_by_search"]

Array = NDArray[np.float64]

_POSITION = FULL_TASK[:3]


def solve_by_search(chain: SerialChain, T: Array, request: Request) -> InverseKinematicsResult:
    """Search for solutions of the pose T (4, 4), or explain why none was found."""
    data, target = _task_data(chain, T, request, request.respect_limits)
    family = iterative_family(chain, data)
    search = iterative_search(data, target, request.seed, timeout=request.timeout)
    if len(search.q):
        return _ranked(chain, T, request, family, search.q)
    if search.timed_out:
        reason = f"no solution within {request.timeout:g} s; {_best(search)}"
        return nothing(chain, T, family, Status.TIMED_OUT, reason)
    if request.respect_limits:
        data, target = _task_data(chain, T, request, False)
        beyond = iterative_search(data, target, request.seed, timeout=request.timeout)
        if len(beyond.q):
            return explain_limits(chain, T, beyond.q, family, continuum=False)
    return _explained(chain, T, request, family, search)


def _task_data(
    chain: SerialChain, T: Array, request: Request, respect_limits: bool
) -> tuple[Array, Array]:
    """Give the constants of the search and its target.

    The components of a partial task are along the axes of the target, those of the search along
    the base's; so the base is turned until both are the same.
    """
    redundant = chain.n > sum(request.task)
    data = iterative_data(
        chain,
        respect_limits=respect_limits,
        task=request.task,
        position_tolerance=request.position_tolerance,
        orientation_tolerance=request.orientation_tolerance,
        wanted=1 if redundant and request.max_solutions == 1 else None,
    )
    if request.task == FULL_TASK:
        return data, T
    turned = data.copy()
    first = at.ROWS + at.N_ROWS * chain.n
    base = turned[first + 1 : first + 13]
    back = T[:3, :3].T
    base[:9] = (back @ base[:9].reshape(3, 3)).ravel()
    base[9:] = back @ base[9:]
    target = np.eye(4)
    target[:3, 3] = back @ T[:3, 3]
    return turned, target


def _ranked(
    chain: SerialChain, T: Array, request: Request, family: Family, q: Array
) -> InverseKinematicsResult:
    """Order the solutions q (k, n) that a search has found."""
    ranked = np.empty((MAX_SOLUTIONS, chain.n))
    names = np.zeros(MAX_SOLUTIONS, np.int64)
    distances = np.empty(MAX_SOLUTIONS)
    count = rank(
        family.turns,
        chain.lower,
        chain.upper,
        request.seed,
        request.metric,
        request.respect_limits,
        False,
        q,
        names,
        ranked,
        names.copy(),
        distances,
    )
    ranked, names, distances = ranked[:count], names[:count], distances[:count]
    if request.include_windings:
        ranked, names, distances = rank_windings(chain, family.turns, request, ranked, names)
    kept = slice(request.max_solutions)
    redundant = chain.n > sum(request.task)
    reason = ""
    if redundant:
        reason = (
            f"{chain.n} joints for {sum(request.task)} conditions: the solutions form a continuum, "
            "of which these are samples"
        )
    return InverseKinematicsResult(
        chain=chain,
        target=T,
        q=ranked[kept],
        seed_distance=distances[kept],
        family=family.name,
        complete=False,
        status=Status.SUCCESS,
        reason=reason,
        blocking_joints=(),
        blocking_excess=NO_EXCESS,
        branch_bits=names[kept],
        task=request.task,
    )


def _explained(
    chain: SerialChain, T: Array, request: Request, family: Family, search: IterativeSearch
) -> InverseKinematicsResult:
    """Say of a search without success how far the target is out of reach, if it is."""
    if request.task[:3] == _POSITION:
        gap = reach_gap(chain, T)
        whole = request.task == FULL_TASK
        if gap.distance > request.position_tolerance or (
            whole and gap.orientation_error > max(NO_GAP, request.orientation_tolerance)
        ):
            status, reason = reach_outcome(chain, T, gap)
            return nothing(chain, T, family, status, reason)
    reason = f"no solution after {search.attempts} starts; {_best(search)}"
    return nothing(chain, T, family, Status.NOT_CONVERGED, reason)


def _best(search: IterativeSearch) -> str:
    return (
        f"the best posture found misses by {search.position_error:.6g} m "
        f"and {search.orientation_error:.6g} rad"
    )
