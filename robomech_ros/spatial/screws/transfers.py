"""Twists and wrenches at other points and in other frames.

Both have the angular part first: ``t = [omega; v]`` and ``w = [n; f]``; their product is power.
"""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.spatial import exponential
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.cross_product import cross, cross_product_matrix
from robomech_ros.spatial.rows import as_rows, common_shape, finite_result
from robomech_ros.spatial.screws.exponential import raise_bad_pose
from robomech_ros.typing import Array, ArrayLike

_adjoints = direct(exponential.adjoints)


def transfer_twist(twist: ArrayLike, from_point: ArrayLike, to_point: ArrayLike) -> Array:
    r"""Return the twist of a body at another of its points.

    .. math:: v_P = v_A + \omega \times (p - a)

    Parameters
    ----------
    twist : array_like, shape (..., 6)
        Angular velocity (rad/s), then velocity of the point a (m/s).
    from_point, to_point : array_like, shape (..., 3)
        The points a and p (m), in the axes of the twist.

    Returns
    -------
    ndarray, shape (..., 6)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.4.2.

    Examples
    --------
    >>> from robomech_ros.spatial import transfer_twist
    >>> transfer_twist([0.0, 0.0, 2.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0])
    array([0., 0., 2., 0., 1., 0.])
    """
    return _moved("twist", twist, from_point, to_point, 0)


def transfer_wrench(wrench: ArrayLike, from_point: ArrayLike, to_point: ArrayLike) -> Array:
    r"""Return the wrench on a body with its moment about another point.

    .. math:: n_P = n_A + (a - p) \times f

    Parameters
    ----------
    wrench : array_like, shape (..., 6)
        Moment about the point a (N m), then force (N).
    from_point, to_point : array_like, shape (..., 3)
        The points a and p (m), in the axes of the wrench.

    Returns
    -------
    ndarray, shape (..., 6)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.7.

    Examples
    --------
    >>> from robomech_ros.spatial import transfer_wrench
    >>> transfer_wrench([0.0, 0.0, 0.0, 0.0, 10.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0])
    array([ 0.,  0.,  5.,  0., 10.,  0.])
    """
    return _moved("wrench", wrench, from_point, to_point, 3)


def twist_transfer_matrix(from_point: ArrayLike, to_point: ArrayLike) -> Array:
    """Form U with ``t_P = U t_A``: ``[[1, 0], [CPM(a - p), 1]]``.

    Parameters
    ----------
    from_point, to_point : array_like, shape (..., 3)
        The points a and p (m).

    Returns
    -------
    ndarray, shape (..., 6, 6)
        Its inverse and transpose is that of wrenches between the same points.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.4.2.
    """
    return _matrix(from_point, to_point, 3, 0)


def wrench_transfer_matrix(from_point: ArrayLike, to_point: ArrayLike) -> Array:
    """Form V with ``w_P = V w_A``: ``[[1, CPM(a - p)], [0, 1]]``.

    Parameters
    ----------
    from_point, to_point : array_like, shape (..., 3)
        The points a and p (m).

    Returns
    -------
    ndarray, shape (..., 6, 6)

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 3.7.
    """
    return _matrix(from_point, to_point, 0, 3)


def pose_adjoint(pose: ArrayLike) -> Array:
    r"""Form the matrix that expresses twists in another frame, at that frame's origin.

    .. math:: t_a = \begin{bmatrix} Q & 0 \\ \mathrm{CPM}(p) Q & Q \end{bmatrix} t_b

    Parameters
    ----------
    pose : array_like, shape (..., 4, 4)
        ``T_a_b``.

    Returns
    -------
    ndarray, shape (..., 6, 6)
        Angular rows and columns first.  Its inverse and transpose expresses wrenches.
    """
    rows, shape = as_rows("pose", pose, (4, 4), 16)
    out = np.empty((len(rows), 36))
    if _adjoints(rows, out):
        raise_bad_pose(rows, shape)
    return out.reshape(*shape, 6, 6)


def _moved(what: str, six: ArrayLike, start: ArrayLike, end: ArrayLike, free: int) -> Array:
    """Add to one half of six numbers the free half times the way between two points."""
    given = as_finite(what, six, (6,))
    a, p = (as_finite(f"point of {what}", one, (3,)) for one in (start, end))
    shape = common_shape(f"{what} and points", given.shape[:-1], a.shape[:-1], p.shape[:-1])
    out = np.empty((*shape, 6))
    out[...] = given
    bound = 3 - free
    with np.errstate(over="ignore", invalid="ignore"):
        out[..., bound : bound + 3] += cross(given[..., free : free + 3], p - a)
    return finite_result(f"{what} and points", out, given)


def _matrix(start: ArrayLike, end: ArrayLike, row: int, column: int) -> Array:
    a, p = (as_finite("point", one, (3,)) for one in (start, end))
    shape = common_shape("points", a.shape[:-1], p.shape[:-1])
    out = np.zeros((*shape, 6, 6))
    out[...] = np.eye(6)
    with np.errstate(over="ignore"):
        way = a - p
    finite_result("points", way, a)
    out[..., row : row + 3, column : column + 3] = cross_product_matrix(way)
    return out
