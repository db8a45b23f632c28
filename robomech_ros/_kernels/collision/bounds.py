"""Which pairs of bodies may be in contact: bounds of their distances by spheres.

A body is covered by spheres, and holds as many inside it: rows of ``spheres`` (s, 8) with
centre and radius of both.  The first columns of ``bodies`` have the frame that the body moves
with, its first sphere and the one after its last, the kind of simple shape that it is or lies
in (``SPHERES`` for none) and 1 where it is that shape exactly; rows of ``around`` (b, 4) a
sphere around all of it.  Centres are in the frame.  Rows of ``shapes`` (b, 15) hold pose and
sizes of the simple shape, rows of ``placed`` (b, 12) the pose of the body itself, both in the
frame.  Each body is inside the convex hull of its corners, or within its radius of that:
columns 5 to 7 of ``bodies`` (b, 8) have its first corner, the radius, and what the body is (see
`hulls`).  Rows of ``pairs`` (p, 5) have the two bodies, of which the first has spheres, the
frame before the first joint that moves them against each other, by how much (m) the pair counts
as nearer than it is, and the number of its group: the pairs of bodies of the same two links or
objects, which stand one behind the other.
"""

import math

import numpy as np

from robomech_ros._kernels.collision.grids import known_apart
from robomech_ros._kernels.collision.hulls import hull_bounds, is_exact
from robomech_ros._kernels.collision.shapes import SPHERES, compose, place_frames, signed_distance
from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT1, OUT1, OUT2, i8

# A pair is surely too near if spheres inside the bodies are, by more than rounding (m).
ROUNDING = 1e-9
# By how much a distance that is computed, and not bounded by spheres, may be too large (m).
UNCERTAIN = 1e-6


@lean
def transformed(frames, f, x, y, z):
    return (
        frames[f, 0] * x + frames[f, 1] * y + frames[f, 2] * z + frames[f, 9],
        frames[f, 3] * x + frames[f, 4] * y + frames[f, 5] * z + frames[f, 10],
        frames[f, 6] * x + frames[f, 7] * y + frames[f, 8] * z + frames[f, 11],
    )


@lean
def place_bodies(frames, bodies, around, placed):
    """Write where the spheres around the bodies are to placed (b, 3)."""
    for b in range(bodies.shape[0]):
        f = int(bodies[b, 0])
        x, y, z = transformed(frames, f, around[b, 0], around[b, 1], around[b, 2])
        placed[b, 0], placed[b, 1], placed[b, 2] = x, y, z


@lean
def place_spheres(frames, bodies, spheres, b, ready, placed):
    """Write where the spheres of body b are to placed (s, 6), outer and inner, if not done yet."""
    if ready[b]:
        return
    ready[b] = 1
    f = int(bodies[b, 0])
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        x, y, z = transformed(frames, f, spheres[s, 0], spheres[s, 1], spheres[s, 2])
        placed[s, 0], placed[s, 1], placed[s, 2] = x, y, z
        x, y, z = transformed(frames, f, spheres[s, 4], spheres[s, 5], spheres[s, 6])
        placed[s, 3], placed[s, 4], placed[s, 5] = x, y, z


@lean
def far_bound(bodies, around, shapes, middles, a, b):
    """Return a lower bound of the distance by one sphere around each body."""
    kind = int(bodies[b, 3])
    if kind == SPHERES:
        x = middles[a, 0] - middles[b, 0]
        y = middles[a, 1] - middles[b, 1]
        z = middles[a, 2] - middles[b, 2]
        return math.sqrt(x * x + y * y + z * z) - around[a, 3] - around[b, 3]
    return (
        signed_distance(kind, shapes, b, middles[a, 0], middles[a, 1], middles[a, 2])
        - (around[a, 3])
    )


@lean
def pair_bounds(bodies, spheres, shapes, placed, moved, a, b, c):
    """Return bounds of the distance of a pair: below, below while it moves, and above.

    Spheres move by at most moved[s, c] against frame c.
    """
    low, moving, high = math.inf, math.inf, math.inf
    kind = int(bodies[b, 3])
    if kind != SPHERES:
        exact = bodies[b, 4] == 1.0
        for s in range(int(bodies[a, 1]), int(bodies[a, 2])):
            gap = signed_distance(kind, shapes, b, placed[s, 0], placed[s, 1], placed[s, 2])
            gap -= spheres[s, 3]
            low = min(low, gap)
            moving = min(moving, gap - moved[s, c])
            if exact:
                inner = signed_distance(kind, shapes, b, placed[s, 3], placed[s, 4], placed[s, 5])
                high = min(high, inner - spheres[s, 7])
        return low, moving, high
    for s in range(int(bodies[a, 1]), int(bodies[a, 2])):
        for t in range(int(bodies[b, 1]), int(bodies[b, 2])):
            x = placed[s, 0] - placed[t, 0]
            y = placed[s, 1] - placed[t, 1]
            z = placed[s, 2] - placed[t, 2]
            gap = math.sqrt(x * x + y * y + z * z) - spheres[s, 3] - spheres[t, 3]
            low = min(low, gap)
            moving = min(moving, gap - moved[s, c] - moved[t, c])
            x = placed[s, 3] - placed[t, 3]
            y = placed[s, 4] - placed[t, 4]
            z = placed[s, 5] - placed[t, 5]
            high = min(high, math.sqrt(x * x + y * y + z * z) - spheres[s, 7] - spheres[t, 7])
    return low, moving, high


