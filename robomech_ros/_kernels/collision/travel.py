"""Bounds of the travel of bodies from bounds of the travel of joints."""

import math

from robomech_ros._kernels.collision.bounds import place_spheres
from robomech_ros._kernels.collision.shapes import KIND, PARENT
from robomech_ros._kernels.compiling.jit import flat, lean


@lean
def point_travel(joints, frames, f, point, travels, moved):
    """Write bounds of the travel of a point of frame f against each frame before it to moved.

    Joint i moves by at most travels[i] to either side.  It moves the point by that angle times the
    distance from its axis, which the joints behind it may have increased.
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
            total += travels[i] * (math.sqrt(max(square, 0.0)) + total)
        else:
            total += travels[i]
        f = int(joints[i, PARENT])
        moved[f] = total


@flat
def move_spheres(tables, posture, b):
    """Place the spheres of body b and bound their travel, unless they are ready."""
    if posture.ready[b]:
        return
    place_spheres(tables, posture, b)
    bodies, points = tables.bodies, posture.points
    f = int(bodies[b, 0])
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        point_travel(tables.joints, posture.frames, f, points[s], posture.travels, posture.moved[s])


@flat
def _hull_travel(tables, posture, b, c):
    """Return a bound of the travel of body b against frame c from the travel of its spheres."""
    joints, bodies, travels = tables.joints, tables.bodies, posture.travels
    f = int(bodies[b, 0])
    growth = 1.0
    while f > 0 and f != c:
        if joints[f - 1, KIND] == 0.0:
            growth *= 1.0 + travels[f - 1]
        f = int(joints[f - 1, PARENT])
    largest = 0.0
    for s in range(int(bodies[b, 1]), int(bodies[b, 2])):
        largest = max(largest, posture.moved[s, c] + (growth - 1.0) * tables.spheres[s, 3])
    return largest


@flat
def pair_travel(tables, posture, p):
    """Return a bound of the relative travel of points of both bodies of pair p."""
    pairs = tables.pairs
    c = int(pairs[p, 2])
    travel = _hull_travel(tables, posture, int(pairs[p, 0]), c)
    return travel + _hull_travel(tables, posture, int(pairs[p, 1]), c)
