"""The posture of a redundant arm nearest to a seed, along the self-motion of one posture.

Every step corrects the pose by the shortest move of the joints, and moves along the self-motion to
the minimum of the linearised distance inside the joint limits.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.dense import cholesky_again, cholesky_solve
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import lean, part, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, b1, f8, i8
from robomech_ros._kernels.inverse.polishing import largest_error, pose_difference
from robomech_ros._kernels.inverse.ranking import LINF, distance_from
from robomech_ros._kernels.tolerances import AT_LIMIT, ON_BOUNDARY

# The nearest solution is sought along the self-motion until a step is shorter than this (rad or m):
# the next one would be about its square.
NEAREST_STEP = 1e-3
# Accepted error of the pose (rad, m).
NEAREST_ERROR = 1e-12
# Damping over the squared error: it shortens steps near a singular posture and no others.
NEAREST_DAMPING = 1e-2
# Largest number of steps; convergent searches need four to seven.
NEAREST_ITERATIONS = 20
# Largest error of the pose (rad, m) for a step.
NEAREST_FARTHEST = 10.0

# Longest change of a joint (rad or m) in a step along the self-motion, and in a correction.
_LONGEST = 0.5
_LONGEST_CORRECTION = 1.0
# A joint that moves less than this fraction of the others is not moved into its limits.
_NEGLIGIBLE = 1e-6
# If the farthest joint moves less than this fraction, another vector gives the direction.
_SMALL_MOTION = 0.1
_ANY_DIRECTION = (0.6, -0.5, 0.4, 0.7, -0.4, 0.5, 0.6)
# Near singular postures a correction may undo part of a step.  If it undoes more than this
# fraction, the next step is shorter by this factor.
_UNDONE_LIMIT, _SHORTER = 0.25, 0.4
# Largest number of cuts for the minimum of the largest of about a dozen lines; a few suffice.
_CUTS = 32
_ROUNDING = 1e-12


@lean
def _largest_after(q, seed, t, s):
    """Return the largest difference from the seed after a step s along t, and its derivative."""
    largest = -1.0
    slope = 0.0
    for i in range(q.shape[0]):
        difference = q[i] + s * t[i] - seed[i]
        if abs(difference) > largest:
            largest = abs(difference)
            slope = math.copysign(t[i], t[i] * difference)
    return largest, slope


@lean
def minimax(q, seed, t, low, high):
    """Return the step in [low, high] along t that minimises the largest difference from the seed.

    It is convex and piecewise linear in the step: the intersection of a falling line on the left
    and a rising one on the right replaces one of both until it is the minimum.
    """
    a, b, s = low, high, low
    fa, ga = _largest_after(q, seed, t, a)
    fb, gb = _largest_after(q, seed, t, b)
    if gb <= 0.0:
        s = high
    elif ga < 0.0:
        for _ in range(_CUTS):
            s = (fa - ga * a - fb + gb * b) / (gb - ga)
            value, slope = _largest_after(q, seed, t, s)
            if value <= fa + ga * (s - a) + _ROUNDING:
                break
            if slope < 0.0:
                a, fa, ga = s, value, slope
            else:
                b, fb, gb = s, value, slope
    here, _ = _largest_after(q, seed, t, 0.0)
    there, _ = _largest_after(q, seed, t, s)
    return s if there < here - _ROUNDING or not low <= 0.0 <= high else 0.0


@lean
def best_step(request, q, rates, longest):
    """Return the step along rates to the posture nearest to the seed, inside the limits."""
    _, lower, upper, seed, metric, bounded = request
    low, high = -longest, longest
    for i in range(7):
        if bounded and rates[i] != 0.0:
            one, other = (lower[i] - q[i]) / rates[i], (upper[i] - q[i]) / rates[i]
            low, high = max(low, min(one, other)), min(high, max(one, other))
    if metric == LINF:
        return minimax(q, seed, rates, low, high)
    along = squares = 0.0
    for i in range(7):
        along += (seed[i] - q[i]) * rates[i]
        squares += rates[i] * rates[i]
    return min(max(along / squares, low), high)


@lean
def _descent_direction(q, seed, metric, g):
    """Write the direction of steepest descent of the distance from the seed."""
    n = q.shape[0]
    if metric != LINF:
        for i in range(n):
            g[i] = seed[i] - q[i]
        return
    k = 0
    for i in range(n):
        g[i] = 0.0
        if abs(q[i] - seed[i]) > abs(q[k] - seed[k]):
            k = i
    g[k] = 1.0 if seed[k] > q[k] else -1.0


@lean
def _step_length(q, seed, metric, t, lower, upper, bounded):
    """Return the step along t, into the limits; at most _LONGEST in every joint."""
    largest = 0.0
    for i in range(q.shape[0]):
        largest = max(largest, abs(t[i]))
    if largest < ON_BOUNDARY:
        return 0.0
    longest = _LONGEST / largest
    low, high = -longest, longest
    if bounded:
        for i in range(q.shape[0]):
            if abs(t[i]) > _NEGLIGIBLE * largest:
                one, other = (lower[i] - q[i]) / t[i], (upper[i] - q[i]) / t[i]
                low = max(low, min(one, other))
                high = min(high, max(one, other))
        if low > high:
            # Not all joints can be inside: use the middle.
            return min(max(0.5 * (low + high), -longest), longest)
    if metric == LINF:
        return minimax(q, seed, t, low, high)
    return min(max(1.0, low), high)


@lean
def _inside(q, lower, upper):
    """Return whether q is inside its limits; clip it if it is outside by rounding only."""
    for i in range(q.shape[0]):
        if not lower[i] - AT_LIMIT <= q[i] <= upper[i] + AT_LIMIT:
            return False
    for i in range(q.shape[0]):
        q[i] = min(max(q[i], lower[i]), upper[i])
    return True


@lean
def correct(J, y, before, q):
    """Add J^T y, the shortest move that corrects the pose, to q, shortened if it is too long.

    Returns the fraction of the step ``before`` (n,) along the self-motion that this undoes.
    """
    longest = 0.0
    for k in range(q.shape[0]):
        value = 0.0
        for i in range(6):
            value += J[i, k] * y[i]
        longest = max(longest, abs(value))
    share = min(1.0, _LONGEST_CORRECTION / longest) if longest > 0.0 else 1.0
    back = squares = 0.0
    for k in range(q.shape[0]):
        value = 0.0
        for i in range(6):
            value += J[i, k] * y[i]
        q[k] += share * value
        back -= share * value * before[k]
        squares += before[k] * before[k]
    return back / squares if squares > 0.0 else 0.0


@lean
def _project(J, A, y, g):
    """Project g (n,) onto the self-motion, A (6, 6) factored; return its largest entry."""
    n = g.shape[0]
    for i in range(6):
        y[i] = 0.0
        for k in range(n):
            y[i] += J[i, k] * g[k]
    cholesky_again(A, y, 6)
    largest = 0.0
    for k in range(n):
        for i in range(6):
            g[k] -= J[i, k] * y[i]
        largest = max(largest, abs(g[k]))
    return largest


@lean
def _direction(J, A, y, q, seed, metric, g):
    """Write the direction of the self-motion that reduces the distance from the seed."""
    _descent_direction(q, seed, metric, g)
    largest = _project(J, A, y, g)
    if q.shape[0] == 7 and metric == LINF and largest < _SMALL_MOTION:
        # The farthest joint hardly moves: another vector gives the only direction more accurately.
        for k in range(7):
            g[k] = _ANY_DIRECTION[k]
        _project(J, A, y, g)


@lean
def direction_like(J, A, y, sense, g):
    """Write the direction of the self-motion of seven joints nearest to g (7,) to g.

    If g is zero, ``sense`` gives its sense.  The joint that moves most moves by 1; returns False
    without such a direction.
    """
    largest = 0.0
    for k in range(7):
        largest = max(largest, abs(g[k]))
    if largest == 0.0:
        for k in range(7):
            g[k] = sense * _ANY_DIRECTION[k]
    largest = _project(J, A, y, g)
    if largest < ON_BOUNDARY:
        return False
    for k in range(7):
        g[k] /= largest
    return True


@lean
def _shortened_step(s, q, seed, metric, g, before, fall, undone):
    """Shorten a step s along g that reverses the last one, to where the slope is zero.

    ``fall`` is the slope at which the distance fell along the last step, ``before`` (n,).  The step
    is shorter if the correction has ``undone`` a large fraction of it.  Returns the step, and the
    slope at which the distance falls along g.
    """
    back = squares = lengths = 0.0
    for k in range(g.shape[0]):
        back += s * g[k] * before[k]
        squares += g[k] * g[k]
        lengths += before[k] * before[k]
    if squares == 0.0:
        return 0.0, 0.0
    size = math.sqrt(squares)
    now = size
    if metric == LINF:
        _, slope = _largest_after(q, seed, g, 0.0)
        now = abs(slope) / size
    most = math.inf
    if back < 0.0 and now + fall > 0.0:
        most = math.sqrt(lengths) / size * now / (now + fall)
    if undone > _UNDONE_LIMIT:
        most = min(most, _SHORTER * math.sqrt(lengths) / size)
    return min(max(s, -most), most), now


@part(f8(IN2, IN2, IN1, IN1, IN1, i8, b1, OUT1))
def approach(packed, T, lower, upper, seed, metric, bounded, q):
    """Move q (n,), a posture of the pose T (4, 4), as near to the seed as its self-motion goes.

    Limits are respected if ``bounded``.  Returns the distance, or infinity with invalid q.
    """
    n = q.shape[0]
    J = np.empty((6, n))
    current = scratch(4, 4)
    e = scratch(6)
    y = scratch(6)
    A = scratch(6, 6)
    g = np.empty(n)
    before = np.zeros(n)
    fall = 0.0
    settled = False
    for iteration in range(NEAREST_ITERATIONS):
        jacobian_body(packed, q, J, current)
        pose_difference(T, current, e)
        error = largest_error(e)
        # Nothing is nearer than the seed itself, even if it is singular.
        there = iteration == 0 and distance_from(q, seed, metric) == 0.0
        if (settled or there) and error <= NEAREST_ERROR:
            if not bounded or _inside(q, lower, upper):
                return distance_from(q, seed, metric)
            settled = False
        if not error < NEAREST_FARTHEST:
            return math.inf
        for i in range(6):
            for j in range(i + 1):
                value = 0.0
                for k in range(n):
                    value += J[i, k] * J[j, k]
                A[i, j] = value
            A[i, i] += NEAREST_DAMPING * error * error
        if not cholesky_solve(A, e, 6):
            return math.inf
        undone = correct(J, e, before, q)
        if not settled:
            _direction(J, A, y, q, seed, metric, g)
            s = _step_length(q, seed, metric, g, lower, upper, bounded)
            s, fall = _shortened_step(s, q, seed, metric, g, before, fall, undone)
            largest = 0.0
            for k in range(n):
                before[k] = s * g[k]
                largest = max(largest, abs(before[k]))
                q[k] += before[k]
            settled = max(largest, error) < NEAREST_STEP or iteration == NEAREST_ITERATIONS - 5
    return math.inf
