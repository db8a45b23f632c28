"""Cross-product matrices and axial vectors."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.spatial.arrays import as_finite

__all__ = ["axial_vector", "cross_product_matrix"]

Array = NDArray[np.float64]


def cross_product_matrix(a: ArrayLike) -> Array:
    """Form the matrix A with ``A x = a x x`` (cross product) for every x.

    Parameters
    ----------
    a : array_like, shape (..., 3)
        Vector, in any unit.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Skew-symmetric.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not three finite real numbers.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 2.
    """
    a = as_finite("vector", a, (3,))
    matrix = np.zeros((*a.shape, 3))
    matrix[..., 2, 1], matrix[..., 1, 2] = a[..., 0], -a[..., 0]
    matrix[..., 0, 2], matrix[..., 2, 0] = a[..., 1], -a[..., 1]
    matrix[..., 1, 0], matrix[..., 0, 1] = a[..., 2], -a[..., 2]
    return matrix


def axial_vector(matrix: ArrayLike) -> Array:
    """Extract the axial vector: half of (a32 - a23, a13 - a31, a21 - a12).

    It inverts :func:`cross_product_matrix`; a symmetric matrix has a vanishing one, a rotation
    through phi about e has e sin(phi).

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Any matrix, in any unit.

    Returns
    -------
    ndarray, shape (..., 3)
        In the unit of the matrix.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not a 3 x 3 matrix of finite real numbers.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., ch. 2.
    """
    m = as_finite("matrix", matrix, (3, 3))
    twice = (
        m[..., 2, 1] - m[..., 1, 2],
        m[..., 0, 2] - m[..., 2, 0],
        m[..., 1, 0] - m[..., 0, 1],
    )
    return 0.5 * np.stack(twice, axis=-1)
