"""Poses as a position and a quaternion or other numbers, and their difference."""

from __future__ import annotations

import numpy as np

from robomech_ros.spatial.arrays import as_choice, as_finite
from robomech_ros.spatial.poses import as_pose, assembled
from robomech_ros.spatial.rotations.axis_angle import rotation_vector_from_matrix
from robomech_ros.spatial.rotations.conversions import convert_rotation
from robomech_ros.spatial.rotations.quaternions import (
    matrix_from_quaternion,
    quaternion_from_matrix,
)
from robomech_ros.spatial.rows import common_shape
from robomech_ros.typing import Array, ArrayLike

_FOUR_NUMBERS = ("quaternion", "linear-invariants", "axis-angle")


def pose_from_position_quaternion(position: ArrayLike, quaternion: ArrayLike) -> Array:
    """Form a pose from a position and a unit quaternion.

    Parameters
    ----------
    position : array_like, shape (..., 3)
        Origin of the frame (m).
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Examples
    --------
    >>> from robomech_ros.spatial import pose_from_position_quaternion
    >>> pose_from_position_quaternion([0.1, 0.2, 0.3], [0.0, 0.0, 0.6, 0.8])
    array([[ 0.28, -0.96,  0.  ,  0.1 ],
           [ 0.96,  0.28,  0.  ,  0.2 ],
           [ 0.  ,  0.  ,  1.  ,  0.3 ],
           [ 0.  ,  0.  ,  0.  ,  1.  ]])
    """
    p = as_finite("position", position, (3,))
    return assembled(matrix_from_quaternion(quaternion), p)


def position_quaternion_from_pose(pose: ArrayLike) -> tuple[Array, Array]:
    """Split a pose into a position and a unit quaternion.

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)

    Returns
    -------
    position : ndarray, shape (..., 3)
        Origin of the frame (m).
    quaternion : ndarray, shape (..., 4)
        Vector first, scalar last, scalar not negative.
    """
    T = as_pose(pose)
    return T[..., :3, 3].copy(), quaternion_from_matrix(T[..., :3, :3])


def pose_array_from_pose(pose: ArrayLike, rotation: str = "quaternion") -> Array:
    """Write poses as seven numbers each, the book's pose array.

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)
    rotation : str, optional
        How the rotation is written: ``"quaternion"`` (r, r0), ``"linear-invariants"`` (q, q0) or
        ``"axis-angle"`` (e, phi).

    Returns
    -------
    ndarray, shape (..., 7)
        Four numbers of the rotation, then the position (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.3.
    """
    kind = as_choice("rotation", rotation, _FOUR_NUMBERS)
    T = as_pose(pose)
    four = convert_rotation(T[..., :3, :3], "matrix", kind)
    return np.concatenate((four, T[..., :3, 3]), axis=-1)


def pose_from_pose_array(array: ArrayLike, rotation: str = "quaternion") -> Array:
    """Read poses from seven numbers each, as :func:`pose_array_from_pose` writes them.

    Parameters
    ----------
    array : array_like, shape (..., 7)
        Four numbers of the rotation, then the position (m).
    rotation : str, optional
        As for :func:`pose_array_from_pose`.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.2.3.
    """
    kind = as_choice("rotation", rotation, _FOUR_NUMBERS)
    seven = as_finite("pose array", array, (7,))
    return assembled(convert_rotation(seven[..., :4], kind, "matrix"), seven[..., 4:])


def pose_error(target: ArrayLike, actual: ArrayLike) -> Array:
    """Measure the displacement that takes the actual pose to the target.

    Parameters
    ----------
    target, actual : array_like, shape (..., 4, 4)
        Both expressed in the same frame.

    Returns
    -------
    ndarray, shape (..., 6)
        Rotation vector (rad), then difference of the origins (m), both in that frame: angular
        first, as a twist.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import pose_error, pose_from_position_quaternion
    >>> target = pose_from_position_quaternion([0.1, 0.2, 0.3], [0.0, 0.0, 0.6, 0.8])
    >>> np.round(pose_error(target, np.eye(4)), 4)
    array([0.   , 0.   , 1.287, 0.1  , 0.2  , 0.3  ])
    """
    A, B = as_pose(target, what="target pose"), as_pose(actual, what="actual pose")
    common_shape("target and actual poses", A.shape[:-2], B.shape[:-2])
    between = A[..., :3, :3] @ np.swapaxes(B[..., :3, :3], -1, -2)
    angular = rotation_vector_from_matrix(between)
    linear = A[..., :3, 3] - B[..., :3, 3]
    return np.concatenate((angular, np.broadcast_to(linear, angular.shape)), axis=-1)
