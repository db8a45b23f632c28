"""Singular values of small matrices, all to the same relative accuracy."""

import math

from robomech_ros._kernels.compiling.jit import inline

# Least ratio of the smallest to the largest singular value of a regular Jacobian.
SINGULAR = 1e-12
# Cosine between two rows that count as orthogonal.
ROWS_ORTHOGONAL = 1e-15

# Largest number of sweeps over all pairs of rows; six rows need about five.
_SWEEPS = 30


@inline
def _rotate(W, i, j, a, b, c):
    """Turn rows i and j of W, with squared norms a, b and product c, until they are orthogonal."""
    ratio = (b - a) / (2.0 * c)
    t = 1.0 / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
    if ratio < 0.0:
        t = -t
    cosine = 1.0 / math.sqrt(1.0 + t * t)
    sine = cosine * t
    for k in range(W.shape[1]):
        x, y = W[i, k], W[j, k]
        W[i, k] = cosine * x - sine * y
        W[j, k] = sine * x + cosine * y


@inline
def make_rows_orthogonal(W, columns):
    """Turn the rows of W (r, c) by one-sided Jacobi rotations until they are orthogonal.

    Only the first `columns` (at least r) become orthogonal, but the rotations apply to all.  If
    the first are A, and the others a unit matrix, they become R A and R: rows of R are left
    singular vectors of A, rows of R A right singular vectors times singular values.
    """
    for _ in range(_SWEEPS):
        done = True
        for i in range(W.shape[0]):
            for j in range(i):
                a, b, c = 0.0, 0.0, 0.0
                for k in range(columns):
                    a += W[i, k] * W[i, k]
                    b += W[j, k] * W[j, k]
                    c += W[i, k] * W[j, k]
                if abs(c) > ROWS_ORTHOGONAL * math.sqrt(a * b):
                    done = False
                    _rotate(W, i, j, a, b, c)
        if done:
            break


@inline
def row_lengths(W, columns, out):
    """Write the lengths of the rows of W, over the first columns, to out (r,)."""
    for i in range(W.shape[0]):
        square = 0.0
        for k in range(columns):
            square += W[i, k] * W[i, k]
        out[i] = math.sqrt(square)


@inline
def condition_of(values):
    """Return the ratio of the largest to the least singular value; infinite if one is zero."""
    largest, least = 0.0, math.inf
    for value in values:
        largest = max(largest, value)
        least = min(least, value)
    return largest / least if least > SINGULAR * largest else math.inf
