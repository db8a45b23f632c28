"""Rotations after one another, and between one another."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import conversions
from robomech_ros._kernels.spatial.representations import MATRIX, QUATERNION
from robomech_ros.spatial.rotations.conversions import (
    converted,
    raise_bad_rotation,
    represented,
    rotation_rows,
    tail_of,
)
from robomech_ros.spatial.rotations.unit_quaternions import unit_quaternion
from robomech_ros.spatial.rows import broadcast_rows, common_shape
from robomech_ros.typing import Array, ArrayLike

_compose = direct(conversions.compose)
_interpolate = direct(conversions.interpolate)


def compose_rotations(second: ArrayLike, first: ArrayLike, representation: str = "matrix") -> Array:
    """Compose two rotations: the first is done first, ``Q = Q_second Q_first``.

    Parameters
    ----------
    second, first : array_like
        Both in the same representation; one may serve for a batch of the other.
    representation : str, optional
        As for :func:`convert_rotation`; default ``"matrix"``.

    Returns
    -------
    ndarray
        In the same representation.

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError
        The numbers stand for no rotation, or the representation has none for the result.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.4 and app. A.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import compose_rotations
    >>> quarter = [0.0, 0.0, np.pi / 2.0]
    >>> np.round(compose_rotations(quarter, quarter, "rotation-vector"), 4)
    array([0.    , 0.    , 3.1416])
    """
    what, kind, left, left_shape = represented(second, representation)
    right, right_shape = rotation_rows(what, first, kind)
    tail = tail_of(kind)
    shape = common_shape("second and first", left_shape, right_shape)
    rows = [_spread(one, own, shape) for one, own in ((left, left_shape), (right, right_shape))]
    out = np.empty((int(np.prod(shape)), 9 if kind == MATRIX else tail[0]))
    status = _compose(kind, *rows, out)
    if status:
        for value in (second, first):
            converted(what, value, kind, QUATERNION)
        raise_bad_rotation(what, out, shape, kind, status)
    return out.reshape(shape + tail)


def _spread(rows: Array, own: tuple[int, ...], shape: tuple[int, ...]) -> Array:
    """Repeat rows along a batch shape; a single one serves for all."""
    if len(rows) == 1 or own == shape:
        return rows
    wide = np.broadcast_to(rows.reshape(*own, -1), (*shape, rows.shape[1]))
    return np.ascontiguousarray(wide).reshape(-1, rows.shape[1])


def slerp(start: ArrayLike, goal: ArrayLike, fraction: ArrayLike) -> Array:
    """Turn from a quaternion to another about a fixed axis, the short way.

    Half turns have two ways of the same length; the quaternions as given, not their opposites, then
    decide which.

    Parameters
    ----------
    start, goal : array_like, shape (..., 4)
        Unit quaternions, vector first, scalar last; one of each may serve for a batch of fractions.
    fraction : array_like, shape (...)
        0 gives the start, 1 the goal; others go on at the same rate.

    Returns
    -------
    ndarray, shape (..., 4)

    References
    ----------
    K. Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import axis_angle_from_quaternion, slerp
    >>> half_way = slerp([0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8], 0.5)
    >>> axis, angle = axis_angle_from_quaternion(half_way)
    >>> round(float(angle), 6) == round(float(np.arctan2(0.6, 0.8)), 6)
    True
    """
    given = ("start", start, 4), ("goal", goal, 4), ("fraction", fraction, 0)
    rows, shape = broadcast_rows(*given)
    out = np.empty((int(np.prod(shape)), 4))
    if _interpolate(*rows, out):
        for one in rows[:2]:
            unit_quaternion(one)
        raise_bad_rotation("fraction", rows[0], (len(rows[0]),), QUATERNION, 1)
    return out.reshape(*shape, 4)
