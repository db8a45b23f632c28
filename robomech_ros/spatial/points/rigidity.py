"""Rigidity of moving points, and accuracy of their angular velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, InconsistentDataError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross
from robomech_ros.spatial.points.from_points import (
    angular_acceleration_from_points,
    angular_velocity_from_points,
    as_motions,
)
from robomech_ros.spatial.rows import common_shape, finite_result, row_name
from robomech_ros.typing import Array, ArrayLike, BoolArray, IntArray

# Speed left over (of the largest relative one) that is taken for rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Rigidity:
    """Deviation of the motion of points from that of a rigid body.

    Attributes
    ----------
    velocity_residuals : ndarray, shape (..., m, 3)
        Velocities less those of the nearest rigid motion (m/s).
    acceleration_residuals : ndarray, shape (..., m, 3)
        The same of accelerations (m/s^2); zero where none are given.
    stretching : ndarray, shape (..., m, m)
        Rates at which distances between points grow (m/s).
    pair : ndarray of int, shape (..., 2)
        The two points whose distance changes fastest.
    rigid : ndarray of bool, shape (...)
        All is within the tolerance.
    """

    velocity_residuals: Array
    acceleration_residuals: Array
    stretching: Array
    pair: IntArray
    rigid: BoolArray


def rigidity(
    points: ArrayLike,
    velocities: ArrayLike,
    accelerations: ArrayLike | None = None,
    *,
    tolerance: float | None = None,
) -> Rigidity:
    r"""Test whether points move like those of a rigid body, and say by how much they do not.

    The book's conditions are :math:`P^T \dot P + \dot P^T P = 0` and
    :math:`P^T \ddot P + \ddot P^T P + 2 \dot P^T \dot P = 0`: distances stay.

    Parameters
    ----------
    points, velocities, accelerations : array_like, shape (..., m, 3)
        Of three points or more (m, m/s, m/s^2); the last may be left out.
    tolerance : float, optional
        Largest residual velocity (m/s) of a rigid body, and the same number of m/s^2; default
        1e-9 of the largest relative velocity or acceleration.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 8.2 and 8.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import rigidity
    >>> points = np.eye(3)
    >>> found = rigidity(points, [[0.1, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    >>> bool(found.rigid), found.pair, np.round(found.stretching[0, 1], 4)
    (False, array([0, 1]), np.float64(0.0707))
    """
    omega = angular_velocity_from_points(points, velocities)[..., None, :]
    p, v = (_centred(one) for one in (points, velocities))
    limit = None if tolerance is None else float(as_finite("tolerance", tolerance, ()).max())
    if limit is not None and limit < 0.0:
        raise BadValueError("tolerance", limit, "at least 0")
    slip = v - cross(omega, p)
    rigid = _small(slip, v, limit)
    left = np.zeros_like(slip)
    if accelerations is not None:
        alpha = angular_acceleration_from_points(points, velocities, accelerations)[..., None, :]
        a = _centred(accelerations)
        left = a - cross(alpha, p) - cross(omega, cross(omega, p))
        rigid &= _small(left, a, limit)
    way, speed = (one[..., :, None, :] - one[..., None, :, :] for one in (p, v))
    distance = np.linalg.norm(way, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = np.where(distance > 0.0, np.sum(way * speed, axis=-1) / distance, 0.0)
    count = growth.shape[-1]
    fastest = np.argmax(np.abs(growth).reshape(*growth.shape[:-2], count * count), axis=-1)
    pair = np.stack((fastest // count, fastest % count), axis=-1)
    return Rigidity(slip, left, growth, pair, rigid)


def require_rigid(
    points: ArrayLike,
    velocities: ArrayLike,
    accelerations: ArrayLike | None = None,
    *,
    tolerance: float | None = None,
) -> Rigidity:
    """Refuse points that do not move like those of a rigid body, naming what is wrong.

    Parameters
    ----------
    points, velocities, accelerations, tolerance
        As for :func:`rigidity`.

    Raises
    ------
    InconsistentDataError
        They are no rigid body: the message names the two points whose distance changes fastest, and
        by how much the motion misses.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 8.2 and 8.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import require_rigid
    >>> points = np.eye(3)
    >>> bool(require_rigid(points, np.cross([0.0, 0.0, 2.0], points)).rigid)
    True
    """
    found = rigidity(points, velocities, accelerations, tolerance=tolerance)
    if not found.rigid.all():
        index, where = row_name(int(np.argmin(found.rigid)), found.rigid.shape)
        i, j = (int(k) for k in found.pair[index])
        slip, left = (
            float(np.linalg.norm(one[index], axis=-1).max())
            for one in (found.velocity_residuals, found.acceleration_residuals)
        )
        within = "rounding" if tolerance is None else f"{float(tolerance):g}"
        raise InconsistentDataError(
            f"motion of the points{where}",
            f"{slip:.3g} m/s and {left:.3g} m/s^2 from that of a rigid body",
            f"zero within {within}; the distance of points {i} and {j} changes fastest, by "
            f"{float(found.stretching[(*index, i, j)]):.3g} m/s",
        )
    return found


def angular_velocity_covariance(points: ArrayLike, deviation: ArrayLike) -> Array:
    r"""Return the covariance of the angular velocity that noisy velocities lead to.

    With independent errors of standard deviation sigma in every coordinate of the velocities,
    that of least squares is :math:`\sigma^2 J^{-1}`.

    Parameters
    ----------
    points : array_like, shape (..., m, 3)
        At least three, not on one line (m).
    deviation : array_like, shape (...)
        Standard deviation sigma of a coordinate of a velocity (m/s).

    Returns
    -------
    ndarray, shape (..., 3, 3)
        In (rad/s)^2.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 8.2.1.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.spatial import angular_velocity_covariance
    >>> square = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [-0.1, 0.0, 0.0], [0.0, -0.1, 0.0]]
    >>> np.sqrt(angular_velocity_covariance(square, 0.01).diagonal()).round(4)
    array([0.0707, 0.0707, 0.05  ])
    """
    sigma = as_finite("deviation", deviation, ())
    if (sigma < 0.0).any():
        raise BadValueError("deviation", float(sigma.min()), "at least 0")
    # Refuses points that do not determine an angular velocity.
    centred = _centred(points)
    angular_velocity_from_points(points, np.zeros_like(centred))
    J = spread_matrix(centred)
    common_shape("points and deviation", J.shape[:-2], sigma.shape)
    with np.errstate(over="ignore", invalid="ignore"):
        covariance: Array = (sigma * sigma)[..., None, None] * np.linalg.inv(J)
    return finite_result("deviation", covariance, sigma)


def spread_matrix(centred: Array) -> Array:
    """Form ``J = tr(P P^T) 1 - P P^T`` of points (..., m, 3) relative to their centroid."""
    scatter = np.swapaxes(centred, -1, -2) @ centred
    trace = np.trace(scatter, axis1=-2, axis2=-1)
    return trace[..., None, None] * np.eye(3) - scatter


def _centred(value: ArrayLike) -> Array:
    (rows,), shape = as_motions(True, ("points", value))
    centred: Array = rows - rows.mean(axis=-2, keepdims=True)
    return centred.reshape(*shape, *rows.shape[1:])


def _small(residual: Array, whole: Array, tolerance: float | None) -> BoolArray:
    most, size = (np.linalg.norm(one, axis=-1).max(axis=-1) for one in (residual, whole))
    return np.asarray(most <= (_ROUNDING * size if tolerance is None else tolerance))
