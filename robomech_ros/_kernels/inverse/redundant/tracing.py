"""Tracing of self-motions of seven joints from many postures, for the one nearest to a seed.

From each start the curve is followed in both directions by steps of the joints, up to BEYOND times
the distance of the nearest known posture from the seed.  Between two steps it is a cubic to about
1e-3 rad; minima of the distance that are small enough are computed exactly.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import flat, lean, part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, b1, f8, i8
from robomech_ros._kernels.inverse.ranking import LINF, distance_from, nearest_winding
from robomech_ros._kernels.inverse.redundant.crossings import (
    CROSSING,
    enter_crossing,
    passes_crossing,
    weakest_direction,
)
from robomech_ros._kernels.inverse.redundant.nearest import best_step, minimax
from robomech_ros._kernels.inverse.redundant.settling import (
    SETTLE_STEP,
    TRACE_ERROR,
    copy,
    settle,
    step_onto,
)

# Largest distance of starts and traces from the seed, over that of the nearest known posture.
BEYOND = 4.0
# No trace starts if a known posture is nearer than this (rad or m): largest joint, Euclidean norm.
SMALL, SMALL_ROOT = 0.125, 0.25
# Length of a step (of the joint that moves most, rad or m), the shortest, and their largest number
# on each side.  A step is shortened if the direction turns by more than TRACE_BENT.
TRACE_STEP = 0.25
TRACE_SHORTEST = 1e-3
TRACE_STEPS = 500
TRACE_BENT = 0.3
# Largest number of stored steps.  A posture within NEAR of them (rad or m) is on a traced curve.
# A curve is closed if it returns to its first CLOSING after at least twice that.
TRACES = 2048
TRACE_NEAR = 0.02
# A posture within TRACE_ON is certainly on the curve.  Near singular postures two branches may be
# close; their distance exceeds APART times the smallest singular value.
TRACE_ON = 2e-4
APART = 4.0
CLOSING = 0.5
# A step is divided into PARTS straight parts.  The curve may be nearer than these by OFF, and they
# may be beyond limits by OUTSIDE; a posture within AGAIN of the nearest known one leads to it (rad
# or m).  The curve is at most CHORD times as long as its chord.
TRACE_PARTS = 8
TRACE_OFF = 5e-3
TRACE_OUTSIDE = 2e-3
TRACE_AGAIN = 3e-3
CHORD = 1.3
# Largest number of queued starts at crossings.
QUEUED = 64
# A posture is a minimum if the tangent leads nearer by less than this (rad or m).
NEARER_BY = 1e-7


@lean
def small_distance(metric):
    """Return the distance from the seed (rad or m) below which a self-motion is nearly a line."""
    return SMALL if metric == LINF else SMALL_ROOT


@lean
def _on_cubic(ends, length, s, q):
    """Write the posture (7,) at the fraction s of the cubic between two postures.

    ``ends`` (4, 7) holds the first posture, the direction there, and those of the second.
    """
    a, b = s * s * (3.0 - 2.0 * s), length * s * (1.0 - s)
    for i in range(7):
        bow = ends[1, i] * (1.0 - s) - ends[3, i] * s
        q[i] = ends[0, i] + a * (ends[2, i] - ends[0, i]) + b * bow


@lean
def _chord(ends):
    """Return the largest move of a joint between two postures."""
    length = 0.0
    for i in range(7):
        length = max(length, abs(ends[2, i] - ends[0, i]))
    return length


@lean
def _least_between(request, p, move):
    """Return the fraction of a ``move`` (7,) from p (7,) to its nearest point, NaN if outside."""
    _, lower, upper, seed, metric, bounded = request
    low, high = 0.0, 1.0
    for i in range(7):
        if bounded:
            first, last = lower[i] - TRACE_OUTSIDE - p[i], upper[i] + TRACE_OUTSIDE - p[i]
            if move[i] != 0.0:
                one, other = first / move[i], last / move[i]
                low, high = max(low, min(one, other)), min(high, max(one, other))
            elif first > 0.0 or last < 0.0:
                return math.nan
    if low > high:
        return math.nan
    if metric == LINF:
        return minimax(p, seed, move, low, high)
    along = squares = 0.0
    for i in range(7):
        along += (seed[i] - p[i]) * move[i]
        squares += move[i] * move[i]
    return min(max(along / squares, low), high) if squares > 0.0 else low


@lean
def _nearest_in_parts(request, ends, least, found):
    """Write the nearest posture in each part of a step to ``found`` (parts, 7).

    Their distances go to ``least`` (parts,), infinite for parts outside the limits.
    """
    _, _, _, seed, metric, _ = request
    p, move, here = scratch(7), scratch(7), scratch(7)
    length = _chord(ends)
    copy(ends[0], p)
    for k in range(TRACE_PARTS):
        _on_cubic(ends, length, (k + 1) / TRACE_PARTS, here)
        for i in range(7):
            move[i] = here[i] - p[i]
        s = _least_between(request, p, move)
        least[k] = math.inf
        if s == s:
            for i in range(7):
                found[k, i] = p[i] + s * move[i]
            least[k] = distance_from(found[k], seed, metric)
        copy(here, p)


@lean
def _distance_from_known(known, count, q):
    """Return the distance of a posture from the traced steps (rad or m), at most TRACE_NEAR."""
    p = scratch(7)
    least = TRACE_NEAR
    for k in range(count):
        ends = known[k]
        length = _chord(ends)
        along = squares = 0.0
        far = False
        for i in range(7):
            move = ends[2, i] - ends[0, i]
            off = q[i] - ends[0, i]
            far = far or abs(off) > length + least
            along += off * move
            squares += move * move
        if far:
            continue
        s = min(max(along / squares, 0.0), 1.0)
        _on_cubic(ends, length, s, p)
        off = 0.0
        for i in range(7):
            off = max(off, abs(q[i] - p[i]))
        least = min(least, off)
        if least < TRACE_ON:
            break
    return least


@lean
def _settled(packed, T, request, space, found, g, distance, best):
    """Settle ``found`` (7,), with self-motion along g (7,), and copy it to ``best`` if nearer.

    Returns the least distance, that of ``best`` (7,).
    """
    along = scratch(7)
    copy(g, along)
    settled = settle(packed, T, request, space, along, found)
    if settled < distance:
        copy(found, best)
    return min(settled, distance)


@lean
def _improve(packed, T, request, space, q, g, distance, best):
    """Settle a posture q (7,) that is as near as the ``best`` one unless it is a minimum."""
    _, _, _, seed, metric, _ = request
    found = scratch(7)
    s = best_step(request, q, g, SETTLE_STEP)
    for i in range(7):
        found[i] = q[i] + s * g[i]
    if distance_from(found, seed, metric) < distance - NEARER_BY:
        distance = _settled(packed, T, request, space, found, g, distance, best)
    return distance


@lean
def _settle_between(packed, T, request, space, ends, distance, best):
    """Settle the postures between two that may be nearer than the ``best`` one (7,).

    Returns the least distance, that of ``best``.
    """
    _, _, _, seed, metric, _ = request
    # Between both ends the curve is nearer by half of its length at most.
    between = distance_from(ends[0], seed, metric) + distance_from(ends[2], seed, metric)
    if between - CHORD * distance_from(ends[0], ends[2], metric) > 2.0 * distance:
        return distance
    least, found = scratch(TRACE_PARTS), scratch(TRACE_PARTS, 7)
    _nearest_in_parts(request, ends, least, found)
    for k in range(TRACE_PARTS):
        lowest = k == 0 or least[k] < least[k - 1]
        lowest = lowest and (k == TRACE_PARTS - 1 or least[k] <= least[k + 1])
        if lowest and least[k] < distance + TRACE_OFF:
            away = 0.0
            for i in range(7):
                away = max(away, abs(found[k, i] - best[i]))
            if away > TRACE_AGAIN:
                distance = _settled(packed, T, request, space, found[k], ends[3], distance, best)
    return distance


@lean
def _advance(packed, T, space, ends, bent, length):
    """Write the posture a step ahead and the direction there to ``ends[2:]``.

    ``bent`` (7,) is half the rate of change of the direction.  Returns the length of the step,
    shorter if the curve bends sharply, zero on failure, and the change of the direction.
    """
    q, g = ends[2], ends[3]
    while True:
        for i in range(7):
            q[i] = ends[0, i] + length * (ends[1, i] + length * bent[i])
            g[i] = ends[1, i]
        lost = step_onto(packed, T, 1.0, space, g, q) > TRACE_ERROR
        turned = 0.0
        for i in range(7):
            turned = max(turned, abs(g[i] - ends[1, i]))
        if not lost and (turned < TRACE_BENT or length < TRACE_SHORTEST):
            return length, turned
        if length < TRACE_SHORTEST:
            return 0.0, turned
        length *= 0.5


@lean
def _rewind(request, ends):
    """Move both postures to the second one's nearest winding; return whether they moved."""
    turns, lower, upper, seed, _, _ = request
    wound, moved = scratch(7), False
    nearest_winding(turns, lower, upper, seed, False, ends[2], wound)
    for i in range(7):
        turn = wound[i] - ends[2, i]
        if abs(turn) > 1.0:
            moved = True
            ends[0, i] += turn
            ends[2, i] += turn
    return moved


