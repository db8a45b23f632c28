"""Signed distance of a point from the border of the convex hull of a few points in a plane."""

import math

from robomech_ros._kernels.compiling.jit import kernel, lean
from robomech_ros._kernels.compiling.types import IN2, OUT1, i8


@lean
def _to_segment(px, py, ax, ay, bx, by):
    """Return the distance of a point from a segment, whose ends may be equal."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    part = 0.0
    if square > 0.0:
        part = min(1.0, max(0.0, ((px - ax) * dx + (py - ay) * dy) / square))
    return math.hypot(px - ax - part * dx, py - ay - part * dy)


@lean
def signed_margin(px, py, feet, count):
    """Return the distance of (px, py) from the border of the hull of feet, positive inside.

    The first `count` rows of feet are used.  For feet on one line it is the negative distance from
    the segment.  Every directed pair of feet with no foot to its right is an edge.
    """
    outside = math.inf
    inside = math.inf
    flat = True
    for i in range(count):
        outside = min(outside, math.hypot(px - feet[i, 0], py - feet[i, 1]))
        for j in range(count):
            dx, dy = feet[j, 0] - feet[i, 0], feet[j, 1] - feet[i, 1]
            length = math.hypot(dx, dy)
            if length == 0.0:
                continue
            edge = True
            for k in range(count):
                side = dx * (feet[k, 1] - feet[i, 1]) - dy * (feet[k, 0] - feet[i, 0])
                if side < 0.0:
                    edge = False
                    break
                if side > 0.0:
                    flat = False
            if edge:
                away = (dx * (py - feet[i, 1]) - dy * (px - feet[i, 0])) / length
                inside = min(inside, away)
                line = _to_segment(px, py, feet[i, 0], feet[i, 1], feet[j, 0], feet[j, 1])
                outside = min(outside, line)
    if flat or inside < 0.0:
        return -outside
    return inside


@kernel(i8(IN2, IN2, OUT1))
def margins(points, feet, out):
    """Write the margins of points (m, 2) over the same feet (n, 2) to out (m,)."""
    for k in range(points.shape[0]):
        out[k] = signed_margin(points[k, 0], points[k, 1], feet, feet.shape[0])
    return 0
