"""Points of neighbouring joint axes: where two come nearest to each other, where three meet."""

import math

from robomech_ros.kinematics.tolerances import ARM_RANK
from robomech_ros.typing import Array


def common_point(link: Array, following: Array) -> tuple[float, float, float] | None:
    """Find the common point of three axes: its height on the first and the last, the misfit (m).

    None where neighbouring axes are parallel. The constant transforms (4, 4) are those between the
    first two and the last two of the axes (m).
    """
    first = nearest_points(link)
    last = nearest_points(following)
    if first is None or last is None:
        return None
    height4, height5, gap = first
    height5_again, height6, gap_again = last
    return height4, height6, max(gap, gap_again, abs(height5 - height5_again))


def nearest_points(link: Array) -> tuple[float, float, float] | None:
    """Return heights of nearest points on a link's z axes, or None if parallel; their distance."""
    u, d = link[:3, 2], link[:3, 3]
    sine2 = u[0] ** 2 + u[1] ** 2
    if sine2 < ARM_RANK**2:
        return None
    before = d[2] - u[2] * (u[0] * d[0] + u[1] * d[1]) / sine2
    after = -(u[0] * d[0] + u[1] * d[1]) / sine2
    return before, after, abs(u[0] * d[1] - u[1] * d[0]) / math.sqrt(sine2)
