"""Bounds of distances between bodies by spheres, and pairs that need exact distances."""

import math
from typing import Any, NamedTuple

import numpy as np

from robomech_ros._kernels.collision.grids import known_apart
from robomech_ros._kernels.collision.hulls import hull_bounds, is_exact
from robomech_ros._kernels.collision.shapes import SPHERES, compose, place_frames, signed_distance
from robomech_ros._kernels.collision.tables import NEAR_PAIRS, TABLES
from robomech_ros._kernels.compiling.jit import flat, inline, kernel, lean
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT1, OUT2, i8

# Overlap (m) of inner spheres of two bodies that proves a contact.
ROUNDING = 1e-9
# Largest excess (m) of a computed distance, except for bounds by spheres.
UNCERTAIN = 1e-6


class Posture(NamedTuple):
    """Working space for the bodies at a posture.

    Poses of the frames (m + 1, 12), bounds of the travel of each joint (m,), flags of bodies whose
    spheres are placed (b,), centres of outer and inner spheres (s, 6), and bounds of the travel of
    each sphere against each frame (s, m + 1).
    """

    frames: Any
    travels: Any
    ready: Any
    points: Any
    moved: Any


@inline
def room_for_posture(tables):
    """Return working space for a posture, without placed spheres."""
    m, s = tables.joints.shape[0], tables.spheres.shape[0]
    return Posture(
        np.empty((m + 1, 12)),
        np.empty(m),
        np.zeros(tables.bodies.shape[0], np.int64),
        np.empty((s, 6)),
        np.zeros((s, m + 1)),
    )


@lean
def _transformed(frames, f, x, y, z):
    return (
        frames[f, 0] * x + frames[f, 1] * y + frames[f, 2] * z + frames[f, 9],
        frames[f, 3] * x + frames[f, 4] * y + frames[f, 5] * z + frames[f, 10],
        frames[f, 6] * x + frames[f, 7] * y + frames[f, 8] * z + frames[f, 11],
    )


@lean
def place_bodies(frames, bodies, around, centres):
    """Write the centres (b, 3) of the spheres around the bodies."""
    for b in range(bodies.shape[0]):
        f = int(bodies[b, 0])
        x, y, z = _transformed(frames, f, around[b, 0], around[b, 1], around[b, 2])
        centres[b, 0], centres[b, 1], centres[b, 2] = x, y, z


@flat
def place_spheres(tables, posture, b):
    """Write the centres of the outer and inner spheres of body b, unless they are ready."""
    ready, frames, points = posture.ready, posture.frames, posture.points
    if ready[b]:
        return
    ready[b] = 1
    bodies, spheres = tables.bodies, tables.spheres
    f = int(bodies[b, 0])
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        x, y, z = _transformed(frames, f, spheres[s, 0], spheres[s, 1], spheres[s, 2])
        points[s, 0], points[s, 1], points[s, 2] = x, y, z
        x, y, z = _transformed(frames, f, spheres[s, 4], spheres[s, 5], spheres[s, 6])
        points[s, 3], points[s, 4], points[s, 5] = x, y, z


@flat
def far_bound(tables, centres, a, b):
    """Return a lower bound of the distance of two bodies by one sphere around each."""
    around = tables.around
    kind = int(tables.bodies[b, 3])
    if kind == SPHERES:
        x = centres[a, 0] - centres[b, 0]
        y = centres[a, 1] - centres[b, 1]
        z = centres[a, 2] - centres[b, 2]
        return math.sqrt(x * x + y * y + z * z) - around[a, 3] - around[b, 3]
    gap = signed_distance(kind, tables.shapes, b, centres[a, 0], centres[a, 1], centres[a, 2])
    return gap - around[a, 3]


