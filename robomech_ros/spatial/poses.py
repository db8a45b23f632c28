"""Poses: 4 x 4 homogeneous matrices ``T_a_b``, the frame b expressed in the frame a."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.tolerances import ROTATION_ERROR
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.axis_angle import rotation_vector_from_matrix
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.spatial.quaternions import matrix_from_quaternion, quaternion_from_matrix

__all__ = [
    "as_pose",
    "compose_poses",
    "inverse_pose",
    "pose_error",
    "pose_from_matrix",
    "pose_from_position_quaternion",
    "position_quaternion_from_pose",
    "rigid_inverse",
]

Array = NDArray[np.float64]


def as_pose(pose: ArrayLike, tolerance: float = ROTATION_ERROR, what: str = "pose") -> Array:
    """Check a pose and remove the rounding of its rotation and of its last row.

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)
    tolerance : float, optional
        Largest deviation from a proper rotation, and from a last row of 0 0 0 1, that is taken
        for rounding.
    what : str, optional
        Name of the pose in messages.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        A copy, with the nearest proper rotation and the last row 0 0 0 1.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a pose; the message gives the amount.
    """
    T: Array = as_finite(what, pose, (4, 4)).copy()
    row = (0.0, 0.0, 0.0, 1.0)
    if (np.abs(T[..., 3, :] - row) > tolerance).any():
        raise BadValueError(
            f"last row of {what}", T[..., 3, :].tolist(), f"0 0 0 1 within {tolerance:g}"
        )
    T[..., 3, :] = row
    T[..., :3, :3] = as_rotation(T[..., :3, :3], tolerance, f"rotation of {what}")
    return T


def pose_from_matrix(rotation: ArrayLike, position: ArrayLike) -> Array:
    """Form a pose from a rotation matrix and a position.

    Parameters
    ----------
    rotation : array_like, shape (..., 3, 3)
        Proper orthogonal.
    position : array_like, shape (..., 3)
        Origin of the frame (m).

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a rotation matrix, or not three finite numbers.
    """
    return _assembled(as_rotation(rotation), as_finite("position", position, (3,)))


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

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError, NonFiniteError
        Not three finite numbers, or not a unit quaternion.

    See Also
    --------
    position_quaternion_from_pose : the inverse.
    pose_from_matrix : from a rotation matrix.

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
    return _assembled(matrix_from_quaternion(quaternion), p)


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

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a pose.
    """
    T = as_pose(pose)
    return T[..., :3, 3].copy(), quaternion_from_matrix(T[..., :3, :3])


def compose_poses(*poses: ArrayLike) -> Array:
    r"""Compose poses: ``T_a_c`` from ``T_a_b`` and ``T_b_c``, and so on.

    .. math::

       \begin{bmatrix} Q_1 & p_1 \\ 0^T & 1 \end{bmatrix}
       \begin{bmatrix} Q_2 & p_2 \\ 0^T & 1 \end{bmatrix} =
       \begin{bmatrix} Q_1 Q_2 & p_1 + Q_1 p_2 \\
       0^T & 1 \end{bmatrix}

    Parameters
    ----------
    *poses : array_like, shape (..., 4, 4)
        From left to right.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        The identity without any.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not poses.

    See Also
    --------
    inverse_pose : the way back.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.5.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import compose_poses, inverse_pose, pose_from_position_quaternion
    >>> T_a_b = pose_from_position_quaternion([0.1, 0.2, 0.3], [0.0, 0.0, 0.6, 0.8])
    >>> np.allclose(compose_poses(T_a_b, inverse_pose(T_a_b)), np.eye(4))
    True
    """
    product = np.eye(4)
    for pose in poses:
        product = product @ as_pose(pose)
    return product


def inverse_pose(pose: ArrayLike) -> Array:
    r"""Invert a pose: ``T_b_a`` from ``T_a_b``, by transposition of its rotation.

    .. math::

       \begin{bmatrix} Q & p \\ 0^T & 1 \end{bmatrix}^{-1} =
       \begin{bmatrix} Q^T & -Q^T p \\ 0^T & 1 \end{bmatrix}

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a pose.

    See Also
    --------
    compose_poses : one after another.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.5.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import inverse_pose, pose_from_position_quaternion
    >>> T = inverse_pose(pose_from_position_quaternion([0.1, 0.2, 0.3], [0.0, 0.0, 0.6, 0.8]))
    >>> np.round(T[:3, 3], 6)
    array([-0.22,  0.04, -0.3 ])
    """
    T = as_pose(pose)
    rotation = np.swapaxes(T[..., :3, :3], -1, -2)
    return _assembled(rotation, -(rotation @ T[..., :3, 3:])[..., 0])


def rigid_inverse(T: Array) -> Array:
    """Invert one pose that is known to be one, as :func:`inverse_pose` without its checks.

    Parameters
    ----------
    T : ndarray, shape (4, 4)

    Returns
    -------
    ndarray, shape (4, 4)
    """
    back = T[:3, :3].T
    return _assembled(back, -back @ T[:3, 3])


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

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not poses.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import pose_error, pose_from_position_quaternion
    >>> target = pose_from_position_quaternion([0.1, 0.2, 0.3], [0.0, 0.0, 0.6, 0.8])
    >>> np.round(pose_error(target, np.eye(4)), 4)
    array([0.   , 0.   , 1.287, 0.1  , 0.2  , 0.3  ])
    """
    A, B = as_pose(target, what="target pose"), as_pose(actual, what="actual pose")
    between = A[..., :3, :3] @ np.swapaxes(B[..., :3, :3], -1, -2)
    angular = rotation_vector_from_matrix(between)
    linear = A[..., :3, 3] - B[..., :3, 3]
    return np.concatenate((angular, np.broadcast_to(linear, angular.shape)), axis=-1)


def _assembled(rotation: Array, position: Array) -> Array:
    shape = np.broadcast_shapes(rotation.shape[:-2], position.shape[:-1])
    T = np.zeros((*shape, 4, 4))
    T[..., :3, :3], T[..., :3, 3], T[..., 3, 3] = rotation, position, 1.0
    return T
