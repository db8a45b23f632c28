"""Angular velocity and acceleration of a rigid body from the motion of its points."""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import points as kernels
from robomech_ros._kernels.spatial.conversions import STATUSES
from robomech_ros.errors import UnderdeterminedError, WrongSizeError
from robomech_ros.spatial.arrays import as_choice, as_finite, readable_axis
from robomech_ros.spatial.rows import finite_result, row_name
from robomech_ros.typing import Array, ArrayLike

_velocities = direct(kernels.velocities_of_points)
_accelerations = direct(kernels.accelerations_of_points)

_METHODS = ("robust", "basic")
_LEAST_POINTS = 3


def angular_velocity_from_points(
    points: ArrayLike, velocities: ArrayLike, *, method: str = "robust"
) -> Array:
    r"""Compute the angular velocity of a body from the velocities of three points or more.

    With positions and velocities relative to the centroid as the columns of P and
    :math:`\dot P = \Omega P`, the basic form, of three points, is

    .. math:: D \omega = \mathrm{vect}(\dot P), \qquad D = (\mathrm{tr}(P) 1 - P) / 2

    D depends on the frame and on the order of the points and may be singular; the robust form,
    which is also that of least squares, is not so for any points that are not on one line:

    .. math:: J \omega = 2 \mathrm{vect}(\dot P P^T), \qquad J = \mathrm{tr}(P P^T) 1 - P P^T

    Parameters
    ----------
    points : array_like, shape (..., m, 3)
        Positions of m points, at least three, not all on one line (m).
    velocities : array_like, shape (..., m, 3)
        In the same axes (m/s).
    method : str, optional
        ``"robust"`` or, for three points, ``"basic"``.

    Returns
    -------
    ndarray, shape (..., 3)
        In the same axes (rad/s).

    Raises
    ------
    BadValueError, WrongSizeError
        Fewer than three points, or not finite numbers; with the basic form, also more than three.
    UnderdeterminedError
        Points on one line, or all the same; with the basic form, a singular D.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 8.2 and 8.2.1.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import angular_velocity_from_points
    >>> points = np.eye(3)
    >>> np.round(angular_velocity_from_points(points, np.cross([0.0, 0.0, 2.0], points)), 6) + 0.0
    array([0., 0., 2.])
    """
    given = ("points", points), ("velocities", velocities)
    return _of_points(_velocities, method, "points and velocities", *given)


def angular_acceleration_from_points(
    points: ArrayLike, velocities: ArrayLike, accelerations: ArrayLike, *, method: str = "robust"
) -> Array:
    r"""Compute the angular acceleration of a body from the motion of three points or more.

    As for the angular velocity, :math:`D \dot \omega = \mathrm{vect}(\ddot P - \Omega^2 P)` or

    .. math:: J \dot \omega = 2 \mathrm{vect} \left( (\ddot P - \Omega^2 P) P^T \right)

    Parameters
    ----------
    points, velocities, method
        As for :func:`angular_velocity_from_points`.
    accelerations : array_like, shape (..., m, 3)
        m/s^2.

    Returns
    -------
    ndarray, shape (..., 3)
        rad/s^2.

    Raises
    ------
    UnderdeterminedError
        As for :func:`angular_velocity_from_points`.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 8.3 and 8.3.1.
    """
    given = ("points", points), ("velocities", velocities), ("accelerations", accelerations)
    return _of_points(_accelerations, method, "points, velocities and accelerations", *given)


def _of_points(
    kernel: Callable[..., int], method: str, what: str, *given: tuple[str, ArrayLike]
) -> Array:
    robust = as_choice("method", method, _METHODS) == "robust"
    rows, shape = as_motions(robust, *given)
    out = np.empty((len(rows[0]), 3))
    status = kernel(*rows, int(robust), out)
    if status:
        raise_collinear(rows[0], shape, status, robust)
    return finite_result(what, out, rows[-1]).reshape(*shape, 3)


def as_motions(robust: bool, *given: tuple[str, ArrayLike]) -> tuple[list[Array], tuple[int, ...]]:
    """Check points and their derivatives; return them as (k, m, 3), and the batch shape."""
    arrays = [as_finite(what, value, (3,)) for what, value in given]
    first = arrays[0]
    count = first.shape[-2] if first.ndim > 1 else 0
    if count < _LEAST_POINTS:
        raise WrongSizeError("points", first.shape, "(..., m, 3) with m at least 3")
    if count > _LEAST_POINTS and not robust:
        raise WrongSizeError("points", first.shape, "(..., 3, 3), three points for the basic form")
    for (what, _), array in zip(given, arrays, strict=True):
        if array.shape != first.shape:
            raise WrongSizeError(what, array.shape, f"{first.shape}, as points")
    rows = [np.ascontiguousarray(array).reshape(-1, count, 3) for array in arrays]
    return rows, first.shape[:-2]


def raise_collinear(points: Array, shape: tuple[int, ...], status: int, robust: bool) -> NoReturn:
    """Say that the points of a row do not determine how the body turns."""
    row = int(status) // STATUSES
    _, where = row_name(row, shape)
    finite_result(f"points{where}", np.ptp(points[row], axis=0), points[row])
    here = points[row].tolist()
    if not np.ptp(points[row], axis=0).any():
        raise UnderdeterminedError(
            f"points{where}", here, "points that are not all the same", np.eye(3).tolist()
        )
    if not robust:
        expected = (
            "points whose matrix D is regular; the robust method takes these, if not collinear"
        )
        raise UnderdeterminedError(f"points{where}", here, expected)
    centred = points[row] - points[row].mean(axis=0)
    axis = readable_axis(np.linalg.svd(centred)[2][0])
    raise UnderdeterminedError(
        f"points{where}",
        here,
        f"points that are not all on one line: the turn about their line, {axis}, is free",
        [axis],
    )
