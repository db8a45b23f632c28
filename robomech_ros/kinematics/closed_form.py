"""All solutions of arms whose family has a closed form."""

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.inverse import MARKS, MAX_SOLUTIONS, NAMES, solve
from robomech_ros._kernels.ranking import rank, winding_count
from robomech_ros._kernels.tolerances import MOST_WINDINGS
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.families import Family
from robomech_ros.kinematics.outcome import (
    NO_EXCESS,
    describe_continuum,
    explain_limits,
    explain_nothing,
    nothing,
)
from robomech_ros.kinematics.request import Request
from robomech_ros.kinematics.result import WHOLE_POSE, InverseKinematicsResult
from robomech_ros.kinematics.status import Status
from robomech_ros.robots.chain import SerialChain

__all__ = ["rank_windings", "solve_closed_form"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_SUCCESS = Status.SUCCESS  # to look it up takes longer than a solution


def solve_closed_form(
    chain: SerialChain, T: Array, request: Request, family: Family
) -> InverseKinematicsResult:
    """Find all solutions of the pose T (4, 4), ranked, or explain why there is none."""
    q, rows = np.empty((MAX_SOLUTIONS, chain.n)), np.empty((1, MAX_SOLUTIONS, chain.n))
    marks, counts = np.empty((MARKS, MAX_SOLUTIONS), np.int64), np.empty(1, np.int64)
    distances = np.empty(MAX_SOLUTIONS)
    bare, missing, count, singular, unproven = solve(
        family.arm,
        T[None],
        request.seed,
        request.metric,
        request.respect_limits,
        q,
        rows,
        distances,
        marks,
        counts,
    )
    if not count:
        if not bare and unproven:
            reason = "the pose is degenerate: no posture was found, which proves nothing"
            return nothing(chain, T, family, Status.NOT_CONVERGED, reason)
        if not bare:
            return explain_nothing(chain, T, family)
        proven = not unproven and family.exact
        return explain_limits(chain, T, q[:bare], family, continuum=singular > 0, proven=proven)
    ranked, names = rows[0], marks[NAMES]
    reason = ""
    if singular > missing:
        reason = describe_continuum(chain, ranked[:count], names[:count])
    if request.include_windings:
        ranked, names, distances = rank_windings(
            chain, family.turns, request, ranked[:count], names[:count]
        )
        count = len(ranked)
    kept = count if request.max_solutions is None else min(count, request.max_solutions)
    return InverseKinematicsResult(
        chain=chain,
        target=T,
        q=ranked[:kept],
        seed_distance=distances[:kept],
        family=family.name,
        complete=not singular and not unproven and family.exact,
        status=_SUCCESS,
        reason=reason,
        blocking_joints=(),
        blocking_excess=NO_EXCESS,
        branch_bits=names[:kept],
        task=WHOLE_POSE,
    )


def rank_windings(
    chain: SerialChain, turns: Integers, request: Request, q: Array, names: Integers
) -> tuple[Array, Integers, Array]:
    """List the solutions q (k, n) in every winding inside the limits, nearest to the seed first.

    Returns joint values, branches and distances.

    Raises
    ------
    BadValueError
        The limits allow more than MOST_WINDINGS.
    """
    room = winding_count(turns, chain.lower, chain.upper, q)
    if room > MOST_WINDINGS:
        expected = f"limits with at most {MOST_WINDINGS} windings of all solutions; here are {room}"
        raise BadValueError("include_windings", True, expected)
    ranked = np.empty((room, chain.n))
    marks = np.empty(room, np.int64)
    distances = np.empty(room)
    count = rank(
        turns,
        chain.lower,
        chain.upper,
        request.seed,
        request.metric,
        request.respect_limits,
        True,
        q,
        names,
        ranked,
        marks,
        distances,
    )
    return ranked[:count], marks[:count], distances[:count]
