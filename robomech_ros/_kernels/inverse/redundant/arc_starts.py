"""A posture near the seed on some arc of a self-motion, and the way down along an arc.

It begins at the seed's value of the parameter; where nothing near is there, steps from the seed
look for another, and where these lead nowhere near, the middles of intervals all around.
"""

import math

from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import flat, lean, scratch
from robomech_ros._kernels.inverse.polishing import largest_error, pose_difference
from robomech_ros._kernels.inverse.ranking import LINF, distance_from, place
from robomech_ros._kernels.inverse.redundant.arc_layout import FOLD, LEVEL, RATE, REGULAR
from robomech_ros._kernels.inverse.redundant.arc_shoulder import enter_first, first_joints
from robomech_ros._kernels.inverse.redundant.arcs import bend_elbow, last_joints, start_level
from robomech_ros._kernels.inverse.redundant.narrowing import (
    NEARER_BY,
    enclose,
    is_beyond,
    narrow_joints,
    whole,
)
from robomech_ros._kernels.inverse.redundant.nearest import approach, best_step

__all__ = [
    "begin_anywhere",
    "begin_near",
    "first_intervals",
    "improve",
    "is_near",
    "take",
    "turn_round",
]

# Length of the first intervals (rad).
BEGIN_LENGTH = 0.4
# Where the nearest posture at the seed's value of the parameter is no nearer than NEAR (rad), steps
# from the seed look for another, if the error of the pose (rad or m) there is no larger than
# STEPPED; and where that is no nearer than PROBED, those in the middles of all intervals are looked
# at, too: much is excluded by a near one.  By the root of squares both are SCALE times as far.
BEGIN_NEAR = 0.5
BEGIN_STEPPED = 1.3
BEGIN_PROBED = 0.8
BEGIN_SCALE = 1.8
# Steps along an arc from a posture that is nearer than any before, the longest and the shortest
# (rad), and the one that is the last: the next would be about its square.
DOWN_STEPS = 14
DOWN_LONGEST = 0.3
DOWN_SHORTEST = 1e-9
DOWN_SETTLED = 1e-6

_ALL = 255
_TURN = 2.0 * math.pi


@lean
def turn_round(backwards, q, out, sign):
    """Write joint values of the inverse motion (of limits the other ones), or the same."""
    for i in range(7):
        out[i] = sign * q[6 - i] if backwards else q[i]


@lean
def first_intervals(box, start, waiting):
    """Write the first intervals, that about the ``start`` last; return how many."""
    low, high = box[6], box[13]
    if high - low >= _TURN:
        low, high = start - math.pi, start + math.pi
    half = 0.5 * BEGIN_LENGTH
    before = max(0, math.ceil((start - half - low) / BEGIN_LENGTH))
    after = max(0, math.ceil((high - start - half) / BEGIN_LENGTH))
    for k in range(before + after):
        pieces = k - before if k < before else before + after - k
        waiting[k, 0] = start + pieces * BEGIN_LENGTH
    waiting[before + after, 0] = start
    for k in range(before + after + 1):
        waiting[k, 1], waiting[k, 2] = half, _ALL
    return before + after + 1


@lean
def _posture(arm, pose, t, k, flip, box, arc):
    """Write the posture of an arc at t, and its rates; False where it has none."""
    level, fold, first = scratch(LEVEL), scratch(FOLD), scratch(2, 3)
    if not start_level(arm, pose, t, 0.0, level):
        return False
    bend_elbow(arm, pose, level, 0.0, 1.0 - 2.0 * (k & 1), fold, arc)
    status = last_joints(arm, pose, level, t, 0.0, 1.0 - (k & 2), fold, box, arc)
    if status != REGULAR or not first_joints(arm, pose, status, 0.0, arc, first):
        return False
    return enter_first(arm, status, 0.0, first[flip], box, arc) == REGULAR


@flat
def take(request, arc, distance, nearest):
    """Keep the posture of an arc if it is inside the limits and nearer; return the distance."""
    turns, lower, upper, seed, metric, bounded = request
    placed = scratch(7)
    if not place(turns, lower, upper, seed, bounded, arc[:7], placed):
        return distance
    here = distance_from(placed, seed, metric)
    if not here < distance:
        return distance
    for i in range(7):
        nearest[i] = placed[i]
    return here


