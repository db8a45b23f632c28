"""Iterative inverse kinematics: restarts inside the limits that collect distinct solutions."""

import math

import numpy as np

from robomech_ros._kernels.chain.serial import forward_body
from robomech_ros._kernels.compiling.jit import inline, kernel, part
from robomech_ros._kernels.compiling.types import IN1, IN2, IOUT1, OUT1, OUT2, i8
from robomech_ros._kernels.inverse.iterative import layout as at
from robomech_ros._kernels.inverse.iterative.steps import Space, attempt
from robomech_ros._kernels.inverse.polishing import (
    polish as polish,
    pose_difference,
    pose_error as pose_error,
)
from robomech_ros._kernels.tolerances import ORIENTATION_TOLERANCE, POSITION_TOLERANCE

NOT_NEW = -1


@inline
def _stretch(data, packed, weights, T):
    """Return the distance of the target over the length of the arm, at least 1.

    It is 1 if every slide has limits.
    """
    square = 0.0
    for k in range(3):
        away = T[k, 3] - packed[0, 10 + k]
        square += weights[3 + k] * away * away
    return max(1.0, math.sqrt(square) / data[at.FAR_LENGTH])


@inline
def _start(seed, number, rows, stretch, q):
    """Write the start of an attempt: the seed first, then a low-discrepancy sequence in the box.

    The range of a slide with one limit is stretched away from it, that of one without in both
    directions.
    """
    n = q.shape[0]
    for i in range(n):
        if number == 0:
            q[i] = min(max(seed[i], rows[0, i]), rows[1, i])
            continue
        part = 0.5 + number * rows[4, i]
        part -= math.floor(part)
        if stretch == 1.0 or rows[5, i] != 0.0 or rows[1, i] - rows[0, i] < math.inf:
            q[i] = rows[2, i] + rows[3, i] * part
        elif rows[0, i] > -math.inf:
            q[i] = rows[0, i] + stretch * rows[3, i] * part
        elif rows[1, i] < math.inf:
            q[i] = rows[1, i] - stretch * rows[3, i] * part
        else:
            q[i] = stretch * (rows[2, i] + rows[3, i] * part)


@inline
def _wrap(rows, q):
    """Wrap the angles of turning joints into (-pi, pi]."""
    for i in range(q.shape[0]):
        if rows[5, i] != 0.0:
            angle = q[i] - 2.0 * math.pi * math.floor(q[i] / (2.0 * math.pi) + 0.5)
            q[i] = math.pi if angle <= -math.pi else angle


@inline
def _distance(rows, p, q):
    """Return the largest difference of two postures, angles modulo a turn."""
    largest = 0.0
    for i in range(q.shape[0]):
        difference = abs(q[i] - p[i])
        if rows[5, i] != 0.0:
            difference = min(difference, 2.0 * math.pi - difference)
        largest = max(largest, difference)
    return largest


@inline
def _enter(data, rows, q, sharp, solutions, marks, found):
    """Enter q unless it is listed; return the number of solutions, or NOT_NEW.

    Loose tolerances admit a whole neighbourhood of a posture, of which one solution is entered,
    preferably a sharp one.  Two sharp ones are different solutions at a smaller distance.
    """
    for k in range(found):
        both = sharp and marks[k] != 0.0
        least = data[at.MIN_SHARP_DISTANCE] if both else data[at.MIN_DISTANCE]
        if (both or not sharp) and _distance(rows, q, solutions[k]) < least:
            return NOT_NEW
    kept = 0
    for k in range(found):
        if sharp and marks[k] == 0.0 and _distance(rows, q, solutions[k]) < data[at.MIN_DISTANCE]:
            continue
        marks[kept] = marks[k]
        for i in range(q.shape[0]):
            solutions[kept, i] = solutions[k, i]
        kept += 1
    marks[kept] = 1.0 if sharp else 0.0
    for i in range(q.shape[0]):
        solutions[kept, i] = q[i]
    return kept + 1


@inline
def _norms(e, weights):
    """Return the weighted position error (m) and orientation error (rad)."""
    angular = 0.0
    linear = 0.0
    for k in range(3):
        angular += weights[k] * e[k] * e[k]
        linear += weights[k + 3] * e[k + 3] * e[k + 3]
    return math.sqrt(linear), math.sqrt(angular)


@kernel(i8(IN1, IN2, IN1, i8, i8, OUT2, i8, OUT1))
def search(data, T, seed, first, restarts, q, found, state):
    """Make attempts ``first`` to ``first + restarts - 1`` at the pose T (4, 4).

    Attempt 0 starts from ``seed`` (n,), the others from a low-discrepancy sequence.  New
    solutions are appended to the ``found`` ones in q (MAX, n).  Returns the number of solutions.
    ``state`` (4 + n + MAX,) is passed from call to call: start with zeros and an infinite best
    score.
    """
    n = int(data[at.JOINTS])
    rows = data[at.ROWS : at.ROWS + at.N_ROWS * n].reshape(at.N_ROWS, n)
    packed = data[at.ROWS + at.N_ROWS * n :].reshape(-1, int(data[at.WIDTH]))
    weights = data[at.WEIGHTS : at.WEIGHTS + 6]
    limit = min(int(data[at.MAX_SOLUTIONS]), q.shape[0])
    x = np.empty(n)
    current, e = np.empty((4, 4)), np.empty(6)
    space = Space(
        np.empty((6, n)),
        current,
        e,
        np.empty((n, n)),
        np.empty((n + 1, n)),
        np.empty((4, n)),
        np.empty(n, dtype=np.int64),
    )
    stretch = _stretch(data, packed, weights, T)
    for number in range(first, first + restarts):
        if found >= limit or (found > 0 and state[at.IDLE] >= data[at.PATIENCE]):
            break
        _start(seed, number, rows, stretch, x)
        unit = data[at.UNIT] / (stretch * stretch)
        most = int(data[at.ITERATIONS])
        attempt(packed, T, x, rows[0], rows[1], weights, unit, stretch, most, data[at.STALL], space)
        forward_body(packed, x, current)
        pose_difference(T, current, e)
        linear, angular = _norms(e, weights)
        score = max(linear / data[at.POSITION_TOLERANCE], angular / data[at.ORIENTATION_TOLERANCE])
        _wrap(rows, x)
        state[at.IDLE] += 1.0
        if score < state[at.BEST_SCORE]:
            state[at.BEST_SCORE] = score
            state[at.BEST_POSITION] = linear
            state[at.BEST_ORIENTATION] = angular
            for i in range(n):
                state[at.BEST_Q + i] = x[i]
        if score <= 1.0:
            sharp = linear <= POSITION_TOLERANCE and angular <= ORIENTATION_TOLERANCE
            more = _enter(data, rows, x, sharp, q, state[at.BEST_Q + n :], found)
            if more != NOT_NEW:
                found = more
                state[at.IDLE] = 0.0
    return found


@part(i8(IN1, IN2, IN1, OUT2, IOUT1))
def solve_iterative(data, T, seed, q, branch):
    """Write the solutions for the pose T (4, 4) to q (MAX, n); return their number."""
    state = np.zeros(at.BEST_Q + int(data[at.JOINTS]) + q.shape[0])
    state[at.BEST_SCORE] = math.inf
    found = search(data, T, seed, 0, int(data[at.RESTARTS]), q, 0, state)
    for k in range(found):
        branch[k] = 0
    return found
