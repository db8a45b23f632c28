"""Simplex around the polar body of a grasp, for the first hull of its wrenches.

The polar body is a . u + |B u| <= 1 for all contacts.  Its logarithmic barrier has the parameter
nu = 2 for each contact.  The body is inside an ellipsoid about the centre of the barrier, with the
Hessian there as its matrix and the radius nu + 2 sqrt(nu).

Source: Nesterov and Nemirovskii, Interior-Point Polynomial Algorithms in Convex Programming, SIAM
1994, proposition 2.3.2.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.compiling.jit import lean, scratch
from robomech_ros._kernels.hands.force_closure import barrier

_MOST_STEPS = 200
# Decrements below which full steps of Newton's method converge, and have converged.
_NEAR = 0.25
_CENTRED = 1e-7
# Enlargement of the ellipsoid for the error of its centre.
_WIDER = 1.01


@lean
def _centre(cones, u, H):
    """Write the centre of the barrier to u, and the factor of its Hessian to H.

    Returns False if Newton's method does not converge, because of rounding errors.
    """
    d = cones.shape[2]
    g, step, y = scratch(6), scratch(6), scratch(10)
    for c in range(d):
        u[c] = 0.0
    for _ in range(_MOST_STEPS):
        barrier(cones, u, H, g, y)
        for c in range(d):
            step[c] = g[c]
        if not cholesky_solve(H, step, d):
            return False
        slope = 0.0
        for c in range(d):
            slope += g[c] * step[c]
        decrement = math.sqrt(max(slope, 0.0))
        if decrement < _CENTRED:
            return True
        size = 1.0 if decrement < _NEAR else 1.0 / (1.0 + decrement)
        for c in range(d):
            u[c] -= size * step[c]
    return False


@lean
def _regular(i, c, d):
    """Return component c of the unit vector from the centre to corner i of a regular simplex."""
    if i == d:
        return 1.0 / math.sqrt(d)
    own = math.sqrt(1.0 + 1.0 / d)
    return (own if i == c else 0.0) - (own + 1.0 / math.sqrt(d)) / d


@lean
def enclosed(cones, points, planes):
    """Write d + 1 wrenches inside the hull of ``cones`` (k, 4, d), and the planes between them.

    The first d + 1 rows of ``points`` and of ``planes`` are written.  Row i of the latter is v of
    the plane v . x = 1 through all points except point i: a corner of a simplex around the polar
    body.  Returns False if rounding errors prevent this.
    """
    d = cones.shape[2]
    u, H = scratch(6), scratch(6, 6)
    if not _centre(cones, u, H):
        return False
    nu = 2.0 * cones.shape[0]
    radius = _WIDER * (nu + 2.0 * math.sqrt(nu))
    for i in range(d + 1):
        at = 0.0
        for r in range(d):
            points[i, r] = -_regular(i, r, d) / H[r, r]
            for c in range(r):
                points[i, r] -= H[r, c] * _regular(i, c, d)
            at += points[i, r] * u[r]
        if not radius + at > 0.0:
            return False
        for r in range(d):
            points[i, r] /= radius + at
        for r in range(d - 1, -1, -1):
            planes[i, r] = d * radius * _regular(i, r, d)
            for c in range(r + 1, d):
                planes[i, r] -= H[c, r] * planes[i, c]
            planes[i, r] *= H[r, r]
        for r in range(d):
            planes[i, r] += u[r]
    return True
