"""Forward kinematics of serial chains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robomech_ros._kernels.chain.serial import forward, forward_one
from robomech_ros.kinematics.joint_values import (
    as_finite_values,
    as_joint_values,
    as_rows,
    raise_not_finite,
)
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import listed
from robomech_ros.typing import Array, ArrayLike


def forward_kinematics(chain: SerialChain, q: ArrayLike) -> Array:
    r"""Compute the pose of the tip in the base.

    .. math:: T = C_0\, J_1(q_1)\, C_1 \cdots J_n(q_n)\, C_n

    with the constant transforms :math:`C_i` of the chain and turns about, or slides along, the
    z axes :math:`J_i`; of a Denavit-Hartenberg table this is the product of its matrices.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.

    Returns
    -------
    ndarray, shape (4, 4) or (..., 4, 4)
        ``T_base_tip`` (m).

    Raises
    ------
    BadValueError
        The pose overflows.

    See Also
    --------
    tip_poses : the same without compiled code, for many postures.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.3.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> T = forward_kinematics(puma, [0.0, np.pi / 4.0, np.pi, 0.0, np.pi / 4.0, 0.0])
    >>> np.round(T[:3, 3], 5)
    array([ 0.5963 , -0.15005, -0.01435])
    >>> forward_kinematics(puma, np.zeros((5, 6))).shape
    (5, 4, 4)
    """
    q = as_joint_values(chain, q)
    if q.ndim == 1:
        pose = np.empty((4, 4))
        if forward_one(chain.packed, q, pose):
            raise_not_finite(chain, q)
        return pose
    rows = as_rows(q)
    poses = np.empty((len(rows), 4, 4))
    if forward(chain.packed, rows, poses):
        raise_not_finite(chain, q)
    return poses.reshape(*q.shape[:-1], 4, 4)


def link_poses(chain: SerialChain, q: ArrayLike, links: Sequence[str] | None = None) -> Array:
    """Compute the poses of several links in the base.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m).
    links : sequence of str, optional
        Links along the chain, or fixed to one that is; default all links along the chain.

    Returns
    -------
    ndarray, shape (..., len(links), 4, 4)
        ``T_base_link`` of each (m).

    Raises
    ------
    UnknownLinkError
        A link that the chain has not.

    Examples
    --------
    >>> from robomech_ros.kinematics import link_poses
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> link_poses(puma, puma.midrange()).shape
    (8, 4, 4)
    """
    q = as_finite_values(chain, q)
    names = chain.links
    if links is not None:
        names = listed("links", links, "a list of links, or None for all along the chain")
    poses = np.empty((*q.shape[:-1], len(names), 4, 4))
    for i, name in enumerate(names):
        part = chain.with_tip(name)
        poses[..., i, :, :] = forward_kinematics(part, q[..., : part.n])
    return poses
