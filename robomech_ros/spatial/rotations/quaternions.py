"""Unit quaternions, which are the Euler-Rodrigues parameters of a rotation.

For a rotation through phi about the unit vector e the parameters are ``r = e sin(phi/2)`` and
``r0 = cos(phi/2)``.  The order of the four numbers is (r, r0) everywhere: vector first, scalar
last, as in the book, and as x y z w in ROS messages and in scipy.  Of the two signs the functions
return the one with r0 >= 0, and at phi = pi the one whose first non-zero number is positive.
"""

from __future__ import annotations

from robomech_ros._kernels.spatial.representations import MATRIX, QUATERNION
from robomech_ros.spatial.rotations.composition import compose_rotations
from robomech_ros.spatial.rotations.conversions import converted, converted_axis_angle
from robomech_ros.spatial.rotations.unit_quaternions import unit_quaternion as unit_quaternion
from robomech_ros.typing import Array, ArrayLike


def matrix_from_quaternion(quaternion: ArrayLike) -> Array:
    r"""Convert a unit quaternion to a rotation matrix.

    Its four numbers are the Euler-Rodrigues parameters
    :math:`r = e \sin(\varphi/2)` and :math:`r_0 = \cos(\varphi/2)`:

    .. math::

       Q = (r_0^2 - r \cdot r)\, 1 + 2\, r r^T
       + 2 r_0\, \mathrm{CPM}(r)

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.3.6.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import matrix_from_quaternion
    >>> matrix_from_quaternion([0.0, 0.0, 0.6, 0.8])
    array([[ 0.28, -0.96,  0.  ],
           [ 0.96,  0.28,  0.  ],
           [ 0.  ,  0.  ,  1.  ]])
    """
    return converted("quaternion", quaternion, QUATERNION, MATRIX)


def quaternion_from_matrix(matrix: ArrayLike) -> Array:
    """Convert a rotation matrix to a unit quaternion.

    The four products of the largest parameter with all of them are sums of entries of the
    matrix; no division is by a small number at any angle, phi = pi included.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal.

    Returns
    -------
    ndarray, shape (..., 4)
        Vector first, scalar last.

    References
    ----------
    S. W. Shepperd, Quaternion from rotation matrix, J. Guidance and Control 1 (1978) 223-224.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import quaternion_from_matrix
    >>> np.round(quaternion_from_matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), 4)
    array([0.5, 0.5, 0.5, 0.5])
    """
    return converted("rotation matrix", matrix, MATRIX, QUATERNION)


def quaternion_from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Convert an axis and an angle to a unit quaternion.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Direction, of any length but zero.
    angle : array_like, shape (...)
        Rotation about it (rad).

    Returns
    -------
    ndarray, shape (..., 4)
        Vector first, scalar last.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.3.6.
    """
    return converted_axis_angle(axis, angle, QUATERNION)


def compose_quaternions(second: ArrayLike, first: ArrayLike) -> Array:
    """Compose two rotations: the first is done first, ``Q = Q_second Q_first``.

    Parameters
    ----------
    second, first : array_like, shape (..., 4)
        Unit quaternions, vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 4)
        ``r0 = r0'' r0' - r''.r'``, ``r = r0'' r' + r0' r'' + r'' x r'``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., app. A.
    """
    return compose_rotations(second, first, "quaternion")


def inverse_quaternion(quaternion: ArrayLike) -> Array:
    """Return the opposite rotation.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Unit quaternion, vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 4)
    """
    opposite = unit_quaternion(quaternion) * (-1.0, -1.0, -1.0, 1.0)
    return converted("quaternion", opposite, QUATERNION, QUATERNION)
