"""Bounds of the distance of two convex hulls; separating planes give the lower bounds.

A row of ``corners`` (k, 5) is a corner of a body in its frame, and the range in ``neighbours`` (e,)
of the corners that edges join to it.  A row of ``axes`` (p, 5) is the normal of the last best plane
between a pair, in the frame of the first body, and the nearest corners of both.  The next search
starts there; wrong rows only cost time.

References
----------
E. G. Gilbert, D. W. Johnson, S. S. Keerthi, "A fast procedure for computing the distance between
complex objects in three-dimensional space", IEEE J. Robotics and Automation 4, 1988.
P. Wolfe, "Finding the nearest point in a polytope", Mathematical Programming 11, 1976.
"""

import math

from robomech_ros._kernels.collision.shapes import HALF_SPACE
from robomech_ros._kernels.compiling.jit import flat, lean, scratch

# Column 7 of bodies: the body is exactly the hull of its corners, or it is a cylinder.
HULL, ROUND = 1.0, 2.0
# Largest number of steps, least progress of a step (m), and relative size of a flat simplex.
_MOST_STEPS = 24
_NO_PROGRESS = 1e-9
_FLAT = 1e-12


@flat
def _support(tables, b, at, direction, point):
    """Write the support point of body b along a direction, both in its frame.

    The search climbs along edges from corner `at` and returns the index of the last corner.  It
    ignores the radius of the body.
    """
    bodies, shapes = tables.bodies, tables.shapes
    corners, neighbours = tables.corners, tables.neighbours
    x, y, z = direction[0], direction[1], direction[2]
    if bodies[b, 7] == ROUND:
        u = shapes[b, 0] * x + shapes[b, 3] * y + shapes[b, 6] * z
        v = shapes[b, 1] * x + shapes[b, 4] * y + shapes[b, 7] * z
        w = shapes[b, 2] * x + shapes[b, 5] * y + shapes[b, 8] * z
        norm = math.sqrt(u * u + v * v)
        u, v = (shapes[b, 12] * u / norm, shapes[b, 12] * v / norm) if norm > 0.0 else (0.0, 0.0)
        w = shapes[b, 13] if w > 0.0 else -shapes[b, 13]
        for r in range(3):
            point[r] = shapes[b, 9 + r] + shapes[b, 3 * r] * u + shapes[b, 3 * r + 1] * v
            point[r] += shapes[b, 3 * r + 2] * w
        return at
    best = corners[at, 0] * x + corners[at, 1] * y + corners[at, 2] * z
    before = -1
    while before != at:
        before = at
        for e in range(int(corners[before, 3]), int(corners[before, 4])):
            k = neighbours[e]
            value = corners[k, 0] * x + corners[k, 1] * y + corners[k, 2] * z
            if value > best:
                best, at = value, k
    point[0], point[1], point[2] = corners[at, 0], corners[at, 1], corners[at, 2]
    return at


@lean
def _solve_edges(points, size, system):
    """Write affine coordinates of the point nearest to zero in the span of a simplex.

    Coordinates of all corners but the first go to column 3 of system (3, 4).  Returns 0 if the
    simplex is flat.
    """
    n = size - 1
    largest = 0.0
    for r in range(n):
        for c in range(n):
            total = 0.0
            for k in range(3):
                total += (points[r + 1, k] - points[0, k]) * (points[c + 1, k] - points[0, k])
            system[r, c] = total
        total = 0.0
        for k in range(3):
            total -= (points[r + 1, k] - points[0, k]) * points[0, k]
        system[r, 3] = total
        largest = max(largest, system[r, r])
    for r in range(n):
        if system[r, r] <= _FLAT * largest:
            return 0
        for q in range(r + 1, n):
            factor = system[q, r] / system[r, r]
            for c in range(r, n):
                system[q, c] -= factor * system[r, c]
            system[q, 3] -= factor * system[r, 3]
    for r in range(n - 1, -1, -1):
        total = system[r, 3]
        for c in range(r + 1, n):
            total -= system[r, c] * system[c, 3]
        system[r, 3] = total / system[r, r]
    return 1


@lean
def _reduce_simplex(points, weights, size, system):
    """Drop corners of a simplex until its point nearest to zero has only positive weights.

    Returns the number of corners, or 0 if the simplex is flat.
    """
    while size > 1:
        if not _solve_edges(points, size, system):
            return 0
        first = 1.0
        for k in range(size - 1):
            first -= system[k, 3]
        share, dropped = 1.0, -1
        for k in range(size):
            wanted = first if k == 0 else system[k - 1, 3]
            if wanted <= 0.0:
                part = weights[k] / (weights[k] - wanted) if weights[k] > wanted else 0.0
                if dropped < 0 or part < share:
                    share, dropped = part, k
        for k in range(size):
            wanted = first if k == 0 else system[k - 1, 3]
            weights[k] += share * (wanted - weights[k])
        if dropped < 0:
            return size
        size -= 1
        weights[dropped] = weights[size]
        for k in range(3):
            points[dropped, k] = points[size, k]
    weights[0] = 1.0
    return size


