"""Denavit-Hartenberg frames of a posture, with joint axes, offsets and common normals."""

from typing import NamedTuple

import numpy as np

from robomech_ros.robots import PRISMATIC, DHTable
from robomech_ros.robots.dh_table import link_transforms
from robomech_ros.typing import Array

# Length of axes beyond their first and last point, in reaches of the robot.
_BEYOND = 0.15
# Least length of a segment (m).
_NONE = 1e-9


class DHFrames(NamedTuple):
    """Frames and lines of n joints in the base (m).

    - ``offsets``: ends of the segments b along z, from the origin of a frame to the common normal
      with the next axis, shape (n, 2, 3).
    - ``normals``: ends of the segments a along the common normal, to the origin of the next frame,
      shape (n, 2, 3).
    """

    #: Frame i has its z along the axis of joint i, shape (n + 1, 4, 4); the last is fixed to the
    #: last link.
    frames: Array
    #: Ends of the drawn part of each joint axis, shape (n, 2, 3); the second is ahead along z.
    axes: Array
    offsets: Array
    normals: Array
    #: Texts and their positions, shape (3,): axes, and the lengths of offsets and normals that are
    #: not 0.
    names: dict[str, Array]


def dh_frames(table: DHTable, q: Array, reach: float) -> DHFrames:
    """Place the frames of a table at joint values q (n,) (rad or m)."""
    slides = table.types == PRISMATIC
    b = table.b + np.where(slides, q, 0.0)
    theta = table.theta + np.where(slides, 0.0, q)
    moved = DHTable(table.a, b, table.alpha, theta, table.base, table.tool, table.types)
    frames = [table.base]
    for T in link_transforms(moved):
        frames.append(frames[-1] @ T)
    placed = np.array(frames)
    origins, z = placed[:, :3, 3], placed[:-1, :3, 2]
    feet = origins[:-1] + b[:, None] * z
    low, high = np.minimum(b, 0.0) - _BEYOND * reach, np.maximum(b, 0.0) + _BEYOND * reach
    axes = np.stack([origins[:-1] + end[:, None] * z for end in (low, high)], axis=1)
    offsets = np.stack([origins[:-1], feet], axis=1)
    normals = np.stack([feet, origins[1:]], axis=1)
    names = {f"Z{i}": end for i, end in enumerate(axes[:, 1], 1)}
    for letter, lengths, lines in (("b", b, offsets), ("a", table.a, normals)):
        for i, (length, ends) in enumerate(zip(lengths.tolist(), lines, strict=True), 1):
            if abs(length) > _NONE:
                names[f"{letter}{i} = {length:.4g} m"] = ends.mean(axis=0)
    return DHFrames(placed, axes, offsets, normals, names)
