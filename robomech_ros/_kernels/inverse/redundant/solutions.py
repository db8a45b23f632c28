"""Redundant arms: a closed form for each value of a parameter, samples of it ranked."""

import math

import numpy as np
from numba import types

from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import (
    IN1,
    IN3,
    IOUT1,
    OUT1,
    OUT3,
    ZERO,
    borrowed,
    i8,
    inline,
    kernel,
    lean,
    scratch,
    scratch_integers,
)
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.polishing import call_polish, largest_error, pose_difference
from robomech_ros._kernels.inverse.ranking import (
    Ranked,
    Request,
    distance_from,
    insert,
    place,
)
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.angle_proof import prove_by_angle
from robomech_ros._kernels.inverse.redundant.arm_angle import call_arm_angle
from robomech_ros._kernels.inverse.redundant.narrowing import NEARER_BY
from robomech_ros._kernels.inverse.redundant.nearest import NEAREST_ERROR, approach
from robomech_ros._kernels.inverse.redundant.nearest_proof import prove_nearest
from robomech_ros._kernels.inverse.redundant.samples import choose, sample
from robomech_ros._kernels.inverse.redundant.walking import walk
from robomech_ros._kernels.inverse.six_joints import MAX_SOLUTIONS

__all__ = ["NONE_EXISTS", "solve_redundant"]

# How many times finer the redundancy parameter is sampled where no sample gives a solution inside
# the limits.
FINER_SAMPLES = 4
# So many of the nearest samples are moved along, those within so much (rad or m) of the first:
# about as much as lies between samples.
APPROACHED = 3
APPROACHED_WITHIN = 0.8
# but not one that is this near (rad or m) to a posture that is as near as its self-motion goes: it
# would only lead there.
APPROACHED_AGAIN = 0.03
# Where steps from the seed come no nearer than FROM (rad or m), others begin beside it, with some
# joints away by this part of the distance, of MOST at most; the last two only where none is nearer.
BESIDE = 4
BESIDE_FROM = 0.1
BESIDE_BY = 0.9
BESIDE_MOST = 0.6
# Steps that bring a posture beside a singular one onto its pose.
POLISH_STEPS = 10

NONE_EXISTS = -1


@lean
def _is_near(q, others, count):
    """Tell whether a posture is near one of others from which its self-motion goes no nearer."""
    for k in range(count):
        near = True
        for i in range(q.shape[0]):
            near = near and abs(q[i] - others[k, i]) <= APPROACHED_AGAIN
        if near:
            return True
    return False


@lean
def _approach_from_seed(packed, T, request, low, high, tries, beside, q):
    """Write to q (n,) the nearest posture to which steps from the seed and beside it lead.

    There are ``tries`` beside it at most, and ``beside`` (n,) is working space.  Returns what
    :func:`approach` does.
    """
    _, lower, upper, seed, metric, bounded = request
    n = seed.shape[0]
    for i in range(n):
        q[i] = seed[i]
    distance, settled = approach(packed, T, lower, upper, seed, metric, bounded, q)
    for k in range(tries):
        # From any posture of seven joints a walk goes on.
        if distance < math.inf and (n == 7 or distance <= (BESIDE_FROM if k < 2 else BESIDE_MOST)):
            break
        # First two joints to one side and to the other, then all of them.
        away = BESIDE_BY * min(distance, BESIDE_MOST) * (1.0 if k % 2 == 0 else -1.0)
        for i in range(n):
            side = 0.0 if k < 2 and i != 0 and i != 2 else away
            alternate = i == 2 if k < 2 else i % 2 == 1
            beside[i] = min(max(seed[i] - side if alternate else seed[i] + side, low[i]), high[i])
        found, sure = approach(packed, T, lower, upper, seed, metric, bounded, beside)
        if found < distance:
            distance, settled = found, sure
            for i in range(n):
                q[i] = beside[i]
    return distance, settled


@lean
def _misses(packed, T, q):
    """Tell whether a posture q (n,) misses the pose T (4, 4) by more than rounding."""
    current, e = scratch(4, 4), scratch(6)
    forward_body(packed, q, current)
    pose_difference(T, current, e)
    return largest_error(e) > NEAREST_ERROR


