"""Small dense solves written out, since numba's own linear algebra loads SciPy."""

import math

from robomech_ros._kernels.compiling.jit import lean


@lean
def cholesky_solve(A, b, n):
    """Solve A x = b for a symmetric positive definite A (n, n), the result in place of b.

    The lower triangle of A is read and overwritten by the Cholesky factor.  Returns False, with
    b spoilt, where A is not positive definite to working precision.
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
    """Solve with the transposed Cholesky factor, the inverses of its diagonal in place of it."""
    for j in range(n - 1, -1, -1):
        value = b[j]
        for k in range(j + 1, n):
            value -= A[k, j] * b[k]
        b[j] = value * A[j, j]


@lean
def cholesky_again(A, b, n):
    """Solve once more with the factor that :func:`cholesky_solve` has left in A."""
    for j in range(n):
        value = b[j]
        for k in range(j):
            value -= A[j, k] * b[k]
        b[j] = value * A[j, j]
    _backwards(A, b, n)
