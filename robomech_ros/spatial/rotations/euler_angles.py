"""Euler angles of all twelve sequences, about moving and about fixed axes.

A sequence is three letters: capitals for axes that move with the body, as ``"ZYX"`` (first about z,
then about the new y, then about the newest x), small letters for fixed ones, as ``"xyz"``, which
are roll, pitch and yaw.  The angles are in the order of the letters.
"""

from __future__ import annotations

from robomech_ros._kernels.spatial.representations import AXIS_ANGLE, MATRIX, QUATERNION
from robomech_ros.spatial.rotations.conversions import (
    SEQUENCES as SEQUENCES,
    converted,
    converted_axis_angle,
    sequence_kind,
)
from robomech_ros.typing import Array, ArrayLike

ROLL_PITCH_YAW = sequence_kind("xyz")


def euler_angles_from_matrix(matrix: ArrayLike, sequence: str) -> Array:
    """Convert a rotation matrix to Euler angles.

    The problem is ill-posed where the first and the third axis are parallel: only the sum or the
    difference of their angles is determined there, and the third angle is 0.  The angles give the
    matrix back to rounding everywhere.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal.
    sequence : str
        One of :data:`SEQUENCES`, such as ``"ZYZ"`` about moving axes or ``"xyz"`` about fixed ones.

    Returns
    -------
    ndarray, shape (..., 3)
        In the order of the letters (rad).  The first and third in [-pi, pi], the second in
        [0, pi] where these two axes are the same, else in [-pi/2, pi/2].

    References
    ----------
    E. Bernardes, S. Viollet, Quaternion to Euler angles conversion: a direct, general and
    computationally efficient method, PLoS ONE 17(11), 2022.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import euler_angles_from_matrix, matrix_from_euler_angles
    >>> Q = matrix_from_euler_angles([0.1, 0.2, 0.3], "ZYZ")
    >>> np.round(euler_angles_from_matrix(Q, "ZYZ"), 6)
    array([0.1, 0.2, 0.3])
    """
    return converted("rotation matrix", matrix, MATRIX, sequence_kind(sequence))


def matrix_from_euler_angles(angles: ArrayLike, sequence: str) -> Array:
    r"""Convert Euler angles to a rotation matrix.

    About moving axes ``"ZYX"`` is :math:`Q = R_z(\theta_1) R_y(\theta_2) R_x(\theta_3)`; about
    fixed ones ``"zyx"`` is :math:`Q = R_x(\theta_3) R_y(\theta_2) R_z(\theta_1)`.

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        In the order of the letters (rad).
    sequence : str
        One of :data:`SEQUENCES`.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.
    """
    return converted("Euler angles", angles, sequence_kind(sequence), MATRIX)


def euler_angles_from_quaternion(quaternion: ArrayLike, sequence: str) -> Array:
    """Convert a unit quaternion to Euler angles, as :func:`euler_angles_from_matrix`.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.
    sequence : str
        One of :data:`SEQUENCES`.

    Returns
    -------
    ndarray, shape (..., 3)
        In the order of the letters (rad).
    """
    return converted("quaternion", quaternion, QUATERNION, sequence_kind(sequence))


def quaternion_from_euler_angles(angles: ArrayLike, sequence: str) -> Array:
    """Convert Euler angles to a unit quaternion.

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        In the order of the letters (rad).
    sequence : str
        One of :data:`SEQUENCES`.

    Returns
    -------
    ndarray, shape (..., 4)
        Vector first, scalar last.
    """
    return converted("Euler angles", angles, sequence_kind(sequence), QUATERNION)


def quaternion_from_roll_pitch_yaw(angles: ArrayLike) -> Array:
    """Convert roll, pitch and yaw to a unit quaternion.

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        Roll, pitch, yaw (rad).

    Returns
    -------
    ndarray, shape (..., 4)
        Vector first, scalar last.
    """
    return converted("roll, pitch, yaw", angles, ROLL_PITCH_YAW, QUATERNION)


def roll_pitch_yaw_from_quaternion(quaternion: ArrayLike) -> Array:
    """Convert a unit quaternion to roll, pitch and yaw.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 3)
        As :func:`roll_pitch_yaw_from_matrix` (rad).
    """
    return converted("quaternion", quaternion, QUATERNION, ROLL_PITCH_YAW)


def axis_angle_from_roll_pitch_yaw(angles: ArrayLike) -> tuple[Array, Array]:
    """Convert roll, pitch and yaw to axis and angle.

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        Roll, pitch, yaw (rad).

    Returns
    -------
    axis : ndarray, shape (..., 3)
        Unit vector.
    angle : ndarray, shape (...)
        In [0, pi] (rad).
    """
    four = converted("roll, pitch, yaw", angles, ROLL_PITCH_YAW, AXIS_ANGLE)
    return four[..., :3], four[..., 3]


def roll_pitch_yaw_from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Convert an axis and an angle to roll, pitch and yaw.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Direction, of any length but zero.
    angle : array_like, shape (...)
        Rotation about it (rad).

    Returns
    -------
    ndarray, shape (..., 3)
        As :func:`roll_pitch_yaw_from_matrix` (rad).
    """
    return converted_axis_angle(axis, angle, ROLL_PITCH_YAW)
