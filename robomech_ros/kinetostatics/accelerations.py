"""Accelerations: how the Jacobian changes in time, of the tip, and of the joints."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from robomech_ros._kernels.chain import jacobian_rates
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.joint_values import as_rows, as_states, raise_not_finite
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.kinetostatics.point_jacobians import TIP, as_point
from robomech_ros.kinetostatics.rates import joint_rates
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.screws.accelerations import point_acceleration
from robomech_ros.typing import Array, ArrayLike

_rate = direct(jacobian_rates.jacobian_rate)
_rate_one = direct(jacobian_rates.jacobian_rate_one)


def jacobian_rate(chain: SerialChain, q: ArrayLike, qd: ArrayLike) -> Array:
    r"""Compute the time derivative of :func:`jacobian`.

    .. math::

       \frac{d}{dt} \begin{bmatrix} e_i \\ e_i \times r_i \end{bmatrix} =
       \begin{bmatrix} \omega_i \times e_i \\
       (\omega_i \times e_i) \times r_i + e_i \times \dot r_i \end{bmatrix}

    with :math:`r_i = p - o_i` and the angular velocity :math:`\omega_i` of the link that carries
    joint i.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    qd : array_like, of the same shape
        Joint rates (rad/s or m/s).

    Returns
    -------
    ndarray, shape (6, n) or (..., 6, n)
        Angular rows first, at the tip's origin, in the axes of the base (1/s and m/s).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.5.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import jacobian, jacobian_rate
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q, qd = np.array([0.3, 0.5, -1.2, 0.4, 0.8, 0.2]), np.array([0.1, 0.2, -0.1, 0.3, 0.1, 0.2])
    >>> difference = (jacobian(puma, q + 1e-6 * qd) - jacobian(puma, q - 1e-6 * qd)) / 2e-6
    >>> np.allclose(jacobian_rate(puma, q, qd), difference, atol=1e-8)
    True
    """
    q, qd = as_states(chain, ("q", "qd"), q, qd)
    n = chain.n
    if q.ndim == 1:
        out = np.empty((6, n))
        if _rate_one(chain.packed, q, qd, out):
            _raise_not_finite(chain, q, qd)
        return out
    rows = as_rows(q)
    matrices = np.empty((len(rows), 6, n))
    if _rate(chain.packed, rows, as_rows(qd), matrices):
        _raise_not_finite(chain, q, qd)
    return matrices.reshape(*q.shape[:-1], 6, n)


def _raise_not_finite(chain: SerialChain, q: Array, qd: Array) -> NoReturn:
    if not np.isfinite(qd).all():
        raise_not_finite(chain, qd, "qd")
    raise_not_finite(chain, q)


def bias_acceleration(
    chain: SerialChain, q: ArrayLike, qd: ArrayLike, *, point: ArrayLike = TIP
) -> Array:
    r"""Compute the part of the tip's twist rate that does not come from joint accelerations.

    .. math:: \dot t = J \ddot q + \dot J \dot q

    This is the second part.

    Parameters
    ----------
    chain, q, qd
        As for :func:`jacobian_rate`.
    point : array_like, shape (3,), optional
        Point of the tip link, in its frame (m), that the twist is about; default the tip's origin.

    Returns
    -------
    ndarray, shape (6,) or (..., 6)
        Angular (rad/s^2), then of the point (m/s^2), in the axes of the base.
    """
    rate, arm = jacobian_rate(chain, q, qd), as_point(point)
    qd = np.asarray(qd, dtype=np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        bias: Array = np.einsum("...ij,...j->...i", rate, qd)
        omega = np.zeros(3)
        if arm.any():
            omega = np.einsum("...ij,...j->...i", jacobian(chain, q)[..., :3, :], qd)
    if not (np.isfinite(bias).all() and np.isfinite(omega).all()):
        largest = float(np.abs(qd).max(initial=0.0))
        raise BadValueError("largest of qd", largest, "rates with a finite bias acceleration")
    if arm.any():
        r = forward_kinematics(chain, q)[..., :3, :3] @ arm
        bias[..., 3:] = point_acceleration(r, np.zeros(3), bias[..., 3:], omega, bias[..., :3])
    return bias


def joint_accelerations(
    chain: SerialChain,
    q: ArrayLike,
    qd: ArrayLike,
    twist_rate: ArrayLike,
    *,
    point: ArrayLike = TIP,
    length: float | None = None,
) -> Array:
    r"""Compute the joint accelerations that give a point of the tip link a twist rate.

    :math:`J \ddot q = \dot t - \dot J \dot q` is solved as :func:`joint_rates` solves
    :math:`J \dot q = t`: with six
    joints exactly, along the structure of arms with a spherical wrist; more joints give the
    accelerations of least norm, fewer, and singular postures, those of least error.

    Parameters
    ----------
    chain, q, qd
        As for :func:`jacobian_rate`, of one joint at least.
    twist_rate : array_like, shape (6,) or (..., 6)
        Rate of the angular velocity, then acceleration of the point, in the axes of the base
        (rad/s^2 and m/s^2); one for all of a batch or one each.
    point : array_like, shape (3,), optional
        Point of the tip link, in its frame (m); default the tip's origin.
    length : float, optional
        As for :func:`joint_rates`.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        In rad/s^2 or m/s^2.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.5.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import bias_acceleration, jacobian, joint_accelerations
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q, qd = [0.3, 0.5, -1.2, 0.4, 0.8, 0.2], [0.1, 0.2, -0.1, 0.3, 0.1, 0.2]
    >>> qdd = joint_accelerations(puma, q, qd, np.zeros(6))
    >>> np.allclose(jacobian(puma, q) @ qdd + bias_acceleration(puma, q, qd), 0.0)
    True
    """
    bias = bias_acceleration(chain, q, qd, point=point)
    wanted = as_finite("twist_rate", twist_rate, (6,))
    if wanted.ndim > 1 and wanted.shape != bias.shape:
        raise WrongSizeError("twist_rate", wanted.shape, f"(6,) or {bias.shape}, as q")
    return joint_rates(chain, q, wanted - bias, point=point, length=length)
