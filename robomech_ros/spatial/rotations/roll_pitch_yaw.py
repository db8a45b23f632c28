"""Roll, pitch and yaw about fixed axes: first about x, then y, then z of the fixed frame.

``Q = Rz(yaw) Ry(pitch) Rx(roll)``, the convention of URDF and of ROS: robots are read with these,
and no compiled code is loaded for them.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.typing import Array, ArrayLike


def matrix_from_roll_pitch_yaw(angles: ArrayLike) -> Array:
    r"""Convert roll, pitch and yaw to a rotation matrix.

    .. math::

       Q = R_z(\text{yaw})\, R_y(\text{pitch})\,
       R_x(\text{roll})

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        Roll about x, pitch about y, yaw about z of the fixed frame (rad).

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import matrix_from_roll_pitch_yaw
    >>> np.round(matrix_from_roll_pitch_yaw([0.0, 0.0, np.pi / 2.0]), 3) + 0.0
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    angles = as_finite("roll, pitch, yaw", angles, (3,))
    c, s = np.moveaxis(np.cos(angles), -1, 0), np.moveaxis(np.sin(angles), -1, 0)
    matrix = np.empty((*angles.shape, 3))
    matrix[..., 0, 0] = c[2] * c[1]
    matrix[..., 0, 1] = c[2] * s[1] * s[0] - s[2] * c[0]
    matrix[..., 0, 2] = c[2] * s[1] * c[0] + s[2] * s[0]
    matrix[..., 1, 0] = s[2] * c[1]
    matrix[..., 1, 1] = s[2] * s[1] * s[0] + c[2] * c[0]
    matrix[..., 1, 2] = s[2] * s[1] * c[0] - c[2] * s[0]
    matrix[..., 2, 0] = -s[1]
    matrix[..., 2, 1] = c[1] * s[0]
    matrix[..., 2, 2] = c[1] * c[0]
    return matrix


def roll_pitch_yaw_from_matrix(matrix: ArrayLike) -> Array:
    """Convert a rotation matrix to roll, pitch and yaw.

    The problem is ill-posed at a pitch of plus or minus pi/2, where only the difference or the
    sum of roll and yaw is determined.  Whatever yaw results there, roll is computed to match it,
    so the angles always give the matrix back; exactly there yaw is 0.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal.

    Returns
    -------
    ndarray, shape (..., 3)
        Roll and yaw in [-pi, pi], pitch in [-pi/2, pi/2] (rad).

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import matrix_from_roll_pitch_yaw, roll_pitch_yaw_from_matrix
    >>> np.round(roll_pitch_yaw_from_matrix(matrix_from_roll_pitch_yaw([0.1, -0.2, 0.3])), 6)
    array([ 0.1, -0.2,  0.3])
    """
    m = as_rotation(matrix)
    # Adding 0 turns -0 into 0: atan2(0, -0) would be pi.
    yaw = np.arctan2(m[..., 1, 0] + 0.0, m[..., 0, 0] + 0.0)
    c, s = np.cos(yaw), np.sin(yaw)
    pitch = np.arctan2(-m[..., 2, 0], c * m[..., 0, 0] + s * m[..., 1, 0])
    roll = np.arctan2(
        s * m[..., 0, 2] - c * m[..., 1, 2] + 0.0, c * m[..., 1, 1] - s * m[..., 0, 1]
    )
    return np.stack((roll, pitch, yaw), axis=-1) + 0.0