@lean
def write_poses(frames, bodies, placed, a, b, poses, k):
    """Write the poses of the two bodies of a pair to rows 2 k and 2 k + 1 of poses."""
    compose(frames, int(bodies[a, 0]), placed, a, 0, poses, 2 * k)
    compose(frames, int(bodies[b, 0]), placed, b, 0, poses, 2 * k + 1)


@kernel(i8(IN2, IN1, OUT2))
def frames_at(joints, q, frames):
    """Write the poses (m + 1, 12) of all frames at drives q."""
    place_frames(joints, q, frames)
    return 0


@kernel(
    i8(
        IN2,
        IN2,
        IN2,
        IN2,
        IN2,
        IN2,
        IN2,
        IN2,
        IIN1,
        OUT2,
        IN2,
        OUT1,
        IN1,
        i8,
        OUT1,
        IOUT1,
        OUT1,
        OUT2,
    )
)
def near_pairs(
    joints,
    bodies,
    around,
    spheres,
    shapes,
    placed,
    pairs,
    corners,
    neighbours,
    axes,
    grids,
    cells,
    q,
    nearest,
    limit,
    found,
    low,
    poses,
):
    """Find the pairs whose distances must be computed at a posture, nearest bound first.

    Without ``nearest`` these are all that may be nearer than limit[0]; if one is so surely, it
    alone is found, and the result is -1 - its number.  With ``nearest`` they are those that may be
    the nearest pair, and limit[0] becomes an upper bound of the least distance.  Returns how many
    there are: their numbers are in found (p,), lower bounds in low (p,), poses of both bodies in
    poses (2 p, 12).
    """
    frames = np.empty((joints.shape[0] + 1, 12))
    place_frames(joints, q, frames)
    middles = np.empty((bodies.shape[0], 3))
    place_bodies(frames, bodies, around, middles)
    points = np.empty((spheres.shape[0], 6))
    ready = np.zeros(bodies.shape[0], np.int64)
    still = np.zeros((spheres.shape[0], 1))
    most = math.inf if nearest else limit[0]
    bounds = np.empty(pairs.shape[0])
    before, apart = -1, False
    for p in range(pairs.shape[0]):
        if not nearest and int(pairs[p, 4]) != before:
            before = int(pairs[p, 4])
            apart = known_apart(grids, cells, before, q, limit[0])
        if apart:
            bounds[p] = math.inf
            continue
        a, b = int(pairs[p, 0]), int(pairs[p, 1])
        bounds[p] = far_bound(bodies, around, shapes, middles, a, b) - pairs[p, 3]
        if nearest:
            # Not farther than the spheres around both are wide, however they lie.
            most = min(most, bounds[p] + 2.0 * (around[a, 3] + around[b, 3]))
    if nearest:
        # The pairs with the least bounds first: what they say leaves out most of the others.
        for p in range(pairs.shape[0]):
            if bounds[p] > 0.0 and bounds[p] > 0.25 * most:
                continue
            a, b = int(pairs[p, 0]), int(pairs[p, 1])
            place_spheres(frames, bodies, spheres, a, ready, points)
            place_spheres(frames, bodies, spheres, b, ready, points)
            _, _, high = pair_bounds(bodies, spheres, shapes, points, still, a, b, 0)
            most = min(most, high - pairs[p, 3])
    count = 0
    for p in range(pairs.shape[0]):
        if bounds[p] > max(most, 0.0):
            continue
        a, b = int(pairs[p, 0]), int(pairs[p, 1])
        place_spheres(frames, bodies, spheres, a, ready, points)
        place_spheres(frames, bodies, spheres, b, ready, points)
        least, _, high = pair_bounds(bodies, spheres, shapes, points, still, a, b, 0)
        least, high = least - pairs[p, 3], high - pairs[p, 3]
        if nearest:
            most = min(most, high)
        elif high < most - ROUNDING:
            found[0], low[0] = p, high
            write_poses(frames, bodies, placed, a, b, poses, 0)
            return -1 - p
        elif least <= most:
            far, high = hull_bounds(
                frames,
                bodies,
                shapes,
                corners,
                neighbours,
                axes,
                p,
                a,
                b,
                most + pairs[p, 3],
                most + pairs[p, 3] + ROUNDING,
            )
            least = max(least, far - pairs[p, 3] - ROUNDING)
            if is_exact(bodies, a, b) and high - pairs[p, 3] <= most:
                found[0], low[0] = p, high - pairs[p, 3]
                write_poses(frames, bodies, placed, a, b, poses, 0)
                return -1 - p
        # Overlapping spheres say nothing about depths.
        least = max(least, bounds[p])
        if (least <= max(most, 0.0)) if nearest else (least <= most):
            k = count
            value = least if least > 0.0 else 0.0
            while k > 0 and low[k - 1] > value:
                found[k], low[k] = found[k - 1], low[k - 1]
                k -= 1
            found[k], low[k] = p, value
            count += 1
    for k in range(count):
        p = found[k]
        write_poses(frames, bodies, placed, int(pairs[p, 0]), int(pairs[p, 1]), poses, k)
    limit[0] = most
    return count
