"""The Jacobian of any point of the tip link, in the axes of any frame."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.chain import jacobian_points as kernels
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial import as_rotation
from robomech_ros.spatial.arrays import as_single
from robomech_ros.typing import Array, ArrayLike

# The origin of the tip, the default point.
TIP = (0.0, 0.0, 0.0)
_ORIGIN = np.zeros(3)


def point_jacobian(
    chain: SerialChain, q: ArrayLike, point: ArrayLike = TIP, axes: ArrayLike | str | None = None
) -> Array:
    r"""Compute the matrix that maps joint rates to the twist of a point of the tip link.

    .. math::

       t_P = \begin{bmatrix} 1 & 0 \\ -\mathrm{CPM}(r) & 1 \end{bmatrix} t, \qquad
       v_P = v + \omega \times r

    with r from the tip's origin to P; then both halves are turned into the axes.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    point : array_like, shape (3,), optional
        P, fixed to the tip link, in the frame of the tip link (m); default the tip's origin.
    axes : str or array_like, shape (3, 3), optional
        In what axes the twist is expressed: the name of a link, such as ``chain.tip``, or a
        rotation ``R_base_axes``; default the base.

    Returns
    -------
    ndarray, shape (6, n) or (..., 6, n)
        Angular rows first (1 and m).

    Raises
    ------
    BadValueError, WrongSizeError
        As for :func:`jacobian`, and for a point that is not three numbers up to 1e6 m or axes that
        are no rotation.
    UnknownLinkError
        The chain has no link with the name of the axes.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 3.4.2 and 5.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import jacobian, point_jacobian
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q = [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]
    >>> J = point_jacobian(puma, q, [0.0, 0.0, 0.1], axes=puma.tip)
    >>> bool(np.isclose(abs(np.linalg.det(J)), abs(np.linalg.det(jacobian(puma, q)))))
    True
    """
    q, arm = as_joint_values(chain, q), as_point(point)
    rows = as_rows(q)
    matrices, poses = np.empty((len(rows), 6, chain.n)), np.empty((len(rows), 4, 4))
    if kernels.point_jacobian(chain.packed, rows, arm, matrices, poses):
        raise_not_finite(chain, q)
    J: Array = matrices.reshape(*q.shape[:-1], 6, chain.n)
    if axes is None:
        return J
    # Rows of R^T, for each half.
    turn = np.swapaxes(rotation_of(chain, q, axes), -1, -2)
    return np.concatenate((turn @ J[..., :3, :], turn @ J[..., 3:, :]), axis=-2)


def as_point(point: ArrayLike) -> Array:
    """Check a point (3,) of the tip link, in its frame (m)."""
    if point is TIP:
        return _ORIGIN
    arm = as_single("point", point, (3,))
    if np.abs(arm).max() > LARGEST_LENGTH:
        expected = f"coordinates of at most {LARGEST_LENGTH:g} m, as of links"
        raise BadValueError("point", arm.tolist(), expected)
    return np.ascontiguousarray(arm)


def rotation_of(chain: SerialChain, q: Array, axes: ArrayLike | str) -> Array:
    """Return the rotation ``R_base_axes`` (..., 3, 3) of a link at q (..., n), or the one given."""
    if isinstance(axes, str):
        part = chain.with_tip(axes)
        return forward_kinematics(part, q[..., : part.n])[..., :3, :3]
    turn = as_rotation(axes, what="axes")
    if turn.ndim != 2:
        raise WrongSizeError("axes", turn.shape, (3, 3))
    return turn
