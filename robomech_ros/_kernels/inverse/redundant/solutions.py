"""Solutions of redundant arms: ranked samples of a parameter, each solved in closed form."""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.compiling.jit import (
    borrowed,
    inline,
    kernel,
    lean,
    scratch,
    scratch_integers,
)
from robomech_ros._kernels.compiling.types import IN1, IN3, IOUT1, OUT1, OUT3, ZERO, i8
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.ranking import (
    Ranked,
    Request,
    distance_from,
    insert,
    nearest_winding,
)
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arm_angle import call_arm_angle
from robomech_ros._kernels.inverse.redundant.nearest import approach
from robomech_ros._kernels.inverse.redundant.samples import choose_locked, sample, stretched
from robomech_ros._kernels.inverse.redundant.tracing import TRACES, small_distance, trace_nearest
from robomech_ros._kernels.inverse.six_joints import GENERAL, ITERATIVE, MAX_SOLUTIONS
from robomech_ros._kernels.tolerances import AT_LIMIT

# Factor of the number of samples of the redundancy parameter if none has a solution inside the
# limits.
FINER_SAMPLES = 4
# Largest number of samples stored as starts, the nearest.
STARTS = 256
# With more than seven joints, this many of the nearest samples are moved along their self-motion,
# if they are within this distance (rad or m) of the first: about the spacing of samples.
APPROACHED = 3
APPROACHED_WITHIN = 0.8
# If steps from the seed end farther than FROM (rad or m), others start near it, with some joints
# displaced by the factor BY of the distance, at most MAX; the last two only if none is nearer.
NEARBY = 4
NEARBY_FROM = 0.1
NEARBY_BY = 0.9
NEARBY_MAX = 0.6
# Number of starts in a box around the seed that find the branches of seven joints along which the
# locked joint hardly moves.
SCATTERED = 24
# Least number of samples of a locked joint within the distance of the nearest known posture.
WITHIN = 3
# Least number of samples if the six joints have a quick closed form.
FAR_SAMPLES = 48

NONE_EXISTS = -1
_NAME = np.int64(bit.SELF_MOTION | bit.UNNAMED)
# Name of a posture that is only a start, such as one of an idealised arm.
INEXACT = np.int64(-1)


@lean
def _approach_from_seed(packed, T, request, nearby, q):
    """Write the nearest posture found by steps from the seed and from starts near it to q (n,).

    ``nearby`` (n,) is working space.  Returns the distance, infinite if none is found.
    """
    _, lower, upper, seed, metric, bounded = request
    n = seed.shape[0]
    for i in range(n):
        q[i] = seed[i]
    distance = approach(packed, T, lower, upper, seed, metric, bounded, q)
    for k in range(NEARBY if n > 7 else 0):
        if distance <= (NEARBY_FROM if k < 2 else NEARBY_MAX):
            break
        # First move two joints to one side and to the other, then all of them.
        away = NEARBY_BY * min(distance, NEARBY_MAX) * (1.0 if k % 2 == 0 else -1.0)
        for i in range(n):
            side = 0.0 if k < 2 and i != 0 and i != 2 else away
            alternate = i == 2 if k < 2 else i % 2 == 1
            there = seed[i] - side if alternate else seed[i] + side
            nearby[i] = min(max(there, lower[i]), upper[i])
        found = approach(packed, T, lower, upper, seed, metric, bounded, nearby)
        if found < distance:
            distance = found
            for i in range(n):
                q[i] = nearby[i]
    return distance


@lean
def _is_inside(request, q):
    """Return whether a posture is inside the limits of the request."""
    _, lower, upper, _, _, _ = request
    for i in range(q.shape[0]):
        if not lower[i] - AT_LIMIT <= q[i] <= upper[i] + AT_LIMIT:
            return False
    return True


@lean
def _enter(request, q, name, count, starts):
    """Add a posture to the starts, in the winding nearest to the seed.

    Returns the number of starts, and its distance from the seed, infinite outside the limits.
    """
    turns, lower, upper, seed, metric, _ = request
    nearest_winding(turns, lower, upper, seed, False, q, q)
    here = distance_from(q, seed, metric)
    count = insert(turns, q, name, here, count, starts)
    return count, here if _is_inside(request, q) else math.inf


