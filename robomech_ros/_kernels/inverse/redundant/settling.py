"""Exact minimum of the distance from a seed along a self-motion of seven joints."""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import lean, scratch
from robomech_ros._kernels.inverse.polishing import largest_error, pose_difference
from robomech_ros._kernels.inverse.ranking import LINF, distance_from
from robomech_ros._kernels.inverse.redundant.nearest import (
    NEAREST_DAMPING,
    NEAREST_ERROR,
    correct,
    direction_like,
)
from robomech_ros._kernels.tolerances import AT_LIMIT

# Largest error of the pose (rad, m) at the start of a step.
TRACE_ERROR = 0.3
# Steps towards a minimum: the first, the longest, their growth, the shortest interval around the
# minimum (rad or m), and their largest number.  EDGE is the smallest fraction cut off an interval.
SETTLE_STEP = 0.01
SETTLE_MAX_STEP = 0.1
SETTLE_GROWTH = 2.0
SETTLE_SHORTEST = 1e-8
SETTLE_STEPS = 40
SETTLE_EDGE = 1e-3
# A posture is on the self-motion if its error (rad, m) was less than this before the last of at
# most CORRECTIONS corrections.  At most FINISH_STEPS move the nearest posture onto its pose.
SETTLE_ERROR = 1e-5
SETTLE_CORRECTIONS = 10
FINISH_STEPS = 10
# Added to the distance of a posture beyond its limits: more than any distance from the seed.
OUTSIDE = 1e6


@lean
def step_onto(packed, T, sense, space, g, q):
    """Correct the pose of q (7,) once and project g (7,) onto the self-motion.

    Returns the error before the correction, infinite on failure.
    """
    J, current, e, y, A, no_step = space
    jacobian_body(packed, q, J, current)
    pose_difference(T, current, e)
    error = largest_error(e)
    for i in range(6):
        for j in range(i + 1):
            value = 0.0
            for k in range(7):
                value += J[i, k] * J[j, k]
            A[i, j] = value
        A[i, i] += NEAREST_DAMPING * error * error
    if not cholesky_solve(A, e, 6):
        return math.inf
    correct(J, e, no_step, q)
    return error if direction_like(J, A, y, sense, g) else math.inf


@lean
def copy(source, target):
    """Copy seven joint values."""
    for i in range(7):
        target[i] = source[i]


@lean
def _measured(request, q, g):
    """Return the objective at a posture q (7,), its slope along g (7,), and the joint it uses.

    The objective is the distance from the seed or, beyond a limit, OUTSIDE plus the excess.  The
    joint is -1 if all count.
    """
    _, lower, upper, seed, metric, bounded = request
    most, joint, sense = AT_LIMIT, -1, 0.0
    for i in range(7):
        if bounded and lower[i] - q[i] > most:
            most, joint, sense = lower[i] - q[i], i, -1.0
        if bounded and q[i] - upper[i] > most:
            most, joint, sense = q[i] - upper[i], i, 1.0
    if joint >= 0:
        return OUTSIDE + most, sense * g[joint], joint
    if metric == LINF:
        most, slope = 0.0, 0.0
        for i in range(7):
            move = q[i] - seed[i]
            if abs(move) >= most:
                most, joint, slope = abs(move), i, math.copysign(g[i], g[i] * move)
        return most, slope, joint
    along = 0.0
    for i in range(7):
        along += (q[i] - seed[i]) * g[i]
    most = distance_from(q, seed, metric)
    return most, along / most if most > 0.0 else 0.0, joint


@lean
def move_onto(packed, T, space, g, q):
    """Correct q (7,) to the self-motion, and g (7,) to its direction; return False on failure."""
    for _ in range(SETTLE_CORRECTIONS):
        error = step_onto(packed, T, 1.0, space, g, q)
        if error < SETTLE_ERROR:
            return True
        if error > TRACE_ERROR:
            return False
    return False


@lean
def _part_between(first, last, length):
    """Return the fraction of a step at the expected minimum, from the values at both ends."""
    value, slope, joint = first
    other, rise, another = last
    part = 0.5
    if other >= OUTSIDE > value and rise > 0.0:
        # The minimum is on the limit.
        part = 1.0 - (other - OUTSIDE) / (rise * length)
    elif value >= OUTSIDE > other and slope < 0.0:
        part = (OUTSIDE - value) / (slope * length)
    elif joint == another and slope < 0.0 < rise:
        part = slope / (slope - rise)
    elif slope < rise:
        part = (other - value - rise * length) / ((slope - rise) * length)
    return part


@lean
def settle(packed, T, request, space, g, q):
    """Move q (7,) to the next minimum of the distance; return the distance, infinite if none.

    Downhill steps bracket the minimum.  The bracket is then cut where the tangents at both ends
    intersect or, if the same joint or all count at both ends, where the slope is zero.
    """
    _, lower, upper, seed, metric, _ = request
    a, b, ga, gb = scratch(7), scratch(7), scratch(7), scratch(7)
    if not move_onto(packed, T, space, g, q):
        return math.inf
    copy(q, a)
    first = _measured(request, a, g)
    sense = -1.0 if first[1] > 0.0 else 1.0
    for i in range(7):
        ga[i] = sense * g[i]
    first = first[0], sense * first[1], first[2]
    last, length, found = first, SETTLE_STEP, False
    for _ in range(SETTLE_STEPS):
        if first[0] >= OUTSIDE and first[1] < 0.0:
            length = min(max(length, (OUTSIDE - first[0]) / first[1]), SETTLE_MAX_STEP)
        for i in range(7):
            b[i], gb[i] = a[i] + length * ga[i], ga[i]
        if not move_onto(packed, T, space, gb, b):
            break
        last = _measured(request, b, gb)
        found = last[0] >= first[0] or last[1] > 0.0
        if found:
            break
        copy(b, a)
        copy(gb, ga)
        first, length = last, min(SETTLE_GROWTH * length, SETTLE_MAX_STEP)
    same = 0
    for _ in range(SETTLE_STEPS if found else 0):
        length = 0.0
        for i in range(7):
            length = max(length, abs(b[i] - a[i]))
        if length < SETTLE_SHORTEST:
            break
        part = _part_between(first, last, length) if abs(same) < 2 else 0.5
        part = min(max(part, SETTLE_EDGE), 1.0 - SETTLE_EDGE)
        for i in range(7):
            q[i] = a[i] + part * (b[i] - a[i])
            g[i] = ga[i]
        if not move_onto(packed, T, space, g, q):
            break
        here = _measured(request, q, g)
        if here[0] < first[0] and here[1] < 0.0:
            copy(q, a)
            copy(g, ga)
            first, same = here, max(same, 0) + 1
        else:
            copy(q, b)
            copy(g, gb)
            last, same = here, min(same, 0) - 1
        if abs(same) > 2:
            same = 0
    if last[0] < first[0]:
        copy(b, a)
    copy(a, q)
    for _ in range(FINISH_STEPS):
        error = step_onto(packed, T, 1.0, space, g, q)
        value, slope, _ = _measured(request, q, g)
        if value >= OUTSIDE and abs(slope) > SETTLE_EDGE:
            # Rounding has moved the posture off the limit.
            for i in range(7):
                q[i] -= (value - OUTSIDE) / slope * g[i]
        elif error <= NEAREST_ERROR:
            for i in range(7):
                q[i] = min(max(q[i], lower[i]), upper[i])
            return distance_from(q, seed, metric) if value < OUTSIDE else math.inf
    return math.inf
