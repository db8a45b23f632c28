"""Motions on which spheres show that bodies stay apart, and the parts on which they do not.

The tables are those of `bounds`.
"""

import math

import numpy as np

from robomech_ros._kernels.collision.bounds import (
    ROUNDING,
    UNCERTAIN,
    far_bound,
    pair_bounds,
    place_bodies,
    place_spheres,
    write_poses,
)
from robomech_ros._kernels.collision.grids import CELL, CELLS, MOST_TOUCHED, cell_number, cell_range
from robomech_ros._kernels.collision.hulls import hull_bounds, is_exact
from robomech_ros._kernels.collision.shapes import DRIVE, GAIN, KIND, PARENT, place_frames
from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT1, IOUT2, OUT1, OUT2, f8, i8

# The most halvings of a piece of a motion.
DEEPEST = 40
# How much farther (m) than asked for is enough for cells of links.
_SPARE = 0.004
FREE, CONTACT, FULL = 0, 1, 2
# What cells say, besides the number of one that is not known.
APART, UNDECIDED = -1, -2


@lean
def _travel(joints, frames, f, point, rates, moved):
    """Bound how far a point of frame f moves against each frame before it, in moved (m + 1,).

    Joint i moves by at most rates[i] to either side.  A point of a body moves with a joint by that
    angle times its distance from the axis, which the joints after that one may have lengthened.
    """
    total = 0.0
    moved[f] = 0.0
    while f > 0:
        i = f - 1
        if joints[i, KIND] == 0.0:
            ux, uy, uz = frames[f, 2], frames[f, 5], frames[f, 8]
            dx, dy, dz = point[0] - frames[f, 9], point[1] - frames[f, 10], point[2] - frames[f, 11]
            along = ux * dx + uy * dy + uz * dz
            square = dx * dx + dy * dy + dz * dz - along * along
            total += rates[i] * (math.sqrt(max(square, 0.0)) + total)
        else:
            total += rates[i]
        f = int(joints[i, PARENT])
        moved[f] = total


@lean
def _move_spheres(joints, frames, bodies, spheres, b, rates, ready, points, moved):
    """Write where the spheres of body b are, and how far they move, if not done yet."""
    if ready[b]:
        return
    place_spheres(frames, bodies, spheres, b, ready, points)
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        _travel(joints, frames, int(bodies[b, 0]), points[s], rates, moved[s])


@lean
def _hull_travel(joints, bodies, spheres, b, c, rates, moved):
    """Bound how far any point of body b moves against frame c, from how far its spheres do."""
    f = int(bodies[b, 0])
    growth = 1.0
    while f > 0 and f != c:
        if joints[f - 1, KIND] == 0.0:
            growth *= 1.0 + rates[f - 1]
        f = int(joints[f - 1, PARENT])
    largest = 0.0
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        largest = max(largest, moved[s, c] + (growth - 1.0) * spheres[s, 3])
    return largest


@lean
def _drive_rate(curve, middle, k):
    """Return how far drive k is from its middle on a curve (d + 1, n) of Bernstein type."""
    most = 0.0
    for d in range(curve.shape[0]):
        most = max(most, abs(curve[d, k] - middle[k]))
    return most


@lean
def _joint_rates(joints, curve, middle, rates):
    """Write how far each joint is from its middle on a curve (d + 1, n) of Bernstein type."""
    for i in range(joints.shape[0]):
        rates[i] = abs(joints[i, GAIN]) * _drive_rate(curve, middle, int(joints[i, DRIVE]))


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


@lean
def _cells_apart(grids, cells, g, curve, middle, keep):
    """Whether group g is farther apart than a distance (m) in all cells that a curve touches.

    Returns APART, UNDECIDED, or the number of the first cell that is not known.
    """
    k, j = int(grids[g, 0]), int(grids[g, 1])
    first, along = cell_range(middle[k], _drive_rate(curve, middle, k))
    second, across = 0, 1
    if j >= 0:
        second, across = cell_range(middle[j], _drive_rate(curve, middle, j))
    if max(along, across) > MOST_TOUCHED:
        return UNDECIDED
    unknown = APART
    for v in range(second, second + across):
        for u in range(first, first + along):
            cell = cell_number(grids, g, u, v)
            if cells[cell] == 0.0:
                unknown = cell
            elif cells[cell] <= keep:
                return UNDECIDED
    return unknown


