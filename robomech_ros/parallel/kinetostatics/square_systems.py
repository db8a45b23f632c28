"""Rows of numbers for many poses, and square systems in mixed units, of which some are singular."""

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike, BoolArray


def are_regular(A: Array) -> BoolArray:
    """Say which matrices (..., m, m) are regular whatever the units of their columns."""
    return _evened(A, False)[2]


def _evened(A: Array, rows: bool) -> tuple[Array, Array, BoolArray]:
    """Bring columns or rows to one size; give the sizes, and which matrices are regular."""
    sizes = np.linalg.norm(A, axis=-1 if rows else -2)
    sizes = np.where(sizes > 0.0, sizes, 1.0)
    scaled = A / (sizes[..., :, None] if rows else sizes[..., None, :])
    values = np.linalg.svd(scaled, compute_uv=False)
    regular: BoolArray = values[..., -1] > RANK * values[..., 0]
    return scaled, sizes, regular


def solved_columns(A: Array, b: Array, *, rows: bool = False) -> Array:
    """Solve A x = b for matrices (..., m, m); NaN where A is singular whatever the units.

    The columns are brought to one size first, or the rows: those that differ in units.
    """
    scaled, sizes, regular = _evened(A, rows)
    scaled[~regular] = np.eye(A.shape[-1])
    right = b / sizes if rows else b
    x = np.linalg.solve(scaled, right[..., None])[..., 0]
    return np.where(regular[..., None], x if rows else x / sizes, np.nan)


def one_each(what: str, values: ArrayLike, count: int, J: Array) -> Array:
    """Check rows of numbers: one for all poses or one for each."""
    given, wanted = as_finite(what, values, (count,)), (*J.shape[:-1], count)
    if given.ndim > 1 and given.shape != wanted:
        raise WrongSizeError(what, given.shape, f"({count},) or {wanted}, as the poses")
    return np.broadcast_to(given, wanted)
