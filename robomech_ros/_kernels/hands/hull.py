"""Incremental convex hull with the neighbours of its facets.

Each facet has d points and the plane v . x = 1 through them.  A new point replaces the connected
facets that are visible from it by facets between it and each of their outer ridges.  The plane of a
new facet is interpolated between those of the two facets at its ridge, so that rounding errors do
not accumulate.

In spite of rounding, the facets always enclose the origin, since no cone from a point over a facet
below it contains the origin.  So the distance of the nearest plane is the radius of a ball inside
the hull.

Source: Motzkin, Raiffa, Thompson and Thrall, The double description method, in: Contributions to
the Theory of Games II, Princeton 1953.
"""

import math

from robomech_ros._kernels.compiling.jit import lean

# Mark of removed facets, and the result if the arrays are full.
DEAD = -(1 << 62)
FULL = -1
# Least excess of v . p over 1 for a point p above a plane.
ABOVE = 1e-12
# A neighbour is stored as facet << _BITS, plus the index of the point that only it has.
_BITS = 3
_PLACE = 7


@lean
def above(planes, f, p):
    """Return v . p for the plane of a facet; it is more than 1 if p is above the plane."""
    found = 0.0
    for c in range(p.shape[0]):
        found += planes[f, c] * p[c]
    return found


@lean
def _measure(planes, f, d):
    """Write the distance of a plane from the origin to the column after v."""
    square = 0.0
    for c in range(d):
        square += planes[f, c] * planes[f, c]
    planes[f, d] = 1.0 / math.sqrt(square)


@lean
def make_simplex(facets, planes, lists, d):
    """Write the facets of a simplex of the points 0 to d; return the number of free facets.

    ``facets`` (m, 2 d + 1) receives points, the neighbours opposite to them, and a mark.
    ``planes`` (m, d + 1) holds v of the first d + 1 facets and receives their distances.  ``lists``
    (3, m) receives free facets; the other rows are for removed and for new facets.
    """
    for f in range(d + 1):
        for j in range(d):
            other = j if j < f else j + 1
            facets[f, j] = other
            facets[f, d + j] = other << _BITS | (f if f < other else f - 1)
        facets[f, 2 * d] = 0
        _measure(planes, f, d)
    free = facets.shape[0] - d - 1
    for k in range(free):
        lists[0, k] = facets.shape[0] - 1 - k
    return free


@lean
def _list_visible(facets, planes, lists, f, p, stamp):
    """List the connected facets below p around f, and mark them; return their number."""
    d = p.shape[0]
    facets[f, 2 * d] = stamp
    lists[1, 0] = f
    count, at = 1, 0
    while at < count:
        for j in range(d):
            g = facets[lists[1, at], d + j] >> _BITS
            if abs(facets[g, 2 * d]) != stamp:
                if above(planes, g, p) > 1.0 + ABOVE:
                    facets[g, 2 * d] = stamp
                    lists[1, count] = g
                    count += 1
                else:
                    facets[g, 2 * d] = -stamp
        at += 1
    return count


@lean
def _add_facet(facets, planes, new, f, j, point, p):
    """Write the facet of a point and of the ridge of f opposite to its point j."""
    d = p.shape[0]
    g, slot = facets[f, d + j] >> _BITS, facets[f, d + j] & _PLACE
    up, down = above(planes, f, p), above(planes, g, p)
    share = min((up - 1.0) / (up - down), 1.0)
    for c in range(d):
        planes[new, c] = planes[f, c] + share * (planes[g, c] - planes[f, c])
        facets[new, c] = facets[f, c]
    _measure(planes, new, d)
    facets[new, j] = point
    facets[new, d + j] = facets[f, d + j]
    facets[new, 2 * d] = 0
    facets[g, d + slot] = new << _BITS | j
    facets[f, d + j] = -1 - new


@lean
def _index_in(facets, f, point, d):
    """Return the index of a point within a facet."""
    for c in range(d):
        if facets[f, c] == point:
            return c
    return 0


@lean
def _link(facets, f, j, d):
    """Write the other neighbours of the new facet at the ridge of f opposite to its point j.

    The search passes removed facets around the common part of both ridges.
    """
    new = -1 - facets[f, d + j]
    for i in range(d):
        if i != j:
            at, out, beside = f, i, facets[f, j]
            while facets[at, d + out] >= 0:
                slot = facets[at, d + out] & _PLACE
                at = facets[at, d + out] >> _BITS
                out = _index_in(facets, at, beside, d)
                beside = facets[at, slot]
            other = -1 - facets[at, d + out]
            facets[new, d + i] = other << _BITS | _index_in(facets, at, beside, d)


@lean
def add_point(facets, planes, lists, sizes, f, point, p):
    """Replace the connected facets below a point, around facet f, by facets to the point.

    ``facets``, ``planes`` and ``lists`` are as for :func:`make_simplex`; ``sizes`` (2,) are the
    number of free facets and the last mark.  ``point`` is the number of the point at p (d,), which
    is above f.  Returns the number of new facets in the third list, or FULL with an invalid hull.
    """
    d = p.shape[0]
    sizes[1] += 1
    removed = _list_visible(facets, planes, lists, f, p, sizes[1])
    count = 0
    for a in range(removed):
        for j in range(d):
            at = lists[1, a]
            if facets[facets[at, d + j] >> _BITS, 2 * d] != sizes[1]:
                if sizes[0] == 0:
                    return FULL
                sizes[0] -= 1
                lists[2, count] = lists[0, sizes[0]]
                _add_facet(facets, planes, lists[2, count], at, j, point, p)
                count += 1
    for a in range(removed):
        for j in range(d):
            if facets[lists[1, a], d + j] < 0:
                _link(facets, lists[1, a], j, d)
    for a in range(removed):
        lists[0, sizes[0]] = lists[1, a]
        facets[lists[1, a], 2 * d] = DEAD
        sizes[0] += 1
    return count
