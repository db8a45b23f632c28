"""Check what callers give to the robots of this package."""

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import (
    LEAST,
    as_finite,
    as_single,
    of_shape,
    real_array,
    real_within,
)
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.spatial.poses import as_pose
from robomech_ros.typing import Array, ArrayLike

# How far a pose may be from one that the platform can take at all (rad, m): rounding of files.
_OFF = 1e-6
# Limits beyond this (rad) would leave no digits of an angle.
_MOST_TURNED = 1e6


def positive(what: str, value: object, *, zero: bool = False) -> float:
    """Check one length (m)."""
    expected = f"a length {'from' if zero else 'above'} 0 m, up to {LARGEST_LENGTH:g} m"
    return real_within(what, value, expected, 0.0 if zero else LEAST, LARGEST_LENGTH)


def actuated(what: str, values: ArrayLike, count: int) -> Array:
    """Check values of actuated joints: their number, and finite."""
    return np.ascontiguousarray(as_single(what, values, (count,)))


def one_or_each(what: str, values: ArrayLike, count: int, tail: tuple[int, ...]) -> Array:
    """Check arrays of a shape, one for all of so many things or one for each (count, *tail)."""
    array = as_finite(what, values, tail)
    if array.shape not in (tail, (count, *tail)):
        raise WrongSizeError(what, array.shape, f"{tail} or {(count, *tail)}")
    return np.broadcast_to(array, (count, *tail)).copy()


def angle_limits(limits: ArrayLike | None) -> Array:
    """Check limits of three angles (rad), one pair for each or for all; all round without any."""
    if limits is None:
        return np.tile([-np.pi, np.pi], (3, 1))
    full = one_or_each("limits", limits, 3, (2,))
    if (full[:, 0] >= full[:, 1]).any() or np.abs(full).max() > _MOST_TURNED:
        row = full[(full[:, 0] >= full[:, 1]) | (np.abs(full).max(axis=1) > _MOST_TURNED)][0]
        why = f"a lower and a greater upper angle, up to {_MOST_TURNED:g} rad"
        raise BadValueError("limits", row.tolist(), why)
    return full


def unit_axes(what: str, axes: ArrayLike) -> Array:
    """Check three directions (3, 3) and give them unit length."""
    array = of_shape(what, as_finite(what, axes, (3,)), (3, 3))
    norms = np.linalg.norm(array, axis=1)
    if not ((norms > 1e-6) & (norms < LARGEST_LENGTH)).all():
        raise BadValueError(what, array.tolist(), "three directions, none of them zero")
    return np.ascontiguousarray(array / norms[:, None])


def translation_only(T: ArrayLike) -> Array:
    """Return the position (3,) of a pose without rotation, or a position as it is."""
    if real_array("pose", T).shape == (3,):
        return _within_reach(as_finite("position", T, (3,)))
    pose = single_pose(T)
    off = float(np.abs(pose[:3, :3] - np.eye(3)).max())
    if off > _OFF:
        why = "0 rad: the platform only translates"
        raise BadValueError("turn of the pose", _turn(pose), why)
    return np.ascontiguousarray(pose[:3, 3])


def planar_pose(T: ArrayLike) -> Array:
    """Return x, y (m) and the angle (rad) of a pose in the plane z = 0, or the three as is."""
    if real_array("pose", T).shape == (3,):
        return _within_reach(as_finite("pose", T, (3,)))
    pose = single_pose(T)
    off = max(float(np.abs(pose[2, :2]).max()), abs(float(pose[2, 3])))
    if off > _OFF:
        why = "0: the platform moves in that plane and turns about z"
        raise BadValueError("distance of the pose from the plane z = 0", off, why)
    return np.array([pose[0, 3], pose[1, 3], np.arctan2(pose[1, 0], pose[0, 0])])


def rotation_only(T: ArrayLike) -> Array:
    """Return the rotation (3, 3) of a pose without translation, or a rotation as it is."""
    if real_array("pose", T).shape == (3, 3):
        return as_rotation(T)
    pose = single_pose(T)
    off = float(np.abs(pose[:3, 3]).max())
    if off > _OFF:
        raise BadValueError("distance of the pose", off, "0 m: the platform only turns")
    return np.ascontiguousarray(pose[:3, :3])


def platform_poses(T: ArrayLike, what: str = "pose") -> Array:
    """Check poses (..., 4, 4), and that they are of a robot's size."""
    poses = as_pose(T, what=what)
    _within_reach(poses[..., :3, 3])
    return poses


def _within_reach(position: Array) -> Array:
    if position.size and np.abs(position).max() > LARGEST_LENGTH:
        largest = float(np.abs(position).max())
        raise BadValueError("position", largest, f"coordinates up to {LARGEST_LENGTH:g} m")
    return np.ascontiguousarray(position)


def single_pose(T: ArrayLike, what: str = "pose") -> Array:
    """Check one pose (4, 4), and that it is of a robot's size."""
    return of_shape(what, platform_poses(T, what), (4, 4))


def _turn(pose: Array) -> float:
    chord = np.linalg.norm(pose[:3, :3] - np.eye(3)) / np.sqrt(8.0)
    return round(float(2.0 * np.arcsin(min(chord, 1.0))), 9)


def pose_about_z(planar: Array) -> Array:
    """Return poses (k, 4, 4) of rows x, y (m) and angle (rad)."""
    T = np.tile(np.eye(4), (len(planar), 1, 1))
    c, s = np.cos(planar[:, 2]), np.sin(planar[:, 2])
    T[:, 0, 0], T[:, 0, 1], T[:, 1, 0], T[:, 1, 1] = c, -s, s, c
    T[:, :2, 3] = planar[:, :2]
    return T
