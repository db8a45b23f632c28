"""Null vectors of a general arm's determinant if two postures have the same hidden angle.

The matrix then has rank four, and its null vectors are a pencil ``a u + b v``.  The vectors of
postures are products, ``s c (s, c)`` of one half angle times ``(s s, sqrt(2) s c, c c)`` of
another.  Products satisfy six quadratic equations, on a pencil quadratic equations in a : b.  A
common zero is one of the at most two zeros of the largest equation.
"""

import math

import numpy as np

from robomech_ros._kernels.compiling.jit import inline

# Equations this small on an orthonormal pencil are rounding: all its vectors are products.
PENCIL_VOID = 1e-4
# Value of these equations below which a vector may belong to a posture.
PENCIL_IS_PRODUCT = 5e-2

MAX_VECTORS = 4
# x_a x_b + w x_c x_d = 0: a, b, c, d, w.
_EQUATIONS = np.array(
    [
        [0, 4, 1, 3, -1],
        [0, 5, 2, 3, -1],
        [1, 5, 2, 4, -1],
        [1, 1, 0, 2, -2],
        [4, 4, 3, 5, -2],
        [1, 4, 0, 5, -2],
    ]
)


@inline
def _orthonormal(u, v):
    """Make u (6,) and v (6,) orthonormal without leaving their span."""
    square = 0.0
    for i in range(6):
        square += u[i] * u[i]
    inverse = 1.0 / math.sqrt(square)
    along = 0.0
    for i in range(6):
        u[i] *= inverse
        along += u[i] * v[i]
    square = 0.0
    for i in range(6):
        v[i] -= along * u[i]
        square += v[i] * v[i]
    inverse = 1.0 / math.sqrt(square)
    for i in range(6):
        v[i] *= inverse


@inline
def _restricted(equation, u, v):
    """Return p, h and r of ``p a a + 2 h a b + r b b``, the equation on the pencil."""
    i, j, k, m, w = equation[0], equation[1], equation[2], equation[3], equation[4]
    p = u[i] * u[j] + w * u[k] * u[m]
    h = 0.5 * (u[i] * v[j] + v[i] * u[j] + w * (u[k] * v[m] + v[k] * u[m]))
    r = v[i] * v[j] + w * v[k] * v[m]
    return p, h, r


@inline
def _violation(u, v, a, b):
    """Return the distance of a u + b v (a unit vector) from a product."""
    worst = 0.0
    for k in range(6):
        p, h, r = _restricted(_EQUATIONS[k], u, v)
        worst = max(worst, abs(p * a * a + 2.0 * h * a * b + r * b * b))
    return worst


@inline
def pencil_vectors(u, v, slack, vectors):
    """Write the vectors of the pencil that may be products to ``vectors`` (MAX_VECTORS, 6).

    ``slack`` is the uncertainty of the equations, up to which a negative discriminant may be a
    double zero; u (6,) and v (6,) are made orthonormal.  Returns the number of vectors, and whether
    they are all; they are not if every vector of the pencil is a product.
    """
    _orthonormal(u, v)
    p, h, r, norm = 0.0, 0.0, 0.0, 0.0
    for k in range(6):
        a, b, c = _restricted(_EQUATIONS[k], u, v)
        square = a * a + 2.0 * b * b + c * c
        if square > norm:
            p, h, r, norm = a, b, c, square
    if norm < PENCIL_VOID * PENCIL_VOID:
        for i in range(6):
            vectors[0, i], vectors[1, i] = u[i], v[i]
            vectors[2, i], vectors[3, i] = u[i] + v[i], u[i] - v[i]
        return 4, False
    discriminant = h * h - p * r
    if discriminant < -slack * math.sqrt(norm):
        return 0, True
    root = math.sqrt(max(discriminant, 0.0))
    t = -h - root if h >= 0.0 else root - h
    count = 0
    for k in range(2):
        a, b = (t, p) if k == 0 else (r, t)
        length = math.hypot(a, b)
        if length == 0.0:
            continue
        a /= length
        b /= length
        if _violation(u, v, a, b) > PENCIL_IS_PRODUCT + math.sqrt(slack):
            continue
        for i in range(6):
            vectors[count, i] = a * u[i] + b * v[i]
        count += 1
    return count, True
