"""Rotation matrices: what makes one, and the nearest one to a matrix that nearly is."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.tolerances import ORTHOGONAL, ROTATION_ERROR
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.rows import row_name
from robomech_ros.typing import Array, ArrayLike


def rotation_error(matrix: ArrayLike) -> Array:
    """Measure how far a matrix is from a proper rotation.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)

    Returns
    -------
    ndarray, shape (...)
        Largest entry of ``|Q^T Q - 1|``; infinite where the determinant is not positive.
    """
    m = as_finite("rotation matrix", matrix, (3, 3))
    with np.errstate(over="ignore", invalid="ignore"):
        gram = np.swapaxes(m, -1, -2) @ m
        error = np.abs(gram - np.eye(3)).max(axis=(-1, -2))
        proper = np.linalg.det(m) > 0.0
    return np.where(proper, error, np.inf)


def as_rotation(
    matrix: ArrayLike, tolerance: float = ROTATION_ERROR, what: str = "rotation matrix"
) -> Array:
    """Check that a matrix is a proper rotation within a tolerance, and remove its rounding.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
    tolerance : float, optional
        Largest :func:`rotation_error` that passes.
    what : str, optional
        Name of the matrix in messages.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        The nearest proper rotation; the matrix itself where it is one up to the last digit.

    Raises
    ------
    BadValueError
        Not a rotation; the message gives the amount.
    """
    m = as_finite(what, matrix, (3, 3))
    error = rotation_error(m)
    bad = ~(error <= tolerance)
    if bad.any():
        index, where = row_name(int(np.argmax(bad)), bad.shape)
        worst = float(error[index])
        how = (
            "determinant not positive"
            if np.isinf(worst)
            else f"columns orthonormal within {worst:.3g}"
        )
        raise BadValueError(
            f"{what}{where}",
            m[index].tolist(),
            f"determinant 1 and columns orthonormal within {tolerance:g} (found: {how}); "
            "spatial.nearest_rotation removes rounding",
        )
    rounded = error > ORTHOGONAL
    if rounded.any():
        m = np.where(rounded[..., None, None], nearest_rotation(m), m)
    return m


def nearest_rotation(matrix: ArrayLike) -> Array:
    """Find the proper rotation with the least sum of squared differences to a matrix.

    Parameters
    ----------
    matrix : array_like, shape (..., 3, 3)
        Not unique where the matrix has rank below two.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        The orthogonal factor of the polar decomposition, with determinant 1.
    """
    u, _, vt = np.linalg.svd(as_finite("rotation matrix", matrix, (3, 3)))
    u[..., :, 2] *= np.where(np.linalg.det(u @ vt) < 0.0, -1.0, 1.0)[..., None]
    return u @ vt