@flat
def pair_bounds(tables, posture, p):
    """Return bounds of the distance of pair p: lower, lower during the travel, and upper."""
    a, b, c = int(tables.pairs[p, 0]), int(tables.pairs[p, 1]), int(tables.pairs[p, 2])
    kind = int(tables.bodies[b, 3])
    if kind == SPHERES:
        return _bounds_of_spheres(tables.bodies, tables.spheres, posture, a, b, c)
    bodies, spheres, shapes = tables.bodies, tables.spheres, tables.shapes
    points, moved = posture.points, posture.moved
    low, moving, high = math.inf, math.inf, math.inf
    exact = bodies[b, 4] == 1.0
    for s in range(int(bodies[a, 1]), int(bodies[a, 2])):
        gap = signed_distance(kind, shapes, b, points[s, 0], points[s, 1], points[s, 2])
        gap -= spheres[s, 3]
        low = min(low, gap)
        moving = min(moving, gap - moved[s, c])
        if exact:
            inner = signed_distance(kind, shapes, b, points[s, 3], points[s, 4], points[s, 5])
            high = min(high, inner - spheres[s, 7])
    return low, moving, high


@flat
def _bounds_of_spheres(bodies, spheres, posture, a, b, c):
    """Return the bounds of `pair_bounds` for two bodies that have spheres."""
    points, moved = posture.points, posture.moved
    low, moving, high = math.inf, math.inf, math.inf
    for s in range(int(bodies[a, 1]), int(bodies[a, 2])):
        for t in range(int(bodies[b, 1]), int(bodies[b, 2])):
            x = points[s, 0] - points[t, 0]
            y = points[s, 1] - points[t, 1]
            z = points[s, 2] - points[t, 2]
            gap = math.sqrt(x * x + y * y + z * z) - spheres[s, 3] - spheres[t, 3]
            low = min(low, gap)
            moving = min(moving, gap - moved[s, c] - moved[t, c])
            x = points[s, 3] - points[t, 3]
            y = points[s, 4] - points[t, 4]
            z = points[s, 5] - points[t, 5]
            high = min(high, math.sqrt(x * x + y * y + z * z) - spheres[s, 7] - spheres[t, 7])
    return low, moving, high


@lean
def insert_pair(near, count, p, low):
    """Insert a pair in the order of lower bounds; return the new count."""
    k = count
    while k > 0 and near.low[k - 1] > low:
        near.pairs[k], near.low[k] = near.pairs[k - 1], near.low[k - 1]
        k -= 1
    near.pairs[k], near.low[k] = p, low
    return count + 1


@flat
def write_poses(tables, frames, near, count):
    """Write the poses of both bodies of each near pair to two rows."""
    bodies, placed, pairs = tables.bodies, tables.placed, tables.pairs
    for k in range(count):
        p = near.pairs[k]
        for i in range(2):
            b = int(pairs[p, i])
            compose(frames, int(bodies[b, 0]), placed, b, 0, near.poses, 2 * k + i)


@kernel(i8(IN2, IN1, OUT2))
def frames_at(joints, q, frames):
    """Write the poses (m + 1, 12) of all frames at drives q."""
    place_frames(joints, q, frames)
    return 0


@flat
def _group_bound(tables, centres, g):
    """Return a lower bound of the distances of group g, by one sphere around each side."""
    a, b = int(tables.grids[g, 5]), int(tables.grids[g, 6])
    if a < 0:
        return -math.inf
    return far_bound(tables, centres, a, b) - tables.pairs[int(tables.grids[g, 3]), 3]


@flat
def _padded_bounds(tables, posture, p):
    """Return lower and upper bound of the distance of pair p by spheres, less its padding."""
    pairs = tables.pairs
    place_spheres(tables, posture, int(pairs[p, 0]))
    place_spheres(tables, posture, int(pairs[p, 1]))
    low, _, high = pair_bounds(tables, posture, p)
    return low - pairs[p, 3], high - pairs[p, 3]


