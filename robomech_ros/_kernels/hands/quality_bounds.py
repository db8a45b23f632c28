"""Bounds of the quality of a grasp by a hull of wrenches that is refined at its nearest facet.

The nearest plane of a hull inside the wrenches gives a lower bound of the quality.  Moved outwards
until it supports the wrenches, it gives an upper bound, and the support point is added to the hull.
Facets farther away than the upper bound are not processed.

Source: Zheng, An Efficient Algorithm for a Grasp Quality Measure, IEEE Trans. Robotics 29, 2013.
"""

import math

from robomech_ros._kernels.compiling.jit import kernel, lean, scratch, scratch_integers
from robomech_ros._kernels.compiling.types import IN3, IOUT2, OUT1, OUT2, f8, i8
from robomech_ros._kernels.hands.hull import ABOVE, DEAD, FULL, above, add_point, make_simplex
from robomech_ros._kernels.hands.polar import enclosed

CLOSE, USED_UP, SPOILT = 0, 1, 2
# Rounding error of a lower bound, for wrenches of size 1.
_ROUNDING = 1e-12
# Facets within this fraction of the tolerance below the upper bound are omitted.
_ENOUGH = 0.999
# New points are shrunk by up to this fraction of the tolerance, and of themselves, so that few are
# in one plane; the golden ratio distributes the fractions.
_SHRINK = 1e-2
_MOST_SHRINK = 1e-6
_GOLDEN = 0.6180339887498949


@lean
def _touch(cone, n, p):
    """Write the wrench of a contact that is farthest along n; return its distance."""
    d = n.shape[0]
    y = scratch(3)
    along, square = 0.0, 0.0
    for c in range(d):
        along += cone[0, c] * n[c]
        p[c] = cone[0, c]
    for j in range(3):
        y[j] = 0.0
        for c in range(d):
            y[j] += cone[1 + j, c] * n[c]
        square += y[j] * y[j]
    size = math.sqrt(square)
    if size > 0.0:
        for j in range(3):
            for c in range(d):
                p[c] += y[j] / size * cone[1 + j, c]
    return along + size


@lean
def _farthest(cones, n, p, best):
    """Write the farthest wrench of all contacts along n to best; return its distance."""
    found = -math.inf
    for i in range(cones.shape[0]):
        height = _touch(cones[i], n, p)
        if height > found:
            found = height
            for c in range(n.shape[0]):
                best[c] = p[c]
    return found


@lean
def _push(heap, size, key, facet):
    """Push a facet onto a heap with the nearest facet first."""
    at = size
    while at > 0 and heap[(at - 1) // 2, 0] > key:
        heap[at, 0], heap[at, 1] = heap[(at - 1) // 2, 0], heap[(at - 1) // 2, 1]
        at = (at - 1) // 2
    heap[at, 0], heap[at, 1] = key, facet


@lean
def _pop(heap, size):
    """Remove the first entry of a heap of this size."""
    key, facet = heap[size - 1, 0], heap[size - 1, 1]
    at, under = 0, 1
    while under < size - 1:
        if under + 1 < size - 1 and heap[under + 1, 0] < heap[under, 0]:
            under += 1
        if heap[under, 0] >= key:
            break
        heap[at, 0], heap[at, 1] = heap[under, 0], heap[under, 1]
        at, under = under, 2 * under + 1
    heap[at, 0], heap[at, 1] = key, facet


@lean
def _wait(planes, heap, waiting, far, came):
    """Push the new facets that are nearer than `far` onto the heap; return its size."""
    d = planes.shape[1] - 1
    size = waiting
    for g in came:
        if planes[g, d] < far:
            _push(heap, size, planes[g, d], g)
            size += 1
    return size


@lean
def _rounding(cones):
    """Return the rounding error of distances of planes through wrenches."""
    largest = 1.0
    for i in range(cones.shape[0]):
        size = 0.0
        for j in range(4):
            for c in range(cones.shape[2]):
                size += abs(cones[i, j, c])
        largest = max(largest, size)
    return _ROUNDING * largest


@lean
def _shrink(best, count, close):
    """Move a new point slightly towards the origin."""
    part = min(_SHRINK * close, _MOST_SHRINK) * (count * _GOLDEN % 1.0)
    for c in range(best.shape[0]):
        best[c] -= part * best[c]


@lean
def _lower_upper(cones, plane, found, best):
    """Update the upper bound with the normal of a facet; write the farthest wrench along it."""
    d = cones.shape[2]
    n, p = scratch(6), scratch(6)
    for c in range(d):
        n[c] = plane[c] * plane[d]
    height = _farthest(cones, n[:d], p[:d], best)
    if height < found[1]:
        found[1] = height
        for c in range(d):
            found[2 + c] = n[c]


@kernel(i8(IN3, f8, OUT2, IOUT2, OUT2, OUT2, IOUT2, OUT1))
def grow(cones, close, points, facets, planes, heap, lists, found):
    """Extend the hull of ``cones`` (k, 4, d) of a closed grasp until bounds differ by ``close``.

    ``points`` (n, d), ``facets``, ``planes`` and ``lists``, as for :func:`make_simplex`, are
    working space, which limits the hull; so is ``heap`` (m, 2), for distances and facets.
    ``found`` (d + 2,) receives the lower bound, the upper bound, and the direction of the latter.
    Returns CLOSE, or, with valid but wider bounds, USED_UP if the working space is full, or SPOILT
    by rounding errors.
    """
    d = cones.shape[2]
    best, sizes = scratch(6)[:d], scratch_integers(2)
    for c in range(d + 1):
        planes[0, c] = 1.0 if c in (0, d) else 0.0
    found[0], found[1] = 0.0, math.inf
    _lower_upper(cones, planes[0], found, best)
    if not enclosed(cones, points, planes):
        return SPOILT
    rounding = _rounding(cones)
    sizes[0], sizes[1] = make_simplex(facets, planes, lists, d), 0
    waiting, count = 0, d + 1
    for f in range(count):
        _push(heap, waiting, planes[f, d], f)
        waiting += 1
    while waiting > 0:
        key, f = heap[0, 0], int(heap[0, 1])
        _pop(heap, waiting)
        waiting -= 1
        if facets[f, 2 * d] != DEAD and planes[f, d] == key:
            # Omitted facets may be nearer.
            found[0] = max(found[0], min(key - rounding, found[1] - _ENOUGH * close))
            _lower_upper(cones, planes[f], found, best)
            if found[1] - found[0] <= close:
                return CLOSE
            _shrink(best, count, close)
            if not above(planes, f, best) > 1.0 + ABOVE:
                return SPOILT
            if count == points.shape[0]:
                return USED_UP
            points[count] = best
            came = add_point(facets, planes, lists, sizes, f, count, best)
            if came == FULL or waiting + came > heap.shape[0]:
                return USED_UP
            count += 1
            far = found[1] - _ENOUGH * close + rounding
            waiting = _wait(planes, heap, waiting, far, lists[2, :came])
    found[0] = max(found[0], found[1] - _ENOUGH * close)
    return CLOSE
