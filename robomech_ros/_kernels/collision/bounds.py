"""Which pairs of bodies may be in contact: bounds of their distances by spheres.

A body is covered by spheres, and holds as many inside it: rows of ``spheres`` (s, 8) with centre
and radius of both.  Rows of ``bodies`` (b, 5) have the frame that the body moves with, its first
sphere and the one after its last, the kind of simple shape that it is or lies in (``SPHERES`` for
none) and 1 where it is that shape exactly; rows of ``around`` (b, 4) a sphere around all of it.
Centres are in the frame.  Rows of ``shapes`` (b, 15) hold pose and sizes of the simple shape, rows
of ``placed`` (b, 12) the pose of the body itself, both in the frame.  Rows of ``pairs`` (p, 5) have
the two bodies, of which the first has spheres, the frame before the first joint that moves them
against each other, by how much (m) the pair counts as nearer than it is, and the number of its
group: the pairs of bodies of the same two links or objects, which stand one behind the other.
"""

import math

import numpy as np

from robomech_ros._kernels.collision.shapes import (
    DRIVE,
    GAIN,
    KIND,
    PARENT,
    SPHERES,
    compose,
    place_frames,
    signed_distance,
)
from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT1, OUT1, OUT2, f8, i8

# A pair is surely too near if spheres inside the bodies are, by more than rounding (m).
_ROUNDING = 1e-9
# How often a piece of a motion is halved at most.
_DEEPEST = 40
FREE, CONTACT, FULL = 0, 1, 2


@lean
def _transformed(frames, f, x, y, z):
    return (
        frames[f, 0] * x + frames[f, 1] * y + frames[f, 2] * z + frames[f, 9],
        frames[f, 3] * x + frames[f, 4] * y + frames[f, 5] * z + frames[f, 10],
        frames[f, 6] * x + frames[f, 7] * y + frames[f, 8] * z + frames[f, 11],
    )


@lean
def _place_bodies(frames, bodies, around, placed):
    """Write where the spheres around the bodies are to placed (b, 3)."""
    for b in range(bodies.shape[0]):
        f = int(bodies[b, 0])
        x, y, z = _transformed(frames, f, around[b, 0], around[b, 1], around[b, 2])
        placed[b, 0], placed[b, 1], placed[b, 2] = x, y, z


@lean
def _place_spheres(frames, bodies, spheres, b, ready, placed):
    """Write where the spheres of body b are to placed (s, 6), outer and inner, if not done yet."""
    if ready[b]:
        return
    ready[b] = 1
    f = int(bodies[b, 0])
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        x, y, z = _transformed(frames, f, spheres[s, 0], spheres[s, 1], spheres[s, 2])
        placed[s, 0], placed[s, 1], placed[s, 2] = x, y, z
        x, y, z = _transformed(frames, f, spheres[s, 4], spheres[s, 5], spheres[s, 6])
        placed[s, 3], placed[s, 4], placed[s, 5] = x, y, z


@lean
def _far_bound(bodies, around, shapes, middles, a, b):
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
def _pair_bounds(bodies, spheres, shapes, placed, moved, a, b, c):
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
def _write_poses(frames, bodies, placed, a, b, poses, k):
    """Write the poses of the two bodies of a pair to rows 2 k and 2 k + 1 of poses."""
    compose(frames, int(bodies[a, 0]), placed, a, 0, poses, 2 * k)
    compose(frames, int(bodies[b, 0]), placed, b, 0, poses, 2 * k + 1)


@kernel(i8(IN2, IN1, OUT2))
def frames_at(joints, q, frames):
    """Write the poses (m + 1, 12) of all frames at drives q."""
    place_frames(joints, q, frames)
    return 0