@lean
def _take_samples(data, T, request, nearest, steps, space, distance, starts):
    """Add the postures of samples to the ``starts``, in the windings nearest to the seed.

    If only the ``nearest`` is requested, samples farther from the seed than the nearest known
    posture are skipped.  Returns the number of starts, and the least distance of one inside the
    limits.
    """
    turns, lower, upper, seed, metric, _ = request
    q, branch, locked, best, _ = space
    count, known = ZERO, distance < math.inf
    if known:
        count = insert(turns, best, _NAME, distance, count, starts)
    if data[at.KIND] == at.ARM_ANGLE or (data[at.ANGLE] > 0.0 and nearest):
        return _take_angles(data, T, request, nearest, steps, space, distance, starts, count)
    within, beyond = distance if nearest else math.inf, 0.0
    if nearest and not distance < small_distance(metric):
        # Take a few samples within the distance to either side, and one beyond: a branch may start
        # between them.
        if known:
            steps = max(steps, int(WITHIN * 2.0 * math.pi / distance) + 1)
        if seed.shape[0] == 7 and data[at.SIX] != GENERAL and data[at.SIX] != ITERATIVE:
            steps = max(steps, FAR_SAMPLES)
        beyond = 2.0 * math.pi / steps
    towards = stretched(data, T)
    for k in range(steps if math.isnan(towards) else steps + 2):
        if k < steps:
            away = choose_locked(data, lower, upper, seed, k, steps, locked)
        else:
            joint = 6 if data[at.FIRST] == 0.0 else 0
            locked[joint] = towards + math.pi * (k - steps)
            away = abs(wrapped(locked[joint] - seed[joint]))
        if away < within + beyond or k == 0:
            for i in range(sample(data, T, seed, 0.0, locked, 0.0, (q, branch))):
                count, here = _enter(request, q[i], branch[i], count, starts)
                distance = min(distance, here)
                within = min(within, distance) if nearest else within
    if data[at.ANGLE] > 0.0:
        return _take_angles(data, T, request, nearest, steps, space, distance, starts, count)
    return count, distance


