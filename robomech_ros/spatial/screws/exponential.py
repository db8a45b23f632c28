"""Exponential and logarithm of poses."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import exponential
from robomech_ros._kernels.spatial.conversions import STATUSES
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.poses import as_pose
from robomech_ros.spatial.rows import as_rows, row_name
from robomech_ros.typing import Array, ArrayLike

_exponentials = direct(exponential.exponentials)
_logarithms = direct(exponential.logarithms)


def pose_exponential(xi: ArrayLike) -> Array:
    r"""Compute the pose that a constant twist reaches in unit time.

    .. math::

       T = \exp \begin{bmatrix} \mathrm{CPM}(w) & v \\ 0^T & 0 \end{bmatrix}

    Parameters
    ----------
    xi : array_like, shape (..., 6)
        ``[w; v]``: rotation vector (rad), then velocity of the point of the body that is at the
        origin (m): angular first.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import pose_exponential
    >>> np.round(pose_exponential([0.0, 0.0, np.pi / 2.0, 1.0, 0.0, 0.0])[:3, 3], 4)
    array([0.6366, 0.6366, 0.    ])
    """
    rows, shape = as_rows("screw vector", xi, (6,), 6)
    out = np.empty((len(rows), 16))
    status = _exponentials(rows, out)
    if status:
        raise_bad_rows("screw vector", rows, shape, status)
    return out.reshape(*shape, 4, 4)


def pose_logarithm(pose: ArrayLike) -> Array:
    """Compute the constant twist that reaches a pose in unit time.

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)

    Returns
    -------
    ndarray, shape (..., 6)
        ``[w; v]`` as :func:`pose_exponential` takes it, w of length at most pi.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import pose_exponential, pose_logarithm
    >>> np.round(pose_logarithm(pose_exponential([0.1, 0.2, 0.3, 1.0, 2.0, 3.0])), 6)
    array([0.1, 0.2, 0.3, 1. , 2. , 3. ])
    """
    rows, shape = as_rows("pose", pose, (4, 4), 16)
    out = np.empty((len(rows), 6))
    if _logarithms(rows, out):
        raise_bad_pose(rows, shape)
    return out.reshape(*shape, 6)


def raise_bad_pose(rows: Array, shape: tuple[int, ...]) -> NoReturn:
    """Say what is wrong with poses that a compiled loop has refused."""
    T = as_pose(rows.reshape(*shape, 4, 4))
    raise BadValueError("largest of pose", float(np.abs(T).max()), "numbers that do not overflow")


def raise_bad_rows(what: str, rows: Array, shape: tuple[int, ...], status: int) -> NoReturn:
    """Say what is wrong with a row of numbers that a compiled loop has refused."""
    as_finite(what, rows.reshape(*shape, -1), ())
    index, where = row_name(int(status) // STATUSES, shape)
    value = rows.reshape(*shape, -1)[index].tolist()
    raise BadValueError(f"{what}{where}", value, "numbers that do not overflow")
