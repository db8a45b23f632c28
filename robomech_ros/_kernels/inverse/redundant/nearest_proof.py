"""The nearest posture of all arcs of a self-motion, with a proof that there is no nearer one.

Intervals of the parameter are halved until it is sure of each arc that no posture of it is inside
the limits and nearer to the seed than the nearest one known, or until they are too short.  The
rates of the joints along an arc, and by how much they can change in an interval, leave but a part
of it in which a joint may be near enough; where that of one joint ends before that of another
begins, nothing is left.
"""

import math

from numba import types

from robomech_ros._kernels.compiling.jit import (
    IN1,
    IN2,
    OUT1,
    b1,
    f8,
    flat,
    i8,
    lean,
    part,
    scratch,
)
from robomech_ros._kernels.inverse.ranking import LINF
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arc_bends import bend_arc
from robomech_ros._kernels.inverse.redundant.arc_layout import (
    ARC,
    BEYOND,
    BEYOND_BOW,
    BEYOND_RATE,
    EMPTY,
    FAR_OFF,
    FAR_OFF_BOW,
    FAR_OFF_RATE,
    FOLD,
    LEVEL,
    POSE,
    REGULAR,
    UNKNOWN,
)
from robomech_ros._kernels.inverse.redundant.arc_shoulder import enter_first, first_joints
from robomech_ros._kernels.inverse.redundant.arc_starts import (
    BEGIN_LENGTH,
    begin_anywhere,
    begin_near,
    first_intervals,
    improve,
    take,
    turn_round,
)
from robomech_ros._kernels.inverse.redundant.arcs import (
    bend_elbow,
    last_joints,
    prepare,
    start_level,
)
from robomech_ros._kernels.inverse.redundant.narrowing import (
    NEARER_BY,
    enclose,
    is_beyond,
    narrow_bent_squares,
    narrow_joints,
    narrow_squares,
    narrow_to,
    whole,
)

__all__ = ["prove_nearest"]

# Intervals shorter than this (rad) are not halved any more.
PROOF_SHORTEST = 1e-9
# Half the length from which on the shoulder is not looked at where joints 4 to 6 have no rates.
PROOF_VAGUE = 0.01
# Half the length from which on second derivatives, which change too much in there, do not help.
PROOF_BENT = 0.15
# Intervals that are looked at, and that wait, at most.
PROOF_INTERVALS = 600
PROOF_WAITING = 128

_BOTH_SIDES = 0b110011
_TURN = 2.0 * math.pi


@flat
def _push(t, left, masks, waiting, count):
    """Put what is left of both sides of an interval with middle t on the pile."""
    for k in range(2):
        first, last = left[2 * k], left[2 * k + 1]
        if masks[k] > 0.0 and first <= last:
            middle = 0.5 * (first + last)
            waiting[count, 0] = t + middle if k == 0 else t - middle
            waiting[count, 1], waiting[count, 2] = 0.5 * (last - first), masks[k]
            count += 1
    return count


@flat
def _keep(sides, bit, left, masks):
    """Add what is left of one arc to what is left of all."""
    for k in range(2):
        if sides[2 * k] <= sides[2 * k + 1]:
            masks[k] += bit
            left[2 * k] = min(left[2 * k], sides[2 * k])
            left[2 * k + 1] = max(left[2 * k + 1], sides[2 * k + 1])


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


@flat
def _examine_shoulder(bench, request, status, h, k, mask, distance):
    """Leave of an interval what the postures of the shoulder leave of two arcs.

    Returns the least distance from the seed, of postures in its middle, too.
    """
    arm, pose, level, arc, _, first, fold, box, sides, left, masks, nearest, own = bench
    _, _, _, seed, metric, _ = request
    two = first_joints(arm, pose, status, h, arc, first)
    for flip in range(2):
        if not mask >> 2 * k + flip & 1:
            continue
        kind = enter_first(arm, status, h, first[flip], box, arc) if two else UNKNOWN
        if kind == EMPTY:
            continue
        regular = kind == REGULAR
        if regular:
            here = take(request, arc, distance, nearest)
            if here < distance:
                distance = improve(bench, request, k, flip, here)
                enclose(request, distance - NEARER_BY, box)
        _copy_sides(own, sides)
        if not narrow_joints(3, 6, arc, status == REGULAR, h, box, sides):
            continue
        if two and not narrow_joints(0, 3, arc, regular, h, box, sides):
            continue
        if two and metric != LINF:
            within = distance - NEARER_BY
            if not narrow_squares(0, arc, regular, h, seed, within, box, sides):
                continue
            if regular and h < PROOF_BENT:
                bend_arc(arm, pose, level, h, fold, arc)
                if not narrow_bent_squares(arc, h, seed, within, box, sides):
                    continue
        _keep(sides, float(1 << 2 * k + flip), left, masks)
    return distance


