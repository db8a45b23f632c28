"""Jacobians of fewer rows: of a part of the task, and of arms that move in a plane."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinematics.tolerances import ARM_RANK
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.kinetostatics.point_jacobians import TIP, point_jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.arrays import held_rows
from robomech_ros.typing import Array, ArrayLike, BoolArray

# More of the base's x axis than this along the normal, and the y axis gives the directions instead.
_UPRIGHT = 0.9


def task_jacobian(
    chain: SerialChain,
    q: ArrayLike,
    mask: Sequence[bool],
    *,
    point: ArrayLike = TIP,
    axes: ArrayLike | str | None = None,
) -> Array:
    """Compute those rows of the Jacobian that a task asks for.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    mask : sequence of six bool
        Whether x, y, z of the velocity and of the angular velocity count, in the order of the
        task mask of :func:`inverse_kinematics`; one of them at least.
    point, axes
        As for :func:`point_jacobian`; the mask is in these axes, such as those of the tool.

    Returns
    -------
    ndarray, shape (r, n) or (..., r, n)
        Angular rows first (1 and m).
    """
    rows = held_rows("mask", mask)
    if not len(rows):
        raise BadValueError("mask", tuple(mask), "at least one True")
    return point_jacobian(chain, q, point, axes)[..., rows, :]


def planar_jacobian(chain: SerialChain, q: ArrayLike, *, point: ArrayLike = TIP) -> Array:
    r"""Compute the matrix that maps the joint rates of a planar arm to its twist in the plane.

    .. math::

       \begin{bmatrix} \omega \\ v_x \\ v_y \end{bmatrix} = J \dot q, \qquad
       j_i = \begin{bmatrix} 1 \\ E s_i \end{bmatrix}, \qquad
       E = \begin{bmatrix} 0 & -1 \\ 1 & 0 \end{bmatrix}

    for a revolute joint, with :math:`s_i` in the plane from the joint to the point.  It is
    ``planar_rows(chain) @ point_jacobian(chain, q, point)``.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, all axes across one plane and all slides along it.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    point : array_like, shape (3,), optional
        Point of the tip link, in its frame (m); default the tip's origin.

    Returns
    -------
    ndarray, shape (3, n) or (..., 3, n)
        The angular row first (1 and m).

    Raises
    ------
    BadValueError, WrongSizeError
        As for :func:`point_jacobian`, or a chain that is not planar.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.7.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import planar_jacobian
    >>> from robomech_ros.robots import chain_from_dh
    >>> arm = chain_from_dh(a=[0.5, 0.4, 0.1], b=[0.0] * 3, alpha=[0.0] * 3)
    >>> np.round(planar_jacobian(arm, [0.0, np.pi / 2.0, 0.0]), 6) + 0.0
    array([[ 1. ,  1. ,  1. ],
           [-0.5, -0.5, -0.1],
           [ 0.5,  0. ,  0. ]])
    """
    rows = planar_rows(chain)
    return rows @ point_jacobian(chain, q, point)


def planar_rows(chain: SerialChain) -> Array:
    """Find the plane of a planar arm, and what takes twists to it and wrenches from it.

    The normal is the axis of the first joint that turns; the x axis is that of the base, as far
    as it lies in the plane, or the y axis where that is nearly across it.

    Parameters
    ----------
    chain : SerialChain
        All axes across one plane and all slides along it.

    Returns
    -------
    ndarray, shape (3, 6)
        S: ``S @ t`` is the twist ``[omega; v_x; v_y]`` in the plane of a twist t of the arm, its
        rate likewise, and ``S.T @ w`` the wrench of ``[n; f_x; f_y]`` in the plane.

    Raises
    ------
    BadValueError
        The arm is not planar: the message tells the joint; or it is one slide alone, or none.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.7.
    """
    check_chain(chain)
    return _planar_rows(chain)


@functools.lru_cache(maxsize=64)
def _planar_rows(chain: SerialChain) -> Array:
    chain = chain.uncoupled
    J = jacobian(chain, np.zeros(chain.n))
    slides = chain.types == PRISMATIC
    directions = np.where(slides, J[3:], J[:3]).T
    normal = _normal(chain, directions, slides)
    along = np.abs(directions @ normal)
    across = np.linalg.norm(np.cross(directions, normal), axis=1)
    leaving = np.flatnonzero(np.where(slides, along, across) > ARM_RANK)
    if len(leaving):
        joint = chain.joint_names[leaving[0]]
        raise BadValueError(
            "chain", chain.name, f"a planar one: joint '{joint}' moves links out of the plane"
        )
    base = np.eye(3)[1 if abs(normal[0]) > _UPRIGHT else 0]
    x = base - (base @ normal) * normal
    x /= np.linalg.norm(x)
    rows = np.zeros((3, 6))
    rows[0, :3], rows[1, 3:], rows[2, 3:] = normal, x, np.cross(normal, x)
    rows.setflags(write=False)
    return rows


def _normal(chain: SerialChain, directions: Array, slides: BoolArray) -> Array:
    """Return the axis of the first joint that turns, else what is across two slides."""
    turning = np.flatnonzero(~slides)
    if len(turning):
        return directions[turning[0]]
    normals = np.cross(directions[:1], directions)
    lengths = np.linalg.norm(normals, axis=1)
    if not (lengths > ARM_RANK).any():
        raise BadValueError("chain", chain.name, "a planar one: its joints leave the plane open")
    k = int(np.argmax(lengths))
    return normals[k] / lengths[k]
