"""Wrench cones of contacts, and the test that they surround the origin.

A contact with the normal force n exerts the wrenches n a + B' y with |y| <= n.  The cones strictly
surround the origin if and only if the polar body a . u + |B u| <= 1 is bounded; then its
logarithmic barrier has a minimum.  Newton's method searches for it: a decrement below 1 proves that
it exists, and a direction along which no cone has a wrench proves that it does not.

Source: Nesterov and Nemirovskii, Interior-Point Polynomial Algorithms in Convex Programming, SIAM
1994, ch. 2.
"""

import math

from robomech_ros._kernels.algebra.dense import cholesky_solve
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT3, b1, f8, i8

OPEN, CLOSED = 0, 1
_MOST_STEPS = 120
# Decrement that proves closure: below 1, with a margin for rounding.
_PROVEN = 0.9
# Size of a polar body that counts as unbounded: the grasp resists wrenches of at most 1e-9.
_FARTHEST = 1e9
# Squared singular values below this fraction of the entries are rounding errors.
_NO_RANK = 1e-14


@lean
def _write_wrench(force, row, at, origin, length, planar, out):
    """Write the wrench of `force` along row[at:at + 3] at the contact, moments over the length."""
    x, y, z = row[0] - origin[0], row[1] - origin[1], row[2] - origin[2]
    f, g, h = row[at] * force, row[at + 1] * force, row[at + 2] * force
    if planar:
        out[0], out[1], out[2] = (x * g - y * f) / length, f, g
    else:
        out[0], out[1], out[2] = (
            (y * h - z * g) / length,
            (z * f - x * h) / length,
            (x * g - y * f) / length,
        )
        out[3], out[4], out[5] = f, g, h


@lean
def _cones(rows, origin, length, planar, cones):
    for i in range(rows.shape[0]):
        row = rows[i]
        _write_wrench(1.0, row, 3, origin, length, planar, cones[i, 0])
        _write_wrench(row[12], row, 6, origin, length, planar, cones[i, 1])
        _write_wrench(row[13], row, 9, origin, length, planar, cones[i, 2])
        for c in range(cones.shape[2]):
            cones[i, 3, c] = 0.0
        if not planar:
            for c in range(3):
                cones[i, 3, c] = row[14] * row[3 + c] / length


@kernel(i8(IN2, IN1, f8, b1, OUT3))
def wrench_cones(rows, origin, length, planar, cones):
    """Write the wrenches of the normal force and of three bounded components of each contact.

    ``rows`` (k, 15) are position, normal and two tangents of the contacts, and the bounds of three
    components for a unit normal force: friction, friction, and torsion (m).  Moments are about the
    ``origin`` (3,), in units of ``length`` (m).  If ``planar``, wrenches only have the moment
    about z and the force along x and y.  ``cones`` (k, 4, 3 or 6) are written.
    """
    _cones(rows, origin, length, planar, cones)
    return 0


@lean
def _unopposed(cones, u):
    """Return whether no contact can exert a wrench with a positive component along u."""
    for i in range(cones.shape[0]):
        along, across = 0.0, 0.0
        for c in range(cones.shape[2]):
            along += cones[i, 0, c] * u[c]
        for j in range(1, 4):
            part = 0.0
            for c in range(cones.shape[2]):
                part += cones[i, j, c] * u[c]
            across += part * part
        if along + math.sqrt(across) > 0.0:
            return False
    return True


@lean
def barrier(cones, u, H, g, y):
    """Write the gradient and the lower triangle of the Hessian of the barrier of the polar body."""
    d = cones.shape[2]
    for c in range(d):
        g[c] = 0.0
        for e in range(c + 1):
            H[c, e] = 0.0
    for i in range(cones.shape[0]):
        cone = cones[i]
        left, across = 1.0, 0.0
        for c in range(d):
            left -= cone[0, c] * u[c]
        for j in range(1, 4):
            y[j] = 0.0
            for c in range(d):
                y[j] += cone[j, c] * u[c]
            across += y[j] * y[j]
        q = left * left - across
        for c in range(d):
            part = left * cone[0, c]
            for j in range(1, 4):
                part += y[j] * cone[j, c]
            y[4 + c] = 2.0 * part / q
            g[c] += y[4 + c]
        for c in range(d):
            for e in range(c + 1):
                part = -cone[0, c] * cone[0, e]
                for j in range(1, 4):
                    part += cone[j, c] * cone[j, e]
                H[c, e] += 2.0 * part / q + y[4 + c] * y[4 + e]


@lean
def _spans(H, d):
    """Factorise the lower triangle of H in place; return whether H has full rank."""
    for j in range(d):
        whole = H[j, j]
        for k in range(j):
            H[j, j] -= H[j, k] * H[j, k]
        if not H[j, j] > _NO_RANK * whole:
            return False
        root = math.sqrt(H[j, j])
        for i in range(j + 1, d):
            for k in range(j):
                H[i, j] -= H[i, k] * H[j, k]
            H[i, j] /= root
        H[j, j] = root
    return True


@kernel(i8(IN2, IN1, f8, b1, OUT3, OUT1))
def closed(rows, origin, length, planar, cones, u):
    """Return whether the wrenches of the contacts surround the origin: CLOSED or OPEN.

    The first five arguments are as for :func:`wrench_cones`.  u (3 or 6,) receives the last point
    of the method; for an open grasp, no wrench has a considerable component along it.
    """
    _cones(rows, origin, length, planar, cones)
    d = cones.shape[2]
    H, g, step, y = scratch(6, 6), scratch(6), scratch(6), scratch(10)
    for c in range(d):
        u[c] = 0.0
    barrier(cones, u, H, g, y)
    if not _spans(H, d):
        return OPEN
    for _ in range(_MOST_STEPS):
        barrier(cones, u, H, g, y)
        for c in range(d):
            step[c] = g[c]
        if not cholesky_solve(H, step, d):
            return OPEN
        slope, far = 0.0, 0.0
        for c in range(d):
            slope += g[c] * step[c]
        decrement = math.sqrt(max(slope, 0.0))
        if decrement < _PROVEN:
            return CLOSED
        for c in range(d):
            u[c] -= step[c] / (1.0 + decrement)
            far += u[c] * u[c]
        if _unopposed(cones, u) or not far < _FARTHEST * _FARTHEST:
            return OPEN
    return OPEN
