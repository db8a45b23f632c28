"""Motion of a trunk and its legs of three joints while some feet are fixed to the ground."""

import math

import numpy as np

from robomech_ros._kernels.algebra.dense import cholesky_solve, factored, solve_factored
from robomech_ros._kernels.chain.jacobian_rates import rate_body
from robomech_ros._kernels.chain.serial import NOT_FINITE, OK, jacobian_body
from robomech_ros._kernels.compiling.jit import kernel, lean, linked, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IN3, OUT1, OUT2, i8
from robomech_ros._kernels.dynamics.floating import floating_inverse, floating_mass
from robomech_ros._kernels.dynamics.forward import SINGULAR
from robomech_ros._kernels.dynamics.inverse import three
from robomech_ros._kernels.spatial.vectors import combined, cross, lower, mixed

# Status: a standing leg may be singular; the caller must check its singular values.
DOUBTFUL = 1
# Least singular value that is not zero, relative to the largest.
ZERO = 1e-9

_inverse, _mass = linked(floating_inverse), linked(floating_mass)


@lean
def _is_regular(J, A):
    """Return whether the lower half of J (6, 3), with factors A, is proved to be regular.

    Its determinant is the product of the singular values; none exceeds the Frobenius norm.
    """
    squares = 0.0
    for i in range(3, 6):
        for j in range(3):
            squares += J[i, j] * J[i, j]
    return ZERO * squares**1.5 * abs(A[0, 0] * A[1, 1] * A[2, 2]) < 1.0


@lean
def _negative_contact_rows(foot, rows):
    """Write the matrix (3, 6) from the twist of the trunk to the negative velocity of a foot."""
    x, y, z = foot
    rows[0, 1], rows[0, 2] = -z, y
    rows[1, 0], rows[1, 2] = z, -x
    rows[2, 0], rows[2, 1] = -y, x
    for i in range(3):
        rows[i, 3 + i] = -1.0


@lean
def _plant(packed, q, w, rows, rates, drift):
    """Write rows (3, 6) of N, rates and drift (3,) of a standing leg; return OK or DOUBTFUL."""
    J, T, changes = scratch(6, 3), scratch(4, 4), scratch(6, 3)
    A, order = scratch(3, 3), scratch_integers(3)
    if jacobian_body(packed, q, J, T) != OK:
        return DOUBTFUL
    for i in range(3):
        for j in range(3):
            A[i, j] = J[3 + i, j]
    if not factored(A, order, 0.0):
        return DOUBTFUL
    foot, turn = (T[0, 3], T[1, 3], T[2, 3]), three(w, 0)
    _negative_contact_rows(foot, rows)
    for i in range(3):
        rates[i] = 0.0
    for j in range(6):
        solve_factored(A, order, rows[:, j])
        for i in range(3):
            rates[i] += rows[i, j] * w[j]
    rate_body(J, rates, changes)
    bent = mixed(rates, lower(changes, 0), lower(changes, 1), lower(changes, 2))
    turned = cross(turn, combined(cross(turn, foot), three(w, 3), 1.0))
    drift[0], drift[1], drift[2] = combined(turned, bent, -1.0)
    solve_factored(A, order, drift)
    return OK if _is_regular(J, A) else DOUBTFUL


@kernel(i8(IN3, IN2, IIN1, IN1, OUT2, OUT2))
def planted_legs(packed, q, stands, w, N, motion):
    """Write the complement N (6 + 3 k, 6 + 3 m) of k legs, m in the air; return OK or DOUBTFUL.

    ``stands`` (k,) are 0 for legs in the air, w (6 + 3 m,) are the twist of the trunk and rates of
    these legs.  ``motion`` (2, 6 + 3 k) gets the rates N w, and their derivative for constant w.
    """
    N[:] = 0.0
    motion[:] = 0.0
    for j in range(6):
        N[j, j], motion[0, j] = 1.0, w[j]
    status, column = OK, 6
    for k in range(q.shape[0]):
        first = 6 + 3 * k
        last = first + 3
        if stands[k]:
            rows, rates, drift = N[first:last, :6], motion[0, first:last], motion[1, first:last]
            status |= _plant(packed[k], q[k], w, rows, rates, drift)
            continue
        for i in range(3):
            N[first + i, column + i], motion[0, first + i] = 1.0, w[column + i]
        column += 3
    return status


@lean
def _add_transposed_product(A, B, out):
    """Add A^T B to out, skipping the many zeros of A."""
    for k in range(A.shape[0]):
        for i in range(A.shape[1]):
            factor = A[k, i]
            if factor != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += factor * B[k, j]


@kernel(i8(IN3, IN2, IN1, IN2, IN2, IN2, OUT1))
def planted_forward(models, q, torques, around, N, motion, out):
    """Write accelerations (6 + 3 k,), then the forces on the feet (3 k,), to out.

    N and ``motion`` are from :func:`planted_legs`; the others are as for :func:`floating_inverse`.
    """
    n, free = N.shape
    M, left = np.empty((n, n)), np.empty((n, 1))
    MN, H, changes = np.zeros((n, free)), np.zeros((free, free)), np.zeros((free, 1))
    status = _inverse(models, q, motion[0], motion[1], around, out[:n]) | _mass(models, q, M)
    for i in range(n):
        left[i, 0] = (torques[i - 6] if i >= 6 else 0.0) - out[i]
    _add_transposed_product(M, N, MN)
    _add_transposed_product(N, MN, H)
    _add_transposed_product(N, left, changes)
    if not cholesky_solve(H, changes[:, 0], free):
        return status | SINGULAR
    for i in range(n):
        out[i] = motion[1, i]
        for j in range(free):
            out[i] += N[i, j] * changes[j, 0]
            left[i, 0] -= MN[i, j] * changes[j, 0]
    # Columns of N are the negative inverse Jacobians of standing legs, or zero.
    for i in range(6, n):
        first = i - i % 3
        force = 0.0
        for j in range(first, first + 3):
            force += N[j, 3 + i % 3] * left[j, 0]
        out[n + i - 6] = force
    for value in out:
        if not math.isfinite(value):
            status |= NOT_FINITE
    return status
