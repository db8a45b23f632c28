"""Motions in the plane: arcs of circles, exact for every turn."""

import numpy as np

from robomech_ros.typing import Array


def moved(pose: Array, step: Array) -> Array:
    """Move poses (..., 3), x y heading, by steps (..., 3) of a constant twist times its time."""
    turn, half = step[..., 0], 0.5 * step[..., 0]
    # sin(t) / t and (1 - cos(t)) / t, which is sin(t / 2) sin(t / 2) / (t / 2).
    a, b = np.sinc(turn / np.pi), np.sin(half) * np.sinc(half / np.pi)
    x, y = a * step[..., 1] - b * step[..., 2], b * step[..., 1] + a * step[..., 2]
    c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    return np.stack(
        [pose[..., 0] + c * x - s * y, pose[..., 1] + s * x + c * y, pose[..., 2] + step[..., 0]],
        axis=-1,
    )


def slope_by_pose(heading: float, step: Array) -> Array:
    """Differentiate the pose after a step by the pose before it, (3, 3)."""
    way = moved(np.array([0.0, 0.0, heading]), step)
    slope = np.eye(3)
    slope[:2, 2] = -way[1], way[0]
    return slope