@flat
def _begin_trace(packed, T, space, start, known, count, begin, ahead, push, weak):
    """Correct ``start`` (7,) to the pose; return the smallest singular value there.

    Writes that posture, the direction of its self-motion, the motion of the tip ``push`` (6,) and
    the ``weak`` direction (7,).  Returns a negative number on failure or on a ``known`` step.
    """
    copy(start, begin)
    for i in range(7):
        ahead[i] = 0.0
    for i in range(6):
        push[i] = 1.0
    if step_onto(packed, T, 1.0, space, ahead, begin) > TRACE_ERROR:
        return -1.0
    size = weakest_direction(space, push, weak)
    if _distance_from_known(known, count, begin) < min(TRACE_NEAR, APART * size):
        return -1.0
    return size


@flat
def _write_line(ends, q, g):
    """Write a straight step through q (7,) along g (7,), by SMALL_ROOT each way, to ``ends``."""
    for i in range(7):
        ends[0, i], ends[1, i] = q[i] - SMALL_ROOT * g[i], g[i]
        ends[2, i], ends[3, i] = q[i] + SMALL_ROOT * g[i], g[i]


@flat
def _trace_side(packed, T, request, space, origin, size, traced, known, distance, best, queue):
    """Trace one side of an ``origin``: posture, direction, weakest one and motion of the tip.

    ``size`` is the smallest singular value there.  ``traced`` are the index of this curve's first
    step, and the numbers of its steps near its start, of known steps and of queued starts.
    Returns the last three, the least distance, and whether the curve has closed.
    """
    _, _, _, seed, metric, _ = request
    q, g, weak, push = origin
    first, closing, count, queued = traced
    bent, weak_ahead = scratch(7), scratch(7)
    for i in range(7):
        bent[i] = 0.0
    length, travelled = TRACE_STEP, 0.0
    before, past = 0.0, 1.0
    for _ in range(TRACE_STEPS):
        if count + 2 > known.shape[0]:
            break
        ends = known[count]
        copy(q, ends[0])
        copy(g, ends[1])
        length, turned = _advance(packed, T, space, ends, bent, length)
        if length == 0.0:
            break
        size_ahead = weakest_direction(space, push, weak_ahead)
        if passes_crossing(before, size, size_ahead, past, length):
            queued = enter_crossing(
                packed, T, request, space, ends[1], weak, ends[0], queue, queued
            )
        before, size, past = size, size_ahead, length
        copy(weak_ahead, weak)
        for i in range(7):
            bent[i] = 0.5 * (ends[3, i] - ends[1, i]) / length
        distance = _settle_between(packed, T, request, space, ends, distance, best)
        closed = (
            travelled > 2.0 * CLOSING
            and _distance_from_known(known[first:], closing, ends[2]) < TRACE_NEAR
        )
        travelled += length
        count += 1
        if travelled < CLOSING:
            closing = count - first
        for i in range(7):
            for row in range(4):
                known[count, row, i] = ends[row, i]
        if _rewind(request, known[count]):
            ends = known[count]
            distance = _settle_between(packed, T, request, space, ends, distance, best)
            count += 1
        copy(ends[2], q)
        copy(ends[3], g)
        if closed:
            return closing, count, queued, distance, True
        if distance_from(q, seed, metric) > distance * BEYOND:
            break
        if turned < 0.5 * TRACE_BENT:
            length = min(TRACE_STEP, 2.0 * length)
    if length == 0.0 and size < CROSSING:
        queued = enter_crossing(packed, T, request, space, g, weak, q, queue, queued)
    return closing, count, queued, distance, False


