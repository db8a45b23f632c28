"""Poses in which platforms may stand to begin with."""

from collections.abc import Callable

import numpy as np

from robomech_ros._kernels.parallel.newton import jacobians, leg_lengths
from robomech_ros.parallel.argument_checks import pose_about_z
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array, BoolArray

_HEIGHTS, _TURNS, _TRIED = 24, 24, 64
# Ratio of singular values above which an upright platform is as good as a tilted one.
_UPRIGHT = 0.02
# Least length of a leg, of the size, where there are no strokes.
_SHORTEST = 0.2


def platform_home(
    a: Array, b: Array, strokes: Array | None, allowed: Callable[[Array], BoolArray]
) -> Array:
    """Choose a pose (4, 4) of a platform on legs: upright if that is regular, within strokes (m).

    a and b (k, 3) are base and platform points (m); other limits say which poses are ``allowed``.
    """
    middle, centre = a.mean(axis=0), b.mean(axis=0)
    size = float(np.sqrt(((a - middle) ** 2).sum() + ((b - centre) ** 2).sum()) / len(a) ** 0.5)

    def regular_one(poses: Array) -> tuple[Array, float]:
        """Return the pose with the best ratio of singular values, if some are allowed."""
        poses = np.ascontiguousarray(poses)
        lengths, rows = np.empty((len(poses), 6)), np.zeros((len(poses), 6, 6))
        leg_lengths(a, b, poses, lengths)
        inside = (lengths.min(axis=1) > _SHORTEST * size) & allowed(poses)
        if strokes is not None:
            inside &= ((lengths >= strokes[:, 0]) & (lengths <= strokes[:, 1])).all(axis=1)
        scores = np.full(len(poses), -1.0)
        for k in np.flatnonzero(inside).tolist():
            jacobians(a, b, poses[k : k + 1], rows[k : k + 1])
            rows[k, :, :3] /= size
            values = np.linalg.svd(rows[k], compute_uv=False)
            scores[k] = values[-1] / values[0]
        best = int(np.argmax(scores))
        return poses[best], float(scores[best])

    normal = np.linalg.svd(a - middle)[2][2]
    normal = -normal if normal[2] < 0.0 else normal
    far = size * np.linspace(0.5, 3.0, _HEIGHTS)
    if strokes is not None:
        far = np.linspace(0.0, strokes.max(), 4 * _HEIGHTS)
    best, score = regular_one(assembled(np.eye(3), middle + far[:, None] * normal - centre))
    if score > _UPRIGHT:
        return best
    rng = np.random.default_rng(6)
    R = matrix_from_rotation_vector(rng.normal(size=(64 * _TRIED, 3)))
    reach = size if strokes is None else float(strokes.mean())
    p = middle + reach * rng.normal(size=(64 * _TRIED, 3)) - R @ centre
    tilted, better = regular_one(assembled(R, p))
    return tilted if better > score else best


def planar_homes(base_points: Array, platform_points: Array) -> Array:
    """Return poses (k, 4, 4) with the centre of the platform over that of the base, all round."""
    angles = np.linspace(np.pi, -np.pi, _TURNS, endpoint=False)
    shift = base_points.mean(axis=0)
    poses = pose_about_z(np.stack((0.0 * angles, 0.0 * angles, angles), axis=1))
    poses[:, :2, 3] = shift - poses[:, :2, :2] @ platform_points.mean(axis=0)
    return poses


def spherical_homes() -> Array:
    """Return poses (k, 4, 4) about a fixed point: none, and turns all round."""
    turns = np.random.default_rng(8).normal(size=(_TRIED, 3))
    turns[0] = 0.0
    return assembled(matrix_from_rotation_vector(turns), np.zeros((_TRIED, 3)))
