"""All solutions of arms whose family has a closed form."""

from functools import lru_cache

import numpy as np

from robomech_ros._kernels.inverse.one_pose import TOTAL, solve_one_pose
from robomech_ros._kernels.inverse.ranking import rank, winding_count
from robomech_ros._kernels.inverse.solutions import MARKS, MAX_SOLUTIONS, solve
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.selection import Family
from robomech_ros.kinematics.inverse.request.request import Request, as_request
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.kinematics.inverse.result.reasons import (
    describe_continuum,
    explain_limits,
    explain_unreachable,
    no_solution,
)
from robomech_ros.kinematics.inverse.result.result import (
    Findings,
    InverseKinematicsResult,
    Listing,
    read_listing,
)
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, IntArray

# Windings listed for one pose, at most: eight solutions of six joints with three windings each
# are 5832; a file of limits in thousands of turns must not fill the memory.
MOST_WINDINGS = 8192


_empty = np.empty  # to look it up takes longer than an argument is checked


def solve_closed_form(
    chain: SerialChain, T: Array, request: Request, family: Family
) -> InverseKinematicsResult:
    """Find all solutions of a pose T (4, 4), ranked, or explain why there is none.

    The pose (m) is as :func:`as_target` gives it; its entries are checked here. The family is one
    that lists all solutions.
    """
    space = _empty(_shape(chain.n))
    fault, bare, missing, count, singular, unproven = solve_one_pose(
        family.arm, T, request.seed, request.metric, request.respect_limits, space
    )
    if fault:
        as_targets(T)  # raises, and says what it is
    if not count:
        target = read_listing(space, 0).target
        limited = request.respect_limits
        return _explained(chain, target, space[:bare], family, limited, singular > 0, unproven > 0)
    if singular > missing:
        listing = read_listing(space, count)
        reason = describe_continuum(chain, listing.target, space[:count], listing.branch_bits)
        findings = Findings(family.name, False, Status.SUCCESS, reason)
    else:
        findings = _solved(family.name, not singular and not unproven and family.exact)
    if request.max_solutions is not None and not request.include_windings:
        count = min(count, request.max_solutions)
    result = InverseKinematicsResult(chain, space[:count], findings, space)
    return _wound(result, request, family) if request.include_windings else result


@lru_cache(maxsize=64)
def _solved(family: str, complete: bool) -> Findings:
    """Return what is found of solutions that need no words."""
    return Findings(family, complete, Status.SUCCESS)


def _wound(
    result: InverseKinematicsResult, request: Request, family: Family
) -> InverseKinematicsResult:
    """Return the result with every winding of its solutions."""
    q, names, distances = rank_solutions(
        result.chain, family.turns, request, result.q, result.branch_bits
    )
    kept = slice(request.max_solutions)
    listing = Listing(result.target, distances[kept], names[kept])
    return InverseKinematicsResult(result.chain, q[kept], result.findings, listing)


@lru_cache(maxsize=8)
def _shape(n: int) -> tuple[int, int]:
    """Return the shape of the space for the solutions of n joints and what is written besides."""
    return MAX_SOLUTIONS + -(-TOTAL // n), n


def _explained(
    chain: SerialChain,
    T: Array,
    q: Array,
    family: Family,
    limited: bool,
    singular: bool,
    unproven: bool,
) -> InverseKinematicsResult:
    """Say why there is no solution inside the limits; q (k, n) are those without limits."""
    if len(q):
        proven = not unproven and family.exact
        return explain_limits(chain, T, q, family, continuum=singular, proven=proven)
    if unproven:
        reason = "the pose is degenerate: no posture was found, which proves nothing"
        return no_solution(chain, T, family, Status.NOT_CONVERGED, reason)
    return explain_unreachable(chain, T, family, respect_limits=limited)


def rank_solutions(
    chain: SerialChain,
    turns: IntArray,
    request: Request,
    q: Array,
    names: IntArray,
    *,
    windings: bool = True,
) -> tuple[Array, IntArray, Array]:
    """Order solutions q (k, n) inside the limits, the nearest to the seed first.

    With ``windings`` each is listed in every winding, else in the nearest one. Returns joint
    values, branches and distances; raises BadValueError where the limits allow more than
    MOST_WINDINGS.
    """
    limits = turns, chain.lower, chain.upper
    room = winding_count(*limits, q) if windings else min(len(q), MAX_SOLUTIONS)
    if room > MOST_WINDINGS:
        expected = f"limits with at most {MOST_WINDINGS} windings of all solutions; here are {room}"
        raise BadValueError("include_windings", True, expected)
    out = np.empty((room, chain.n)), np.empty(room, np.int64), np.empty(room)
    asked = request.seed, request.metric, request.respect_limits, windings
    count = rank(*limits, *asked, q, names, *out)
    ranked, marks, distances = out
    return ranked[:count], marks[:count], distances[:count]


def solve_many(
    chain: SerialChain, targets: Array, family: Family, request: Request, room: int
) -> tuple[Array, IntArray, tuple[int, ...]]:
    """Solve poses (m, 4, 4) in one loop; give solutions, counts and the state of the last pose.

    Counts below 1 are those of ``_kernels.inverse.solutions.solve``.
    """
    q, count = np.empty((len(targets), room, chain.n)), np.empty(len(targets), np.int64)
    asked = request.seed, request.metric, request.respect_limits
    away, marks = np.empty(MAX_SOLUTIONS), np.empty((MARKS, MAX_SOLUTIONS), np.int64)
    space = np.empty((MAX_SOLUTIONS, chain.n))
    return q, count, solve(family.arm, targets, *asked, space, q, away, marks, count)


def all_postures(chain: SerialChain, T: Array, family: Family) -> tuple[Array, bool]:
    """List the postures (k, n) of a pose, limits aside, and tell whether they are provably all."""
    request = as_request(chain, np.zeros(chain.n), respect_limits=False)
    q, count, state = solve_many(chain, T[None], family, request, MAX_SOLUTIONS)
    _, _, _, singular, unproven = state
    return q[0, : max(int(count[0]), 0)], family.exact and not singular and not unproven
