"""The determinant whose zeros are the values of the hidden joint.

With E_2, E_1, E_0 (6, 3) the parts of the six equations for x^2, x and 1, x the half angle's
tangent of joint THIRD, the twelve equations ``E m = 0`` and ``x E m = 0`` are linear in the twelve
monomials of x^3, x^2, x, 1 and those of joint FOURTH::

    | E_2 E_1 E_0  0  |
    |  0  E_2 E_1 E_0 |

The first three columns are eliminated in the upper half and the last three in the lower half; a
matrix of six by six is left.  As a function of the hidden angle the determinant of every arm is a
trigonometric polynomial of order eight.
"""

import math

from robomech_ros._kernels.compiling.jit import inline

_TINY = 1e-300


@inline
def _eliminate(A, least):
    """Eliminate the first three columns of A (6, 9); return their determinant and least pivot."""
    value = 1.0
    for k in range(3):
        r = k
        best = abs(A[k, k])
        for i in range(k + 1, 6):
            size = abs(A[i, k])
            if size > best:
                best = size
                r = i
        if best < _TINY:
            return 0.0, 0.0
        if r != k:
            for j in range(9):
                A[k, j], A[r, j] = A[r, j], A[k, j]
            value = -value
        least = min(least, best)
        value *= A[k, k]
        inverse = 1.0 / A[k, k]
        for i in range(k + 1, 6):
            factor = A[i, k] * inverse
            for j in range(9):
                A[i, j] -= factor * A[k, j]
    return value, least


@inline
def reduced_matrix(E, cosine, sine, A, B, K):
    """Write the remaining matrix K (6, 6); return the eliminated factor and its least pivot."""
    for i in range(6):
        for j in range(9):
            value = E[i, j] * cosine + E[i, 9 + j] * sine + E[i, 18 + j]
            A[i, j] = value
            B[i, 8 - j] = value
    upper, least = _eliminate(A, math.inf)
    lower, least = _eliminate(B, least)
    for i in range(3):
        for j in range(6):
            K[i, j] = A[3 + i, 3 + j]
            K[3 + i, 5 - j] = B[3 + i, 3 + j]
    return upper * lower, least


@inline
def determinant(E, cosine, sine, A, B, K):
    """Return the determinant, the product of all pivots but the least, and a loss factor.

    That product, times the rounding of one pivot, is the rounding of the determinant.  Late pivots
    have the roundings of the earlier ones over the loss factor: the least pivot of the three by
    three eliminations times the least of the rest.
    """
    value, least = reduced_matrix(E, cosine, sine, A, B, K)
    early = least
    smallest = 1.0
    for k in range(5):
        r = k
        best = abs(K[k, k])
        for i in range(k + 1, 6):
            size = abs(K[i, k])
            if size > best:
                best = size
                r = i
        if best < _TINY:
            return 0.0, 0.0, max(early * smallest, _TINY)
        if r != k:
            for j in range(6):
                K[k, j], K[r, j] = K[r, j], K[k, j]
            value = -value
        least = min(least, best)
        if k < 4:
            smallest = min(smallest, best)
        value *= K[k, k]
        inverse = 1.0 / K[k, k]
        for i in range(k + 1, 6):
            factor = K[i, k] * inverse
            for j in range(k + 1, 6):
                K[i, j] -= factor * K[k, j]
    last = abs(K[5, 5])
    others = abs(value) if last <= least else abs(value) * (last / least)
    return value * K[5, 5], others, max(min(1.0, early) * smallest, _TINY)


@inline
def _solve_back(K, order, rank, x):
    """Solve the first ``rank`` rows of the triangular K for the entries of x (6,) not yet known."""
    for i in range(rank - 1, -1, -1):
        value = 0.0
        for j in range(i + 1, 6):
            value -= K[i, j] * x[order[j]]
        x[order[i]] = value / K[i, i] if abs(K[i, i]) > _TINY else 0.0


@inline
def null_space(K, x, u, v, order):
    """Write the null vector x (6,) of K (6, 6) and, for rank four, the null pencil u (6,), v (6,).

    K is overwritten.  Returns the last three pivots of an elimination with complete pivoting, over
    the first.
    """
    first, fourth, fifth = 1.0, 0.0, 0.0
    for i in range(6):
        order[i] = i
    for k in range(5):
        r, c, best = k, k, -1.0
        for i in range(k, 6):
            for j in range(k, 6):
                size = abs(K[i, j])
                if size > best:
                    r, c, best = i, j, size
        if k == 0:
            first = max(best, _TINY)
        fourth = fifth
        fifth = best
        if r != k:
            for j in range(6):
                K[k, j], K[r, j] = K[r, j], K[k, j]
        if c != k:
            for i in range(6):
                K[i, k], K[i, c] = K[i, c], K[i, k]
            order[k], order[c] = order[c], order[k]
        inverse = 1.0 / K[k, k] if best > _TINY else 0.0
        for i in range(k + 1, 6):
            factor = K[i, k] * inverse
            for j in range(k + 1, 6):
                K[i, j] -= factor * K[k, j]
    x[order[5]] = 1.0
    _solve_back(K, order, 5, x)
    u[order[4]], u[order[5]] = 0.0, 1.0
    _solve_back(K, order, 4, u)
    v[order[4]], v[order[5]] = 1.0, 0.0
    _solve_back(K, order, 4, v)
    return fourth / first, fifth / first, abs(K[5, 5]) / first
