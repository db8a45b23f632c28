"""Forward kinematics without compiled kernels, for many poses now and then."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, raise_not_finite
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.typing import Array, ArrayLike


def tip_poses(chain: SerialChain, q: ArrayLike) -> Array:
    """Compute the poses of the tip along a path, all poses joint by joint.

    `forward_kinematics` gives the same and is faster; this takes 100 MB less to load.

    Parameters
    ----------
    chain : SerialChain
        n joints.
    q : array_like, shape (m, n)
        Joint values, rad or m.

    Returns
    -------
    ndarray, shape (m, 4, 4)
        ``T_base_tip``, lengths in m.
    """
    values = as_joint_values(chain, q)
    if values.ndim != 2:
        raise WrongSizeError("q", values.shape, f"(m, {chain.n})")
    if not np.isfinite(values).all():
        raise_not_finite(chain, values)
    return link_transforms(chain, values)[:, -1]


def link_transforms(chain: SerialChain, q: Array) -> Array:
    """Compute the poses (..., m + 1, 4, 4) of the frames that move with m joints, and of the tip.

    They are in the base (m), for joint values q (..., n) of the drives (rad or m).
    """
    q, chain = chain.joint_values(q), chain.uncoupled
    constants = chain.transforms
    poses = np.empty((*q.shape[:-1], chain.n + 1, 4, 4))
    T = np.broadcast_to(constants[0], (*q.shape[:-1], 4, 4))
    for i in range(chain.n):
        joint = np.zeros((*q.shape[:-1], 4, 4))
        joint[...] = np.eye(4)
        if chain.types[i] == REVOLUTE:
            c, s = np.cos(q[..., i]), np.sin(q[..., i])
            joint[..., 0, 0], joint[..., 0, 1] = c, -s
            joint[..., 1, 0], joint[..., 1, 1] = s, c
        else:
            joint[..., 2, 3] = q[..., i]
        poses[..., i, :, :] = T @ joint
        T = poses[..., i, :, :] @ constants[i + 1]
    poses[..., chain.n, :, :] = T
    return poses
