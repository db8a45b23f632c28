"""Redundant arms: a closed form for each value of a parameter, samples of it ranked."""

import math

import numpy as np

from robomech_ros._kernels.algebra.angles import wrapped
from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import (
    IN1,
    IN2,
    IN3,
    IOUT1,
    OUT1,
    OUT2,
    OUT3,
    ZERO,
    b1,
    borrowed,
    i8,
    inline,
    kernel,
    lean,
    scratch,
    scratch_integers,
)
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.continuum import free_value
from robomech_ros._kernels.inverse.polishing import call_polish, largest_error, pose_difference
from robomech_ros._kernels.inverse.ranking import (
    LINF,
    Ranked,
    Request,
    distance_from,
    insert,
    place,
)
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.angle_proof import prove_by_angle
from robomech_ros._kernels.inverse.redundant.arm_angle import (
    call_arm_angle,
    call_arm_angle_postures,
)
from robomech_ros._kernels.inverse.redundant.nearest import NEAREST_ERROR, approach
from robomech_ros._kernels.inverse.redundant.nearest_proof import NEARER_BY, prove_nearest
from robomech_ros._kernels.inverse.redundant.walking import walk
from robomech_ros._kernels.inverse.six_joints import DOUBT, GENERAL, MAX_SOLUTIONS, call_six_joints

__all__ = ["NONE_EXISTS", "locked_postures", "solve_redundant"]

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
# Distance as the root of squares (rad) from which on no proof is tried: it would take long.
PROOF_OF_SQUARES = 1.5
# Where steps from the seed come no nearer than FROM (rad or m), others begin beside it, with some
# joints away by this part of the distance, of MOST at most; the last two only where none is nearer.
BESIDE = 4
BESIDE_FROM = 0.1
BESIDE_BY = 0.9
BESIDE_MOST = 0.6
# Steps that bring a posture beside a singular one onto its pose.
POLISH_STEPS = 10

NONE_EXISTS = -1
# Typed, since numba compiles a function anew for a literal.
_FORWARDS = np.bool_(False)


@lean
def _between(front, T, back, out):
    """front^-1 T back^-1."""
    for i in range(3):
        a, b, c = front[0, i], front[1, i], front[2, i]
        x = a * T[0, 0] + b * T[1, 0] + c * T[2, 0]
        y = a * T[0, 1] + b * T[1, 1] + c * T[2, 1]
        z = a * T[0, 2] + b * T[1, 2] + c * T[2, 2]
        p = a * (T[0, 3] - front[0, 3]) + b * (T[1, 3] - front[1, 3]) + c * (T[2, 3] - front[2, 3])
        for j in range(3):
            out[i, j] = x * back[j, 0] + y * back[j, 1] + z * back[j, 2]
        out[i, 3] = p - out[i, 0] * back[0, 3] - out[i, 1] * back[1, 3] - out[i, 2] * back[2, 3]
        out[3, i] = 0.0
    out[3, 3] = 1.0


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
def _locked_body(data, T, seed, locked, q, branch):
    """Write the postures for the pose T (4, 4) in which the joints outside the six have a value.

    ``locked`` (n,) holds the values, those of the six are not read; q is (16, n).  Returns how
    many postures there are.
    """
    n = int(data[at.JOINTS])
    first = int(data[at.FIRST])
    own = at.PARTS + 13 * (n + 1)
    packed = data[at.PARTS : own].reshape((n + 1, 13))
    front, back, target = scratch(4, 4), scratch(4, 4), scratch(4, 4)
    found = scratch(MAX_SOLUTIONS, 6)
    forward_body(packed[: first + 1], locked[:first], front)
    forward_body(packed[first + 6 :], locked[first + 6 :], back)
    _between(front, T, back, target)
    start = seed[first : first + 6]
    six = int(data[at.SIX])
    total = call_six_joints(
        six, data[at.BACKWARDS] != 0.0, data[own:], target, start, found, branch
    )
    exact = int(data[at.GENERAL])
    if total >= DOUBT and exact > 0:
        total = call_six_joints(GENERAL, _FORWARDS, data[exact:], target, start, found, branch)
    # Of a continuum no list is complete, so that a doubt that is left changes nothing.
    count = total % DOUBT
    for k in range(count):
        for i in range(n):
            if i < first or i >= first + 6:
                q[k, i] = locked[i]
            else:
                value = found[k, i - first]
                q[k, i] = wrapped(value) if packed[i, 0] == 0.0 else value
        branch[k] = bit.SELF_MOTION | bit.UNNAMED
    return count


@kernel(i8(IN1, IN2, IN1, IN1, OUT2, IOUT1))
def locked_postures(data, T, seed, locked, q, branch):
    """Do for Python what :func:`_locked_body` does: postures with some joints locked."""
    return _locked_body(data, T, seed, locked, q, branch)


