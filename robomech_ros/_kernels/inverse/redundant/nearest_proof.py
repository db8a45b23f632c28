"""The nearest posture of all arcs of a self-motion, with a proof that there is no nearer one.

Intervals of the parameter are halved until it is sure of each arc that no posture of it is inside
the limits and nearer to the seed than the nearest one known, or until they are too short.  The
rates of the joints along an arc, and by how much they can change in an interval, leave but a part
of it in which a joint may be near enough; where that of one joint ends before that of another
begins, nothing is left.
"""

import math

from numba import types

from robomech_ros._kernels.compiling.jit import IN1, IN2, OUT1, b1, f8, i8, lean, part, scratch
from robomech_ros._kernels.inverse.ranking import LINF, distance_from, place
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arc_layout import (
    ARC,
    EMPTY,
    FOLD,
    LEVEL,
    POSE,
    RATE,
    REGULAR,
    UNKNOWN,
    Q,
)
from robomech_ros._kernels.inverse.redundant.arc_shoulder import enter_first, first_joints
from robomech_ros._kernels.inverse.redundant.arcs import (
    bend_elbow,
    last_joints,
    prepare,
    start_level,
)
from robomech_ros._kernels.inverse.redundant.narrowing import (
    enclose,
    is_beyond,
    narrow_joints,
    narrow_squares,
    whole,
)
from robomech_ros._kernels.inverse.redundant.nearest import best_step

__all__ = ["NEARER_BY", "prove_nearest"]

# What is proved is that no posture is nearer by more than this (rad).
NEARER_BY = 1e-6
# Length of the first intervals (rad), and of those that are not halved any more.
PROOF_LENGTH = 0.4
PROOF_SHORTEST = 1e-9
# Half the length from which on the shoulder is not looked at where joints 4 to 6 have no rates.
PROOF_VAGUE = 0.01
# While the nearest posture known is no nearer than this (rad), the middles of all intervals are
# looked at first: much is excluded by a near one.
PROOF_PROBED = 0.8
# Steps along an arc from a posture that is nearer than any before.
PROOF_STEPS = 12
# Intervals that are looked at, and that wait, at most.
PROOF_INTERVALS = 600
PROOF_WAITING = 128

_ALL = 255
_BOTH_SIDES = 0b110011
_TURN = 2.0 * math.pi


@lean
def _turn_round(backwards, q, out, sign):
    """Write joint values of the inverse motion (of limits the other ones), or the same."""
    for i in range(7):
        out[i] = sign * q[6 - i] if backwards else q[i]


@lean
def _begin(box, seed, waiting):
    """Write the first intervals, that of the seed last; return how many."""
    low, high = box[6], box[13]
    if high - low >= _TURN:
        low, high = seed[6] - math.pi, seed[6] + math.pi
    pieces = int((high - low) / PROOF_LENGTH) + 1
    half = 0.5 * (high - low) / pieces
    for k in range(pieces):
        t = low + (2 * k + 1) * half
        row = k
        while row > 0 and abs(waiting[row - 1, 0] - seed[6]) < abs(t - seed[6]):
            waiting[row, 0] = waiting[row - 1, 0]
            row -= 1
        waiting[row, 0] = t
    for k in range(pieces):
        waiting[k, 1], waiting[k, 2] = half, _ALL
    return pieces


@lean
def _push(t, sides, masks, waiting, count):
    """Put what is left of both sides of an interval with middle t on the pile."""
    for k in range(2):
        first, last = sides[2 * k], sides[2 * k + 1]
        if masks[k] > 0.0 and first <= last:
            middle = 0.5 * (first + last)
            waiting[count, 0] = t + middle if k == 0 else t - middle
            waiting[count, 1], waiting[count, 2] = 0.5 * (last - first), masks[k]
            count += 1
    return count


@lean
def _keep(sides, bit, left, masks):
    """Add what is left of one arc to what is left of all."""
    for k in range(2):
        if sides[2 * k] <= sides[2 * k + 1]:
            masks[k] += bit
            left[2 * k] = min(left[2 * k], sides[2 * k])
            left[2 * k + 1] = max(left[2 * k + 1], sides[2 * k + 1])


@lean
def _posture(arm, pose, t, k, flip, arc):
    """Write the posture of an arc at t, and its rates; False where it has none."""
    level, fold, first = scratch(LEVEL), scratch(FOLD), scratch(2, 3)
    if not start_level(arm, pose, t, 0.0, level):
        return False
    bend_elbow(arm, level, 0.0, 1.0 - 2.0 * (k & 1), fold, arc)
    status = last_joints(arm, pose, level, t, 0.0, 1.0 - (k & 2), fold, arc)
    if status != REGULAR or not first_joints(arm, pose, status, 0.0, arc, first):
        return False
    return enter_first(arm, status, 0.0, first[flip], arc) == REGULAR


