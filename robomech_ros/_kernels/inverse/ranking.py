"""Ranking of bare solutions: windings, limits, order and margins."""

import math
from typing import Any, NamedTuple

import numpy as np

from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import (
    IIN1,
    IN1,
    IN2,
    IOUT1,
    OUT1,
    OUT2,
    ZERO,
    b1,
    f8,
    i8,
)
from robomech_ros._kernels.tolerances import AT_LIMIT, SAME_POSTURE

LINF = 0
INSIDE = -1
_TURN = 2.0 * math.pi
_TURN_AND_HALF = 3.0 * math.pi


class Request(NamedTuple):
    """Criteria for ranking solutions; each array (n,), ``turns`` true for revolute joints."""

    turns: Any
    lower: Any
    upper: Any
    seed: Any
    metric: Any
    bounded: Any


class Ranked(NamedTuple):
    """Buffers for ranked solutions: joint values (room, n), branches (room,), distances (room,)."""

    q: Any
    names: Any
    distances: Any


@lean
def _windings(value, lower, upper):
    """Return the first and the last winding that keep a revolute joint inside its limits."""
    first = np.ceil((lower - AT_LIMIT - value) / _TURN)
    last = np.floor((upper + AT_LIMIT - value) / _TURN)
    return first, last


@lean
def _moved_inside(value, low, high):
    """Return a value outside its limits, moved by turns until it is back across that limit."""
    below = low - AT_LIMIT - value
    if below > 0.0:
        return value + (_TURN * math.ceil(below / _TURN) if below > _TURN else _TURN)
    above = value - high - AT_LIMIT
    return value - (_TURN * math.ceil(above / _TURN) if above > _TURN else _TURN)


@lean
def _near(value, seed):
    """Return the value in the winding nearest to the seed, without a branch for one turn."""
    move = seed - value
    if abs(move) >= _TURN_AND_HALF:
        return value + _TURN * math.floor(move / _TURN + 0.5)
    wound = value + _TURN if move >= math.pi else value
    return value - _TURN if move < -math.pi else wound


@lean
def _on_limit(value, lower, upper):
    """Return the value clipped to the limits, which it exceeds by rounding at most."""
    return min(max(value, lower), upper)


@lean
def nearest_winding(turns, lower, upper, seed, bounded, q, nearest):
    """Write q in the winding nearest to the seed; return False if ``bounded`` limits exclude it."""
    for i in range(q.shape[0]):
        value = _near(q[i], seed[i]) if turns[i] else q[i]
        low, high = lower[i], upper[i]
        inside = low - AT_LIMIT <= value <= high + AT_LIMIT
        if turns[i] and not inside:
            wound = _moved_inside(value, low, high)
            inside = low - AT_LIMIT <= wound <= high + AT_LIMIT
            value = wound if inside else value
        if inside:
            value = _on_limit(value, low, high)
        elif bounded:
            return False
        nearest[i] = value
    return True


@lean
def distance_from(q, seed, metric):
    """Return the distance of q (n,) from the seed: largest joint move, or Euclidean norm."""
    largest = 0.0
    squares = 0.0
    for i in range(q.shape[0]):
        move = abs(q[i] - seed[i])
        largest = max(largest, move)
        squares += move * move
    return largest if metric == LINF else math.sqrt(squares)


@lean
def is_listed(turns, q, distance, count, ranked):
    """Return whether a solution q (n,) is among the first ``count``, angles modulo a turn.

    Only solutions at the same distance from the seed are compared.
    """
    rows, _, distances = ranked
    slack = SAME_POSTURE * q.shape[0]
    for k in range(count):
        if abs(distances[k] - distance) > slack:
            continue
        same = True
        for i in range(q.shape[0]):
            apart = abs(q[i] - rows[k, i])
            if turns[i] and apart > math.pi:
                apart = abs(apart - _TURN * math.floor(apart / _TURN + 0.5))
            if apart > SAME_POSTURE:
                same = False
                break
        if same:
            return True
    return False


@lean
def insert(turns, q, name, distance, count, ranked):
    """Insert a solution behind those as near to the seed; return the number of solutions.

    A solution that is already listed, angles modulo a turn, is not inserted.
    """
    rows, names, distances = ranked
    room = rows.shape[0]
    if count == room and not distance < distances[count - 1]:
        return count
    if is_listed(turns, q, distance, count, ranked):
        return count
    k = min(count, room - 1)
    while k > 0 and distances[k - 1] > distance:
        distances[k] = distances[k - 1]
        names[k] = names[k - 1]
        for i in range(q.shape[0]):
            rows[k, i] = rows[k - 1, i]
        k -= 1
    distances[k] = distance
    names[k] = name
    for i in range(q.shape[0]):
        rows[k, i] = q[i]
    return min(count + 1, room)


