"""All families behind one kernel: solutions, ranked; one pose or many."""

import math

import numpy as np

from robomech_ros._kernels import branch_bits as bit
from robomech_ros._kernels._jit import (
    IIN1,
    IN1,
    IN3,
    IOUT1,
    OUT1,
    OUT2,
    OUT3,
    b1,
    i8,
    inline,
    kernel,
)
from robomech_ros._kernels.continuum import free_value, settle_wrist
from robomech_ros._kernels.inverse_general import DOUBT
from robomech_ros._kernels.inverse_short import solve_short
from robomech_ros._kernels.ranking import distance_from, insert, place, rank_body
from robomech_ros._kernels.six_joints import (
    BACKWARDS,
    DECOUPLED,
    GENERAL,
    ITERATIVE,
    MAX_SOLUTIONS,
    THREE_PARALLEL,
    call_six_joints,
)

__all__ = [
    "DECOUPLED",
    "GENERAL",
    "ITERATIVE",
    "MAX_SOLUTIONS",
    "NONE_EXISTS",
    "SHORT",
    "STATE",
    "THREE_PARALLEL",
    "solve",
]

# Families with kernels of their own: the number of that of short arms, after those of six joints
# and the redundant one.
SHORT = 4

# In place of a count: there is no solution, with limits or without.
NONE_EXISTS = -1

# Entries of ``state``: how many bare solutions there are, branches of continua without a posture
# inside the limits, ranked solutions, bare ones that stand for a continuum, and 1 where the family
# cannot vouch for having found all.
BARE = 0
MISSING = 1
RANKED = 2
SINGULAR = 3
UNPROVEN = 4
STATE = 5

# Values of the free joints that are tried where the seed's leads out of the limits.
_FREE_VALUES = 96
# Limits hold; typed, so that numba does not compile a function anew for a literal.
_BOUNDED = np.bool_(True)


@inline
def _settle(family, lower, upper, seed, q, branch, total):
    """Choose among the postures of singular spherical wrists those that limits allow."""
    if family == DECOUPLED:
        for k in range(total):
            if branch[k] & bit.WRIST_SINGULAR:
                settle_wrist(branch[k] & bit.WRIST_OPPOSED != 0, lower, upper, seed, q[k])


@inline
def _count_continua(branch, total):
    """Count the solutions that stand for a continuum."""
    count = 0
    for k in range(total):
        if branch[k] & bit.CONTINUUM:
            count += 1
    return count


@inline
def _excluded(turns, lower, upper, seed, q, branch, total, placed, missing):
    """List the branches of continua whose representatives limits exclude; return how many."""
    count = 0
    for k in range(total):
        if branch[k] & bit.CONTINUUM:
            if not place(turns, lower, upper, seed, _BOUNDED, q[k], placed):
                missing[count] = branch[k]
                count += 1
    return count


@inline
def _add_missing(
    turns, lower, upper, seed, metric, q, branch, placed, missing, ranked, names, distances, state
):
    """Add the postures of missing branches that are inside the limits to the ranked ones.

    ``state`` holds how many postures there are in q, branches missing, and ranked ones.
    """
    for m in range(state[BARE]):
        for j in range(state[MISSING]):
            if missing[j] != branch[m]:
                continue
            if place(turns, lower, upper, seed, _BOUNDED, q[m], placed):
                distance = distance_from(placed, seed, metric)
                state[RANKED] = insert(
                    placed, branch[m], distance, state[RANKED], ranked, names, distances
                )
                state[MISSING] -= 1
                missing[j] = missing[state[MISSING]]
            break


