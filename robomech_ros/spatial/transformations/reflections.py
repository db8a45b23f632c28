"""Reflections in planes through the origin, and the rotations that two of them make."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross
from robomech_ros.spatial.rotations.axis_angle import axis_angle_from_matrix
from robomech_ros.spatial.rows import common_shape
from robomech_ros.spatial.transformations.linear_maps import projection_on_line
from robomech_ros.typing import Array, ArrayLike

# Largest entry of |H H - 1| and |H - H^T| of a reflection that is taken for rounding, as for
# rotations.
_REFLECTION_ERROR = 2e-4


def reflection(normal: ArrayLike) -> Array:
    """Form the reflection ``1 - 2 n n^T`` in a plane through the origin.

    Parameters
    ----------
    normal : array_like, shape (..., 3)
        Normal of the plane, of any length but zero.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Symmetric, its own inverse, of determinant -1.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 2.2 and 2.4.

    Examples
    --------
    >>> from robomech_ros.spatial import reflection
    >>> reflection([0.0, 0.0, 2.0]).diagonal()
    array([ 1.,  1., -1.])
    """
    return np.eye(3) - 2.0 * projection_on_line(normal)


def reflection_normal(matrix: ArrayLike) -> Array:
    """Find the normal of the plane in which a matrix reflects.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        A reflection.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit vector; its first component that is not zero is positive.

    Raises
    ------
    BadValueError
        Not a reflection; the message gives the amount.
    """
    H = as_finite("reflection", matrix, (3, 3))
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.abs(H @ H - np.eye(3)).max(axis=(-1, -2))
        off = np.maximum(off, np.abs(H - np.swapaxes(H, -1, -2)).max(axis=(-1, -2)))
        off = np.maximum(off, np.abs(np.trace(H, axis1=-2, axis2=-1) - 1.0))
    bad = ~(off <= _REFLECTION_ERROR)
    if bad.any():
        first = tuple(np.argwhere(bad)[0])
        expected = f"1 - 2 n n^T within {_REFLECTION_ERROR:g}, off by {float(off[first]):.3g}"
        raise BadValueError("reflection", H[first].tolist(), expected)
    # Columns of (1 - H) / 2 = n n^T; the longest one has the most digits.
    square = 0.5 * (np.eye(3) - H)
    longest = np.argmax(np.diagonal(square, axis1=-2, axis2=-1), axis=-1)
    n = np.take_along_axis(square, longest[..., None, None], axis=-1)[..., 0]
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    first_used = np.argmax(n != 0.0, axis=-1)[..., None]
    sign = np.where(np.take_along_axis(n, first_used, axis=-1) < 0.0, -1.0, 1.0)
    return sign * n + 0.0


def compose_reflections(second: ArrayLike, first: ArrayLike) -> Array:
    """Form the rotation that two reflections make, one after the other.

    It turns about the line that both planes have in common, from the first towards the second
    normal, by twice the angle between them.

    Parameters
    ----------
    second, first : array_like, shape (..., 3)
        Normals of the planes, of any length but zero; the first reflection is done first.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.4.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import compose_reflections
    >>> np.round(compose_reflections([1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), 6) + 0.0
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    after, before = reflection(second), reflection(first)
    common_shape("second and first", after.shape[:-2], before.shape[:-2])
    return after @ before


def reflections_from_matrix(matrix: ArrayLike) -> tuple[Array, Array]:
    """Split a rotation into two reflections.

    Any first plane through the axis does; this one has its normal as near to a coordinate axis as
    the axis of the rotation allows.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal.

    Returns
    -------
    second, first : ndarray, shape (..., 3)
        Unit normals, as :func:`compose_reflections` takes them.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.4.
    """
    axis, angle = axis_angle_from_matrix(matrix)
    least = np.argmin(np.abs(axis), axis=-1)
    n = np.eye(3)[least]
    n = n - axis * np.sum(axis * n, axis=-1, keepdims=True)
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    half = 0.5 * angle[..., None]
    turned: Array = np.cos(half) * n + np.sin(half) * cross(axis, n)
    return turned, n