@inline
def _prove(data, T, request, joints, distance, placed):
    """Find the nearest posture of all arcs; return its distance, and whether it is proved.

    ``placed`` (7,) is the nearest posture known, at this distance, and the nearest of all then.
    """
    turns, lower, upper, seed, metric, bounded = request
    packed = data[at.PARTS : at.PARTS + 8 * 13].reshape((8, 13))
    nearest_so_far = distance
    if data[at.RIGHT] != 0.0:
        distance, proved = prove_by_angle(data, T, joints, metric, bounded, distance, placed)
    else:
        distance, proved = prove_nearest(data, T, joints, metric, bounded, placed)
    if not distance < nearest_so_far or not _misses(packed, T, placed):
        return distance, proved
    beside = scratch(7)
    for i in range(7):
        beside[i] = placed[i]
    found, _ = approach(packed, T, lower, upper, seed, metric, bounded, beside)
    if found >= distance + NEARER_BY:
        # Beside a singular posture no step leads nearer, but one to the pose itself does.
        for i in range(7):
            beside[i] = placed[i]
        call_polish(packed, T, beside, POLISH_STEPS)
        if place(turns, lower, upper, seed, bounded, beside, beside):
            found = distance_from(beside, seed, metric)
    if found < distance + NEARER_BY:
        distance = found
        for i in range(7):
            placed[i] = beside[i]
    return distance, proved


@inline
def _find_nearest(data, T, request, bench, placed, reached):
    """Find the nearest posture to which steps from the seed lead, or along all arcs.

    It goes to ``placed`` (n,), and to ``reached`` (n,) where it is as near as its self-motion goes,
    else NaN.  ``bench`` has the joints as :func:`.walk` has them, and where they may be.  Returns
    its distance, and whether it is proved to be the nearest of all.
    """
    joints, low, high = bench
    n = placed.shape[0]
    packed = data[at.PARTS : at.PARTS + 13 * (n + 1)].reshape((n + 1, 13))
    arcs, by_angle = data[at.ARCS] > 0.0, data[at.RIGHT] != 0.0
    distance, settled, proved = math.inf, False, False
    if arcs and not by_angle:
        distance, proved = _prove(data, T, request, joints, distance, placed)
    if not proved:
        tries = 0 if arcs else BESIDE
        start, beside = np.empty(n), np.empty(n)
        found, sure = _approach_from_seed(packed, T, request, low, high, tries, beside, start)
        if found < distance:
            distance, settled = found, sure
            for i in range(n):
                placed[i] = start[i]
    if by_angle:
        distance, proved = _prove(data, T, request, joints, distance, placed)
    for i in range(n):
        reached[i] = placed[i] if settled else math.nan
    return distance, proved


