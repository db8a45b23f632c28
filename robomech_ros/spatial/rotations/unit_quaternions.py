"""Quaternions from a caller: checked, without compiled code."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.spatial.tolerances import UNIT_NORM
from robomech_ros.errors import BadQuaternionError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.rows import row_name
from robomech_ros.typing import Array, ArrayLike


def unit_quaternion(quaternion: ArrayLike, tolerance: float = UNIT_NORM) -> Array:
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
    """
    q = as_finite("quaternion", quaternion, (4,))
    with np.errstate(over="ignore"):
        norm = np.linalg.norm(q, axis=-1)
    bad = ~(np.abs(norm - 1.0) <= tolerance)
    if bad.any():
        index, where = row_name(int(np.flatnonzero(bad)[0]), bad.shape)
        value, length = q[index].tolist(), float(norm[index])
        reason = "all zero" if length == 0.0 else f"norm is {length:.9g}"
        raise BadQuaternionError(value, f"{reason}{where}, expected norm 1 within {tolerance:g}")
    return q / norm[..., None]
