"""Rates of the representations of a rotation, and angular velocity and acceleration from them."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import rates
from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import as_finite, of_shape
from robomech_ros.spatial.rotations.conversions import raise_bad_rotation, represented, tail_of
from robomech_ros.spatial.rows import broadcast_rows, finite_result
from robomech_ros.typing import Array, ArrayLike

_rates = direct(rates.rates)
_motions = direct(rates.angular_motions)

_STILL = np.zeros(3)


def rotation_rates(
    value: ArrayLike,
    representation: str,
    angular_velocity: ArrayLike,
    angular_acceleration: ArrayLike | None = None,
) -> tuple[Array, Array]:
    r"""Compute how the numbers of a rotation change while a body turns.

    For example :math:`\dot Q = \mathrm{CPM}(\omega) Q` of the matrix,
    :math:`\dot r = (r_0 \omega + \omega \times r) / 2` and :math:`\dot r_0 = - r \cdot \omega / 2`
    of the quaternion, :math:`\dot \varphi = \omega \cdot e` of the natural invariants.

    Parameters
    ----------
    value : array_like
        The rotation that takes vectors from the body to the fixed frame, as
        :func:`convert_rotation` has it; the rates are those of these numbers, of the same sign.
    representation : str
        As for :func:`convert_rotation`.
    angular_velocity : array_like, shape (3,) or (..., 3)
        Angular velocity of the body, in the fixed frame (rad/s).
    angular_acceleration : array_like, shape (3,) or (..., 3), optional
        In the fixed frame (rad/s^2); without it, zero.

    Returns
    -------
    rates, second_rates : ndarray
        Of the shape of the value (1/s or rad/s, and 1/s^2 or rad/s^2).

    Raises
    ------
    BadQuaternionError, BadValueError
        No rotation, or one at which the numbers have no rates: the identity for axis and angle, a
        half turn for Rodrigues vectors, parallel axes for Euler angles.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., app. A.

    Examples
    --------
    >>> from robomech_ros.spatial import rotation_rates
    >>> rates, _ = rotation_rates([0.1, 0.0, 0.0], "ZYX", [0.0, 0.0, 2.0])
    >>> rates + 0.0
    array([2., 0., 0.])
    """
    what, kind, rows, shape = represented(value, representation)
    faster = _STILL if angular_acceleration is None else angular_acceleration
    moving = ("angular velocity", angular_velocity, 3), ("angular acceleration", faster, 3)
    (velocity, acceleration), moved = broadcast_rows(*moving)
    if moved != shape and moved:
        raise WrongSizeError(
            "angular velocity", (*moved, 3), f"(3,) or {(*shape, 3)}, as the rotation"
        )
    first, second = np.empty_like(rows), np.empty_like(rows)
    status = _rates(kind, rows, velocity, acceleration, first, second)
    if status:
        raise_bad_rotation(what, rows, shape, kind, status)
    tail = tail_of(kind)
    for one in (first, second):
        finite_result("angular velocity or acceleration", one, np.append(velocity, acceleration))
    return first.reshape(shape + tail), second.reshape(shape + tail)


def angular_motion(
    value: ArrayLike, representation: str, rates: ArrayLike, second_rates: ArrayLike | None = None
) -> tuple[Array, Array]:
    r"""Compute angular velocity and acceleration from the rates of a rotation's numbers.

    For example :math:`\omega = \mathrm{vect}(\dot Q Q^T)` of the matrix,
    :math:`\omega = 2 (r_0 \dot r + r \times \dot r - \dot r_0 r)` of the quaternion.

    Parameters
    ----------
    value : array_like
        The rotation that takes vectors from the body to the fixed frame, as
        :func:`convert_rotation` has it.
    representation : str
        As for :func:`convert_rotation`.
    rates : array_like, of the shape of the value
        Of these numbers (1/s or rad/s).
    second_rates : array_like, of the shape of the value, optional
        1/s^2 or rad/s^2; without them, zero.

    Returns
    -------
    angular_velocity, angular_acceleration : ndarray, shape (..., 3)
        In the fixed frame (rad/s, rad/s^2).

    Raises
    ------
    BadQuaternionError, BadValueError, WrongSizeError
        No rotation, rates of another shape, or a half turn given by its linear invariants.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., app. A.

    Examples
    --------
    >>> from robomech_ros.spatial import angular_motion
    >>> angular_motion([0.1, 0.0, 0.0], "ZYX", [2.0, 0.0, 0.0])[0] + 0.0
    array([0., 0., 2.])
    """
    what, kind, rows, shape = represented(value, representation)
    tail = tail_of(kind)
    given = []
    for name, one in (("rates", rates), ("second_rates", second_rates)):
        array = np.zeros(shape + tail) if one is None else as_finite(name, one, tail)
        of_shape(name, array, shape + tail)
        given.append(np.ascontiguousarray(array).reshape(rows.shape))
    velocity, acceleration = np.empty((2, len(rows), 3))
    status = _motions(kind, rows, *given, velocity, acceleration)
    if status:
        raise_bad_rotation(what, rows, shape, kind, status)
    return velocity.reshape(*shape, 3), acceleration.reshape(*shape, 3)