@lean
def _examine(bench, request, t, h, mask, distance):
    """Leave of an interval, half of it h long, what no arc of the mask excludes.

    Returns the least distance from the seed, of postures in its middle, too.
    """
    arm, pose, level, arc, _, _, fold, box, sides, left, masks, _, own = bench
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
            bend_elbow(arm, pose, level, h, 1.0 - branch, fold, arc)
            if not _narrow_existing(level, fold, h, own) or is_beyond(3, arc, box):
                mask &= ~(_BOTH_SIDES << branch)
            elif max(0.0, own[1] - own[0]) + max(0.0, own[3] - own[2]) < h:
                _keep(own, float(mask & _BOTH_SIDES << branch), left, masks)
                mask &= ~(_BOTH_SIDES << branch)
        if not mask >> 2 * k & 3:
            continue
        status = last_joints(arm, pose, level, t, h, 1.0 - (k & 2), fold, box, arc)
        if status == EMPTY:
            continue
        _copy_sides(own, sides)
        if not narrow_joints(3, 6, arc, status == REGULAR, h, box, sides):
            continue
        if metric != LINF:
            within = distance - NEARER_BY
            if not narrow_squares(3, arc, status == REGULAR, h, seed, within, box, sides):
                continue
        if status != REGULAR and h > PROOF_VAGUE:
            _keep(sides, float(mask & 3 << 2 * k), left, masks)
        else:
            distance = _examine_shoulder(bench, request, status, h, k, mask, distance)
    return distance


@flat
def _narrow_existing(level, fold, h, own):
    """Write the part of an interval in which both arcs with one bend may be; False where none."""
    whole(h, own)
    if fold[BEYOND_BOW] < 0.0:
        return False
    narrow_to(level[FAR_OFF], level[FAR_OFF_RATE], level[FAR_OFF_BOW], own)
    if fold[BEYOND_BOW] < math.inf:
        narrow_to(fold[BEYOND], fold[BEYOND_RATE], fold[BEYOND_BOW], own)
    return own[0] <= own[1] or own[2] <= own[3]


@flat
def _copy_sides(own, sides):
    for i in range(4):
        sides[i] = own[i]


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
    start = bench[11][6] if distance < math.inf else request[3][6]
    if request[4] != LINF:
        # However often an interval is halved, the nearest posture known is not at an end of one.
        start += BEGIN_LENGTH / 6.0
    count, doubts, known = first_intervals(box, start, waiting), 0, distance
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


@part(types.Tuple((f8, b1))(IN1, IN2, IN2, i8, b1, OUT1))
def prove_nearest(data, T, joints, metric, bounded, best):
    """Find the nearest posture of the pose T (4, 4), and tell whether it is proved to be that.

    ``joints`` (4, 7) holds whether joints turn, lower and upper limits, which hold where
    ``bounded``, and the seed.  Returns the distance by the ``metric`` of the posture that is in
    ``best`` (7,) then, infinite where there is none, and whether no other is nearer by more than
    NEARER_BY.
    """
    parts = data[int(data[at.ARCS]) :]
    arm = parts[: at.ARC_SHOULDER].reshape((8, 13)), parts
    backwards = parts[at.ARC_BACKWARDS] != 0.0
    own, target, nearest = scratch(4, 7), scratch(4, 4), scratch(7)
    turn_round(backwards, joints[0], own[0], 1.0)
    turn_round(backwards, joints[1], own[2 if backwards else 1], -1.0)
    turn_round(backwards, joints[2], own[1 if backwards else 2], -1.0)
    turn_round(backwards, joints[3], own[3], -1.0)
    for i in range(0 if bounded else 7):
        # Else windings inside the limits would stand for nearer ones outside.
        own[1, i], own[2, i] = -math.inf, math.inf
    request = own[0], own[1], own[2], own[3], metric, bounded
    pose, level, arc, other = scratch(POSE), scratch(LEVEL), scratch(ARC), scratch(ARC)
    first, fold, box = scratch(2, 3), scratch(FOLD), scratch(14)
    sides, left, masks = scratch(4), scratch(4), scratch(2)
    bench = arm, pose, level, arc, other, first, fold, box, sides, left, masks, nearest, scratch(4)
    _target_of(backwards, T, target)
    prepare(arm, target, pose)
    waiting, doubted = scratch(PROOF_WAITING, 3), scratch(PROOF_WAITING, 3)
    spot, q, current, e = scratch(2), scratch(7), scratch(4, 4), scratch(6)
    packed = data[at.PARTS : at.PARTS + 8 * 13].reshape((8, 13))
    steps = packed, T, joints[1], joints[2], joints[3], backwards, q, current, e
    distance = begin_near(bench, request, spot, steps)
    distance = begin_anywhere(bench, request, spot, waiting, distance)
    distance, proved = _search(bench, request, waiting, doubted, distance)
    turn_round(backwards, nearest, best, -1.0)
    return distance, proved
