"""Vectors, points and matrices seen from another frame, and what all frames agree on."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite, positive_number
from robomech_ros.spatial.cross_product import axial_vector, cross
from robomech_ros.spatial.matrices import as_rotation
from robomech_ros.spatial.poses import as_pose
from robomech_ros.spatial.rows import common_shape, finite_result
from robomech_ros.typing import Array, ArrayLike, BoolArray

# Relative difference of moments of matrices that are the same: products of doubles.
_SAME = 1e-9


def transform_vectors(rotation: ArrayLike, vectors: ArrayLike) -> Array:
    """Express vectors in another frame: ``[v]_A = Q [v]_B``.

    Parameters
    ----------
    rotation : array_like, shape (..., 3, 3)
        ``R_a_b``, whose columns are the axes of frame b in frame a.
    vectors : array_like, shape (..., 3)
        In frame b; free vectors, which have no place.

    Returns
    -------
    ndarray, shape (..., 3)
        In frame a.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.5.1.
    """
    Q, v = as_rotation(rotation), as_finite("vectors", vectors, (3,))
    common_shape("rotation and vectors", Q.shape[:-2], v.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        seen: Array = (Q @ v[..., None])[..., 0]
    return finite_result("vectors", seen, v)


def transform_points(pose: ArrayLike, points: ArrayLike) -> Array:
    """Express points in another frame: ``[p]_A = [b]_A + Q [p]_B``.

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)
        ``T_a_b``.
    points : array_like, shape (..., 3)
        In frame b (m).

    Returns
    -------
    ndarray, shape (..., 3)
        In frame a (m).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.5.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import transform_points
    >>> T = np.eye(4)
    >>> T[:3, 3] = 1.0, 2.0, 3.0
    >>> transform_points(T, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    array([[1., 2., 3.],
           [2., 2., 3.]])
    """
    T, p = as_pose(pose), as_finite("points", points, (3,))
    common_shape("pose and points", T.shape[:-2], p.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        seen: Array = (T[..., :3, :3] @ p[..., None])[..., 0] + T[..., :3, 3]
    return finite_result("points", seen, p)


def homogeneous_coordinates(points: ArrayLike) -> Array:
    """Add the fourth coordinate 1 to points.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        In m.

    Returns
    -------
    ndarray, shape (..., 4)
        What a pose (..., 4, 4) multiplies.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.5.3.
    """
    p = as_finite("points", points, (3,))
    return np.concatenate((p, np.ones((*p.shape[:-1], 1))), axis=-1)


def points_from_homogeneous(coordinates: ArrayLike) -> Array:
    """Divide the first three of four coordinates by the last.

    Parameters
    ----------
    coordinates : array_like, shape (..., 4)
        The last not 0: those are directions, points at infinity.

    Returns
    -------
    ndarray, shape (..., 3)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.5.3.
    """
    four = as_finite("homogeneous coordinates", coordinates, (4,))
    if (four[..., 3] == 0.0).any():
        raise BadValueError("last homogeneous coordinate", 0.0, "a number that is not 0")
    with np.errstate(over="ignore"):
        points: Array = four[..., :3] / four[..., 3:]
    return finite_result("homogeneous coordinates", points, four)


def similarity_transform(matrix: ArrayLike, rotation: ArrayLike) -> Array:
    """Express a matrix, such as an inertia or a rotation, in another frame: ``Q A Q^T``.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        In frame b.
    rotation : array_like, shape (..., 3, 3)
        ``R_a_b``.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        In frame a.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.6.
    """
    A, Q = as_finite("matrix", matrix, (3, 3)), as_rotation(rotation)
    common_shape("matrix and rotation", A.shape[:-2], Q.shape[:-2])
    with np.errstate(over="ignore", invalid="ignore"):
        seen: Array = Q @ A @ np.swapaxes(Q, -1, -2)
    return finite_result("matrix", seen, A)


def moments(matrix: ArrayLike) -> Array:
    """Compute the moments ``tr(A^k)`` of a matrix, k = 1 to n, which are the same in all frames.

    Parameters
    ----------
    matrix : array_like, shape (..., n, n)
        In any unit.

    Returns
    -------
    ndarray, shape (..., n)
        In the unit to the power k.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.

    Examples
    --------
    >>> from robomech_ros.spatial import moments
    >>> moments([[1.0, 0.0], [0.0, 2.0]])
    array([3., 5.])
    """
    A = _square("matrix", matrix)
    traces = np.empty((*A.shape[:-2], A.shape[-1]))
    power = A
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(A.shape[-1]):
            traces[..., k] = np.trace(power, axis1=-2, axis2=-1)
            power = power @ A
    return finite_result("matrix", traces, A)


def same_in_two_frames(first: ArrayLike, second: ArrayLike, tolerance: float = _SAME) -> BoolArray:
    """Return whether two matrices can be the same one, seen in two frames.

    Their moments are compared.  Symmetric matrices with the same moments are the same up to the
    frame; of others the symmetric and the skew parts are compared, too, by the moments of
    ``A^T A`` and the lengths of both parts, which different matrices rarely share.  Of 3 x 3
    matrices also those products of the symmetric part S and the axial vector v are compared that
    tell all apart: v.Sv, v.SSv, and v.(Sv x SSv), whose sign a matrix and its transpose differ in.

    Parameters
    ----------
    first, second : array_like, shape (..., n, n)
        In the same unit.
    tolerance : float, optional
        Largest difference, relative to the size of the matrices.

    Returns
    -------
    ndarray of bool, shape (...)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.
    """
    A, B = _square("first", first), _square("second", second)
    if A.shape[-1] != B.shape[-1]:
        raise WrongSizeError("second", B.shape, f"(..., {A.shape[-1]}, {A.shape[-1]})")
    limit = positive_number("tolerance", tolerance)
    common_shape("first and second", A.shape[:-2], B.shape[:-2])
    sizes = [np.abs(one).max(axis=(-1, -2), keepdims=True) for one in (A, B)]
    scale = np.maximum(*sizes)
    scale = np.where(scale > 0.0, scale, 1.0)
    found = []
    for one in (A / scale, B / scale):
        mirrored = np.swapaxes(one, -1, -2)
        parts = (one, mirrored @ one, 0.5 * (one + mirrored))
        numbers = [moments(part) for part in parts]
        if A.shape[-1] == 3:
            numbers.append(_mixed_products(parts[2], axial_vector(one)))
        found.append(np.concatenate(numbers, axis=-1))
    # The k-th moment grows with the k-th power, and its differences with k.
    return (np.abs(found[0] - found[1]) <= limit * A.shape[-1] ** 3).all(axis=-1)


def _mixed_products(symmetric: Array, vector: Array) -> Array:
    """Return v.Sv, v.SSv and v.(Sv x SSv), which no rotation of the frame alters, (..., 3)."""
    once = (symmetric @ vector[..., None])[..., 0]
    twice = (symmetric @ once[..., None])[..., 0]
    seen = (once, twice, cross(once, twice))
    return np.stack([np.sum(vector * one, axis=-1) for one in seen], axis=-1)


def _square(what: str, value: ArrayLike) -> Array:
    A = as_finite(what, value, ())
    if A.ndim < 2 or A.shape[-1] != A.shape[-2] or A.shape[-1] == 0:
        raise WrongSizeError(what, A.shape, "(..., n, n) with n at least 1")
    return A
