"""Anchors of a platform on six legs: checked, brought to order one, and what kind they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.parallel.newton import jacobians
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import distinct
from robomech_ros.parallel.argument_checks import one_or_each
from robomech_ros.spatial.arrays import as_finite, of_shape
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array, ArrayLike

# Points nearer to each other than this (of the size; m) are one.
_SAME, _LEAST = 1e-9, 1e-12
# Best ratio of singular values over many poses, below which a platform is architecturally
# singular: it is about the deviation, over the size, from one that is, and from 5e-5 on solved.
SINGULAR_ARCHITECTURE = 3e-5
_POSES_TRIED = 64
# A turn that makes no anchor lie along an axis, so that pivots vanish for no pose people choose.
_TURN = (0.3, 0.7, -0.5)


@dataclass(frozen=True, eq=False)
class ScaledPlatform:
    """The same platform about its centres, its own frame turned, and lengths (m) times a scale."""

    a: Array
    b: Array
    scale: float
    base_centre: Array
    platform_centre: Array
    turn: Array

    @classmethod
    def of(cls, base_points: Array, platform_points: Array) -> ScaledPlatform:
        """Scale points in m, shape (6, 3)."""
        one, two = base_points.mean(axis=0), platform_points.mean(axis=0)
        a, b = base_points - one, platform_points - two
        scale = 1.0 / np.sqrt(((a * a).sum() + (b * b).sum()) / 6.0)
        turn = matrix_from_rotation_vector(np.array(_TURN))
        a, b = np.ascontiguousarray(scale * a), np.ascontiguousarray(scale * b @ turn.T)
        return cls(a, b, float(scale), one, two, turn)

    def poses(self, scaled: Array) -> Array:
        """Return poses (k, 4, 4) in m from scaled ones (k, 12)."""
        R = scaled[:, :9].reshape(-1, 3, 3) @ self.turn
        p = self.base_centre + scaled[:, 9:] / self.scale - R @ self.platform_centre
        return assembled(R, p)

    def scaled_pose(self, T: Array) -> Array:
        """Return one pose (12,) from that (4, 4) in m."""
        R = T[:3, :3] @ self.turn.T
        p = self.scale * (T[:3, 3] + T[:3, :3] @ self.platform_centre - self.base_centre)
        return np.concatenate((R.ravel(), p))


def checked_points(what: str, points: ArrayLike, count: int, dimension: int) -> Array:
    """Check anchors: their number, finite, of a robot's size, and not all in one point."""
    array = of_shape(what, as_finite(what, points, (dimension,)), (count, dimension))
    if np.abs(array).max() > LARGEST_LENGTH:
        largest = float(np.abs(array).max())
        raise BadValueError(what, largest, f"coordinates (m) up to {LARGEST_LENGTH:g}")
    count = _different(array)
    if count < 3:
        raise BadValueError(what, array.tolist(), f"three different points or more, not {count}")
    return np.ascontiguousarray(array).copy()


def _different(points: Array) -> int:
    return len(distinct(points, max(_SAME * float(np.ptp(points, axis=0).max()), _LEAST)))


def checked_strokes(strokes: ArrayLike | None, count: int) -> Array | None:
    """Check strokes (m): least and greatest length of each leg, or one pair for all of them."""
    if strokes is None:
        return None
    full = one_or_each("strokes", strokes, count, (2,))
    if full.max() > LARGEST_LENGTH:
        raise BadValueError("strokes", float(full.max()), f"lengths up to {LARGEST_LENGTH:g} m")
    if (full[:, 0] < 0.0).any() or (full[:, 0] >= full[:, 1]).any():
        row = full[(full[:, 0] < 0.0) | (full[:, 0] >= full[:, 1])][0].tolist()
        raise BadValueError("strokes", row, "a least length (m) from 0, and a greater one")
    return full


def _is_plane(points: Array) -> bool:
    centred = points - points.mean(axis=0)
    values = np.linalg.svd(centred, compute_uv=False)
    return bool(values[2] <= _SAME * values[0])


def family_of(base_points: Array, platform_points: Array) -> str:
    """Name the kind of a platform: how many anchors it has, and which of them lie in planes."""
    kind = f"{_different(base_points)}-{_different(platform_points)}"
    planes = ("general", "planar platform", "planar base", "planar")
    return f"{kind} {planes[2 * _is_plane(base_points) + _is_plane(platform_points)]}"


def best_conditioning(scaled: ScaledPlatform) -> float:
    """Return the best ratio of least to greatest singular value over poses all round.

    Moments are about the centre of the smaller one of base and platform, over its size: the same
    legs seen from the platform have the same ratio, and a small platform is not a singular one.
    """
    sizes = [float(np.sqrt((points**2).sum() / 6.0)) for points in (scaled.a, scaled.b)]
    a, b = (scaled.a, scaled.b) if sizes[1] <= sizes[0] else (scaled.b, scaled.a)
    rng = np.random.default_rng(6)
    R = matrix_from_rotation_vector(rng.normal(size=(_POSES_TRIED, 3)))
    T = np.ascontiguousarray(assembled(R, rng.normal(size=(_POSES_TRIED, 3))))
    rows = np.empty((_POSES_TRIED, 6, 6))
    jacobians(a, b, T, rows)
    rows[:, :, :3] /= min(sizes)
    values = np.linalg.svd(rows, compute_uv=False)
    return float((values[:, 5] / values[:, 0]).max())