@lean
def rank_body(request, q, branch, total, nearest, order, away, ranked):
    """Write each of ``total`` solutions once, in the winding nearest to the seed, nearest first.

    If ``ranked`` has too few rows, only the nearest solutions are written.  ``nearest``, ``order``
    and ``away`` are working space.  Returns the number of solutions written.
    """
    turns, lower, upper, seed, metric, bounded = request
    rows, names, distances = ranked
    count = ZERO
    for k in range(total):
        if nearest_winding(turns, lower, upper, seed, bounded, q[k], nearest[k]):
            distance = distance_from(nearest[k], seed, metric)
            row = count
            while row > 0 and away[row - 1] > distance:
                away[row], order[row] = away[row - 1], order[row - 1]
                row -= 1
            away[row], order[row] = distance, k
            count += 1
    kept = ZERO
    for i in range(count):
        one = nearest[order[i]]
        if kept == rows.shape[0]:
            break
        if is_listed(turns, one, away[i], kept, ranked):
            continue
        distances[kept] = away[i]
        names[kept] = branch[order[i]]
        for j in range(q.shape[1]):
            rows[kept, j] = one[j]
        kept += 1
    return kept


@lean
def _wound(turns, lower, upper, number, q, wound):
    """Write winding ``number`` of q to ``wound``; a joint without two limits is unchanged."""
    for i in range(q.shape[0]):
        wound[i] = q[i]
        if turns[i] and upper[i] - lower[i] < math.inf:
            first, last = _windings(q[i], lower[i], upper[i])
            if last >= first:
                count = int(last - first) + 1
                digit = number % count
                number //= count
                value = q[i] + _TURN * (first + digit)
                wound[i] = _on_limit(value, lower[i], upper[i])


@lean
def _count_windings(turns, lower, upper, q):
    total = 1.0
    for i in range(q.shape[0]):
        if turns[i] and upper[i] - lower[i] < math.inf:
            first, last = _windings(q[i], lower[i], upper[i])
            total *= max(1.0, last - first + 1.0)
    return total


@kernel(i8(IIN1, IN1, IN1, IN2))
def winding_count(turns, lower, upper, q):
    """Return the number of windings of all solutions q (k, n) inside the limits, at most 2**62."""
    total = 0.0
    for k in range(q.shape[0]):
        total += _count_windings(turns, lower, upper, q[k])
    return int(min(total, 2.0**62))


@kernel(i8(IIN1, IN1, IN1, IN1, i8, b1, b1, IN2, IIN1, OUT2, IOUT1, OUT1))
def rank(turns, lower, upper, seed, metric, bounded, winding, q, branch, ranked, names, distances):
    """Order the solutions q (k, n) by their distance from the seed; return their number.

    If ``bounded``, solutions outside the limits are dropped.  If ``winding``, every winding inside
    the limits is listed, not only the nearest.  ``turns`` is 1 for revolute joints.
    """
    total = q.shape[0]
    if not winding:
        request = Request(turns, lower, upper, seed, metric, bounded)
        nearest, order, away = np.empty(q.shape), np.empty(total, np.int64), np.empty(total)
        into = Ranked(ranked, names, distances)
        return rank_body(request, q, branch, total, nearest, order, away, into)
    one, wound = np.empty(q.shape[1]), np.empty(q.shape[1])
    # Windings of one posture count as different solutions.
    none_turns = np.zeros(q.shape[1], np.int64)
    into = Ranked(ranked, names, distances)
    count = ZERO
    for k in range(total):
        if not nearest_winding(turns, lower, upper, seed, bounded, q[k], one):
            continue
        for number in range(int(_count_windings(turns, lower, upper, one))):
            _wound(turns, lower, upper, number, one, wound)
            distance = distance_from(wound, seed, metric)
            count = insert(none_turns, wound, branch[k], distance, count, into)
    return count


@kernel(i8(IIN1, IN1, IN1, IN2, OUT2))
def excesses(turns, lower, upper, q, excess):
    """Write each joint's distance beyond its limits, 0 inside; return the row of the least.

    Revolute joints count in the winding that is least outside.  The returned solution has the
    smallest largest excess; among equals, the smallest sum.
    """
    best = -1
    least = math.inf
    least_sum = math.inf
    for k in range(q.shape[0]):
        largest = 0.0
        total = 0.0
        for i in range(q.shape[1]):
            below = lower[i] - q[k, i]
            above = q[k, i] - upper[i]
            value = max(below, above, 0.0)
            if turns[i]:
                first, last = _windings(q[k, i], lower[i], upper[i])
                value = 0.0
                if last < first:
                    below -= _TURN * np.floor(below / _TURN)
                    above -= _TURN * np.floor(above / _TURN)
                    value = min(below, above)
            excess[k, i] = value if value > AT_LIMIT else 0.0
            largest = max(largest, excess[k, i])
            total += excess[k, i]
        equal = abs(largest - least) <= AT_LIMIT
        if best < 0 or (equal and total < least_sum) or (not equal and largest < least):
            least = largest
            least_sum = total
            best = k
    return best


@kernel(i8(IN1, IN1, IN1, f8))
def first_outside(lower, upper, q, slack):
    """Return the index of the first joint outside its limits by more than ``slack``, or INSIDE.

    NaN and infinite values are outside.
    """
    for i in range(q.shape[0]):
        if not (lower[i] - slack <= q[i] <= upper[i] + slack and math.isfinite(q[i])):
            return i
    return INSIDE