@lean
def _is_nearer(request, arc, distance):
    """Tell whether the posture of an arc is inside the limits and nearer than ``distance``."""
    turns, lower, upper, seed, metric, bounded = request
    placed = scratch(7)
    if not place(turns, lower, upper, seed, bounded, arc[:7], placed):
        return False
    return distance_from(placed, seed, metric) < distance


@lean
def _improve(bench, request, k, flip, longest, distance):
    """Go down along an arc from a posture that is nearer than ``distance``; return the least one.

    The posture is where the bench has the other arc, which is overwritten; that with the least
    distance becomes the nearest posture known.
    """
    arm, pose, _, _, arc, _, _, _, _, _, _, nearest = bench
    turns, lower, upper, seed, metric, bounded = request
    placed = scratch(7)
    t, step = arc[Q + 6], 0.0
    for _ in range(PROOF_STEPS):
        nearer = False
        if place(turns, lower, upper, seed, bounded, arc[:7], placed):
            here = distance_from(placed, seed, metric)
            nearer = here < distance
        if nearer:
            distance = here
            for i in range(7):
                nearest[i] = placed[i]
            t = arc[Q + 6]
            step = best_step(request, placed, arc[RATE : RATE + 7], longest)
        else:
            step *= 0.25
        if abs(step) < PROOF_SHORTEST or not _posture(arm, pose, t + step, k, flip, arc):
            break
    return distance


@lean
def _target_of(backwards, T, target):
    """Write the pose, or its inverse."""
    for i in range(4):
        for j in range(4):
            target[i, j] = T[i, j]
    if backwards:
        for i in range(3):
            target[i, 3] = 0.0
            for j in range(3):
                target[i, j] = T[j, i]
                target[i, 3] -= T[j, i] * T[j, 3]


@lean
def _examine_shoulder(bench, request, status, h, k, mask, distance):
    """Leave of an interval what the postures of the shoulder leave of two arcs.

    Returns the least distance from the seed, of postures in its middle, too.
    """
    arm, pose, _, arc, other, first, _, box, sides, left, masks, _ = bench
    _, _, _, seed, metric, _ = request
    two = first_joints(arm, pose, status, h, arc, first)
    for flip in range(2):
        if not mask >> 2 * k + flip & 1:
            continue
        kind = enter_first(arm, status, h, first[flip], arc) if two else UNKNOWN
        regular = kind == REGULAR
        if regular and _is_nearer(request, arc, distance):
            for i in range(ARC):
                other[i] = arc[i]
            distance = _improve(bench, request, k, flip, h, distance)
            enclose(request, distance - NEARER_BY, box)
        whole(h, sides)
        if not narrow_joints(3, 6, arc, status == REGULAR, box, sides):
            continue
        if two and not narrow_joints(0, 3, arc, regular, box, sides):
            continue
        if two and metric != LINF:
            if not narrow_squares(0, arc, regular, seed, distance - NEARER_BY, box, sides):
                continue
        _keep(sides, float(1 << 2 * k + flip), left, masks)
    return distance


@lean
def _examine(bench, request, t, h, mask, distance):
    """Leave of an interval, half of it h long, what no arc of the mask excludes.

    Returns the least distance from the seed, of postures in its middle, too.
    """
    arm, pose, level, arc, _, _, fold, box, sides, left, masks, _ = bench
    _, _, _, seed, metric, _ = request
    left[0] = left[2] = math.inf
    left[1] = left[3] = -math.inf
    masks[0] = masks[1] = 0.0
    if not start_level(arm, pose, t, h, level):
        return distance
    for branch in range(4):
        # Both arcs with one bend of the elbow, then both with the other.
        k = branch // 2 + 2 * (branch % 2)
        if branch % 2 == 0 and mask >> branch & _BOTH_SIDES:
            bend_elbow(arm, level, h, 1.0 - branch, fold, arc)
        if not mask >> 2 * k & 3 or is_beyond(3, arc, box):
            continue
        status = last_joints(arm, pose, level, t, h, 1.0 - (k & 2), fold, arc)
        if status == EMPTY:
            continue
        whole(h, sides)
        if not narrow_joints(3, 6, arc, status == REGULAR, box, sides):
            continue
        if metric != LINF:
            within = distance - NEARER_BY
            if not narrow_squares(3, arc, status == REGULAR, seed, within, box, sides):
                continue
        if status != REGULAR and h > PROOF_VAGUE:
            _keep(sides, float(mask & 3 << 2 * k), left, masks)
        else:
            distance = _examine_shoulder(bench, request, status, h, k, mask, distance)
    return distance