@lean
def improve(bench, request, k, flip, distance):
    """Go down along an arc from the nearest posture known, one of its; return the distance."""
    arm, pose, _, _, arc, _, _, _, _, _, _, nearest, _ = bench
    step, anywhere = 0.0, scratch(14)
    for i in range(7):
        anywhere[i], anywhere[7 + i] = -math.inf, math.inf
    for i in range(DOWN_STEPS):
        here = math.inf
        if _posture(arm, pose, nearest[6] + step, k, flip, anywhere, arc):
            here = take(request, arc, distance, nearest) if i > 0 else -1.0
        if here < distance:
            distance = here if i > 0 else distance
            settled = 0.0 < abs(step) < DOWN_SETTLED
            step = best_step(request, nearest, arc[RATE : RATE + 7], DOWN_LONGEST)
        else:
            settled = False
            step *= 0.25
        if settled or abs(step) < DOWN_SHORTEST:
            break
    return distance


@lean
def is_near(distance, limit, metric):
    """Tell whether a distance is below a limit, of the largest move of a joint."""
    return distance < (limit if metric == LINF else BEGIN_SCALE * limit)


@lean
def _probe(bench, request, t, spot, distance):
    """Look at the postures at t; return the least distance, and write to ``spot`` whose it is."""
    arm, pose, level, arc, _, first, fold, box, sides, _, _, nearest, _ = bench
    if not start_level(arm, pose, t, 0.0, level):
        return distance
    for branch in range(4):
        k = branch // 2 + 2 * (branch % 2)
        if branch % 2 == 0:
            bend_elbow(arm, pose, level, 0.0, 1.0 - branch, fold, arc)
        if is_beyond(3, arc, box):
            continue
        status = last_joints(arm, pose, level, t, 0.0, 1.0 - (k & 2), fold, box, arc)
        whole(0.0, sides)
        if status != REGULAR or not narrow_joints(3, 6, arc, True, 0.0, box, sides):
            continue
        if not first_joints(arm, pose, status, 0.0, arc, first):
            continue
        for flip in range(2):
            if enter_first(arm, status, 0.0, first[flip], box, arc) == REGULAR:
                here = take(request, arc, distance, nearest)
                if here < distance:
                    distance, spot[0], spot[1] = here, k, flip
                    enclose(request, distance - NEARER_BY, box)
    return distance


@lean
def begin_near(bench, request, spot, steps):
    """Find a posture near the seed: at its value of the parameter, or by steps from the seed.

    ``steps`` has what :func:`approach` needs, in the order of the arm.  Returns the distance.
    """
    box, nearest = bench[7], bench[11]
    enclose(request, math.inf, box)
    distance = _probe(bench, request, request[3][6], spot, math.inf)
    if is_near(distance, BEGIN_PROBED, request[4]):
        distance = improve(bench, request, int(spot[0]), int(spot[1]), distance)
        spot[0] = -1.0
    if is_near(distance, BEGIN_NEAR, request[4]):
        return distance
    packed, T, lower, upper, seed, backwards, q, current, e = steps
    forward_body(packed, seed, current)
    pose_difference(T, current, e)
    if largest_error(e) > BEGIN_STEPPED:
        return distance
    for i in range(7):
        q[i] = seed[i]
    found, _ = approach(packed, T, lower, upper, seed, request[4], request[5], q)
    if found < distance:
        distance, spot[0] = found, -1.0
        turn_round(backwards, q, nearest, -1.0)
    return distance


@lean
def begin_anywhere(bench, request, spot, waiting, distance):
    """Find a near posture among those in the middles of all intervals, if none is known."""
    if is_near(distance, BEGIN_PROBED, request[4]):
        return distance
    box = bench[7]
    for k in range(first_intervals(box, request[3][6], waiting) - 1):
        distance = _probe(bench, request, waiting[k, 0], spot, distance)
    if spot[0] >= 0.0:
        distance = improve(bench, request, int(spot[0]), int(spot[1]), distance)
    return distance
