"""Small motions of a pose, and between poses."""

import math

import numpy as np

from robomech_ros.typing import Array


def norm(vector: Array) -> float:
    """Return the length of a vector (n,), faster than numpy does."""
    return math.sqrt(float(vector @ vector))


def moved_pose(pose: Array, motion: Array) -> Array:
    """Turn a pose (4, 4) about its origin, and shift it: angular first, in base axes."""
    moved = pose.copy()
    x, y, z, *shift = motion.tolist()
    angle = math.sqrt(x * x + y * y + z * z)
    if angle > 0.0:
        cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
        half = math.sin(0.5 * angle) / angle
        R = math.sin(angle) / angle * cross + 2.0 * half * half * cross @ cross
        moved[:3, :3] += R @ pose[:3, :3]
    moved[:3, 3] += shift
    return moved


def small_motion(target: Array, pose: Array) -> Array:
    """Return the small motion from a pose to another, angular first, in base axes."""
    R = target[:3, :3] @ pose[:3, :3].T
    turn = 0.5 * (R[2, 1] - R[1, 2]), 0.5 * (R[0, 2] - R[2, 0]), 0.5 * (R[1, 0] - R[0, 1])
    return np.array((*turn, *(target[:3, 3] - pose[:3, 3])))
