"""Axis and angle of a rotation, its natural invariants, and the rotation vector."""

from __future__ import annotations

from robomech_ros._kernels.spatial import representations as kinds
from robomech_ros.spatial.rotations.conversions import converted, converted_axis_angle
from robomech_ros.typing import Array, ArrayLike


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
    return converted_axis_angle(axis, angle, kinds.MATRIX)


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
    """
    four = converted("quaternion", quaternion, kinds.QUATERNION, kinds.AXIS_ANGLE)
    return four[..., :3], four[..., 3]


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

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import axis_angle_from_matrix
    >>> axis, angle = axis_angle_from_matrix(np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3.0)
    >>> np.round(axis, 4), round(float(np.degrees(angle)), 4)
    (array([0.5774, 0.5774, 0.5774]), 60.0)
    """
    four = converted("rotation matrix", matrix, kinds.MATRIX, kinds.AXIS_ANGLE)
    return four[..., :3], four[..., 3]


def matrix_from_rotation_vector(vector: ArrayLike) -> Array:
    """Convert a rotation vector, axis times angle, to a rotation matrix.

    Parameters
    ----------
    vector : array_like, shape (..., 3)
        Vector of any length, zero included (rad).

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal, the matrix exponential of the vector's cross-product matrix.
    """
    return converted("rotation vector", vector, kinds.ROTATION_VECTOR, kinds.MATRIX)


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
    """
    return converted("rotation matrix", matrix, kinds.MATRIX, kinds.ROTATION_VECTOR)


def quaternion_from_rotation_vector(vector: ArrayLike) -> Array:
    """Convert a rotation vector, axis times angle, to a unit quaternion.

    Parameters
    ----------
    vector : array_like, shape (..., 3)
        Vector of any length, zero included (rad).

    Returns
    -------
    ndarray, shape (..., 4)
        Vector first, scalar last.
    """
    return converted("rotation vector", vector, kinds.ROTATION_VECTOR, kinds.QUATERNION)


def rotation_vector_from_quaternion(quaternion: ArrayLike) -> Array:
    """Convert a unit quaternion to its rotation vector, axis times angle.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 3)
        Of length at most pi (rad).
    """
    return converted("quaternion", quaternion, kinds.QUATERNION, kinds.ROTATION_VECTOR)
