"""Linear transformations: range, kernel and projections."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite, real_within
from robomech_ros.typing import Array, ArrayLike, IntArray

# Singular values below this part of the largest are zero: rounding of products of matrices.
_RANK = 1e-12


@dataclass(frozen=True, eq=False)
class LinearMap:
    """Rank, range, kernel and singular values of a matrix (m, n).

    Attributes
    ----------
    rank : ndarray of int, shape (...)
        Dimension of the range.
    range_basis : ndarray, shape (..., m, m)
        The first ``rank`` columns are an orthonormal basis of the range, the others zero.
    kernel_basis : ndarray, shape (..., n, n)
        The last ``n - rank`` columns are an orthonormal basis of the kernel, the others zero.
    singular_values : ndarray, shape (..., min(m, n))
        In descending order.
    """

    rank: IntArray
    range_basis: Array
    kernel_basis: Array
    singular_values: Array


def linear_map(matrix: ArrayLike, tolerance: float = _RANK) -> LinearMap:
    """Find range and kernel of a linear transformation.

    Parameters
    ----------
    matrix : array_like, shape (..., m, n)
        Neither m nor n zero.
    tolerance : float, optional
        Singular values below this part of the largest count as zero.

    Returns
    -------
    LinearMap
        The columns that are not zero are ``range_basis[..., :rank]`` and
        ``kernel_basis[..., rank:]``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.2.

    Examples
    --------
    >>> from robomech_ros.spatial import linear_map
    >>> found = linear_map([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
    >>> int(found.rank), abs(found.kernel_basis[:, 2])
    (2, array([0., 0., 1.]))
    """
    A = as_finite("matrix", matrix, ())
    if A.ndim < 2 or 0 in A.shape[-2:]:
        raise WrongSizeError("matrix", A.shape, "(..., m, n) with m and n at least 1")
    limit = real_within("tolerance", tolerance, "a number from 0 to 1", 0.0, 1.0)
    # Divided by the largest entry, so that no square overflows.
    largest = np.abs(A).max(axis=(-1, -2), keepdims=True)
    scale = np.where(largest > 0.0, largest, 1.0)
    left, values, right = np.linalg.svd(A / scale)
    rank = np.count_nonzero(values > limit * values[..., :1], axis=-1)
    rows, columns = np.arange(A.shape[-2]), np.arange(A.shape[-1])
    inside = rows < np.asarray(rank)[..., None]
    outside = columns >= np.asarray(rank)[..., None]
    return LinearMap(
        rank=np.asarray(rank),
        range_basis=np.where(inside[..., None, :], left, 0.0),
        kernel_basis=np.where(outside[..., None, :], np.swapaxes(right, -1, -2), 0.0),
        singular_values=values * scale[..., 0],
    )


def orthogonal_projection(matrix: ArrayLike) -> Array:
    r"""Form the projection onto the range of a matrix, along what is orthogonal to it.

    :math:`P^2 = P = P^T`, and of full column rank :math:`P = A (A^T A)^{-1} A^T`.

    Parameters
    ----------
    matrix : array_like, shape (..., m, n)
        Its columns span what is projected onto.

    Returns
    -------
    ndarray, shape (..., m, m)
        Symmetric.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.2.
    """
    basis = linear_map(matrix).range_basis
    return basis @ np.swapaxes(basis, -1, -2)


def projection_on_line(direction: ArrayLike) -> Array:
    """Form the projection ``e e^T`` onto a line through the origin.

    Parameters
    ----------
    direction : array_like, shape (..., 3)
        Along the line, of any length but zero.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.2.
    """
    e = unit_vectors("direction", direction)
    return e[..., :, None] * e[..., None, :]


def projection_on_plane(normal: ArrayLike) -> Array:
    """Form the projection ``1 - n n^T`` onto a plane through the origin.

    Parameters
    ----------
    normal : array_like, shape (..., 3)
        Normal of any length but zero.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.2.
    """
    return np.eye(3) - projection_on_line(normal)


def unit_vectors(what: str, value: ArrayLike) -> Array:
    """Return vectors (..., 3) of length 1."""
    v = as_finite(what, value, (3,))
    largest = np.abs(v).max(axis=-1, keepdims=True)
    if (largest == 0.0).any():
        raise BadValueError(what, v.tolist(), "a vector that is not zero")
    # First by the largest entry, so that no square over- or underflows.
    v = v / largest
    return v / np.linalg.norm(v, axis=-1, keepdims=True)
