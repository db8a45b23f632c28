"""Poses as plain numbers, for programs that load no compiled code."""

import math

from robomech_ros.typing import Array

Three = tuple[float, float, float]
Four = tuple[float, float, float, float]


def plain_pose(T: Array) -> tuple[Three, Four]:
    """Split a homogeneous transform, shape (4, 4), into a place (m) and a quaternion xyzw.

    The quaternion has w >= 0; if w is 0, its first number
    that is not zero is positive.
    """
    (a, b, c, px), (d, e, f, py), (g, h, i, pz) = T[:3].tolist()
    # The largest of the four parameters is found first: no division by a small number.
    traces = (1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i)
    largest = traces.index(max(traces))
    x, y, z, w = (
        (traces[0], b + d, c + g, h - f),
        (b + d, traces[1], f + h, c - g),
        (c + g, f + h, traces[2], d - b),
        (h - f, c - g, d - b, traces[3]),
    )[largest]
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if (w, x, y, z) < (0.0, 0.0, 0.0, 0.0):
        norm = -norm
    # Adding 0 turns -0 into 0: equal poses are equal bytes.
    return (px, py, pz), (x / norm + 0.0, y / norm + 0.0, z / norm + 0.0, w / norm + 0.0)
