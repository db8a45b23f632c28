"""Tracking of a pose to new leg lengths, with each step proved by Kantorovich's theorem.

In the frame of the platform, with g_0 = -w . tau as a seventh equation, the conditions of the legs
(see :mod:`robomech_ros._kernels.parallel.series`) are quadratic: their second derivatives are
constant, and the bounds of the theorem are exact.  With h = |J^-1 F''| |J^-1 F| <= 1/2 there is
one solution in the ball of radius (1 - sqrt(1 - 2 h)) / |J^-1 F''|; the pose moves to it while the
lengths change.

References
----------
Ortega, The Newton-Kantorovich theorem, American Mathematical Monthly 75 (1968), pp. 658-660.
"""

import math

from robomech_ros._kernels.algebra.dense import solve_factored
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, i8
from robomech_ros._kernels.parallel.newton import eliminate, newton, rows

# Status if a singularity is on the path, and if no further step can be proved.
SINGULAR, _UNPROVED = -1, -2

# Part of the largest provable step, and the least step, of the whole path.  As steps decrease with
# the square of the regularity, the latter can fall far below _SINGULAR.
_PART, _LEAST_STEP = 0.9, 1e-13
_STEPS = 2000
# Least ratio of norms, 1 / (|J| |J^-1|), of a pose that is not singular.
_SINGULAR = 2e-6
# Rounding error of the distance of a step, of the size.
_ROUNDING = 1e-9


@lean
def _curvature_norm(B, J, inverse, r, H):
    """Return the Frobenius norm |J^-1 F''|."""
    for k in range(6):
        d = J[k, 0], J[k, 1], J[k, 2]
        b = B[k, 0], B[k, 1], B[k, 2]
        a = b[0] - d[0], b[1] - d[1], b[2] - d[2]
        inner = 2.0 * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - r[k])
        H[k, 0] = 2.0
        for j in range(3):
            H[k, 1 + j] = a[j] + b[j]
            H[k, 4 + j] = inner - 2.0 * a[j] * b[j]
            H[k, 10 + j] = d[j]
        H[k, 7] = -(a[0] * b[1] + a[1] * b[0])
        H[k, 8] = -(a[1] * b[2] + a[2] * b[1])
        H[k, 9] = -(a[2] * b[0] + a[0] * b[2])
    # The seventh equation: two blocks of ones.
    total = 6.0
    for i in range(6):
        for j in range(13):
            value = 0.0
            for k in range(6):
                value += inverse[k, i] * H[k, j]
            # Number of times that an entry occurs in F'': four for tau . tau and g_0^2, and for
            # the cross product; one for squares of w; two for products of w, and of g_0 and w.
            often = 4.0 if j < 4 else 1.0 if j < 7 else 2.0
            total += often * value * value
    return math.sqrt(total)


@lean
def _distance(start, pose):
    """Return the distance of two poses, as the length of (tau, w, g_0) in the frame of one."""
    trace = 1.0
    for i in range(9):
        trace += start[i] * pose[i]
    if not trace > 1e-6:
        return math.inf
    p, w = scratch(3), scratch(3)
    for i in range(3):
        p[i] = 0.0
        for j in range(3):
            p[i] += start[3 * j + i] * (pose[9 + j] - start[9 + j])
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        value = 0.0
        for m in range(3):
            value += start[3 * m + k] * pose[3 * m + j] - start[3 * m + j] * pose[3 * m + k]
        w[i] = value / trace
    total = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        tau = 0.5 * (p[i] + p[j] * w[k] - p[k] * w[j])
        total += tau * tau
    g = 0.5 * (p[0] * w[0] + p[1] * w[1] + p[2] * w[2])
    return math.sqrt(total + g * g)


@lean
def _inverted(J, order, inverse):
    """Write the transposed inverse from the factors."""
    for i in range(6):
        for j in range(6):
            inverse[i, j] = 1.0 if i == j else 0.0
        solve_factored(J, order, inverse[i])


@lean
def _regularity(J, inverse):
    """Return 1 / (|J| |J^-1|) with Frobenius norms."""
    one, other = 0.0, 0.0
    for i in range(6):
        for j in range(6):
            one += J[i, j] * J[i, j]
            other += inverse[i, j] * inverse[i, j]
    return 1.0 / math.sqrt(one * other)


@kernel(i8(IN2, IN2, IN1, OUT1, OUT1))
def follow(A, B, lengths, pose, report):
    """Move a pose (12,) in place until it has the leg lengths (6,).

    Points are of order one.  The squared lengths move along a line.  ``report`` (2,) receives the
    travelled part of this path, and the regularity at its end.  Returns the number of steps, or a
    negative status.
    """
    J, order, factors = scratch(6, 6), scratch_integers(6), scratch(6, 6)
    H, inverse = scratch(6, 13), scratch(6, 6)
    now, b, r = scratch(6), scratch(6), scratch(6)
    first, start, aim = scratch(6), scratch(12), scratch(6)
    rows(A, B, pose, J, first)
    done, longest, regularity = 0.0, 1.0, 0.0
    for taken in range(1, _STEPS + 1):
        rows(A, B, pose, J, now)
        factors[:] = J
        b[:] = 0.0
        if not eliminate(factors, b, order):
            regularity = 0.0
            break
        _inverted(factors, order, inverse)
        regularity = _regularity(J, inverse)
        step = min(1.0 - done, longest)
        while step >= _LEAST_STEP or step == 1.0 - done:
            for k in range(6):
                share = done + step
                squared = first[k] + share * (lengths[k] * lengths[k] - first[k])
                if step == 1.0 - done:
                    squared = lengths[k] * lengths[k]
                aim[k] = math.sqrt(squared)
                r[k] = 0.25 * (squared - now[k])
                b[k] = r[k]
            solve_factored(factors, order, b)
            size = 0.0
            for k in range(6):
                size += b[k] * b[k]
            size = math.sqrt(size)
            bend = _curvature_norm(B, J, inverse, r, H)
            if bend * size <= 0.5:
                break
            step *= max(0.1, min(_PART, 0.5 * _PART / (bend * size)))
        else:
            break
        start[:] = pose
        error = newton(A, B, aim, pose)
        radius = (1.0 - math.sqrt(1.0 - 2.0 * bend * size)) / bend
        if not error >= 0.0 or _distance(start, pose) > radius * (1.0 + _ROUNDING) + _ROUNDING:
            pose[:] = start
            longest = 0.5 * step
            if longest < _LEAST_STEP:
                break
            continue
        longest = 1.0
        if step == 1.0 - done:
            report[0], report[1] = 1.0, regularity
            return taken
        done += step
    report[0], report[1] = done, regularity
    return SINGULAR if regularity < _SINGULAR else _UNPROVED