@lean
def _relative_pose(frames, f, g, pose):
    """Write the pose of frame g in frame f to pose (12,)."""
    for r in range(3):
        for c in range(3):
            total = 0.0
            for k in range(3):
                total += frames[f, 3 * k + r] * frames[g, 3 * k + c]
            pose[3 * r + c] = total
        total = 0.0
        for k in range(3):
            total += frames[f, 3 * k + r] * (frames[g, 9 + k] - frames[f, 9 + k])
        pose[9 + r] = total


@flat
def _above_plane(tables, frames, a, b):
    """Return the least height of body a above the half-space b."""
    bodies, shapes = tables.bodies, tables.shapes
    f, g = int(bodies[a, 0]), int(bodies[b, 0])
    normal, down, lowest = scratch(3), scratch(3), scratch(3)
    for r in range(3):
        normal[r] = 0.0
        for k in range(3):
            normal[r] += frames[g, 3 * r + k] * shapes[b, 3 * k + 2]
    for r in range(3):
        down[r] = 0.0
        for k in range(3):
            down[r] -= frames[f, 3 * k + r] * normal[k]
    _support(tables, a, int(bodies[a, 5]), down, lowest)
    height = 0.0
    for r in range(3):
        x, origin = frames[f, 9 + r], frames[g, 9 + r]
        for k in range(3):
            x += frames[f, 3 * r + k] * lowest[k]
            origin += frames[g, 3 * r + k] * shapes[b, 9 + k]
        height += normal[r] * (x - origin)
    return height - bodies[a, 6]


@lean
def _write_difference(pose, first, second, difference):
    """Write the vector from the first point to the second; `pose` is that of the second frame."""
    for r in range(3):
        difference[r] = (
            pose[3 * r] * second[0]
            + pose[3 * r + 1] * second[1]
            + pose[3 * r + 2] * second[2]
            + pose[9 + r]
            - first[r]
        )


@lean
def _nearest_point(points, weights, size):
    """Return the point of a simplex with these weights."""
    x, y, z = 0.0, 0.0, 0.0
    for k in range(size):
        x += weights[k] * points[k, 0]
        y += weights[k] * points[k, 1]
        z += weights[k] * points[k, 2]
    return x, y, z


@lean
def is_exact(bodies, a, b):
    """Return whether the upper bound of `hull_bounds` holds for the bodies themselves."""
    return bodies[a, 7] > 0.0 and bodies[b, 7] > 0.0


@lean
def hull_bounds(tables, frames, p, keep, enough):
    """Return lower and upper bound of the distance of the hulls of pair p; cylinders are exact.

    The search ends once the lower bound is above ``enough`` (m), or once the upper bound is not and
    both are on the same side of ``keep``.
    """
    bodies, axes = tables.bodies, tables.axes
    a, b = int(tables.pairs[p, 0]), int(tables.pairs[p, 1])
    if int(bodies[b, 3]) == HALF_SPACE:
        height = _above_plane(tables, frames, a, b)
        return height, height
    pose, points, weights, system = scratch(12), scratch(4, 3), scratch(4), scratch(3, 4)
    towards, first, second = scratch(3), scratch(3), scratch(3)
    _relative_pose(frames, int(bodies[a, 0]), int(bodies[b, 0]), pose)
    radii = bodies[a, 6] + bodies[b, 6]
    i, j = int(axes[p, 3]), int(axes[p, 4])
    x, y, z = axes[p, 0], axes[p, 1], axes[p, 2]
    low, high, size = -math.inf, math.inf, 0
    for _ in range(_MOST_STEPS):
        norm = math.sqrt(x * x + y * y + z * z)
        if norm < _NO_PROGRESS:
            # No direction: the bodies overlap, or this is the first search for the pair.
            if size:
                break
            x, y, z, norm = 1.0, 0.0, 0.0, 1.0
        x, y, z = x / norm, y / norm, z / norm
        towards[0], towards[1], towards[2] = x, y, z
        i = _support(tables, a, i, towards, first)
        for r in range(3):
            towards[r] = -(pose[r] * x + pose[3 + r] * y + pose[6 + r] * z)
        j = _support(tables, b, j, towards, second)
        _write_difference(pose, first, second, points[size])
        between = x * points[size, 0] + y * points[size, 1] + z * points[size, 2]
        if between > low:
            low = between
            axes[p, 0], axes[p, 1], axes[p, 2], axes[p, 3], axes[p, 4] = x, y, z, i, j
        if low - radii > enough or (high - radii <= enough and low - radii > keep):
            break
        if high - low < _NO_PROGRESS:
            break
        weights[size] = 0.0 if size else 1.0
        size = _reduce_simplex(points, weights, size + 1, system)
        if not size:
            break
        x, y, z = _nearest_point(points, weights, size)
        nearest = math.sqrt(x * x + y * y + z * z)
        if nearest > high - _NO_PROGRESS:
            break
        # Four corners with positive weights enclose zero: the hulls overlap.
        high = nearest if size < 4 else 0.0
        if size == 4 or (high - radii <= enough and (low - radii > keep or high - radii <= keep)):
            break
    return low - radii, high - radii
