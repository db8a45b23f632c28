"""Accelerations of the points of a body, and motion seen from moving axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross, cross_product_matrix
from robomech_ros.spatial.rows import common_shape, finite_result
from robomech_ros.typing import Array, ArrayLike

# Sine of the angle between angular velocity and acceleration below which there is no pole.
_PARALLEL = 1e-9


def angular_acceleration_matrix(
    angular_velocity: ArrayLike, angular_acceleration: ArrayLike
) -> Array:
    r"""Form the angular-acceleration matrix ``CPM(alpha) + CPM(omega)^2``.

    Its axial vector is alpha, its trace :math:`-2 |\omega|^2`, its determinant
    :math:`-|\omega \times \alpha|^2`.

    Parameters
    ----------
    angular_velocity, angular_acceleration : array_like, shape (..., 3)
        rad/s, rad/s^2.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        In 1/s^2.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.5.
    """
    w = as_finite("angular velocity", angular_velocity, (3,))
    dw = as_finite("angular acceleration", angular_acceleration, (3,))
    common_shape("angular velocity and acceleration", w.shape[:-1], dw.shape[:-1])
    with np.errstate(over="ignore", invalid="ignore"):
        turn = cross_product_matrix(w)
        matrix: Array = cross_product_matrix(dw) + turn @ turn
    return finite_result("angular velocity", matrix, w)


def point_acceleration(
    point: ArrayLike,
    reference: ArrayLike,
    acceleration: ArrayLike,
    angular_velocity: ArrayLike,
    angular_acceleration: ArrayLike,
) -> Array:
    r"""Compute the acceleration of a point of a body from that of another.

    .. math:: a_P = a_A + \alpha \times (p - a) + \omega \times (\omega \times (p - a))

    Parameters
    ----------
    point, reference : array_like, shape (..., 3)
        The points p and a of the body (m).
    acceleration : array_like, shape (..., 3)
        Acceleration of the reference (m/s^2).
    angular_velocity, angular_acceleration : array_like, shape (..., 3)
        rad/s, rad/s^2.

    Returns
    -------
    ndarray, shape (..., 3)
        m/s^2.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.5.

    Examples
    --------
    >>> from robomech_ros.spatial import point_acceleration
    >>> still = [0.0, 0.0, 0.0]
    >>> point_acceleration([0.5, 0.0, 0.0], still, still, [0.0, 0.0, 2.0], [0.0, 0.0, 4.0])
    array([-2.,  2.,  0.])
    """
    names = ("point", "reference", "acceleration", "angular velocity", "angular acceleration")
    values = (point, reference, acceleration, angular_velocity, angular_acceleration)
    p, a, linear, w, dw = _vectors(names, values)
    with np.errstate(over="ignore", invalid="ignore"):
        r = p - a
        result: Array = linear + cross(dw, r) + cross(w, cross(w, r))
    return finite_result(" and ".join(names), result, w)


def acceleration_pole(
    reference: ArrayLike,
    acceleration: ArrayLike,
    angular_velocity: ArrayLike,
    angular_acceleration: ArrayLike,
) -> Array:
    """Find the point of a body that has no acceleration.

    There is one unless angular velocity and acceleration are parallel or zero.  If they are
    parallel and the point accelerates across them, as in a plane, there is a line of such points.

    Parameters
    ----------
    reference : array_like, shape (..., 3)
        A point of the body (m).
    acceleration : array_like, shape (..., 3)
        Acceleration of the reference (m/s^2).
    angular_velocity, angular_acceleration : array_like, shape (..., 3)
        rad/s, rad/s^2.

    Returns
    -------
    ndarray, shape (..., 3)
        In m; of a line of points the one nearest to the reference.  NaN where there is none.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.5.
    """
    names = ("reference", "acceleration", "angular velocity", "angular acceleration")
    values = (reference, acceleration, angular_velocity, angular_acceleration)
    a, linear, w, dw = _vectors(names, values)
    a, linear, w, dw = np.broadcast_arrays(a, linear, w, dw)
    matrix = angular_acceleration_matrix(w, dw)
    with np.errstate(over="ignore", invalid="ignore"):
        sizes = [np.linalg.norm(one, axis=-1) for one in (w, dw, cross(w, dw))]
        there = (sizes[2] > _PARALLEL * sizes[0] * sizes[1]) & (sizes[2] > 0.0)
        # Along a common axis of both rotations nothing may accelerate.
        axis = np.where((sizes[0] ** 2 > sizes[1])[..., None], w, dw)
        axis = axis / np.linalg.norm(axis, axis=-1, keepdims=True)
        along = np.abs((axis * linear).sum(axis=-1))
        level = ~there & (along <= _PARALLEL * np.linalg.norm(linear, axis=-1))
        matrix[level] += (axis[..., :, None] * axis[..., None, :])[level]
        there |= level
        matrix[~there] = np.eye(3)
        pole = a - np.linalg.solve(matrix, linear[..., None])[..., 0]
    pole = np.where(there[..., None], pole, np.nan)
    finite_result("acceleration", pole[there], linear)
    return pole


@dataclass(frozen=True, eq=False)
class MovingAxesMotion:
    """Velocity and acceleration of a point that moves in axes that move; the parts of the latter.

    Attributes
    ----------
    velocity : ndarray, shape (..., 3)
        In the fixed frame (m/s).
    acceleration : ndarray, shape (..., 3)
        In the fixed frame (m/s^2): origin, tangential, centripetal, Coriolis and relative parts.
    tangential : ndarray, shape (..., 3)
        ``alpha x rho`` (m/s^2).
    centripetal : ndarray, shape (..., 3)
        ``omega x (omega x rho)`` (m/s^2).
    coriolis : ndarray, shape (..., 3)
        ``2 omega x`` the relative velocity (m/s^2).
    """

    velocity: Array
    acceleration: Array
    tangential: Array
    centripetal: Array
    coriolis: Array


def moving_axes_motion(
    position: ArrayLike,
    relative_velocity: ArrayLike,
    relative_acceleration: ArrayLike,
    angular_velocity: ArrayLike,
    angular_acceleration: ArrayLike,
    origin_velocity: ArrayLike = (0.0, 0.0, 0.0),
    origin_acceleration: ArrayLike = (0.0, 0.0, 0.0),
) -> MovingAxesMotion:
    r"""Compute velocity and acceleration of a point from its motion in moving axes.

    .. math::

       \ddot p = \ddot b + \dot \omega \times \rho + \omega \times (\omega \times \rho)
       + 2 \omega \times \dot \rho_r + \ddot \rho_r

    All vectors are given in the same, fixed axes.

    Parameters
    ----------
    position : array_like, shape (..., 3)
        The point rho, from the origin of the moving axes (m).
    relative_velocity, relative_acceleration : array_like, shape (..., 3)
        As seen from the moving axes (m/s, m/s^2).
    angular_velocity, angular_acceleration : array_like, shape (..., 3)
        Of the moving axes (rad/s, rad/s^2).
    origin_velocity, origin_acceleration : array_like, shape (..., 3), optional
        Of their origin (m/s, m/s^2).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.6.

    Examples
    --------
    >>> from robomech_ros.spatial import moving_axes_motion
    >>> still = [0.0, 0.0, 0.0]
    >>> outwards = [1.0, 0.0, 0.0]
    >>> moving_axes_motion(still, outwards, still, [0.0, 0.0, 2.0], still).acceleration
    array([0., 4., 0.])
    """
    names = ("position", "relative velocity", "relative acceleration", "angular velocity",
             "angular acceleration", "origin velocity", "origin acceleration")  # fmt: skip
    values = (position, relative_velocity, relative_acceleration, angular_velocity,
              angular_acceleration, origin_velocity, origin_acceleration)  # fmt: skip
    rho, v, a, w, dw, start, faster = _vectors(names, values)
    with np.errstate(over="ignore", invalid="ignore"):
        carried = cross(w, rho)
        tangential, centripetal = cross(dw, rho), cross(w, carried)
        coriolis = 2.0 * cross(w, v)
        velocity = start + carried + v
        total = faster + tangential + centripetal + coriolis + a
    for one in (velocity, total):
        finite_result(" and ".join(names), one, w)
    return MovingAxesMotion(velocity, total, tangential, centripetal, coriolis)


def _vectors(names: tuple[str, ...], values: tuple[ArrayLike, ...]) -> list[Array]:
    arrays = [as_finite(name, value, (3,)) for name, value in zip(names, values, strict=True)]
    common_shape(", ".join(names), *(array.shape[:-1] for array in arrays))
    return arrays