@inline
def _collect(data, T, request, nearest, bench, ranked, reached):
    """Rank the postures of all samples.

    Returns how many are inside the limits, how many exist, and whether the first of them is proved
    to be the nearest of all, not only of samples: then no others are made where only the nearest
    is asked for.  ``bench`` has room for postures and what they are called, too.
    The posture that :func:`_find_nearest` finds is among them.  Where only the nearest is asked
    for, samples that are farther from the seed than the first are left out.
    """
    turns, lower, upper, seed, metric, bounded = request
    joints, low, high, q, branch = bench
    rows, names, distances = ranked
    n = seed.shape[0]
    placed = np.empty(n)
    distance, proved = _find_nearest(data, T, request, (joints, low, high), placed, reached)
    count = ZERO
    bare = ZERO
    if distance < math.inf:
        name = np.int64(bit.SELF_MOTION | bit.UNNAMED)
        count = insert(placed, name, distance, count, rows, names, distances)
        bare += 1
        if proved and nearest:
            return count, bare, proved
    locked = np.empty(n)
    steps = int(data[at.SAMPLES])
    angle = call_arm_angle(data, seed) if data[at.KIND] == at.ARM_ANGLE else 0.0
    for _ in range(2):
        for k in range(steps):
            if data[at.KIND] == at.LOCKED:
                away = choose(data, low, high, seed, k, steps, locked)
                if nearest and count > 0 and away >= distances[0]:
                    continue
            turn = 2.0 * math.pi * ((k + 1) // 2) / steps * (1.0 if k % 2 == 1 else -1.0)
            total = sample(data, T, seed, angle, locked, turn, (q, branch))
            bare += total
            for i in range(total):
                if place(turns, lower, upper, seed, bounded, q[i], placed):
                    distance = distance_from(placed, seed, metric)
                    count = insert(placed, branch[i], distance, count, rows, names, distances)
        if count > 0:
            break
        steps *= FINER_SAMPLES
    return count, bare, proved


@inline
def _approach_first(packed, T, request, count, reached, ranked):
    """Move the first few ranked solutions along their self-motion; return how many there are then.

    ``reached`` (APPROACHED + 1, n) has in its first row what is as near as its self-motion goes.
    """
    _, lower, upper, seed, metric, bounded = request
    rows, names, distances = ranked
    n = seed.shape[0]
    starts, away = np.empty((APPROACHED, n)), scratch(APPROACHED)
    tried = min(count, APPROACHED)
    for k in range(tried):
        for i in range(n):
            starts[k, i] = rows[k, i]
        away[k] = distances[k]
    ends = 1
    for k in range(tried):
        if away[k] > distances[0] + APPROACHED_WITHIN:
            break
        if away[k] >= distances[0] and _is_near(starts[k], reached, ends):
            continue
        distance, settled = approach(packed, T, lower, upper, seed, metric, bounded, starts[k])
        if settled:
            for i in range(n):
                reached[ends, i] = starts[k, i]
            ends += 1
        if distance < distances[0]:
            count = insert(starts[k], names[0], distance, count, rows, names, distances)
    return count


@inline
def _walk(packed, T, joints, request, count, best, ranked):
    """Walk along self-motions from the first ranked solution, or from the seed where there is none.

    ``joints`` is as :func:`walk` has it, ``best`` (7,) working space.  Returns how many solutions
    there are then.
    """
    _, _, _, seed, metric, bounded = request
    rows, names, distances = ranked
    distance = distances[0] if count > 0 else math.inf
    if distance <= BESIDE_FROM:
        return count
    for i in range(7):
        best[i] = rows[0, i] if count > 0 else seed[i]
    away = walk(packed, T, joints, metric, bounded, distance, best)
    name = np.int64(bit.SELF_MOTION | bit.UNNAMED)
    if away < distance:
        distance = away
        count = insert(best, name, away, count, rows, names, distances)
    if away < math.inf:
        # Where the way bends sharply, beside a singular posture, the walk stops a little early.
        _, lower, upper, _, _, _ = request
        away, _ = approach(packed, T, lower, upper, seed, metric, bounded, best)
        if away < distance:
            count = insert(best, name, away, count, rows, names, distances)
    return count


@kernel(i8(IN1, IN3, IN1, types.UniTuple(i8, 3), OUT3, IOUT1, OUT1, IOUT1))
def solve_redundant(arm, T, seed, asked, ranked, names, distances, counts):
    """Solve the poses T (m, 4, 4) one after another, for samples of the redundancy parameter.

    ``arm`` is as :func:`.inverse.solutions.solve` has it.  ``asked`` are the metric, whether limits
    hold, and whether only the nearest is asked for: then samples farther than the first are left
    out.  The solutions go to ``ranked`` (m, room, n),
    nearest to the seed first and NaN after the last; the first few are moved along their
    self-motion until they are as near as that goes.  ``counts`` (m,) gets their number, or
    NONE_EXISTS where no sample has a posture even outside the limits.  ``names`` and ``distances``
    (room,) are those of the last pose.  Returns 1 where the first of that is proved to be the
    nearest.
    """
    metric, bounded, nearest = asked[0], asked[1] != 0, asked[2] != 0
    n = seed.shape[0]
    arm, T, ranked = borrowed(arm), borrowed(T), borrowed(ranked)
    turns, lower, upper = arm[1 : n + 1], arm[n + 1 : 2 * n + 1], arm[2 * n + 1 : 3 * n + 1]
    data = arm[3 * n + 1 :]
    packed = data[at.PARTS : at.PARTS + 13 * (n + 1)].reshape((n + 1, 13))
    request = Request(turns, lower, upper, seed, metric, bounded)
    q = np.empty((MAX_SOLUTIONS, n))
    branch = scratch_integers(MAX_SOLUTIONS)
    reached = np.empty((APPROACHED + 1, n))
    low, high, beside = np.empty(n), np.empty(n), np.empty(n)
    joints = np.empty((4, n))
    proved = False
    for i in range(n):
        joints[0, i], joints[1, i] = turns[i], lower[i]
        joints[2, i], joints[3, i] = upper[i], seed[i]
        low[i] = lower[i] if bounded else -math.inf
        high[i] = upper[i] if bounded else math.inf
    bench = joints, low, high, q, branch
    for m in range(T.shape[0]):
        into = Ranked(ranked[m], names, distances)
        count, bare, proved = _collect(data, T[m], request, nearest, bench, into, reached[0])
        if not proved:
            count = _approach_first(packed, T[m], request, count, reached, into)
        if not proved and n == 7:
            count = _walk(packed, T[m], joints, request, count, beside, into)
            bare = max(bare, count)
        counts[m] = count if bare > 0 else NONE_EXISTS
        for k in range(count, ranked.shape[1]):
            for i in range(n):
                ranked[m, k, i] = math.nan
    return 1 if proved else 0