@kernel(i8(IN2, IN2, IN2, IN2, IN2, IN2, IN2, IN1, i8, OUT1, IOUT1, OUT1, OUT2))
def near_pairs(
    joints, bodies, around, spheres, shapes, placed, pairs, q, nearest, limit, found, low, poses
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
    _place_bodies(frames, bodies, around, middles)
    points = np.empty((spheres.shape[0], 6))
    ready = np.zeros(bodies.shape[0], np.int64)
    still = np.zeros((spheres.shape[0], 1))
    most = math.inf if nearest else limit[0]
    bounds = np.empty(pairs.shape[0])
    for p in range(pairs.shape[0]):
        a, b = int(pairs[p, 0]), int(pairs[p, 1])
        bounds[p] = _far_bound(bodies, around, shapes, middles, a, b) - pairs[p, 3]
        if nearest:
            # Not farther than the spheres around both are wide, however they lie.
            most = min(most, bounds[p] + 2.0 * (around[a, 3] + around[b, 3]))
    if nearest:
        # The pairs with the least bounds first: what they say leaves out most of the others.
        for p in range(pairs.shape[0]):
            if bounds[p] > 0.0 and bounds[p] > 0.25 * most:
                continue
            a, b = int(pairs[p, 0]), int(pairs[p, 1])
            _place_spheres(frames, bodies, spheres, a, ready, points)
            _place_spheres(frames, bodies, spheres, b, ready, points)
            _, _, high = _pair_bounds(bodies, spheres, shapes, points, still, a, b, 0)
            most = min(most, high - pairs[p, 3])
    count = 0
    for p in range(pairs.shape[0]):
        if bounds[p] > max(most, 0.0):
            continue
        a, b = int(pairs[p, 0]), int(pairs[p, 1])
        _place_spheres(frames, bodies, spheres, a, ready, points)
        _place_spheres(frames, bodies, spheres, b, ready, points)
        least, _, high = _pair_bounds(bodies, spheres, shapes, points, still, a, b, 0)
        least, high = least - pairs[p, 3], high - pairs[p, 3]
        if nearest:
            most = min(most, high)
        elif high < most - _ROUNDING:
            found[0], low[0] = p, high
            _write_poses(frames, bodies, placed, a, b, poses, 0)
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
        _write_poses(frames, bodies, placed, int(pairs[p, 0]), int(pairs[p, 1]), poses, k)
    limit[0] = most
    return count


@lean
def _travel(joints, frames, f, x, y, z, radius, rates, moved):
    """Bound how far a sphere moves against each frame before its own, in moved (m + 1,).

    Joint i moves by at most rates[i] to either side.  A point of a body moves with a joint by that
    angle times its distance from the axis, which the joints after that one may have lengthened.
    """
    total = 0.0
    moved[f] = 0.0
    while f > 0:
        i = f - 1
        if joints[i, KIND] == 0.0:
            ux, uy, uz = frames[f, 2], frames[f, 5], frames[f, 8]
            dx, dy, dz = x - frames[f, 9], y - frames[f, 10], z - frames[f, 11]
            along = ux * dx + uy * dy + uz * dz
            square = dx * dx + dy * dy + dz * dz - along * along
            total += rates[i] * (math.sqrt(max(square, 0.0)) + radius + total)
        else:
            total += rates[i]
        f = int(joints[i, PARENT])
        moved[f] = total


@lean
def _joint_rates(joints, curve, middle, rates):
    """Write how far each joint is from its middle on a curve (d + 1, n) of Bernstein type."""
    for i in range(joints.shape[0]):
        k = int(joints[i, DRIVE])
        most = 0.0
        for d in range(curve.shape[0]):
            most = max(most, abs(curve[d, k] - middle[k]))
        rates[i] = abs(joints[i, GAIN]) * most


@lean
def _halve(curve, left, right):
    """Write both halves of a curve (d + 1, n) of Bernstein type, by de Casteljau's method."""
    size = curve.shape[0]
    for k in range(curve.shape[1]):
        for d in range(size):
            right[d, k] = curve[d, k]
        for d in range(size):
            left[d, k] = right[0, k]
            for e in range(size - 1 - d):
                right[e, k] = 0.5 * (right[e, k] + right[e + 1, k])


@kernel(i8(IN2, IN2, IN2, IN2, IN2, IN2, IN2, IIN1, i8, IN2, IN1, OUT1, OUT2, IOUT1))
def sweep(
    joints,
    bodies,
    around,
    spheres,
    shapes,
    placed,
    pairs,
    tested,
    count,
    curve,
    limits,
    found,
    open_parts,
    open_groups,
):
    """Prove that pairs keep their distance on a curve (d + 1, n) of Bernstein type, from 0 to 1.

    Parts on which spheres do not decide, although a body moves by less than limits[1] (m) there,
    are left to others: begin and end in open_parts, the group in open_groups.  The distance to keep
    is limits[0].  The first ``count`` of ``tested`` are the pairs.

    Returns FREE, CONTACT, or FULL where there are more open parts than places.  found (4,) is how
    many open parts there are, where a contact is or until where all is done, the pair in contact,
    and the end of what is proved before it.
    """
    frames = np.empty((joints.shape[0] + 1, 12))
    middles = np.empty((bodies.shape[0], 3))
    points = np.empty((spheres.shape[0], 6))
    ready = np.empty(bodies.shape[0], np.int64)
    size, n = curve.shape
    curves = np.empty((_DEEPEST + 2, size, n))
    ends = np.empty((_DEEPEST + 2, 2))
    depths = np.empty(_DEEPEST + 2, np.int64)
    lists = np.empty((_DEEPEST + 2, count), np.int64)
    lengths = np.empty(_DEEPEST + 2, np.int64)
    rates = np.empty(joints.shape[0])
    moved = np.empty((spheres.shape[0], joints.shape[0] + 1))
    middle_moved = np.empty((bodies.shape[0], joints.shape[0] + 1))
    left, right = np.empty((size, n)), np.empty((size, n))
    lists[0] = tested[:count]
    lengths[0] = count
    curves[0] = curve
    ends[0, 0], ends[0, 1] = 0.0, 1.0
    depths[0] = 0
    waiting, parts = 1, 0
    found[0] = 0.0
    while waiting:
        waiting -= 1
        depth = depths[waiting]
        begin, end = ends[waiting, 0], ends[waiting, 1]
        _halve(curves[waiting], left, right)
        middle = right[0]
        _joint_rates(joints, curves[waiting], middle, rates)
        place_frames(joints, middle, frames)
        _place_bodies(frames, bodies, around, middles)
        ready[:] = 0
        for b in range(bodies.shape[0]):
            if bodies[b, 0] > 0.0:
                _travel(
                    joints,
                    frames,
                    int(bodies[b, 0]),
                    middles[b, 0],
                    middles[b, 1],
                    middles[b, 2],
                    0.0,
                    rates,
                    middle_moved[b],
                )
            else:
                middle_moved[b, 0] = 0.0
        kept, largest = 0, 0.0
        for i in range(lengths[depth]):
            p = lists[depth, i]
            a, b, c = int(pairs[p, 0]), int(pairs[p, 1]), int(pairs[p, 2])
            keep = limits[0] + pairs[p, 3]
            bound = _far_bound(bodies, around, shapes, middles, a, b) - middle_moved[a, c]
            if bodies[b, 0] > 0.0:
                bound -= middle_moved[b, c]
            if bound > keep:
                continue
            for which in (a, b):
                if not ready[which]:
                    _place_spheres(frames, bodies, spheres, which, ready, points)
                    f = int(bodies[which, 0])
                    for s in range(int(bodies[which, 1]), int(bodies[which, 2])):
                        if f > 0:
                            _travel(
                                joints,
                                frames,
                                f,
                                points[s, 0],
                                points[s, 1],
                                points[s, 2],
                                0.0,
                                rates,
                                moved[s],
                            )
                        else:
                            moved[s, 0] = 0.0
            low, moving, high = _pair_bounds(bodies, spheres, shapes, points, moved, a, b, c)
            if moving > keep:
                continue
            if high < keep - _ROUNDING:
                found[0], found[1], found[2], found[3] = parts, 0.5 * (begin + end), p, begin
                return CONTACT
            lists[depth + 1, kept] = p
            kept += 1
            largest = max(largest, low - moving)
        if not kept:
            continue
        if largest > limits[1] and depth < _DEEPEST:
            lengths[depth + 1] = kept
            half = 0.5 * (begin + end)
            curves[waiting], curves[waiting + 1] = right, left
            ends[waiting, 0], ends[waiting, 1] = half, end
            ends[waiting + 1, 0], ends[waiting + 1, 1] = begin, half
            depths[waiting], depths[waiting + 1] = depth + 1, depth + 1
            waiting += 2
            continue
        if parts + kept > open_groups.shape[0]:
            found[0], found[1] = parts, begin
            return FULL
        before = -1
        for i in range(kept):
            group = int(pairs[lists[depth + 1, i], 4])
            if group != before:
                before = group
                open_parts[parts, 0], open_parts[parts, 1] = begin, end
                open_groups[parts] = group
                parts += 1
    found[0], found[1] = parts, 1.0
    return FREE


@lean
def _cut(curve, begin, end):
    """Replace a curve (d + 1, n) of Bernstein type by its part from begin to end."""
    size = curve.shape[0]
    for k in range(curve.shape[1]):
        for d in range(size - 1):
            for e in range(size - 1, d, -1):
                curve[e, k] += (1.0 - end) * (curve[e - 1, k] - curve[e, k])
        share = begin / end if end > 0.0 else 0.0
        for d in range(size - 1):
            for e in range(size - 1 - d):
                curve[e, k] += share * (curve[e + 1, k] - curve[e, k])


@kernel(i8(IN2, IN2, IN2, IN2, IN2, IN2, IIN1, i8, IN2, IN1, f8, IOUT1, OUT1, OUT1, OUT2))
def group_part(
    joints,
    bodies,
    spheres,
    shapes,
    placed,
    pairs,
    tested,
    size,
    curve,
    part,
    keep,
    found,
    travel,
    low,
    poses,
):
    """Find the pairs of the first ``size`` tested that spheres leave open on a part of a curve.

    They are those that may come nearer than ``keep`` (m).  Returns how many there are, the nearest
    first: their numbers in found, how far a point of one can move against the other on half the
    part in travel, bounds of their distances in the middle in low, and where the bodies are there
    in poses.
    """
    whole, middle, other = curve.copy(), np.empty(curve.shape), np.empty(curve.shape)
    _cut(whole, part[0], part[1])
    _halve(whole, middle, other)
    frames = np.empty((joints.shape[0] + 1, 12))
    rates = np.empty(joints.shape[0])
    place_frames(joints, other[0], frames)
    _joint_rates(joints, whole, other[0], rates)
    points = np.empty((spheres.shape[0], 6))
    ready = np.zeros(bodies.shape[0], np.int64)
    moved = np.zeros((spheres.shape[0], joints.shape[0] + 1))
    wide = np.zeros((spheres.shape[0], joints.shape[0] + 1))
    count = 0
    for i in range(size):
        p = tested[i]
        a, b, c = int(pairs[p, 0]), int(pairs[p, 1]), int(pairs[p, 2])
        for which in (a, b):
            if ready[which]:
                continue
            _place_spheres(frames, bodies, spheres, which, ready, points)
            f = int(bodies[which, 0])
            for s in range(int(bodies[which, 1]), int(bodies[which, 2])):
                x, y, z = points[s, 0], points[s, 1], points[s, 2]
                _travel(joints, frames, f, x, y, z, 0.0, rates, moved[s])
                _travel(joints, frames, f, x, y, z, spheres[s, 3], rates, wide[s])
        least, moving, _ = _pair_bounds(bodies, spheres, shapes, points, moved, a, b, c)
        if moving > keep + pairs[p, 3]:
            continue
        total = 0.0
        for which in (a, b):
            largest = 0.0
            for s in range(int(bodies[which, 1]), int(bodies[which, 2])):
                largest = max(largest, wide[s, c])
            total += largest
        k = count
        while k > 0 and low[k - 1] > least:
            found[k], low[k], travel[k] = found[k - 1], low[k - 1], travel[k - 1]
            k -= 1
        found[k], low[k], travel[k] = p, least, total
        count += 1
    for k in range(count):
        p = found[k]
        _write_poses(frames, bodies, placed, int(pairs[p, 0]), int(pairs[p, 1]), poses, k)
    return count