@inline
def _number(branch):
    """Give numbers to postures that were solved backwards, whose names belong to other joints."""
    for k in range(branch.shape[0]):
        number = branch[k] & (bit.SHOULDER_RIGHT | bit.ELBOW_DOWN | bit.WRIST_FLIP)
        if branch[k] & bit.ARM_NUMBERED:
            arm = (branch[k] & bit.ARM_MASK) >> bit.ARM_SHIFT
            number = 2 * arm + (1 if branch[k] & bit.WRIST_FLIP else 0)
        marks = bit.SELF_MOTION if branch[k] & bit.CONTINUUM else branch[k] & bit.BOUNDARY
        branch[k] = bit.POSTURE_NUMBERED | marks | (number << bit.ARM_SHIFT & bit.ARM_MASK)


@inline
def _clear(rows, first):
    """Fill the rows from ``first`` on with NaN."""
    for k in range(first, rows.shape[0]):
        for i in range(rows.shape[1]):
            rows[k, i] = math.nan


@kernel(i8(i8, IN1, IN3, IIN1, IN1, IN1, IN1, i8, b1, OUT2, IOUT1, OUT3, IOUT1, OUT1, IOUT1, IOUT1))
def solve(
    family,
    data,
    T,
    turns,
    lower,
    upper,
    seed,
    metric,
    bounded,
    q,
    branch,
    ranked,
    names,
    distances,
    counts,
    state,
):
    """Solve the poses T (m, 4, 4) one after another.

    The solutions inside the limits (all where not ``bounded``) go to ``ranked`` (m, room, n),
    nearest to the seed first and NaN after the last, their number to ``counts`` (m,): it is
    NONE_EXISTS where there is no solution even outside the limits.  Where limits exclude a
    representative of a continuum, others are tried, with other values of the free joints.
    BACKWARDS is added to ``family`` where the constants are those of the inverse motion.

    Of the last pose, q (16, n) and ``branch`` (16,) get the bare solutions, ``names`` (16,) and
    ``distances`` (16,) the branches of the ranked ones and their distances, and ``state`` (STATE,)
    the numbers of each.
    """
    missing = np.empty(MAX_SOLUTIONS, np.int64)
    others = np.empty((MAX_SOLUTIONS, seed.shape[0]))
    marks = np.empty(MAX_SOLUTIONS, np.int64)
    placed = np.empty(seed.shape[0])
    start = seed.copy()
    for m in range(T.shape[0]):
        found = 0
        for k in range(_FREE_VALUES + 1):
            p, b = (q, branch) if k == 0 else (others, marks)
            if family == SHORT:
                total = solve_short(data, T[m], start, p, b)
            else:
                total = call_six_joints(
                    family % BACKWARDS, family >= BACKWARDS, data, T[m], start, p, b
                )
            unproven = total & DOUBT
            total -= unproven
            if bounded:
                _settle(family, lower, upper, seed, p, b, total)
            state[BARE] = total
            if k == 0:
                found = total
                state[UNPROVEN] = unproven // DOUBT
                state[MISSING] = 0
                state[SINGULAR] = _count_continua(branch, total)
                state[RANKED] = rank_body(
                    turns,
                    lower,
                    upper,
                    seed,
                    metric,
                    bounded,
                    q[:total],
                    branch,
                    ranked[m],
                    names,
                    distances,
                )
                if bounded and state[SINGULAR] > 0:
                    state[MISSING] = _excluded(
                        turns, lower, upper, seed, q, branch, total, placed, missing
                    )
            else:
                _add_missing(
                    turns,
                    lower,
                    upper,
                    seed,
                    metric,
                    p,
                    b,
                    placed,
                    missing,
                    ranked[m],
                    names,
                    distances,
                    state,
                )
            if state[MISSING] == 0:
                break
            for i in range(seed.shape[0]):
                start[i] = free_value(lower[i], upper[i], seed[i], k + 1, _FREE_VALUES)
        for i in range(seed.shape[0]):
            start[i] = seed[i]
        if family >= BACKWARDS:
            _number(branch[:found])
            _number(names[: state[RANKED]])
        counts[m] = state[RANKED] if found > 0 else NONE_EXISTS
        _clear(ranked[m], state[RANKED])
        state[BARE] = found
    return 0