@lean
def _fill_cell(
    joints,
    bodies,
    spheres,
    shapes,
    pairs,
    corners,
    neighbours,
    axes,
    grids,
    cells,
    g,
    cell,
    middle,
    keep,
    frames,
    rates,
    ready,
    points,
    moved,
):
    """Compute the bound of a cell of group g, with its joints moved to the middle of the cell."""
    place = cell - int(grids[g, 2])
    middle[int(grids[g, 0])] = (place % CELLS + 0.5) * CELL
    if grids[g, 1] >= 0.0:
        middle[int(grids[g, 1])] = (place // CELLS + 0.5) * CELL
    place_frames(joints, middle, frames)
    for i in range(joints.shape[0]):
        turns = joints[i, DRIVE] == grids[g, 0] or joints[i, DRIVE] == grids[g, 1]
        rates[i] = (0.5 + 1e-9) * CELL if turns else 0.0
    ready[:] = 0
    least = math.inf
    for p in range(int(grids[g, 3]), int(grids[g, 4])):
        a, b, c = int(pairs[p, 0]), int(pairs[p, 1]), int(pairs[p, 2])
        for which in (a, b):
            _move_spheres(joints, frames, bodies, spheres, which, rates, ready, points, moved)
        travel = _hull_travel(joints, bodies, spheres, a, c, rates, moved)
        travel += _hull_travel(joints, bodies, spheres, b, c, rates, moved)
        _, bound, _ = pair_bounds(bodies, spheres, shapes, points, moved, a, b, c)
        enough = keep + _SPARE
        if bound <= enough:
            low, _ = hull_bounds(
                frames, bodies, shapes, corners, neighbours, axes, p, a, b, keep, enough + travel
            )
            bound = max(bound, low - travel)
        least = min(least, bound - pairs[p, 3] - UNCERTAIN)
        if least <= 0.0:
            break
    cells[cell] = least if least != 0.0 else -ROUNDING


@kernel(
    i8(
        *(IN2, IN2, IN2, IN2, IN2, IN2, IN2, IN2, IIN1, OUT2, IN2, OUT1),
        *(IIN1, i8, IN2, IN1, IOUT2, OUT1, OUT2, IOUT1),
    )
)
def sweep(
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
    tested,
    count,
    curve,
    limits,
    lists,
    found,
    open_parts,
    open_groups,
):
    """Prove that pairs keep their distance on a curve (d + 1, n) of Bernstein type, from 0 to 1.

    Hulls are looked at where a body moves by less than limits[1] (m).  Parts on which they do not
    decide although none moves by more than limits[2] there, or on which they overlap, are left to
    others: begin and end in open_parts, the group in open_groups.  If limits[3] is not 0, only
    those in whose middle hulls are not shown apart are: then nothing is proved.  The distance to
    keep is limits[0].  The first ``count`` of ``tested`` are the pairs.  There is room for lists of
    them in lists (DEEPEST + 2, count).

    Returns FREE, CONTACT, or FULL where there are more open parts than places.  found (4,) is how
    many open parts there are, where a contact is or until where all is done, the pair in contact,
    and the end of what is proved before it.
    """
    frames = np.empty((joints.shape[0] + 1, 12))
    middles = np.empty((bodies.shape[0], 3))
    points = np.empty((spheres.shape[0], 6))
    ready = np.empty(bodies.shape[0], np.int64)
    size, n = curve.shape
    curves = np.empty((DEEPEST + 2, size, n))
    ends = np.empty((DEEPEST + 2, 2))
    depths = np.empty(DEEPEST + 2, np.int64)
    lengths = np.empty(DEEPEST + 2, np.int64)
    rates = np.empty(joints.shape[0])
    moved = np.empty((spheres.shape[0], joints.shape[0] + 1))
    known = np.empty(bodies.shape[0], np.int64)
    decided = np.empty(grids.shape[0], np.int64)
    inside = np.empty(n)
    middle_moved = np.empty((bodies.shape[0], joints.shape[0] + 1))
    left, right = np.empty((size, n)), np.empty((size, n))
    lists[0, :count] = tested[:count]
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
        part = curves[waiting]
        _halve(part, left, right)
        middle = right[0]
        _joint_rates(joints, part, middle, rates)
        place_frames(joints, middle, frames)
        place_bodies(frames, bodies, around, middles)
        ready[:] = 0
        decided[:] = 0
        known[:] = 0
        kept, left_open = 0, 0
        for i in range(lengths[depth]):
            p = lists[depth, i]
            a, b, c = int(pairs[p, 0]), int(pairs[p, 1]), int(pairs[p, 2])
            keep = limits[0] + pairs[p, 3]
            bound = far_bound(bodies, around, shapes, middles, a, b)
            travel = 0.0
            for which in (a, b):
                f = int(bodies[which, 0])
                if f > 0:
                    if not known[which]:
                        known[which] = 1
                        _travel(joints, frames, f, middles[which], rates, middle_moved[which])
                    travel += middle_moved[which, c]
            if bound - travel > keep:
                continue
            g = int(pairs[p, 4])
            if not decided[g]:
                decided[g] = 1
                if (
                    grids[g, 2] >= 0.0
                    and _cells_apart(grids, cells, g, part, middle, keep) == APART
                ):
                    decided[g] = 2
            if decided[g] == 2:
                continue
            if travel > max(limits[1], bound + around[a, 3] + around[b, 3]):
                # Bodies that may change places: nothing is shown before this part is divided.
                lists[depth + 1, kept] = p
                kept += 1
                continue
            for which in (a, b):
                _move_spheres(joints, frames, bodies, spheres, which, rates, ready, points, moved)
            low, moving, high = pair_bounds(bodies, spheres, shapes, points, moved, a, b, c)
            if moving > keep:
                continue
            if high < keep - ROUNDING:
                found[0], found[1], found[2], found[3] = parts, 0.5 * (begin + end), p, begin
                return CONTACT
            if low - moving > limits[1]:
                lists[depth + 1, kept] = p
                kept += 1
                continue
            if decided[g] == 1 and grids[g, 2] >= 0.0:
                decided[g] = 3
                cell = _cells_apart(grids, cells, g, part, middle, keep)
                while cell >= 0:
                    inside[:] = middle
                    _fill_cell(
                        joints,
                        bodies,
                        spheres,
                        shapes,
                        pairs,
                        corners,
                        neighbours,
                        axes,
                        grids,
                        cells,
                        g,
                        cell,
                        inside,
                        keep,
                        frames,
                        rates,
                        ready,
                        points,
                        moved,
                    )
                    cell = _cells_apart(grids, cells, g, part, middle, keep)
                _joint_rates(joints, part, middle, rates)
                place_frames(joints, middle, frames)
                ready[:] = 0
                if cell == APART:
                    decided[g] = 2
                    continue
                for which in (a, b):
                    _move_spheres(
                        joints, frames, bodies, spheres, which, rates, ready, points, moved
                    )
            travel = _hull_travel(joints, bodies, spheres, a, c, rates, moved)
            travel += _hull_travel(joints, bodies, spheres, b, c, rates, moved)
            # Where nothing is proved, it is enough to know that the middle is free.
            enough = keep + UNCERTAIN + (travel if limits[3] == 0.0 else 0.0)
            low, high = hull_bounds(
                frames, bodies, shapes, corners, neighbours, axes, p, a, b, keep, enough
            )
            if low > keep + travel + UNCERTAIN:
                continue
            if is_exact(bodies, a, b) and high <= keep:
                found[0], found[1], found[2], found[3] = parts, 0.5 * (begin + end), p, begin
                return CONTACT
            if high > keep and travel > limits[2] and depth < DEEPEST:
                lists[depth + 1, kept] = p
                kept += 1
            elif low <= keep + UNCERTAIN or limits[3] == 0.0:
                # Pairs that stay open stand at the end of the list.
                left_open += 1
                lists[depth + 1, count - left_open] = p
        if left_open:
            if parts + left_open > open_groups.shape[0]:
                found[0], found[1] = parts, begin
                return FULL
            before = -1
            for i in range(count - left_open, count):
                group = int(pairs[lists[depth + 1, i], 4])
                if group != before:
                    before = group
                    open_parts[parts, 0], open_parts[parts, 1] = begin, end
                    open_groups[parts] = group
                    parts += 1
        if kept:
            lengths[depth + 1] = kept
            half = 0.5 * (begin + end)
            curves[waiting], curves[waiting + 1] = right, left
            ends[waiting, 0], ends[waiting, 1] = half, end
            ends[waiting + 1, 0], ends[waiting + 1, 1] = begin, half
            depths[waiting], depths[waiting + 1] = depth + 1, depth + 1
            waiting += 2
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
    count = 0
    for i in range(size):
        p = tested[i]
        a, b, c = int(pairs[p, 0]), int(pairs[p, 1]), int(pairs[p, 2])
        for which in (a, b):
            _move_spheres(joints, frames, bodies, spheres, which, rates, ready, points, moved)
        least, moving, _ = pair_bounds(bodies, spheres, shapes, points, moved, a, b, c)
        if moving > keep + pairs[p, 3]:
            continue
        total = _hull_travel(joints, bodies, spheres, a, c, rates, moved)
        total += _hull_travel(joints, bodies, spheres, b, c, rates, moved)
        k = count
        while k > 0 and low[k - 1] > least:
            found[k], low[k], travel[k] = found[k - 1], low[k - 1], travel[k - 1]
            k -= 1
        found[k], low[k], travel[k] = p, least, total
        count += 1
    for k in range(count):
        p = found[k]
        write_poses(frames, bodies, placed, int(pairs[p, 0]), int(pairs[p, 1]), poses, k)
    return count