@lean
def _trace_from(packed, T, request, space, start, known, count, distance, best, queue, queued):
    """Trace both sides of ``start`` (7,), and queue starts around crossings.

    Returns the number of known steps, the least distance, that of ``best`` (7,), and the number of
    queued starts.
    """
    _, _, _, seed, metric, _ = request
    begin, ahead, weak_begin, push = scratch(7), scratch(7), scratch(7), scratch(6)
    size = _begin_trace(packed, T, space, start, known, count, begin, ahead, push, weak_begin)
    if size < 0.0:
        return count, distance, queued
    if distance_from(start, seed, metric) <= distance:
        distance = _improve(packed, T, request, space, begin, ahead, distance, best)
        if distance < small_distance(metric):
            # So near the seed it is a line, and no other branch is as near.
            _write_line(known[count], begin, ahead)
            return count + 1, distance, queued
    if size < CROSSING:
        queued = enter_crossing(packed, T, request, space, ahead, weak_begin, begin, queue, queued)
    q, g, weak = scratch(7), scratch(7), scratch(7)
    first, closing = count, 1
    for side in range(2):
        copy(begin, q)
        copy(weak_begin, weak)
        for i in range(7):
            g[i] = ahead[i] * (1.0 - 2.0 * side)
        origin, traced = (q, g, weak, push), (first, closing, count, queued)
        closing, count, queued, distance, closed = _trace_side(
            packed, T, request, space, origin, size, traced, known, distance, best, queue
        )
        if closed:
            break
    return count, distance, queued