@flat
def _contact_bounds(tables, posture, p, limit):
    """Return a lower bound for pair p, and an upper one, infinite unless it is within the limit."""
    low, high = _padded_bounds(tables, posture, p)
    if high < limit - ROUNDING:
        return low, high
    if low > limit:
        return low, math.inf
    pairs = tables.pairs
    padding = pairs[p, 3]
    keep = limit + padding
    below, above = hull_bounds(tables, posture.frames, p, keep, keep + ROUNDING)
    low = max(low, below - padding - ROUNDING)
    if is_exact(tables.bodies, int(pairs[p, 0]), int(pairs[p, 1])) and above - padding <= limit:
        return low, above - padding
    return low, math.inf


@flat
def _find_nearest(tables, posture, centres, bounds, near):
    """Find all pairs that may be the nearest; return their number and a bound of the distance.

    ``bounds`` (p,) is working space.
    """
    pairs, around, grids = tables.pairs, tables.around, tables.grids
    most = math.inf
    for g in range(grids.shape[0]):
        apart = _group_bound(tables, centres, g) > max(most, 0.0)
        for p in range(int(grids[g, 3]), int(grids[g, 4])):
            if apart:
                bounds[p] = math.inf
                continue
            a, b = int(pairs[p, 0]), int(pairs[p, 1])
            bounds[p] = far_bound(tables, centres, a, b) - pairs[p, 3]
            # The distance exceeds its lower bound by at most the diameters of both spheres.
            most = min(most, bounds[p] + 2.0 * (around[a, 3] + around[b, 3]))
    # Pairs with small bounds come first, since they exclude most others.
    for p in range(bounds.size):
        if bounds[p] <= 0.0 or bounds[p] <= 0.25 * most:
            most = min(most, _padded_bounds(tables, posture, p)[1])
    found = 0
    for p in range(bounds.size):
        if bounds[p] <= max(most, 0.0):
            low, high = _padded_bounds(tables, posture, p)
            most = min(most, high)
            # Overlapping spheres say nothing of the depth.
            low = max(low, bounds[p])
            if low <= max(most, 0.0):
                found = insert_pair(near, found, p, max(low, 0.0))
    return found, most


@flat
def _find_contacts(tables, posture, centres, q, limit, near):
    """Find the pairs that may be within a limit (m), or one that surely is, as `near_pairs`."""
    pairs, grids = tables.pairs, tables.grids
    found = 0
    for g in range(grids.shape[0]):
        if (
            known_apart(grids, tables.cells, g, q, limit)
            or _group_bound(tables, centres, g) > limit
        ):
            continue
        for p in range(int(grids[g, 3]), int(grids[g, 4])):
            bound = far_bound(tables, centres, int(pairs[p, 0]), int(pairs[p, 1])) - pairs[p, 3]
            if bound > max(limit, 0.0):
                continue
            low, high = _contact_bounds(tables, posture, p, limit)
            if high < math.inf:
                insert_pair(near, 0, p, high)
                return -1 - p
            low = max(low, bound)
            if low <= limit:
                found = insert_pair(near, found, p, max(low, 0.0))
    return found


@kernel(i8(TABLES, IN1, i8, OUT1, NEAR_PAIRS))
def near_pairs(tables, q, nearest, limit, near):
    """Find the pairs whose distances must be computed at a posture, in order of lower bounds.

    Without ``nearest``, these are all pairs that may be nearer than limit[0].  If pair p surely is,
    it is the only one, and the result is -1 - p.  With ``nearest``, they are the candidates for the
    nearest pair, and limit[0] becomes an upper bound of the least distance.

    Returns the number of pairs.
    """
    posture = room_for_posture(tables)
    place_frames(tables.joints, q, posture.frames)
    centres = np.empty((tables.bodies.shape[0], 3))
    place_bodies(posture.frames, tables.bodies, tables.around, centres)
    if nearest:
        bounds = np.empty(tables.pairs.shape[0])
        found, limit[0] = _find_nearest(tables, posture, centres, bounds, near)
    else:
        found = _find_contacts(tables, posture, centres, q, limit[0], near)
    write_poses(tables, posture.frames, near, max(found, 1 if found < 0 else 0))
    return found
