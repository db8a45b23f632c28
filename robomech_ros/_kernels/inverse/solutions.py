"""One kernel that solves one pose or many for all families and ranks the solutions."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import types

from robomech_ros._kernels.compiling.jit import borrowed, kernel, lean, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IOUT1, IOUT2, OUT1, OUT2, OUT3, b1, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.branch_bits import DOUBT
from robomech_ros._kernels.inverse.continuum import free_value, settle_wrist
from robomech_ros._kernels.inverse.ranking import (
    Ranked,
    Request,
    distance_from,
    insert,
    nearest_winding,
    rank_body,
)
from robomech_ros._kernels.inverse.short import solve_short
from robomech_ros._kernels.inverse.six_joints import (
    BACKWARDS,
    DECOUPLED as DECOUPLED,
    GENERAL as GENERAL,
    ITERATIVE as ITERATIVE,
    MAX_SOLUTIONS as MAX_SOLUTIONS,
    THREE_PARALLEL as THREE_PARALLEL,
    call_six_joints,
)

# Family of short arms; six_joints has the families of six joints, and 3 is that of redundant arms.
SHORT = 4

# Counts without a solution: none exists, even outside the limits; none was found, without a proof.
NONE_EXISTS = -1
UNDECIDED = -2

# Rows of ``marks``: branches of the bare and of the ranked solutions.
BRANCH = 0
NAMES = 1
MARKS = 2
# Entries of ``state``: numbers of bare solutions, of branches of continua without a posture inside
# the limits, of ranked solutions and of bare solutions that represent a continuum; and 1 if the
# family cannot prove that it has found all.
BARE = 0
MISSING = 1
RANKED = 2
SINGULAR = 3
UNPROVEN = 4
STATE = 5

# Number of values of the free joints tried if the seed's value leads out of the limits.
_FREE_VALUES = 96
# True, typed so that numba does not recompile a function for a literal.
_BOUNDED = np.bool_(True)


class _Space(NamedTuple):
    """Working space of one pose: other solutions, nearest winding, missing branches, distances."""

    q: Any
    marks: Any
    nearest: Any
    missing: Any
    away: Any


@lean
def _settle(family, lower, upper, seed, q, branch, total):
    """Move the postures of singular spherical wrists into the limits."""
    if family == DECOUPLED:
        for k in range(total):
            if branch[k] & bit.WRIST_SINGULAR:
                settle_wrist(branch[k] & bit.WRIST_OPPOSED != 0, lower, upper, seed, q[k])


@lean
def _count_continua(branch, total):
    """Return the number of solutions that represent a continuum."""
    count = 0
    for k in range(total):
        if branch[k] & bit.CONTINUUM:
            count += 1
    return count


@lean
def _excluded(request, q, branch, total, space):
    """List the branches of continua whose representatives exceed the limits; return how many."""
    turns, lower, upper, seed, _, _ = request
    count = 0
    for k in range(total):
        if branch[k] & bit.CONTINUUM:
            if not nearest_winding(turns, lower, upper, seed, _BOUNDED, q[k], space.nearest):
                space.missing[count] = branch[k]
                count += 1
    return count


@lean
def _add_missing(request, space, ranked, state):
    """Add the postures of missing branches that are inside the limits to the ranked ones.

    ``state`` holds the numbers of postures in the space, missing branches and ranked solutions.
    """
    turns, lower, upper, seed, metric, _ = request
    q, branch, nearest, missing, _ = space
    for m in range(state[BARE]):
        for j in range(state[MISSING]):
            if missing[j] != branch[m]:
                continue
            if nearest_winding(turns, lower, upper, seed, _BOUNDED, q[m], nearest):
                distance = distance_from(nearest, seed, metric)
                count = insert(turns, nearest, branch[m], distance, state[RANKED], ranked)
                state[RANKED] = count
                state[MISSING] -= 1
                missing[j] = missing[state[MISSING]]
            break


@lean
def _bare(family, data, T, start, request, bounded, q, branch):
    """Write the bare solutions of any family; return their number, plus DOUBT if incomplete."""
    if family == SHORT:
        total = solve_short(data, T, start, q, branch)
    else:
        total = call_six_joints(family % BACKWARDS, family >= BACKWARDS, data, T, start, q, branch)
    if bounded:
        _settle(family, request.lower, request.upper, request.seed, q, branch, total % DOUBT)
    return total


@lean
def _seek_missing(family, data, T, start, request, space, ranked, state):
    """Try other values of the free joints until no branch of a continuum is missing."""
    _, lower, upper, seed, _, _ = request
    for k in range(1, _FREE_VALUES + 1):
        for i in range(seed.shape[0]):
            start[i] = free_value(lower[i], upper[i], seed[i], k, _FREE_VALUES)
        total = _bare(family, data, T, start, request, _BOUNDED, space.q, space.marks)
        state[BARE] = total % DOUBT
        _add_missing(request, space, ranked, state)
        if state[MISSING] == 0:
            break
    for i in range(seed.shape[0]):
        start[i] = seed[i]


@lean
def _solve_pose(family, data, T, start, request, q, branch, space, ranked, state):
    """Solve one pose and rank its solutions; return the number of bare solutions."""
    total = _bare(family, data, T, start, request, request.bounded, q, branch)
    found = total % DOUBT
    state[UNPROVEN] = total // DOUBT
    state[MISSING] = 0
    state[SINGULAR] = _count_continua(branch, found)
    state[RANKED] = rank_body(request, q, branch, found, space.q, space.marks, space.away, ranked)
    if request.bounded and state[SINGULAR] > 0:
        state[MISSING] = _excluded(request, q, branch, found, space)
    if state[MISSING] > 0:
        _seek_missing(family, data, T, start, request, space, ranked, state)
    return found


@lean
def _number(branch):
    """Replace branch names, which belong to other joints, by numbers after solving backwards."""
    for k in range(branch.shape[0]):
        number = branch[k] & (bit.SHOULDER_RIGHT | bit.ELBOW_DOWN | bit.WRIST_FLIP)
        if branch[k] & bit.ARM_NUMBERED:
            arm = (branch[k] & bit.ARM_MASK) >> bit.ARM_SHIFT
            number = 2 * arm + (1 if branch[k] & bit.WRIST_FLIP else 0)
        marks = bit.SELF_MOTION if branch[k] & bit.CONTINUUM else branch[k] & bit.BOUNDARY
        branch[k] = bit.POSTURE_NUMBERED | marks | (number << bit.ARM_SHIFT & bit.ARM_MASK)


@lean
def _clear(rows, first):
    """Fill the rows from ``first`` on with NaN."""
    for k in range(first, rows.shape[0]):
        for i in range(rows.shape[1]):
            rows[k, i] = math.nan


@kernel(types.UniTuple(i8, STATE)(OUT1, OUT3, OUT1, i8, b1, OUT2, OUT3, OUT1, IOUT2, IOUT1))
def solve(arm, T, seed, metric, bounded, q, ranked, distances, marks, counts):
    """Solve the poses T (m, 4, 4) one after another.

    ``arm`` holds the index of the family; for all joints whether they turn, then their lower and
    their upper limits; then the constants of the family.  It is one array, since passing an array
    takes a fourth of the time of solving an arm.  Arrays that are only read are writable, too:
    numba takes thrice as long to accept read-only ones.

    The solutions inside the limits (all if not ``bounded``) go to ``ranked`` (m, room, n),
    nearest to the seed first and NaN after the last, their number to ``counts`` (m,).  It is
    NONE_EXISTS without a solution even outside the limits, UNDECIDED if the family cannot prove
    that.  If limits exclude a representative of a continuum, other values of the free joints are
    tried.  BACKWARDS is added to the family if the constants are those of the inverse motion.

    For the last pose, q (16, n) and row BRANCH of ``marks`` (MARKS, 16) get the bare solutions, row
    NAMES and ``distances`` (16,) the branches and distances of the ranked ones.  Returns the
    entries of its ``state``.
    """
    n = seed.shape[0]
    arm, T, q, ranked = borrowed(arm), borrowed(T), borrowed(q), borrowed(ranked)
    marks = borrowed(marks)
    branch, names, state = marks[BRANCH], marks[NAMES], scratch_integers(STATE)
    family = int(arm[0])
    turns, lower, upper = arm[1 : n + 1], arm[n + 1 : 2 * n + 1], arm[2 * n + 1 : 3 * n + 1]
    data = arm[3 * n + 1 :]
    rows = np.empty((MAX_SOLUTIONS + 2, n))
    bare_rows = borrowed(rows)
    start = bare_rows[MAX_SOLUTIONS + 1]
    space = _Space(
        bare_rows[:MAX_SOLUTIONS],
        scratch_integers(MAX_SOLUTIONS),
        bare_rows[MAX_SOLUTIONS],
        scratch_integers(MAX_SOLUTIONS),
        scratch(MAX_SOLUTIONS),
    )
    request = Request(turns, lower, upper, seed, metric, bounded)
    for i in range(n):
        start[i] = seed[i]
    for i in range(STATE):
        state[i] = 0
    for m in range(T.shape[0]):
        into = Ranked(ranked[m], names, distances)
        found = _solve_pose(family, data, T[m], start, request, q, branch, space, into, state)
        if family >= BACKWARDS:
            _number(branch[:found])
            _number(names[: state[RANKED]])
        counts[m] = state[RANKED]
        if found == 0:
            counts[m] = UNDECIDED if state[UNPROVEN] > 0 else NONE_EXISTS
        _clear(ranked[m], state[RANKED])
        state[BARE] = found
    return state[BARE], state[MISSING], state[RANKED], state[SINGULAR], state[UNPROVEN]
