"""Joint torques and the wrench at the tip."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.joint_values import as_finite_values
from robomech_ros.kinetostatics.indices import as_length
from robomech_ros.kinetostatics.point_jacobians import TIP, point_jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike

_POSE = 6


def joint_torques(
    chain: SerialChain,
    q: ArrayLike,
    exerted_wrench: ArrayLike,
    *,
    point: ArrayLike = TIP,
    axes: ArrayLike | str | None = None,
) -> Array:
    r"""Compute the torques with which a resting arm exerts a wrench on its surroundings.

    .. math:: \tau = J^T w, \qquad w = \begin{bmatrix} n \\ f \end{bmatrix}

    What the surroundings exert on the tip, the ``tip_wrench`` of :func:`gravity_torque` and the
    other functions of the dynamics, is ``-w``: to hold a load of weight G, ask for the force G
    upwards.  The weight of the links themselves is not in it.  In motion
    ``tau . qd = w . t`` is the power that goes to the surroundings, t the twist of the point.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    exerted_wrench : array_like, shape (6,) or (..., 6)
        Moment about the point, then force, of the tip on its surroundings (N m and N); one for all
        of a batch or one each.
    point : array_like, shape (3,), optional
        Point of the tip link, in its frame (m), at which the wrench acts; default the tip's origin.
    axes : str or array_like, shape (3, 3), optional
        In what axes the wrench is expressed: the name of a link, such as ``chain.tip``, or a
        rotation ``R_base_axes``; default the base.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Torques of revolute and forces of prismatic joints, as the actuators exert them (N m or N).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.6.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import joint_torques
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> np.round(joint_torques(puma, np.zeros(6), [0.0, 0.0, 0.0, 0.0, 0.0, 10.0]), 3) + 0.0
    array([0.   , 4.521, 0.203, 0.   , 0.   , 0.   ])
    """
    J = point_jacobian(chain, q, point, axes)
    w = _rows("exerted_wrench", as_finite("exerted_wrench", exerted_wrench, (_POSE,)), J)
    with np.errstate(over="ignore", invalid="ignore"):
        torques: Array = np.einsum("...ij,...i->...j", J, w)
    if not np.isfinite(torques).all():
        largest = float(np.abs(w).max(initial=0.0))
        raise BadValueError("largest of exerted_wrench", largest, "a wrench with finite torques")
    return torques


def wrench_from_torques(
    chain: SerialChain,
    q: ArrayLike,
    torques: ArrayLike,
    *,
    point: ArrayLike = TIP,
    axes: ArrayLike | str | None = None,
    length: float | None = None,
) -> Array:
    """Compute the wrench that a resting arm exerts on its surroundings with given torques.

    The inverse of :func:`joint_torques`.  The torques of more than six joints that balance a
    wrench have six degrees of freedom; of others the wrench of least squares is given.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, six or more.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    torques : array_like, of the shape of q or (n,)
        Torques of the actuators, without what the weight of the links needs (N m or N).
    point, axes
        As for :func:`joint_torques`.
    length : float, optional
        What the linear rows of the Jacobian are divided by where its rank is found (m), such as
        the characteristic length; default 1 m.

    Returns
    -------
    ndarray, shape (6,) or (..., 6)
        Moment about the point, then force, of the tip on its surroundings (N m and N), as the
        ``exerted_wrench`` of :func:`joint_torques`.  NaN where the posture is singular: there
        are wrenches there that load no joint, ``singularity_report(chain, q).idle_wrenches``.

    Raises
    ------
    UnknownLinkError, BadValueError, WrongSizeError
        As for :func:`joint_torques`, or a chain of fewer than six joints.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.6.
    """
    J = point_jacobian(chain, q, point, axes)
    if chain.n < _POSE:
        names = f"{chain.name} with {counted(chain.n, 'joint')}"
        raise BadValueError("chain", names, "six joints or more: a wrench is six numbers")
    tau = as_finite_values(chain, torques, "torques")
    scale = np.repeat((1.0, 1.0 / (1.0 if length is None else as_length(length))), 3)
    left, values, right = np.linalg.svd(J * scale[:, None], full_matrices=False)
    regular = values[..., -1:] > RANK * values[..., :1]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        parts = np.einsum("...ij,...j->...i", right, _rows("torques", tau, J)) / values
        wrench: Array = scale * np.einsum("...ij,...j->...i", left, parts)
    return np.where(regular, wrench, np.nan)


def _rows(what: str, given: Array, J: Array) -> Array:
    """Check that there is one row for all of the Jacobians or one for each."""
    if given.ndim > 1 and given.shape[:-1] != J.shape[:-2]:
        tail = given.shape[-1]
        raise WrongSizeError(what, given.shape, f"({tail},) or {(*J.shape[:-2], tail)}, as q")
    return given
