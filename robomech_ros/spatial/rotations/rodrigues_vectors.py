"""The Rodrigues vector ``e tan(phi/2)``, and rotations from their linear invariants."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.spatial import representations as kinds
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.rotations.conversions import converted
from robomech_ros.spatial.rows import common_shape
from robomech_ros.typing import Array, ArrayLike


def rodrigues_vector_from_matrix(matrix: ArrayLike) -> Array:
    """Convert a rotation matrix to its Rodrigues vector.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Proper orthogonal; no half turn, at which the vector is infinite.

    Returns
    -------
    ndarray, shape (..., 3)
        ``e tan(phi/2)``.

    Raises
    ------
    BadValueError
        A half turn.
    """
    return converted("rotation matrix", matrix, kinds.MATRIX, kinds.RODRIGUES_VECTOR)


def matrix_from_rodrigues_vector(vector: ArrayLike) -> Array:
    """Convert a Rodrigues vector ``e tan(phi/2)`` to a rotation matrix.

    Parameters
    ----------
    vector : array_like, shape (..., 3)
        Vector of any finite length.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.
    """
    return converted("Rodrigues vector", vector, kinds.RODRIGUES_VECTOR, kinds.MATRIX)


def rodrigues_vector_from_quaternion(quaternion: ArrayLike) -> Array:
    """Convert a unit quaternion to its Rodrigues vector, ``r / r0``.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4)
        Vector first, scalar last, which is not 0.

    Returns
    -------
    ndarray, shape (..., 3)
        ``e tan(phi/2)``.

    Raises
    ------
    BadQuaternionError, BadValueError
        Not a unit quaternion, or that of a half turn.
    """
    return converted("quaternion", quaternion, kinds.QUATERNION, kinds.RODRIGUES_VECTOR)


def quaternion_from_rodrigues_vector(vector: ArrayLike) -> Array:
    """Convert a Rodrigues vector ``e tan(phi/2)`` to a unit quaternion.

    Parameters
    ----------
    vector : array_like, shape (..., 3)
        Vector of any finite length.

    Returns
    -------
    ndarray, shape (..., 4)
        Vector first, scalar last.
    """
    return converted("Rodrigues vector", vector, kinds.RODRIGUES_VECTOR, kinds.QUATERNION)


def matrix_from_linear_invariants(vect: ArrayLike, trace: ArrayLike) -> Array:
    r"""Find the rotation with given axial vector and trace.

    The inverse of :func:`linear_invariants`.

    With :math:`q = \mathrm{vect}(Q)` and :math:`q_0 = (\mathrm{tr}(Q) - 1) / 2`

    .. math:: Q = \frac{q q^T}{1 + q_0} + q_0 1 + \mathrm{CPM}(q)

    which is not how it is computed: near half turns it loses all digits.

    Parameters
    ----------
    vect : array_like, shape (..., 3)
        Axial vector e sin(phi).
    trace : array_like, shape (...)
        1 + 2 cos(phi), of the same rotation up to rounding; more than -1: a half turn has no axial
        vector, and its axis is not determined.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Proper orthogonal.

    Raises
    ------
    BadValueError
        The linear invariants of no rotation, or of a half turn.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.3.4.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import matrix_from_linear_invariants
    >>> np.round(matrix_from_linear_invariants([0.5, 0.5, 0.5], 2.0) * 3.0, 6)
    array([[ 2., -1.,  2.],
           [ 2.,  2., -1.],
           [-1.,  2.,  2.]])
    """
    q, t = as_finite("axial vector", vect, (3,)), as_finite("trace", trace, ())
    rows = np.empty((*common_shape("axial vector and trace", q.shape[:-1], t.shape), 4))
    rows[..., :3], rows[..., 3] = q, 0.5 * t - 0.5
    return converted("linear invariants", rows, kinds.LINEAR_INVARIANTS, kinds.MATRIX)