@part(f8(IN2, IN2, IN2, i8, b1, IN2, IN1, f8, OUT1, OUT2))
def trace_nearest(packed, T, joints, metric, bounded, starts, away, distance, best, known):
    """Find the posture nearest to a seed on the self-motions through the ``starts`` (m, 7).

    ``joints`` (4, 7) holds whether joints turn, lower and upper limits (ignored unless
    ``bounded``), and the seed.  The starts are at the distances ``away`` (m,), nearest first.  The
    nearest known posture ``best`` (7,) is at ``distance``, infinite if none is known.  The nearest
    of all replaces it, and its distance is returned.  ``known`` (TRACES, 28) is working space.
    """
    request = joints[0], joints[1], joints[2], joints[3], metric, bounded
    J, current, e, y, A = scratch(6, 7), scratch(4, 4), scratch(6), scratch(6), scratch(6, 6)
    space = J, current, e, y, A, np.zeros(7)
    known = known.reshape((known.shape[0], 4, 7))
    queue = np.empty((QUEUED, 7))
    count = queued = k = taken = 0
    if distance < math.inf:
        count, distance, queued = _trace_from(
            packed, T, request, space, best, known, count, distance, best, queue, queued
        )
    while True:
        if k < starts.shape[0] and away[k] <= distance * BEYOND:
            start, k = starts[k], k + 1
        elif taken < queued:
            start, taken = queue[taken], taken + 1
        else:
            break
        if count + 2 > known.shape[0]:
            break
        if _distance_from_known(known, count, start) >= TRACE_ON:
            count, distance, queued = _trace_from(
                packed, T, request, space, start, known, count, distance, best, queue, queued
            )
    return distance
