"""Axis and angle of a rotation, its natural invariants, and the rotation vector."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.quaternions import (
    canonical_quaternion,
    matrix_from_quaternion,
    quaternion_from_axis_angle,
    quaternion_from_matrix,
    unit_quaternion,
)

__all__ = [
    "axis_angle_from_matrix",
    "axis_angle_from_quaternion",
    "matrix_from_axis_angle",
    "matrix_from_rotation_vector",
    "rotation_vector_from_matrix",
]

Array = NDArray[np.float64]


def matrix_from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    r"""Convert an axis and an angle to a rotation matrix.

    .. math::

       Q = e e^T + \cos\varphi\, (1 - e e^T)
       + \sin\varphi\, \mathrm{CPM}(e)

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Direction e, of any length but zero.
    angle : array_like, shape (...)
        Rotation phi about it (rad).

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        An axis of zero length, or not finite real numbers.

    See Also
    --------
    axis_angle_from_matrix : the inverse.
    matrix_from_rotation_vector, matrix_from_quaternion, matrix_from_roll_pitch_yaw

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.3.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import matrix_from_axis_angle
    >>> np.round(matrix_from_axis_angle([1.0, 1.0, 1.0], 2.0 * np.pi / 3.0), 3) + 0.0
    array([[0., 0., 1.],
           [1., 0., 0.],
           [0., 1., 0.]])
    """
    return matrix_from_quaternion(quaternion_from_axis_angle(axis, angle))


def axis_angle_from_quaternion(quaternion: ArrayLike) -> tuple[Array, Array]:
    """Convert a unit quaternion to its axis and angle.

    The problem is ill-posed at the identity, where every axis serves; it is then z.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.

    Returns
    -------
    axis : ndarray, shape (..., 3)
        Unit vector; at the angle pi its first non-zero component is positive.
    angle : ndarray, shape (...)
        In [0, pi] (rad).

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError, NonFiniteError
        Not a unit quaternion.
    """
    q = canonical_quaternion(unit_quaternion(quaternion))
    r = q[..., :3]
    largest = np.abs(r).max(axis=-1, keepdims=True)
    none = largest == 0.0
    scaled = np.where(none, (0.0, 0.0, 1.0), r / np.where(none, 1.0, largest))
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    sine = np.where(none, 0.0, largest * length)[..., 0]
    return scaled / length + 0.0, 2.0 * np.arctan2(sine, q[..., 3])


def axis_angle_from_matrix(matrix: ArrayLike) -> tuple[Array, Array]:
    """Convert a rotation matrix to its axis and angle.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal.

    Returns
    -------
    axis : ndarray, shape (..., 3)
        Unit vector; z at the identity; at the angle pi its first non-zero component is positive.
    angle : ndarray, shape (...)
        In [0, pi] (rad).

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a rotation matrix.

    See Also
    --------
    matrix_from_axis_angle : the inverse.
    rotation_vector_from_matrix, quaternion_from_matrix, roll_pitch_yaw_from_matrix

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import axis_angle_from_matrix
    >>> axis, angle = axis_angle_from_matrix(np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3.0)
    >>> np.round(axis, 4), round(float(np.degrees(angle)), 4)
    (array([0.5774, 0.5774, 0.5774]), 60.0)
    """
    return axis_angle_from_quaternion(quaternion_from_matrix(matrix))


def matrix_from_rotation_vector(vector: ArrayLike) -> Array:
    """Convert a rotation vector, axis times angle, to a rotation matrix.

    Parameters
    ----------
    vector : array_like, shape (..., 3)
        Of any length, zero included (rad).

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal, the matrix exponential of the vector's cross-product matrix.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not three finite real numbers.

    See Also
    --------
    rotation_vector_from_matrix : the inverse.
    matrix_from_axis_angle, matrix_from_quaternion, matrix_from_roll_pitch_yaw
    """
    v = as_finite("rotation vector", vector, (3,))
    largest = np.abs(v).max(axis=-1, keepdims=True)
    none = largest == 0.0
    # By the largest entry first, so that no square over- or underflows.
    axis = np.where(none, (0.0, 0.0, 1.0), v / np.where(none, 1.0, largest))
    angle = largest[..., 0] * np.linalg.norm(axis, axis=-1)
    return matrix_from_axis_angle(axis, angle)


def rotation_vector_from_matrix(matrix: ArrayLike) -> Array:
    """Convert a rotation matrix to its rotation vector, axis times angle.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal.

    Returns
    -------
    ndarray, shape (..., 3)
        Of length at most pi (rad).

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a rotation matrix.

    See Also
    --------
    matrix_from_rotation_vector : the inverse.
    axis_angle_from_matrix, quaternion_from_matrix, roll_pitch_yaw_from_matrix
    """
    axis, angle = axis_angle_from_matrix(matrix)
    return axis * angle[..., None]
