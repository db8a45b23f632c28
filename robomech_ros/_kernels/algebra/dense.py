"""Solution of small dense linear systems; numba's own linear algebra would load SciPy."""

import math

from robomech_ros._kernels.compiling.jit import flat, lean


@lean
def cholesky_solve(A, b, n):
    """Solve A x = b for a symmetric positive definite A (n, n), and overwrite b with x.

    Only the lower triangle of A is read; the Cholesky factor overwrites it.  Returns False, with
    b invalid, if A is not positive definite to working precision.
    """
    for j in range(n):
        pivot = A[j, j]
        for k in range(j):
            pivot -= A[j, k] * A[j, k]
        if not pivot > 0.0:
            return False
        root = math.sqrt(pivot)
        inverse = 1.0 / root
        A[j, j] = inverse
        value = b[j]
        for k in range(j):
            value -= A[j, k] * b[k]
        b[j] = value * inverse
        for i in range(j + 1, n):
            value = A[i, j]
            for k in range(j):
                value -= A[i, k] * A[j, k]
            A[i, j] = value * inverse
    _backwards(A, b, n)
    return True


@lean
def _backwards(A, b, n):
    """Solve with the transposed Cholesky factor, whose diagonal is stored inverted."""
    for j in range(n - 1, -1, -1):
        value = b[j]
        for k in range(j + 1, n):
            value -= A[k, j] * b[k]
        b[j] = value * A[j, j]


@lean
def cholesky_again(A, b, n):
    """Solve with the factor that :func:`cholesky_solve` left in A."""
    for j in range(n):
        value = b[j]
        for k in range(j):
            value -= A[j, k] * b[k]
        b[j] = value * A[j, j]
    _backwards(A, b, n)


@flat
def factored(A, order, least):
    """Replace A (n, n) by its factors L U, with inverted pivots on the diagonal.

    ``order`` (n,) receives the pivot rows.  Returns False if a pivot is not above ``least``.
    """
    n = A.shape[0]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[best, k]):
                best = i
        order[k] = best
        if not abs(A[best, k]) > least:
            return False
        if best != k:
            for j in range(n):
                A[k, j], A[best, j] = A[best, j], A[k, j]
        inverse = 1.0 / A[k, k]
        for i in range(k + 1, n):
            A[i, k] *= inverse
            for j in range(k + 1, n):
                A[i, j] -= A[i, k] * A[k, j]
        A[k, k] = inverse
    return True


@flat
def solve_factored(A, order, b):
    """Solve with the factors that :func:`factored` left in A, and overwrite b (n,) with x."""
    n = A.shape[0]
    for k in range(n):
        b[k], b[order[k]] = b[order[k]], b[k]
    for k in range(n):
        for i in range(k + 1, n):
            b[i] -= A[i, k] * b[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= A[k, j] * b[j]
        b[k] *= A[k, k]
