"""Proof that motions are free of contacts, and the parts that remain undecided."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import types

from robomech_ros._kernels.collision.bounds import (
    ROUNDING,
    UNCERTAIN,
    far_bound,
    insert_pair,
    pair_bounds,
    place_bodies,
    room_for_posture,
    write_poses,
)
from robomech_ros._kernels.collision.cells import fill_cells
from robomech_ros._kernels.collision.curves import cut, halve, joint_travels
from robomech_ros._kernels.collision.grids import APART, cells_apart
from robomech_ros._kernels.collision.hulls import hull_bounds, is_exact
from robomech_ros._kernels.collision.shapes import place_frames
from robomech_ros._kernels.collision.tables import NEAR_PAIRS, TABLES
from robomech_ros._kernels.collision.travel import move_spheres, pair_travel, point_travel
from robomech_ros._kernels.compiling.jit import flat, inline, kernel, lean
from robomech_ros._kernels.compiling.types import IIN1, IN1, IN2, IOUT1, IOUT2, OUT1, OUT2, f8, i8

# Largest number of halvings of a motion.
DEEPEST = 40
FREE, CONTACT, FULL = 0, 1, 2
# Verdicts about a pair on a part of a motion: free, to be halved, undecided, in contact.
_CLEAR, _HALVE, _OPEN, _TOUCHING = 0, 1, 2, 3
# States of a group on a part: not tested, undecided, apart, undecided by its cells, and moving too
# far for a decision.
_NEW, _LOOKED_UP, _APART, _FILLED, _FAR = 0, 1, 2, 3, 4


class OpenParts(NamedTuple):
    """Undecided parts of a motion: start and end (k, 2), and group (k,)."""

    ends: Any
    groups: Any


class _Part(NamedTuple):
    """Working space for a part of a motion.

    The drives in its middle (n,), centres of the spheres around the bodies there (b, 3), bounds of
    the travel of these centres against each frame (b, m + 1), flags of known rows (b,), states of
    the groups (g,), and drives of a cell (n,).
    """

    middle: Any
    centres: Any
    moved: Any
    known: Any
    groups: Any
    q: Any


class _Stack(NamedTuple):
    """Waiting parts: their curves (k, d + 1, n), start and end (k, 2), and depths (k,)."""

    curves: Any
    ends: Any
    depths: Any


@inline
def _room_for_part(tables, middle):
    b = tables.bodies.shape[0]
    return _Part(
        middle,
        np.empty((b, 3)),
        np.empty((b, tables.joints.shape[0] + 1)),
        np.zeros(b, np.int64),
        np.zeros(tables.grids.shape[0], np.int64),
        np.empty(middle.size),
    )


@inline
def _room_for_stack(curve):
    size, n = curve.shape
    stack = _Stack(
        np.empty((DEEPEST + 2, size, n)),
        np.empty((DEEPEST + 2, 2)),
        np.zeros(DEEPEST + 2, np.int64),
    )
    stack.curves[0] = curve
    stack.ends[0, 0], stack.ends[0, 1] = 0.0, 1.0
    return stack


@lean
def _push_halves(stack, waiting, right, left):
    """Replace the part at the top of the stack by its halves, the left half on top."""
    begin, end = stack.ends[waiting, 0], stack.ends[waiting, 1]
    half = 0.5 * (begin + end)
    for d in range(right.shape[0]):
        for k in range(right.shape[1]):
            stack.curves[waiting, d, k] = right[d, k]
            stack.curves[waiting + 1, d, k] = left[d, k]
    stack.ends[waiting, 0], stack.ends[waiting, 1] = half, end
    stack.ends[waiting + 1, 0], stack.ends[waiting + 1, 1] = begin, half
    stack.depths[waiting] += 1
    stack.depths[waiting + 1] = stack.depths[waiting]


@flat
def _place_middle(tables, posture, curve, middle):
    """Place the frames in the middle of a curve, and bound the travel of the joints from there."""
    joint_travels(tables.joints, curve, middle, posture.travels)
    place_frames(tables.joints, middle, posture.frames)
    posture.ready[:] = 0


@flat
def _start_part(tables, posture, part, curve):
    """Place all bodies in the middle of a part, and reset the rest of the working space."""
    _place_middle(tables, posture, curve, part.middle)
    place_bodies(posture.frames, tables.bodies, tables.around, part.centres)
    part.groups[:] = _NEW
    part.known[:] = 0


@flat
def _centre_travel(tables, posture, part, b, c):
    """Bound the travel of the centre of the sphere around body b against frame c."""
    f = int(tables.bodies[b, 0])
    if f == 0:
        return 0.0
    if not part.known[b]:
        part.known[b] = 1
        point_travel(
            tables.joints, posture.frames, f, part.centres[b], posture.travels, part.moved[b]
        )
    return part.moved[b, c]


@flat
def _travel_of_centres(tables, posture, part, a, b, c):
    """Bound the relative travel of the centres of the spheres around two bodies."""
    travel = _centre_travel(tables, posture, part, a, c)
    return travel + _centre_travel(tables, posture, part, b, c)


@flat
def _judge_group(tables, posture, part, curve, p, keep, step):
    """Return the state of the group of pair p by its cells, and by one sphere around each side.

    If they move by more than a step (m), an undecided group is _FAR, and its part will be halved.
    """
    grids = tables.grids
    g, c = int(tables.pairs[p, 4]), int(tables.pairs[p, 2])
    a, b = int(grids[g, 5]), int(grids[g, 6])
    travel = 0.0
    if a >= 0:
        travel = _travel_of_centres(tables, posture, part, a, b, c)
        if far_bound(tables, part.centres, a, b) - travel > keep:
            return _APART
    if grids[g, 2] >= 0.0 and APART == cells_apart(
        grids, tables.cells, g, curve, part.middle, keep
    ):
        return _APART
    return _FAR if travel > step else _LOOKED_UP


@lean
def _skip_apart(tables, part, waiting, i):
    """Return the index of the next pair after i; skip the group of pair i if it is apart."""
    g = int(tables.pairs[waiting[i], 4])
    i += 1
    if part.groups[g] == _APART:
        last = int(tables.grids[g, 4])
        while i < waiting.size and waiting[i] < last:
            i += 1
    return i


@flat
def _spheres_moved(tables, posture, p):
    """Return the bounds of `pair_bounds`, after placing and moving the spheres of both bodies."""
    for i in range(2):
        move_spheres(tables, posture, int(tables.pairs[p, i]))
    return pair_bounds(tables, posture, p)


@flat
def _judge(tables, posture, part, curve, p, limits, finest):
    """Return the verdict about pair p on a part of a motion."""
    pairs, around = tables.pairs, tables.around
    a, b, c = int(pairs[p, 0]), int(pairs[p, 1]), int(pairs[p, 2])
    keep = limits[0] + pairs[p, 3]
    g, groups = int(pairs[p, 4]), part.groups
    if groups[g] == _NEW:
        groups[g] = _judge_group(tables, posture, part, curve, p, keep, limits[1])
    if groups[g] == _APART:
        return _CLEAR
    if groups[g] == _FAR:
        return _HALVE
    bound = far_bound(tables, part.centres, a, b)
    travel = _travel_of_centres(tables, posture, part, a, b, c)
    if bound - travel > keep:
        return _CLEAR
    if travel > max(limits[1], bound + around[a, 3] + around[b, 3]):
        # The bodies could pass each other: only a shorter part can be proved.
        return _HALVE
    low, moving, high = _spheres_moved(tables, posture, p)
    if moving > keep:
        return _CLEAR
    if high < keep - ROUNDING:
        return _TOUCHING
    if low - moving > limits[1]:
        return _HALVE
    if groups[g] == _LOOKED_UP and tables.grids[g, 2] >= 0.0:
        groups[g] = _FILLED
        cell = fill_cells(tables, posture, g, curve, part.middle, part.q, keep)
        _place_middle(tables, posture, curve, part.middle)
        if cell == APART:
            groups[g] = _APART
            return _CLEAR
        for i in range(2):
            move_spheres(tables, posture, int(pairs[p, i]))
    return _judge_by_hulls(tables, posture, p, limits, finest)


@flat
def _judge_by_hulls(tables, posture, p, limits, finest):
    """Return the verdict about pair p by the hulls of its bodies in the middle of a part."""
    pairs = tables.pairs
    keep = limits[0] + pairs[p, 3]
    travel = pair_travel(tables, posture, p)
    # If no proof is required, it is enough that the middle is free.
    enough = keep + UNCERTAIN + (travel if limits[3] == 0.0 else 0.0)
    low, high = hull_bounds(tables, posture.frames, p, keep, enough)
    if low > keep + travel + UNCERTAIN:
        return _CLEAR
    if is_exact(tables.bodies, int(pairs[p, 0]), int(pairs[p, 1])) and high <= keep:
        return _TOUCHING
    if high > keep and travel > finest:
        return _HALVE
    return _OPEN if low <= keep + UNCERTAIN or limits[3] == 0.0 else _CLEAR


@lean
def _add_open(pairs, left_open, begin, end, open_parts, count):
    """Add an open part for each group of the undecided pairs; return the new count."""
    before = -1
    for i in range(left_open.size):
        group = int(pairs[left_open[i], 4])
        if group != before:
            before = group
            open_parts.ends[count, 0], open_parts.ends[count, 1] = begin, end
            open_parts.groups[count] = group
            count += 1
    return count


@kernel(i8(TABLES, IIN1, IN2, IN1, IOUT2, OUT1, types.NamedTuple((OUT2, IOUT1), OpenParts)))
def sweep(tables, tested, curve, limits, lists, found, open_parts):
    """Prove that pairs keep a distance on a curve of Bernstein coefficients (d + 1, n).

    The distance to keep is limits[0] (m).  Hulls are tested if a body moves by less than limits[1].
    An undecided part becomes an open part if no body moves by more than limits[2] on it, or if the
    hulls overlap.  If limits[3] is not 0, nothing is proved: only parts are open whose hulls are
    not shown apart in the middle.  The pairs are those of ``tested`` (k,); lists (DEEPEST + 2, k)
    is working space.

    Returns FREE, CONTACT, or FULL if ``open_parts`` is too small.  found (4,) receives the number
    of open parts, the parameter of the contact or of the end of the tested motion, the pair in
    contact, and the end of the motion proved before the contact.
    """
    count = tested.size
    posture, stack = room_for_posture(tables), _room_for_stack(curve)
    left, right = np.empty(curve.shape), np.empty(curve.shape)
    part = _room_for_part(tables, right[0])
    lengths = np.empty(DEEPEST + 2, np.int64)
    lists[0, :] = tested
    lengths[0] = count
    waiting, parts = 1, 0
    found[0] = 0.0
    while waiting:
        waiting -= 1
        depth, begin, end = stack.depths[waiting], stack.ends[waiting, 0], stack.ends[waiting, 1]
        piece = stack.curves[waiting]
        halve(piece, left, right)
        _start_part(tables, posture, part, piece)
        finest = limits[2] if depth < DEEPEST else math.inf
        kept, left_open, i = 0, 0, 0
        remaining = lists[depth, : lengths[depth]]
        while i < remaining.size:
            p = remaining[i]
            verdict = _judge(tables, posture, part, piece, p, limits, finest)
            i = _skip_apart(tables, part, remaining, i)
            if verdict == _TOUCHING:
                found[0], found[1], found[2], found[3] = parts, 0.5 * (begin + end), p, begin
                return CONTACT
            if verdict == _HALVE:
                lists[depth + 1, kept] = p
                kept += 1
            elif verdict == _OPEN:
                # Undecided pairs are at the end of the list.
                left_open += 1
                lists[depth + 1, count - left_open] = p
        if left_open:
            if parts + left_open > open_parts.groups.size:
                found[0], found[1] = parts, begin
                return FULL
            last = lists[depth + 1, count - left_open :]
            parts = _add_open(tables.pairs, last, begin, end, open_parts, parts)
        if kept:
            lengths[depth + 1] = kept
            _push_halves(stack, waiting, right, left)
            waiting += 2
    found[0], found[1] = parts, 1.0
    return FREE


@kernel(i8(TABLES, IIN1, IN2, IN1, f8, OUT1, NEAR_PAIRS))
def group_part(tables, tested, curve, ends, keep, travel, near):
    """Find the tested pairs that may come nearer than ``keep`` (m) on a part of a curve.

    The part is from ends[0] to ends[1] of a curve of Bernstein coefficients (d + 1, n).  Bounds of
    distances and poses of bodies are those in its middle.  ``travel`` (p,) bounds the travel (m) of
    points of one body against the other on half the part.

    Returns the number of pairs.
    """
    whole, left, right = curve.copy(), np.empty(curve.shape), np.empty(curve.shape)
    cut(whole, ends[0], ends[1])
    halve(whole, left, right)
    posture = room_for_posture(tables)
    _place_middle(tables, posture, whole, right[0])
    count = 0
    for i in range(tested.size):
        p = tested[i]
        low, moving, _ = _spheres_moved(tables, posture, p)
        if moving <= keep + tables.pairs[p, 3]:
            count = insert_pair(near, count, p, low)
    for k in range(count):
        travel[k] = pair_travel(tables, posture, near.pairs[k])
    write_poses(tables, posture.frames, near, count)
    return count
