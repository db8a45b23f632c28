"""A walk along self-motions from a posture, to nearer ones beyond farther ones.

Where the nearest posture is not proved, steps from a start lead to the next least distance alone.
From there the walk goes both ways, over postures that are farther from the seed by no more than
BEYOND, and settles where the cubic between two postures comes near enough.  Then it does the same
from the posture on the other side of the singular one that is nearest, such as that with the elbow
bent the other way.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.dense import cholesky_again, cholesky_solve
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import IN2, OUT1, b1, f8, i8, lean, part, scratch
from robomech_ros._kernels.inverse.polishing import largest_error, pose_difference
from robomech_ros._kernels.inverse.ranking import distance_from
from robomech_ros._kernels.inverse.redundant.nearest import (
    NEAREST_DAMPING,
    NEAREST_ERROR,
    best_step,
    correct,
    direction_like,
)
from robomech_ros._kernels.tolerances import AT_LIMIT

__all__ = ["walk"]

# How much farther from the seed (rad or m) than the nearest posture known the walk goes, by steps
# of this length (of the joint that moves most), and how many to each side at most.
BEYOND = 0.25
WALK_STEP = 0.2
WALK_STEPS = 14
# The walk ends where the error of the pose (rad, m) is larger than this.
WALK_ERROR = 0.3
# Steps from the seed, where no posture is known, that bring the error below this (rad, m).
REACH_STEPS = 20
REACH_ERROR = 1e-2
# Into so many parts a step is divided to look for near postures; they are off by so much (rad or
# m), may be so far beyond limits, since what lies between two of them is not looked at, and one
# this near to the nearest posture known would lead there.
WALK_PARTS = 8
WALK_OFF = 3e-4
WALK_BEYOND = 0.02
WALK_AGAIN = 0.02
# So often a walk from one start settles at most.  The first step then is no longer than this, later
# ones may be longer by a factor each, up to the most, and none is tried that is shorter (rad or m).
SETTLED = 3
SETTLE_LONGEST = 0.03
SETTLE_GROWTH = 1.5
SETTLE_MOST = 0.1
SETTLE_SHORTEST = 1e-6
SETTLE_STEPS = 16
# A posture counts whose error (rad, m) was less than this before the last correction; so many at
# most bring the nearest one onto its pose.
SETTLE_ERROR = 2e-3
FINISH_STEPS = 10
# The nearest posture known has settled within this.
NEARLY_SETTLED = 8e-3
# How far (rad or m) beyond a singular posture the other side is looked for, the move that shows how
# the Jacobian changes, and steps along the self-motion before that, so many to each side.
JUMP_LONGEST = 1.0
JUMP_PROBE = 1e-2
JUMP_STEP = 0.2
JUMP_SIDE = 2


@lean
def _square(J, A, damping):
    """Write the lower half of J J^T + damping."""
    for i in range(6):
        for j in range(i + 1):
            value = 0.0
            for k in range(7):
                value += J[i, k] * J[j, k]
            A[i, j] = value
        A[i, i] += damping


@lean
def _step(packed, T, way, bench, g, q):
    """Correct the pose of q (7,) and turn g (7,) into the direction of the self-motion.

    Returns the error that there was, infinite where the pose is lost.
    """
    J, current, e, y, A, none = bench
    jacobian_body(packed, q, J, current)
    pose_difference(T, current, e)
    error = largest_error(e)
    _square(J, A, NEAREST_DAMPING * error * error)
    if not cholesky_solve(A, e, 6):
        return math.inf
    correct(J, e, none, q)
    return error if direction_like(J, A, y, way, g) else math.inf


@lean
def _keeps_limits(request, q, slack):
    """Tell whether a posture keeps the limits that hold."""
    _, lower, upper, _, _, bounded = request
    for i in range(7):
        if bounded and not lower[i] - slack <= q[i] <= upper[i] + slack:
            return False
    return True


@lean
def _copy(source, target):
    for i in range(7):
        target[i] = source[i]


@lean
def _settle(packed, T, request, bench, longest, g, q):
    """Go down from q (7,) to the next least distance; return that, infinite where there is none."""
    _, lower, upper, seed, metric, bounded = request
    kept, ahead = scratch(7), scratch(7)
    least = math.inf
    for _ in range(SETTLE_STEPS):
        error = _step(packed, T, 1.0, bench, g, q)
        if error > WALK_ERROR:
            break
        if error > SETTLE_ERROR:
            continue
        here = distance_from(q, seed, metric)
        if here < least or not _keeps_limits(request, kept, AT_LIMIT):
            least = here
            _copy(q, kept)
            _copy(g, ahead)
        else:
            longest *= 0.25
        s = best_step(request, kept, ahead, longest)
        if abs(s) >= longest:
            longest = min(SETTLE_MOST, SETTLE_GROWTH * longest)
        if abs(s) < SETTLE_SHORTEST:
            break
        for i in range(7):
            q[i] = kept[i] + s * ahead[i]
            g[i] = ahead[i]
    if math.isinf(least):
        return least
    _copy(kept, q)
    for _ in range(FINISH_STEPS):
        error = _step(packed, T, 1.0, bench, g, q)
        inside = _keeps_limits(request, q, AT_LIMIT)
        if error <= NEAREST_ERROR and inside:
            for i in range(7):
                if bounded:
                    q[i] = min(max(q[i], lower[i]), upper[i])
            return distance_from(q, seed, metric)
        if not inside:
            s = best_step(request, q, g, SETTLE_LONGEST)
            for i in range(7):
                q[i] += s * g[i]
    return math.inf


@lean
def _nearest_between(request, ends, best, between, found):
    """Write the nearest posture (7,) between two postures to ``found``; return its distance.

    ``ends`` (4, 7) holds the first posture, the direction there, and those of the second.  What is
    near the ``best`` one is left out.
    """
    _, _, _, seed, metric, _ = request
    length = 0.0
    for i in range(7):
        length = max(length, abs(ends[2, i] - ends[0, i]))
    least = math.inf
    for k in range(1, WALK_PARTS + 1):
        s = k / WALK_PARTS
        a, b = s * s * (3.0 - 2.0 * s), length * s * (1.0 - s)
        away = 0.0
        for i in range(7):
            move = ends[2, i] - ends[0, i]
            bow = ends[1, i] * (1.0 - s) - ends[3, i] * s
            between[i] = ends[0, i] + a * move + b * bow
            away = max(away, abs(between[i] - best[i]))
        if away < WALK_AGAIN or not _keeps_limits(request, between, WALK_BEYOND):
            continue
        here = distance_from(between, seed, metric)
        if here < least:
            least = here
            _copy(between, found)
    return least


@lean
def _walk_from(packed, T, request, bench, start, distance, best):
    """Walk both ways from ``start`` (7,); return the least distance, of what is ``best`` then."""
    _, _, _, seed, metric, _ = request
    ends, q, g = scratch(4, 7), scratch(7), scratch(7)
    between, found, along = scratch(7), scratch(7), scratch(7)
    tries = SETTLED
    for side in range(2):
        for i in range(7):
            q[i], g[i] = start[i], 0.0
        for k in range(WALK_STEPS):
            if tries == 0 or _step(packed, T, 1.0 - 2.0 * side, bench, g, q) > WALK_ERROR:
                break
            _copy(q, ends[2])
            _copy(g, ends[3])
            if k > 0:
                near = _nearest_between(request, ends, best, between, found)
                if near < distance + WALK_OFF:
                    tries -= 1
                    _copy(g, along)
                    away = _settle(packed, T, request, bench, SETTLE_LONGEST, along, found)
                    if away < distance:
                        distance = away
                        _copy(found, best)
            if distance_from(q, seed, metric) > distance + BEYOND:
                break
            for i in range(7):
                # As the direction has changed in the last step, it will in the next.
                ahead = 1.5 * g[i] - 0.5 * ends[1, i] if k > 0 else g[i]
                q[i] += WALK_STEP * ahead
            _copy(ends[2], ends[0])
            _copy(ends[3], ends[1])
    return distance


@lean
def _least_moved(J, A, u, v):
    """Write the unit twist u (6,) of the tip that is least of all for a unit move v (7,) of joints.

    Returns how large it is for that; u has what is not orthogonal to it before.
    """
    _square(J, A, 0.0)
    if not cholesky_solve(A, u, 6):
        return 0.0
    for k in range(4):
        size = 0.0
        for i in range(6):
            size += u[i] * u[i]
        size = math.sqrt(size)
        for i in range(6):
            u[i] /= size
        if k < 3:
            cholesky_again(A, u, 6)
    squares = 0.0
    for k in range(7):
        v[k] = 0.0
        for i in range(6):
            v[k] += J[i, k] * u[i]
        squares += v[k] * v[k]
    sigma = math.sqrt(squares)
    for k in range(7):
        v[k] /= sigma
    return sigma


@lean
def _change(packed, bench, u, q, along, move):
    """How fast u^T J ``move`` changes along a move of q (7,), from its value at q."""
    J, current, _, _, _, _ = bench
    moved = scratch(7)
    for k in range(7):
        moved[k] = q[k] + JUMP_PROBE * along[k]
    jacobian_body(packed, q, J, current)
    before = _part(J, u, move)
    jacobian_body(packed, moved, J, current)
    return (_part(J, u, move) - before) / JUMP_PROBE


@lean
def _part(J, u, move):
    """u^T J ``move``."""
    value = 0.0
    for i in range(6):
        for k in range(7):
            value += u[i] * J[i, k] * move[k]
    return value


@lean
def _jump(packed, T, request, bench, q):
    """Move q (7,) to the other side of the nearest singular posture, to second order.

    Along the direction v in which the tip moves least, by sigma u, and t in which it does not, its
    motion sigma s + (a s^2 + 2 b s r + c r^2) / 2 along u is zero again.  Of some r, zero is taken
    or, where that leads far away, the one that leads nearest to the seed.  Returns False where all
    lead far away.
    """
    J, _, _, _, A, _ = bench
    _, _, _, seed, metric, _ = request
    u, v, t, there, start = scratch(6), scratch(7), scratch(7), scratch(7), scratch(7)
    for i in range(7):
        t[i] = 0.0
    if math.isinf(_step(packed, T, 1.0, bench, t, q)):
        return False
    for i in range(6):
        u[i] = 1.0 - 0.2 * i
    sigma = _least_moved(J, A, u, v)
    if not sigma > 0.0:
        return False
    a = _change(packed, bench, u, q, v, v)
    b = _change(packed, bench, u, q, v, t)
    c = _change(packed, bench, u, q, t, t)
    least = math.inf
    for k in range(-JUMP_SIDE, JUMP_SIDE + 1):
        r = k * JUMP_STEP
        half = sigma + b * r
        root = half * half - a * c * r * r
        if root < 0.0:
            continue
        # The larger root of both: the other one stays on this side.
        s = -half - math.copysign(math.sqrt(root), half)
        if not abs(s) < JUMP_LONGEST * abs(a):
            continue
        for i in range(7):
            there[i] = q[i] + s / a * v[i] + r * t[i]
        # Without a move along the self-motion the change is best known.
        here = distance_from(there, seed, metric) if k != 0 else 0.0
        if here < least:
            least = here
            _copy(there, start)
    if math.isinf(least):
        return False
    _copy(start, q)
    return True


@part(f8(IN2, IN2, IN2, i8, b1, f8, OUT1))
def walk(packed, T, joints, metric, bounded, distance, best):
    """Walk along self-motions from ``best`` (7,), which is at a distance from the seed.

    Where that is infinite, no posture is known, and the first steps lead from ``best`` to one.

    ``joints`` (4, 7) holds whether joints turn, lower and upper limits, which hold where
    ``bounded``, and the seed.  The nearest posture that is found is in ``best`` then; returns its
    distance.
    """
    request = joints[0], joints[1], joints[2], joints[3], metric, bounded
    J, current, e, y, A = scratch(6, 7), scratch(4, 4), scratch(6), scratch(6), scratch(6, 6)
    none, start, g = np.zeros(7), scratch(7), np.zeros(7)
    bench = J, current, e, y, A, none
    _copy(best, start)
    for _ in range(REACH_STEPS if math.isinf(distance) else 0):
        if not REACH_ERROR < _step(packed, T, 1.0, bench, g, start) < math.inf:
            break
    _copy(start, best)
    away = _settle(packed, T, request, bench, NEARLY_SETTLED, g, start)
    if away < distance:
        distance = away
        _copy(start, best)
    _copy(best, start)
    first = distance
    distance = _walk_from(packed, T, request, bench, start, distance, best)
    for again in range(2):
        if again == 1:
            if distance == first:
                break
            _copy(best, start)
        if _jump(packed, T, request, bench, start):
            distance = _walk_from(packed, T, request, bench, start, distance, best)
    return distance