@lean
def _choose(data, lower, upper, seed, k, steps, locked):
    """Write the k-th of some values of the locked joints; return how far they are from the seed.

    The first is the seed's.  One joint takes the others in order of their distance from there;
    several follow a sequence that fills the box of their limits evenly.
    """
    n = int(data[at.JOINTS])
    first = int(data[at.FIRST])
    largest = 0.0
    root = 1.0
    for _ in range(32 if n > 7 and k > 0 else 0):
        root = (1.0 + root) ** (1.0 / (n - 5))
    stride = 1.0
    for i in range(n):
        locked[i] = seed[i]
        if first <= i < first + 6 or k == 0:
            continue
        if n == 7:
            locked[i] = free_value(lower[i], upper[i], seed[i], k, steps)
        else:
            stride /= root
            part = 0.5 + k * stride
            low, high = lower[i], upper[i]
            if not high - low < 2.0 * math.pi and data[at.PARTS + 13 * i] == 0.0:
                low, high = seed[i] - math.pi, seed[i] + math.pi
            elif not high - low < math.inf:
                low, high = seed[i] - data[at.SIZE], seed[i] + data[at.SIZE]
                low, high = max(low, lower[i]), min(high, upper[i])
            locked[i] = low + (high - low) * (part - math.floor(part))
        largest = max(largest, abs(locked[i] - seed[i]))
    return largest


@lean
def _sample(data, T, seed, angle, locked, turn, postures):
    """Write the postures of one sample and what they are called.

    ``angle`` is the arm angle of the seed, from which the sample is a ``turn`` (rad) away.
    """
    q, branch = postures
    if data[at.KIND] == at.ARM_ANGLE:
        return call_arm_angle_postures(data, T, seed, angle + turn, q, branch)
    return _locked_body(data, T, seed, locked, q, branch)


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
def _collect(data, T, request, nearest, bench, ranked, reached):
    """Rank the postures of all samples.

    Returns how many are inside the limits, how many exist, and whether the first of them is proved
    to be the nearest of all, not only of samples: then no others are made where only the nearest
    is asked for.  ``bench`` has the joints as :func:`walk` has them, where they may be, and room
    for postures and what they are called.
    The posture to which steps from the seed lead is among them, and goes to ``reached`` (n,) where
    it is as near as its self-motion goes, else NaN.  Where only the nearest is asked for, samples
    that are farther from the seed than the first are left out.
    """
    turns, lower, upper, seed, metric, bounded = request
    joints, low, high, q, branch = bench
    rows, names, distances = ranked
    n = seed.shape[0]
    packed = data[at.PARTS : at.PARTS + 13 * (n + 1)].reshape((n + 1, 13))
    locked = np.empty(n)
    placed = np.empty(n)
    count = ZERO
    bare = ZERO
    steps = int(data[at.SAMPLES])
    angle = call_arm_angle(data, seed) if data[at.KIND] == at.ARM_ANGLE else 0.0
    arcs, by_angle = data[at.ARCS] > 0.0, data[at.RIGHT] != 0.0
    tries = 0 if arcs else BESIDE
    distance, settled = _approach_from_seed(packed, T, request, low, high, tries, locked, placed)
    proved = False
    if arcs and (by_angle or metric == LINF or distance < PROOF_OF_SQUARES):
        nearest_so_far = distance
        if by_angle:
            distance, proved = prove_by_angle(data, T, joints, metric, bounded, distance, placed)
        else:
            distance, proved = prove_nearest(data, T, joints, metric, bounded, distance, placed)
        if distance < nearest_so_far and _misses(packed, T, placed):
            for i in range(n):
                locked[i] = placed[i]
            found, _ = approach(packed, T, lower, upper, seed, metric, bounded, locked)
            if found >= distance + NEARER_BY:
                # Beside a singular posture no step leads nearer, but one to the pose itself does.
                for i in range(n):
                    locked[i] = placed[i]
                call_polish(packed, T, locked, POLISH_STEPS)
                if place(turns, lower, upper, seed, bounded, locked, locked):
                    found = distance_from(locked, seed, metric)
            if found < distance + NEARER_BY:
                distance = found
                for i in range(n):
                    placed[i] = locked[i]
    if distance < math.inf:
        name = np.int64(bit.SELF_MOTION | bit.UNNAMED)
        count = insert(placed, name, distance, count, rows, names, distances)
        bare += 1
        if proved and nearest:
            return count, bare, proved
    for i in range(n):
        reached[i] = placed[i] if settled else math.nan
    for _ in range(2):
        for k in range(steps):
            if data[at.KIND] == at.LOCKED:
                away = _choose(data, low, high, seed, k, steps, locked)
                if nearest and count > 0 and away >= distances[0]:
                    continue
            turn = 2.0 * math.pi * ((k + 1) // 2) / steps * (1.0 if k % 2 == 1 else -1.0)
            total = _sample(data, T, seed, angle, locked, turn, (q, branch))
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


@kernel(i8(IN1, IN3, IN1, i8, b1, b1, OUT3, IOUT1, OUT1, IOUT1))
def solve_redundant(arm, T, seed, metric, bounded, nearest, ranked, names, distances, counts):
    """Solve the poses T (m, 4, 4) one after another, for samples of the redundancy parameter.

    ``arm`` is as :func:`.inverse.solutions.solve` has it.  The solutions inside the limits (all
    where not ``bounded``) go to ``ranked`` (m, room, n),
    nearest to the seed first and NaN after the last; the first few are moved along their
    self-motion until they are as near as that goes.  Samples farther than the first are left out
    where only ``nearest`` is asked for.  ``counts`` (m,) gets their number, or NONE_EXISTS where
    no sample has a posture even outside the limits.  ``names`` and ``distances`` (room,) are those
    of the last pose.
    """
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
