"""Poses: 4 x 4 homogeneous matrices ``T_a_b``, the frame b expressed in the frame a."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.tolerances import ROTATION_ERROR
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.spatial.rows import common_shape
from robomech_ros.typing import Array, ArrayLike


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
    BadValueError
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
    """
    return assembled(as_rotation(rotation), as_finite("position", position, (3,)))


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
    return assembled(rotation, -(rotation @ T[..., :3, 3:])[..., 0])


def rigid_inverse(T: Array) -> Array:
    """Invert a pose (4, 4) without the checks of :func:`inverse_pose`."""
    back = T[:3, :3].T
    return assembled(back, -back @ T[:3, 3])


def assembled(rotation: Array, position: Array) -> Array:
    """Put rotations (..., 3, 3) and positions (..., 3) into poses (..., 4, 4), unchecked."""
    shape = common_shape("rotation and position", rotation.shape[:-2], position.shape[:-1])
    T = np.zeros((*shape, 4, 4))
    T[..., :3, :3], T[..., :3, 3], T[..., 3, 3] = rotation, position, 1.0
    return T
