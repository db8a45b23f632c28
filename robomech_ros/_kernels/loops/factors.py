"""Rates of a platform and of all joints of the chains that carry it.

Chain i moves the platform with ``J_p p + J_a a = t - d``: p and a are the rates of its passive and
actuated joints, t is the twist of the platform, and d an additional twist of the chain.  With
``J_p = Q [R; 0]``, the rows of Q' below R are wrenches that do no work on passive joints.  They
give ``K t = J a + ...``, the book's equation with six columns; then R gives p of each chain.

Chains are packed one after another, n_i + 1 rows each (see :mod:`..chain.serial`); ``starts`` has
the first joint of each, then the number of joints; ``drives`` has the drive of each joint, or -1.
Lengths are multiplied by ``scale``, so that all entries are of order one.
"""

import math
from collections import namedtuple

import numpy as np

from robomech_ros._kernels.chain.serial import OK, jacobian_body
from robomech_ros._kernels.compiling.jit import inline, lean

# Status: regular; the drives do not hold the platform; a limb has a self-motion; not finite.
REGULAR, SINGULAR, FREE, NOT_FINITE = 0, 1, 2, 3
# Least part of a column that must be independent of the columns before it.
_INDEPENDENT = 1e-10

Chains = namedtuple("Chains", ("packed", "starts", "drives", "scale"))

# For each limb the Jacobian J (6, w), the pose T (4, 4), R (6, w) and Q' (6, 6); and working space
# of the solver, A (6 limbs, 6) and B (6 limbs, c).
Factors = namedtuple("Factors", ("J", "T", "R", "Q", "A", "B"))


@lean
def widest(starts):
    """Return the largest number of joints of a limb."""
    n = 1
    for i in range(starts.size - 1):
        n = max(n, starts[i + 1] - starts[i])
    return n


@inline
def room_for_factors(starts, width):
    """Return room for the factors of all limbs, and for a solution with `width` columns."""
    limbs, n = starts.size - 1, widest(starts)
    return Factors(
        np.zeros((limbs, 6, n)),
        np.empty((limbs, 4, 4)),
        np.empty((limbs, 6, n)),
        np.empty((limbs, 6, 6)),
        np.empty((6 * limbs, 6)),
        np.empty((6 * limbs, width)),
    )


@lean
def _triangulate(A, B, rows, columns, width):
    """Reduce A (rows, columns) to an upper triangle by reflections, and apply them to B.

    Returns the least part of a column of A that is independent of the columns before it.
    """
    least = math.inf if columns <= rows else 0.0
    for c in range(min(columns, rows)):
        above, below = 0.0, 0.0
        for r in range(c):
            above += A[r, c] * A[r, c]
        for r in range(c, rows):
            below += A[r, c] * A[r, c]
        size = math.sqrt(below)
        if not size > 0.0:
            return 0.0
        least = min(least, size / math.sqrt(above + below))
        head = A[c, c]
        first = head + size if head > 0.0 else head - size
        factor = 1.0 / (size * abs(first))
        A[c, c] = first
        for j in range(c + 1, columns):
            dot = 0.0
            for r in range(c, rows):
                dot += A[r, c] * A[r, j]
            dot *= factor
            for r in range(c, rows):
                A[r, j] -= dot * A[r, c]
        for j in range(width):
            dot = 0.0
            for r in range(c, rows):
                dot += A[r, c] * B[r, j]
            dot *= factor
            for r in range(c, rows):
                B[r, j] -= dot * A[r, c]
        A[c, c] = head - first
    return least


@lean
def passive_count(drives, start, end):
    """Return the number of joints without a drive from start to before end."""
    k = 0
    for j in range(start, end):
        if drives[j] < 0:
            k += 1
    return k


@lean
def factors(chains, q, out):
    """Write the factors of all limbs for q (n,); return a status.  Lengths in J are scaled."""
    packed, starts, drives, scale = chains
    J, T, R, Q = out.J, out.T, out.R, out.Q
    status = REGULAR
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        if jacobian_body(packed[s + i : e + i + 1], q[s:e], J[i], T[i]) != OK:
            return NOT_FINITE
        k = 0
        for j in range(e - s):
            for r in range(3, 6):
                J[i, r, j] *= scale
            if drives[s + j] < 0:
                for r in range(6):
                    R[i, r, k] = J[i, r, j]
                k += 1
        for r in range(6):
            for j in range(6):
                Q[i, r, j] = 1.0 if r == j else 0.0
        if _triangulate(R[i], Q[i], 6, k, 6) < _INDEPENDENT:
            status = FREE
    return status


