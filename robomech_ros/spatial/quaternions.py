"""Unit quaternions, which are the Euler-Rodrigues parameters of a rotation.

For a rotation through phi about the unit vector e the parameters are ``r = e sin(phi/2)`` and
``r0 = cos(phi/2)``.  The order of the four numbers is (r, r0) everywhere: vector first, scalar
last, as in the book, and as x y z w in ROS messages and in scipy.  Of the two signs the functions
return the one with r0 >= 0, and at phi = pi the one whose first non-zero number is positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadQuaternionError, BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.matrices import as_rotation

__all__ = [
    "canonical_quaternion",
    "compose_quaternions",
    "inverse_quaternion",
    "matrix_from_quaternion",
    "quaternion_from_axis_angle",
    "quaternion_from_matrix",
    "unit_quaternion",
]

# Deviation of a quaternion's norm from 1 that is taken for rounding: messages written by hand
# carry four digits or more.
QUATERNION_NORM = 1e-3

Array = NDArray[np.float64]


def unit_quaternion(quaternion: ArrayLike, tolerance: float = QUATERNION_NORM) -> Array:
    """Check that a quaternion stands for a rotation, and remove the rounding of its norm.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last.
    tolerance : float, optional
        Largest deviation of the norm from 1 that is taken for rounding.

    Returns
    -------
    ndarray, shape (..., 4)
        The same with norm 1; the sign stays.

    Raises
    ------
    BadQuaternionError
        The norm is 0 or not 1 within the tolerance.
    BadValueError, WrongSizeError, NonFiniteError
        Not four finite real numbers.
    """
    q = as_finite("quaternion", quaternion, (4,))
    with np.errstate(over="ignore"):
        norm = np.linalg.norm(q, axis=-1)
    bad = ~(np.abs(norm - 1.0) <= tolerance)
    if bad.any():
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        value, length = q[index].tolist(), float(norm[index])
        where = f" in row {', '.join(map(str, index))}" if index else ""
        reason = "all zero" if length == 0.0 else f"norm is {length:.9g}"
        raise BadQuaternionError(value, f"{reason}{where}, expected norm 1 within {tolerance:g}")
    result: Array = q / norm[..., None]
    return result


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

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError, NonFiniteError
        As for :func:`unit_quaternion`.

    See Also
    --------
    quaternion_from_matrix : the inverse.
    matrix_from_axis_angle, matrix_from_rotation_vector, matrix_from_roll_pitch_yaw

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
    x, y, z, w = np.moveaxis(unit_quaternion(quaternion), -1, 0)
    matrix = np.empty((*x.shape, 3, 3))
    matrix[..., 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    matrix[..., 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    matrix[..., 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    matrix[..., 0, 1], matrix[..., 1, 0] = 2.0 * (x * y - z * w), 2.0 * (x * y + z * w)
    matrix[..., 0, 2], matrix[..., 2, 0] = 2.0 * (x * z + y * w), 2.0 * (x * z - y * w)
    matrix[..., 1, 2], matrix[..., 2, 1] = 2.0 * (y * z - x * w), 2.0 * (y * z + x * w)
    return matrix


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

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a rotation matrix.

    See Also
    --------
    matrix_from_quaternion : the inverse.
    axis_angle_from_matrix, rotation_vector_from_matrix, roll_pitch_yaw_from_matrix

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
    m = as_rotation(matrix)
    d0, d1, d2 = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    products = np.empty((*d0.shape, 4, 4))
    products[..., 0, 0] = 1.0 + d0 - d1 - d2
    products[..., 1, 1] = 1.0 - d0 + d1 - d2
    products[..., 2, 2] = 1.0 - d0 - d1 + d2
    products[..., 3, 3] = 1.0 + d0 + d1 + d2
    for i, j in ((0, 1), (0, 2), (1, 2)):
        products[..., i, j] = products[..., j, i] = m[..., i, j] + m[..., j, i]
        k = 3 - i - j
        sign = 1.0 if k != 1 else -1.0
        # For k = 0, 1, 2: m21 - m12, m02 - m20, m10 - m01.
        products[..., k, 3] = products[..., 3, k] = sign * (m[..., j, i] - m[..., i, j])
    largest = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    row = np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :]
    return canonical_quaternion(row / np.linalg.norm(row, axis=-1, keepdims=True))


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

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        An axis of zero length, or not finite real numbers.

    See Also
    --------
    axis_angle_from_quaternion : the inverse.
    quaternion_from_matrix
    quaternion_from_roll_pitch_yaw

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.3.6.
    """
    axis = as_finite("axis", axis, (3,))
    half = 0.5 * as_finite("angle", angle, ())
    largest = np.abs(axis).max(axis=-1, keepdims=True)
    if (largest == 0.0).any():
        raise BadValueError("axis", axis.tolist(), "a vector that is not zero")
    # First by the largest entry, so that no square over- or underflows.
    scaled = axis / largest
    unit = scaled / np.linalg.norm(scaled, axis=-1, keepdims=True)
    r = unit * np.sin(half)[..., None]
    r0 = np.broadcast_to(np.cos(half)[..., None], (*r.shape[:-1], 1))
    return canonical_quaternion(np.concatenate((r, r0), axis=-1))


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

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError, NonFiniteError
        As for :func:`unit_quaternion`.

    See Also
    --------
    compose_poses : of poses.
    inverse_quaternion : the opposite rotation.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., app. A.
    """
    p, q = unit_quaternion(second), unit_quaternion(first)
    a, a0 = p[..., :3], p[..., 3:]
    b, b0 = q[..., :3], q[..., 3:]
    scalar = a0 * b0 - np.sum(a * b, axis=-1, keepdims=True)
    product = np.concatenate((a0 * b + b0 * a + np.cross(a, b), scalar), axis=-1)
    return canonical_quaternion(product / np.linalg.norm(product, axis=-1, keepdims=True))


def inverse_quaternion(quaternion: ArrayLike) -> Array:
    """Give the opposite rotation.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Unit quaternion, vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 4)

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError, NonFiniteError
        As for :func:`unit_quaternion`.
    """
    return canonical_quaternion(unit_quaternion(quaternion) * (-1.0, -1.0, -1.0, 1.0))


def canonical_quaternion(q: Array) -> Array:
    """Choose the sign: scalar positive, else the first non-zero number positive.

    Parameters
    ----------
    q : ndarray, shape (..., 4)
        Vector first, scalar last.

    Returns
    -------
    ndarray, shape (..., 4)
        q or -q, without negative zeros.
    """
    ordered = np.concatenate((q[..., 3:], q[..., :3]), axis=-1)
    first = np.argmax(ordered != 0.0, axis=-1)[..., None]
    leading = np.take_along_axis(ordered, first, axis=-1)
    # Adding 0 turns -0 into 0: equal rotations are equal bytes.
    result: Array = np.where(leading < 0.0, -q, q) + 0.0
    return result
