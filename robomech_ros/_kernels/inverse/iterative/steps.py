"""One attempt of the iterative solver: damped Newton steps inside the joint limits."""

import math
from typing import Any, NamedTuple

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.chain.coupling import drive_count, drive_kind
from robomech_ros._kernels.chain.layout import SLIDE
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import inline
from robomech_ros._kernels.compiling.types import ZERO
from robomech_ros._kernels.inverse.polishing import pose_difference

# Damping at the start of an attempt, over the squared error: a short gradient step then becomes a
# Newton step as the error vanishes.
ATTEMPT_DAMPING = 0.1
# Least damping after successful steps.
ATTEMPT_MIN_DAMPING = 1e-4
# Longest change of a joint (rad or m) in one step: linearisation fails beyond a radian.
ATTEMPT_STEP = 1.0
# Squared error at which an attempt ends: 1e-13 in rad and in units of half the arm's length.
CONVERGED = 1e-26
# The same for a far target, for which that unit is long: rounding.
CONVERGED_FAR = 1e-30


@inline
def _correct_for_partial_orientation(J, e, n):
    """Convert the angular rows of J to rates of the rotation vector.

    This matters only if a component of the rotation vector is free and large; for a full
    orientation the step is the same.
    """
    x, y, z = e[0], e[1], e[2]
    square = x * x + y * y + z * z
    if square < 1e-12:
        return
    angle = math.sqrt(square)
    half = 0.5 * angle
    factor = (1.0 - half / math.tan(half)) / square
    for i in range(n):
        u, v, w = J[0, i], J[1, i], J[2, i]
        cu = y * w - z * v
        cv = z * u - x * w
        cw = x * v - y * u
        J[0, i] = u + 0.5 * cu + factor * (y * cw - z * cv)
        J[1, i] = v + 0.5 * cv + factor * (z * cu - x * cw)
        J[2, i] = w + 0.5 * cw + factor * (x * cv - y * cu)


@inline
def _bounded_step(H, g, q, lower, upper, damping, scales, n, A, step, free):
    """Solve (H + damping D) step = g with q + step inside the limits.

    D is diagonal, with the squares of ``scales`` (n,).  Joints at a limit do not leave it.
    """
    for i in range(n):
        free[i] = 1
        if (q[i] <= lower[i] and g[i] < 0.0) or (q[i] >= upper[i] and g[i] > 0.0):
            free[i] = 0
            step[i] = 0.0
    for _ in range(n + 1):
        m = ZERO
        b = A[n]
        for i in range(n):
            if free[i] == 0:
                continue
            value = g[i]
            for j in range(n):
                if free[j] == 0:
                    value -= H[i, j] * step[j]
            b[m] = value
            c = 0
            for j in range(i):
                if free[j] == 1:
                    A[m, c] = H[i, j]
                    c += 1
            A[m, m] = H[i, i] + damping * scales[i] * scales[i]
            m += 1
        if m == 0:
            return True
        if not cholesky_solve(A, b, m):
            return False
        m = ZERO
        inside = True
        for i in range(n):
            if free[i] == 0:
                continue
            value = b[m]
            m += 1
            if q[i] + value < lower[i]:
                value = lower[i] - q[i]
                free[i] = 0
                inside = False
            elif q[i] + value > upper[i]:
                value = upper[i] - q[i]
                free[i] = 0
                inside = False
            step[i] = value
        if inside:
            return True
    return True


class Space(NamedTuple):
    """Working space of an attempt.

    The Jacobian J (6, n), the pose (4, 4) and its error (6,), the normal equations H (n, n), their
    rows A (n + 1, n) for free joints, vectors (4, n), and 1 for free joints (n,).
    """

    J: Any
    pose: Any
    error: Any
    H: Any
    A: Any
    vectors: Any
    free: Any


@inline
def _fill_normal_equations(J, e, weights, unit, n, H, g):
    """Write the weighted J^T J to H (n, n) and J^T e to g (n,)."""
    for i in range(n):
        value = 0.0
        for k in range(3):
            value += weights[k] * J[k, i] * e[k]
            value += unit * weights[k + 3] * J[k + 3, i] * e[k + 3]
        g[i] = value
        for j in range(i + 1):
            value = 0.0
            for k in range(3):
                value += weights[k] * J[k, i] * J[k, j]
                value += unit * weights[k + 3] * J[k + 3, i] * J[k + 3, j]
            H[i, j] = value
            H[j, i] = value


@inline
def attempt(packed, T, q, lower, upper, weights, unit, stretch, iterations, stall, space):
    """Improve q (n,) in place inside the limits until it converges or stalls.

    The angular weights are 0 or 1; the linear ones are scaled by ``unit`` (1/m^2).  The
    displacement of a slide is divided by ``stretch``.  Returns the squared weighted error.
    """
    n = drive_count(packed)
    J, current, e, H, A, v, free = space
    g = v[0]
    step = v[1]
    kept = v[2]
    scales = v[3]
    for i in range(n):
        scales[i] = 1.0 / stretch if drive_kind(packed, i) == SLIDE else 1.0
    converged = max(CONVERGED / (stretch * stretch), CONVERGED_FAR)
    best = math.inf
    damping = ATTEMPT_DAMPING
    partial = weights[0] * weights[1] * weights[2] == 0.0
    checkpoint = math.inf
    for iteration in range(iterations):
        jacobian_body(packed, q, J, current)
        pose_difference(T, current, e)
        error = 0.0
        for k in range(3):
            error += weights[k] * e[k] * e[k] + unit * weights[k + 3] * e[k + 3] * e[k + 3]
        if error < best:
            best = error
            for i in range(n):
                kept[i] = q[i]
            if error < converged:
                break
            damping = max(0.25 * damping, ATTEMPT_MIN_DAMPING)
            if partial:
                _correct_for_partial_orientation(J, e, n)
            _fill_normal_equations(J, e, weights, unit, n, H, g)
        else:
            damping *= 8.0
        if iteration % 6 == 5:
            if best > stall * checkpoint:
                break
            checkpoint = best
        shift = damping * best + 1e-16
        if not _bounded_step(H, g, kept, lower, upper, shift, scales, n, A, step, free):
            damping *= 8.0
            continue
        longest = 0.0
        for i in range(n):
            longest = max(longest, scales[i] * abs(step[i]))
        scale = 1.0 if longest <= ATTEMPT_STEP else ATTEMPT_STEP / longest
        for i in range(n):
            q[i] = min(max(kept[i] + scale * step[i], lower[i]), upper[i])
    for i in range(n):
        q[i] = kept[i]
    return best