@lean
def _take_angles(data, T, request, nearest, steps, space, distance, starts, count):
    """Add the postures of samples of the arm angle to the ``starts``.

    Postures of an idealised arm are INEXACT.  Returns the number of starts, and the least distance
    of one inside the limits.
    """
    _, _, _, seed, metric, _ = request
    q, branch, locked, best, _ = space
    idealised = data[at.KIND] != at.ARM_ANGLE
    if idealised:
        data = data[int(data[at.ANGLE]) :]
    near = distance < math.inf and (nearest or idealised)
    angle = call_arm_angle(data, best if near else seed)
    for k in range(steps):
        turn = 2.0 * math.pi * ((k + 1) // 2) / steps * (1.0 if k % 2 == 1 else -1.0)
        if k > 0 and nearest and distance < small_distance(metric):
            break
        for i in range(sample(data, T, seed, angle, locked, turn, (q, branch))):
            name = INEXACT if idealised else branch[i]
            count, here = _enter(request, q[i], name, count, starts)
            distance = distance if idealised else min(distance, here)
    return count, distance


@lean
def _needs_scatter(data, metric, known):
    """Return whether samples of a locked joint may miss a branch nearer than ``known``."""
    return (
        data[at.KIND] == at.LOCKED and data[at.STRETCHED] == 0.0 and known > small_distance(metric)
    )


@lean
def _scatter(packed, T, request, space, distance, count, starts):
    """Add postures reached from a box around the seed to the ``starts``.

    Half the width of the box is the ``distance`` of the nearest known posture.  Returns the number
    of starts, and the least distance of one inside the limits.
    """
    _, lower, upper, seed, metric, bounded = request
    q, _, _, _, _ = space
    root, size = 1.0, min(distance, math.pi)
    for _ in range(32):
        root = (1.0 + root) ** 0.125
    for k in range(SCATTERED):
        stride = 1.0
        for i in range(7):
            stride /= root
            part = 0.5 + (k + 1) * stride
            there = seed[i] + size * (2.0 * (part - math.floor(part)) - 1.0)
            q[0, i] = min(max(there, lower[i]), upper[i])
        if approach(packed, T, lower, upper, seed, metric, bounded, q[0]) < math.inf:
            count, here = _enter(request, q[0], INEXACT, count, starts)
            distance = min(distance, here)
    return count, distance


@inline
def _approach_first(packed, T, request, count, ranked):
    """Move the first few solutions along their self-motion; return the number of solutions."""
    turns, lower, upper, seed, metric, bounded = request
    rows, names, distances = ranked
    n = seed.shape[0]
    starts, away = np.empty((APPROACHED, n)), scratch(APPROACHED)
    tried = min(count, APPROACHED)
    for k in range(tried):
        for i in range(n):
            starts[k, i] = rows[k, i]
        away[k] = distances[k]
    for k in range(tried):
        if away[k] > distances[0] + APPROACHED_WITHIN:
            break
        distance = approach(packed, T, lower, upper, seed, metric, bounded, starts[k])
        if distance < distances[0]:
            count = insert(turns, starts[k], names[0], distance, count, ranked)
    return count


@inline
def _solve_pose(data, T, request, nearest, traced, joints, space, starts, ranked):
    """Rank the nearest posture and those of all samples.

    Returns the number inside the limits and the number of all.  If only the ``nearest`` is
    requested, samples farther from the seed are skipped.  Self-motions are followed if ``traced``;
    with more than seven joints the first few samples are moved along them.  ``joints`` is that of
    :func:`.trace_nearest`, ``space`` is working space.
    """
    turns, lower, upper, seed, metric, bounded = request
    _, _, locked, best, traces = space
    n = seed.shape[0]
    packed = data[at.PARTS : at.PARTS + 13 * (n + 1)].reshape((n + 1, 13))
    distance = _approach_from_seed(packed, T, request, locked, best)
    if distance < math.inf and nearest_winding(turns, lower, upper, seed, bounded, best, best):
        distance = distance_from(best, seed, metric)
    else:
        # Steps that fail leave an invalid posture.
        for i in range(n):
            best[i] = math.inf
    steps = int(data[at.SAMPLES])
    total, count = ZERO, ZERO
    rows, marks, away = starts
    for _ in range(2):
        total, known = _take_samples(data, T, request, nearest, steps, space, distance, starts)
        if traced and _needs_scatter(data, metric, known):
            total, known = _scatter(packed, T, request, space, known, total, starts)
        if traced:
            for k in range(total if known < distance else 0):
                if away[k] == known:
                    distance = known
                    for i in range(n):
                        best[i] = rows[k, i]
                    break
            distance = trace_nearest(
                packed,
                T,
                joints,
                metric,
                bounded,
                rows[:total],
                away[:total],
                distance,
                best,
                traces,
            )
        if distance < math.inf:
            count = insert(turns, best, _NAME, distance, count, ranked)
        for k in range(total):
            if marks[k] != INEXACT and _is_inside(request, rows[k]):
                nearest_winding(turns, lower, upper, seed, bounded, rows[k], rows[k])
                count = insert(turns, rows[k], marks[k], away[k], count, ranked)
        if count > 0:
            break
        steps *= FINER_SAMPLES
    if n > 7:
        count = _approach_first(packed, T, request, count, ranked)
    return count, total


@kernel(i8(IN1, IN3, IN1, types.UniTuple(i8, 4), OUT3, IOUT1, OUT1, IOUT1))
def solve_redundant(arm, T, seed, options, ranked, names, distances, counts):
    """Solve the poses T (m, 4, 4) one after another, for samples of the redundancy parameter.

    ``arm`` is that of :func:`.inverse.solutions.solve`.  ``options`` are the metric, whether limits
    are respected, whether only the nearest is requested (farther samples are then skipped), and
    whether self-motions of seven joints are traced.  The solutions go to ``ranked`` (m, room, n),
    nearest to the seed first and NaN after the last; with tracing the first is the nearest of the
    self-motions.  ``counts`` (m,) gets their number, or NONE_EXISTS if no sample has a posture even
    outside the limits.  ``names`` and ``distances`` (room,) are those of the last pose.  Returns 0.
    """
    metric, bounded, nearest = options[0], options[1] != 0, options[2] != 0
    n = seed.shape[0]
    traced = options[3] != 0 and n == 7
    arm, T, ranked = borrowed(arm), borrowed(T), borrowed(ranked)
    turns, lower, upper = arm[1 : n + 1], arm[n + 1 : 2 * n + 1], arm[2 * n + 1 : 3 * n + 1]
    data = arm[3 * n + 1 :]
    q = np.empty((MAX_SOLUTIONS, n))
    branch = scratch_integers(MAX_SOLUTIONS)
    low, high, locked, best = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    joints = np.empty((4, n))
    starts = Ranked(np.empty((STARTS, n)), np.empty(STARTS, np.int64), np.empty(STARTS))
    for i in range(n):
        low[i] = lower[i] if bounded else -math.inf
        high[i] = upper[i] if bounded else math.inf
        joints[0, i], joints[1, i], joints[2, i], joints[3, i] = turns[i], low[i], high[i], seed[i]
    request = Request(turns, low, high, seed, metric, bounded)
    space = q, branch, locked, best, np.empty((TRACES, 28))
    for m in range(T.shape[0]):
        into = Ranked(ranked[m], names, distances)
        count, bare = _solve_pose(data, T[m], request, nearest, traced, joints, space, starts, into)
        counts[m] = count if bare > 0 else NONE_EXISTS
        for k in range(count, ranked.shape[1]):
            for i in range(n):
                ranked[m, k, i] = math.nan
    return 0