@lean
def _probe(bench, request, t, h, distance):
    """Go down along the arcs of which the posture at t is nearer; return the least distance."""
    arm, pose, level, arc, other, first, fold, box, sides, _, _, _ = bench
    if not start_level(arm, pose, t, 0.0, level):
        return distance
    for branch in range(4):
        k = branch // 2 + 2 * (branch % 2)
        if branch % 2 == 0:
            bend_elbow(arm, level, 0.0, 1.0 - branch, fold, arc)
        if is_beyond(3, arc, box):
            continue
        status = last_joints(arm, pose, level, t, 0.0, 1.0 - (k & 2), fold, arc)
        whole(0.0, sides)
        if status != REGULAR or not narrow_joints(3, 6, arc, True, box, sides):
            continue
        if not first_joints(arm, pose, status, 0.0, arc, first):
            continue
        for flip in range(2):
            kind = enter_first(arm, status, 0.0, first[flip], arc)
            if kind != REGULAR or not _is_nearer(request, arc, distance):
                continue
            for i in range(ARC):
                other[i] = arc[i]
            distance = _improve(bench, request, k, flip, h, distance)
            enclose(request, distance - NEARER_BY, box)
    return distance


@lean
def _copied(rows, count, out):
    for k in range(count):
        for i in range(3):
            out[k, i] = rows[k, i]
    return count


@lean
def _search(bench, request, waiting, doubted, distance):
    """Halve intervals until nothing is left; return the least distance and whether it is proved."""
    box, left, masks = bench[7], bench[9], bench[10]
    if not enclose(request, distance - NEARER_BY, box):
        return distance, True
    count, doubts, known = _begin(box, request[3], waiting), 0, distance
    for k in range(count - 1, -1, -1):
        if distance > PROOF_PROBED:
            distance = _probe(bench, request, waiting[k, 0], waiting[k, 1], distance)
    for _ in range(PROOF_INTERVALS):
        if count == 0 and distance < known:
            # What was in doubt may be too far away by now.
            count, doubts, known = _copied(doubted, doubts, waiting), 0, distance
        if count == 0:
            return distance, doubts == 0
        count -= 1
        t, h, mask = waiting[count, 0], waiting[count, 1], int(waiting[count, 2])
        if box[13] - box[6] < _TURN:
            low, high = max(t - h, box[6]), min(t + h, box[13])
            if low > high:
                continue
            t, h = 0.5 * (low + high), 0.5 * (high - low)
        distance = _examine(bench, request, t, h, mask, distance)
        if masks[0] + masks[1] == 0.0:
            continue
        if max(count, doubts) + 2 > PROOF_WAITING:
            break
        if h < PROOF_SHORTEST:
            doubted[doubts, 0], doubted[doubts, 1], doubted[doubts, 2] = t, h, float(mask)
            doubts += 1
        else:
            count = _push(t, left, masks, waiting, count)
    return distance, False


@part(types.Tuple((f8, b1))(IN1, IN2, IN2, i8, b1, f8, OUT1))
def prove_nearest(data, T, joints, metric, bounded, distance, best):
    """Find the nearest posture of the pose T (4, 4), and tell whether it is proved to be that.

    ``joints`` (4, 7) holds whether joints turn, lower and upper limits, which hold where
    ``bounded``, and the seed; ``best`` (7,) the nearest posture known, at this ``distance`` from
    the seed by the ``metric``, which is infinite where there is none.  Returns the
    distance of the posture that is in ``best`` then, and whether no other is nearer by more than
    NEARER_BY.
    """
    arm = data[int(data[at.ARCS]) :]
    backwards = arm[at.ARC_BACKWARDS] != 0.0
    own, target, nearest = scratch(4, 7), scratch(4, 4), scratch(7)
    _turn_round(backwards, joints[0], own[0], 1.0)
    _turn_round(backwards, joints[1], own[2 if backwards else 1], -1.0)
    _turn_round(backwards, joints[2], own[1 if backwards else 2], -1.0)
    _turn_round(backwards, joints[3], own[3], -1.0)
    _turn_round(backwards, best, nearest, -1.0)
    for i in range(0 if bounded else 7):
        # Else windings inside the limits would stand for nearer ones outside.
        own[1, i], own[2, i] = -math.inf, math.inf
    request = own[0], own[1], own[2], own[3], metric, bounded
    pose, level, arc, other = scratch(POSE), scratch(LEVEL), scratch(ARC), scratch(ARC)
    first, fold, box = scratch(2, 3), scratch(FOLD), scratch(14)
    sides, left, masks = scratch(4), scratch(4), scratch(2)
    bench = arm, pose, level, arc, other, first, fold, box, sides, left, masks, nearest
    _target_of(backwards, T, target)
    prepare(arm, target, pose)
    waiting, doubted = scratch(PROOF_WAITING, 3), scratch(PROOF_WAITING, 3)
    distance, proved = _search(bench, request, waiting, doubted, distance)
    _turn_round(backwards, nearest, best, -1.0)
    return distance, proved
