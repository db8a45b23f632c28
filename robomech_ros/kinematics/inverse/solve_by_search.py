"""Solutions by iteration: chains without a closed form, partial tasks, loose tolerances."""

import math
import time
from dataclasses import replace

import numpy as np

from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.inverse.closed_form import rank_solutions
from robomech_ros.kinematics.inverse.equivalent_arms.coupled_joints import solve_coupled_joints
from robomech_ros.kinematics.inverse.equivalent_arms.virtual_joints import solve_with_virtual_joints
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, task_data
from robomech_ros.kinematics.inverse.families.iterative_search import (
    IterativeSearch,
    iterative_search,
)
from robomech_ros.kinematics.inverse.families.selection import Family, iterative_family
from robomech_ros.kinematics.inverse.request.request import Request, is_loose
from robomech_ros.kinematics.inverse.result.reach import NO_TIME, reach_gap
from robomech_ros.kinematics.inverse.result.reasons import (
    NO_GAP,
    describe_continuum,
    describe_gap,
    explain_limits,
    explain_unreachable,
    no_solution,
)
from robomech_ros.kinematics.inverse.result.result import Findings, InverseKinematicsResult, Listing
from robomech_ros.kinematics.inverse.result.singular_marks import singular_marks
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array


def solve_by_search(
    chain: SerialChain, T: Array, request: Request, started: float | None = None
) -> InverseKinematicsResult:
    """Search for solutions of the pose T (4, 4), or explain why none was found.

    The timeout of the request counts from ``started`` by ``time.monotonic``, or from now.
    """
    started = time.monotonic() if started is None else started
    data, target = _task_data(chain, T, request, request.respect_limits)
    family = iterative_family(chain, data)
    if chain.coupling is not None:
        result = _through_followers(chain, T, request, family)
        if result is not None:
            return result
    elif (listed := solve_with_virtual_joints(chain, T, request)) is not None:
        return ranked_solutions(chain, T, request, replace(family, name="short"), *listed)
    search = iterative_search(data, target, request.seed, timeout=_left(request, started))
    if len(search.q):
        return ranked_solutions(chain, T, request, family, search, False)
    if search.timed_out:
        reason = f"no solution within {request.timeout:g} s; {_best(search)}"
        return no_solution(chain, T, family, Status.TIMED_OUT, reason)
    if request.respect_limits:
        data, target = _task_data(chain, T, request, False)
        beyond = iterative_search(data, target, request.seed, timeout=_left(request, started))
        if len(beyond.q):
            return explain_limits(chain, T, beyond.q, family, continuum=False, proven=False)
    deadline = math.inf if request.timeout is None else started + request.timeout
    return _explained(chain, T, request, family, search, deadline)


def _through_followers(
    chain: SerialChain, T: Array, request: Request, family: Family
) -> InverseKinematicsResult | None:
    """Solve a chain on which joints follow others in closed form; None where a search has to."""
    listed = solve_coupled_joints(chain, T, request)
    if listed is None:
        return None
    found, complete = listed
    family = replace(family, name="coupled", certain=complete)
    if len(found.q):
        result = ranked_solutions(chain, T, request, family, found, complete)
        if len(result):
            return result
        return explain_limits(chain, T, found.q, family, continuum=False, proven=complete)
    if not complete or is_loose(chain, request):
        return None
    return explain_unreachable(chain, T, family, respect_limits=request.respect_limits)


def _left(request: Request, started: float) -> float | None:
    """Return the time (s) that is left; None without a timeout."""
    if request.timeout is None:
        return None
    return max(0.0, request.timeout - (time.monotonic() - started))


def _task_data(
    chain: SerialChain, T: Array, request: Request, respect_limits: bool
) -> tuple[Array, Array]:
    """Return the constants of the search and its target."""
    redundant = chain.n > sum(request.task)
    wanted = 1 if redundant and request.max_solutions == 1 else None
    tolerances = request.position_tolerance, request.orientation_tolerance
    return task_data(chain, T, SearchGoal(respect_limits, request.task, *tolerances, wanted))


def ranked_solutions(
    chain: SerialChain,
    T: Array,
    request: Request,
    family: Family,
    search: IterativeSearch,
    complete: bool,
) -> InverseKinematicsResult:
    """Order the solutions that a search has found, perhaps all of them."""
    unnamed = np.zeros(len(search.q), np.int64)
    ranked, _, distances = rank_solutions(
        chain, family.turns, request, search.q, unnamed, windings=False
    )
    names = singular_marks(chain, T, request.task, ranked)
    continuum = ""
    if (names & bit.CONTINUUM).any():
        continuum = describe_continuum(chain, T, ranked, names, request.task, sampled=True)
    if request.include_windings:
        ranked, names, distances = rank_solutions(chain, family.turns, request, ranked, names)
    kept = slice(request.max_solutions)
    findings = Findings(
        family.name,
        complete and not continuum,
        Status.SUCCESS,
        "; ".join(filter(None, (continuum, _reason(chain, request, search)))),
        task=request.task,
    )
    listing = Listing(T, distances[kept], names[kept])
    return InverseKinematicsResult(chain, ranked[kept], findings, listing)


def _reason(chain: SerialChain, request: Request, search: IterativeSearch) -> str:
    """Say what the solutions that were found are not."""
    parts = []
    count = sum(request.task)
    if chain.n > count:
        parts.append(
            f"{counted(chain.n, 'joint')} for {counted(count, 'condition')}: the solutions form a "
            "continuum, of which these are samples"
        )
    if search.timed_out:
        parts.append(
            f"the search was cut short after {request.timeout:g} s and "
            f"{counted(search.attempts, 'start')}: there may be more solutions, and nearer ones"
        )
    return "; ".join(parts)


def _explained(
    chain: SerialChain,
    T: Array,
    request: Request,
    family: Family,
    search: IterativeSearch,
    deadline: float,
) -> InverseKinematicsResult:
    """Say of a search without success how far the target is out of reach, if it is."""
    late = time.monotonic() >= deadline
    gap = NO_TIME if late else reach_gap(chain, T, request.task, deadline)
    if math.isnan(gap.distance):
        reason = f"no solution, and no reason found, within {request.timeout:g} s; {_best(search)}"
        return no_solution(chain, T, family, Status.TIMED_OUT, reason)
    least_angle = max(NO_GAP, request.orientation_tolerance)
    if gap.distance > request.position_tolerance or gap.orientation_error > least_angle:
        status, reason = describe_gap(
            chain, T, gap, request.task, respect_limits=request.respect_limits, deadline=deadline
        )
        return no_solution(chain, T, family, status, reason)
    reason = f"no solution after {counted(search.attempts, 'start')}; {_best(search)}"
    return no_solution(chain, T, family, Status.NOT_CONVERGED, reason)


def _best(search: IterativeSearch) -> str:
    return (
        f"the best posture found misses by {search.position_error:.6g} m "
        f"and {search.orientation_error:.6g} rad"
    )