@lean
def solve(chains, found, rates, D, qd, t):
    """Solve for all joint rates qd (n, c) and twists t (6, c) of the platform.

    The inputs are factors, rates of the drives (m, c), and twists D (limbs, 6, c) with lengths in
    m, which are overwritten.  The array with the fewest columns sets c.  Returns a status.
    """
    starts, drives, scale = chains.starts, chains.drives, chains.scale
    J, R, Q, A, B = found.J, found.R, found.Q, found.A, found.B
    width, count = min(rates.shape[1], D.shape[2], B.shape[1], qd.shape[1], t.shape[1]), 0
    for i in range(starts.size - 1):
        s, e = starts[i], starts[i + 1]
        for c in range(width):
            for r in range(3, 6):
                D[i, r, c] *= scale
        k = 0
        for j in range(e - s):
            a = drives[s + j]
            if a < 0:
                k += 1
                continue
            for c in range(width):
                qd[s + j, c] = rates[a, c]
                for r in range(6):
                    D[i, r, c] += J[i, r, j] * rates[a, c]
        for row in range(k, 6):
            for j in range(6):
                A[count, j] = Q[i, row, j]
            for c in range(width):
                total = 0.0
                for j in range(6):
                    total += Q[i, row, j] * D[i, j, c]
                B[count, c] = total
            count += 1
    if _triangulate(A, B, count, 6, width) < _INDEPENDENT:
        return SINGULAR
    for c in range(width):
        for r in range(5, -1, -1):
            value = B[r, c]
            for j in range(r + 1, 6):
                value -= A[r, j] * t[j, c]
            t[r, c] = value / A[r, r]
    for i in range(starts.size - 1):
        _passive(starts[i], starts[i + 1], drives, R[i], Q[i], D[i], t, qd, width)
    for c in range(width):
        for r in range(3, 6):
            t[r, c] /= scale
    return REGULAR


@lean
def left_inverse(chains, found, S):
    """Write a left inverse (6, c) of the rows of Q' below R, limb by limb, to the top of S.

    Returns a status.
    """
    starts, drives, Q, A = chains.starts, chains.drives, found.Q, found.A
    count = 0
    for i in range(starts.size - 1):
        for row in range(passive_count(drives, starts[i], starts[i + 1]), 6):
            for j in range(6):
                A[count, j] = Q[i, row, j]
            count += 1
    for r in range(count):
        for c in range(count):
            S[r, c] = 1.0 if r == c else 0.0
    if _triangulate(A, S, count, 6, count) < _INDEPENDENT:
        return SINGULAR
    for c in range(count):
        for r in range(5, -1, -1):
            for j in range(r + 1, 6):
                S[r, c] -= A[r, j] * S[j, c]
            S[r, c] /= A[r, r]
    return REGULAR


@lean
def _passive(start, end, drives, R, Q, D, t, qd, width):
    """Write the rates of the passive joints of one limb, from the last to the first."""
    k = passive_count(drives, start, end)
    for c in range(width):
        row = k
        for j in range(end - 1, start - 1, -1):
            if drives[j] >= 0:
                continue
            row -= 1
            value = 0.0
            for m in range(6):
                value += Q[row, m] * (t[m, c] - D[m, c])
            # The rates of passive joints behind this one are known.
            column = k
            for other in range(end - 1, j, -1):
                if drives[other] < 0:
                    column -= 1
                    value -= R[row, column] * qd[other, c]
            qd[j, c] = value / R[row, row]


@lean
def loop_errors(T, scale, D):
    """Write the twist (limbs, 6, 1) from the first limb's end to the end of each limb.

    It is the axis times the sine of the angle, then the distance (m).  Returns the largest entry,
    with scaled lengths.
    """
    largest = 0.0
    for i in range(T.shape[0]):
        for r in range(3):
            j, k = (r + 1) % 3, (r + 2) % 3
            total = 0.0
            for c in range(3):
                total += T[0, j, c] * T[i, k, c] - T[0, k, c] * T[i, j, c]
            D[i, r, 0] = 0.5 * total
            D[i, 3 + r, 0] = T[i, r, 3] - T[0, r, 3]
            largest = max(largest, abs(D[i, r, 0]), abs(D[i, 3 + r, 0]) * scale)
    return largest
