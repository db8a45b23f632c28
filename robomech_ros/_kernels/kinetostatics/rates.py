"""Joint rates that move the tip link with a given twist of one of its points.

For six joints they come from elimination, with a spherical wrist in two systems of three: the
velocity of the wrist centre gives the rates of the arm, and the remaining angular velocity those of
the wrist.  The determinant bounds the least singular value from below.  If this bound does not
exclude a singularity, and for all other arms, singular values give the rates of least norm, or of
least error of the twist.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.3.  Yu and Gu, A note on a
lower bound for the smallest singular value, Linear Algebra and its Applications 253, 1997.
"""

import math

import numpy as np

from robomech_ros._kernels.algebra.dense import factored, solve_factored
from robomech_ros._kernels.algebra.singular_values import make_rows_orthogonal
from robomech_ros._kernels.chain.jacobian_points import move_jacobian
from robomech_ros._kernels.chain.serial import jacobian_body
from robomech_ros._kernels.compiling.jit import inline, kernel, lean, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT2, f8, i8
from robomech_ros._kernels.spatial.vectors import (
    combined,
    cramer,
    cross,
    lower,
    scaled,
    times,
    upper,
)
from robomech_ros._kernels.tolerances import RANK


@lean
def _move(J, i, r):
    """Return the velocity caused by joint i at the vector r from the reference point of J."""
    return combined(lower(J, i), cross(upper(J, i), r), 1.0)


@lean
def _reciprocal(a, b, c, d, x, first):
    """Write the solution of [a b c] x = d to x from entry `first` on; return the determinant."""
    determinant, found = cramer(a, b, c, d)
    if determinant != 0.0:
        x[first], x[first + 1], x[first + 2] = scaled(found, 1.0 / determinant)
    return determinant


@lean
def _through_wrist(J, r, b, x):
    """Solve J x = b for an arm whose last three axes meet at the vector r; return det J."""
    centre = combined((b[3], b[4], b[5]), cross(b, r), 1.0)
    arm = _reciprocal(_move(J, 0, r), _move(J, 1, r), _move(J, 2, r), centre, x, 0)
    if arm == 0.0:
        return 0.0
    left = combined(b, times(J, (x[0], x[1], x[2])), -1.0)
    return arm * _reciprocal(upper(J, 3), upper(J, 4), upper(J, 5), left, x, 3)


@lean
def _eliminated(J, b, x):
    """Solve J x = b, 6 x 6, by elimination with partial pivoting; return det J."""
    A, order = scratch(6, 6), scratch_integers(6)
    for i in range(6):
        x[i] = b[i]
        for k in range(6):
            A[i, k] = J[i, k]
    if not factored(A, order, 0.0):
        return 0.0
    solve_factored(A, order, x)
    determinant = 1.0
    for k in range(6):
        determinant *= (1.0 if order[k] == k else -1.0) / A[k, k]
    return determinant


@lean
def _is_regular(J, determinant, length, damping):
    """Return whether the least singular value is proved to be neither damped nor zero.

    The product of the other five is at most their mean square to the power of 5/2.
    """
    square = 0.0
    for k in range(6):
        for i in range(3):
            square += J[i, k] * J[i, k] + J[3 + i, k] * J[3 + i, k] / (length * length)
    least = abs(determinant) / length**3 * (5.0 / square) ** 2.5 if square > 0.0 else 0.0
    return least > max(damping, RANK * math.sqrt(square))


@inline
def _by_singular_values(J, b, length, damping, W, x):
    """Solve J x = b by singular values; damp those below `damping` and ignore zeros.

    W (k, 6 + n), k the smaller of 6 and n, is working space.
    """
    n = J.shape[1]
    small, large = W.shape[0], W.shape[1] - W.shape[0]
    wide = n >= 6
    for i in range(small):
        for k in range(large):
            row, column = (i, k) if wide else (k, i)
            W[i, k] = J[row, column] if row < 3 else J[row, column] / length
        for k in range(small):
            W[i, large + k] = 1.0 if i == k else 0.0
    make_rows_orthogonal(W, large)
    largest = 0.0
    for i in range(small):
        square = 0.0
        for k in range(large):
            square += W[i, k] * W[i, k]
        largest = max(largest, square)
    for k in range(n):
        x[k] = 0.0
    for i in range(small):
        square, along = 0.0, 0.0
        for k in range(large):
            square += W[i, k] * W[i, k]
        for k in range(6):
            value = b[k] if k < 3 else b[k] / length
            along += value * (W[i, large + k] if wide else W[i, k])
        if square < damping * damping:
            along /= damping * damping
        elif square > RANK * RANK * largest:
            along /= square
        else:
            along = 0.0
        for k in range(n):
            x[k] += along * (W[i, k] if wide else W[i, large + k])


@inline
def _rates(J, b, r, spherical, length, damping, W, x):
    """Solve J x = b by the fastest method that is accurate."""
    if J.shape[1] == 6:
        determinant = _through_wrist(J, r, b, x) if spherical else _eliminated(J, b, x)
        if _is_regular(J, determinant, length, damping):
            return
    _by_singular_values(J, b, length, damping, W, x)


@kernel(i8(IN2, i8, IN1, IN1, f8, f8, IN2, IN2, IN2, OUT2))
def joint_rates(packed, spherical, wrist, point, length, damping, q, twist, secondary, out):
    """Write joint rates for q (m, n) and twists (m, 6) of a point, in base axes, to out (m, n).

    In the tip frame, ``wrist`` is the intersection of the last three axes, if they meet, and
    ``point`` the point with the twist.  Rates ``secondary`` (m, n), or (0, n) for none, are added
    and their effect on the tip compensated.
    """
    n = q.shape[1]
    small, large = min(6, n), max(6, n)
    J, T = np.empty((6, n)), np.empty((4, 4))
    W, b = np.empty((small, small + large)), np.empty(6)
    status = 0
    for k in range(q.shape[0]):
        if jacobian_body(packed, q[k], J, T):
            status = 1
            continue
        move_jacobian(J, T, point)
        for i in range(6):
            b[i] = twist[k, i]
            if secondary.shape[0] > 0:
                for j in range(n):
                    b[i] -= J[i, j] * secondary[k, j]
        r = times(T, combined(wrist, point, -1.0))
        _rates(J, b, r, spherical != 0, length, damping, W, out[k])
        if secondary.shape[0] > 0:
            for j in range(n):
                out[k, j] += secondary[k, j]
    return status
