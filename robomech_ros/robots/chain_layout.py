"""Layout of a chain's constant transforms and joint types for the kernels."""

import math

import numpy as np

from robomech_ros.typing import Array, IntArray

REVOLUTE = 0
PRISMATIC = 1
# What is found once for a robot, such as its characteristic length, takes seconds for a chain of so
# many joints, and four times that for twice as many.
MOST_JOINTS = 64


def turn_about_z(angle: float) -> Array:
    """Turn about z by an angle (rad): shape (4, 4)."""
    T = np.eye(4)
    c, s = math.cos(angle), math.sin(angle)
    T[:2, :2] = (c, -s), (s, c)
    return T


def shift(vector: Array) -> Array:
    """Move by a vector (3,) in m, without a turn: shape (4, 4)."""
    T = np.eye(4)
    T[:3, 3] = vector
    return T


def joint_transform(slides: bool, q: float) -> Array:
    """Turn about z by q (rad), or slide along it by q (m): shape (4, 4)."""
    if not slides:
        return turn_about_z(q)
    T = np.eye(4)
    T[2, 3] = q
    return T


def pack_chain(transforms: Array, types: IntArray) -> Array:
    """Lay out constant transforms and joint types as the kernels read them.

    - ``transforms``: C_0 .. C_n (m), shape (n + 1, 4, 4).
    - ``types``: 0 revolute, 1 prismatic, shape (n,).

    Returns an array (n + 1, 13); see :class:`robomech_ros.robots.SerialChain`.
    """
    n = len(types)
    packed = np.empty((n + 1, 13))
    packed[:n, 0] = types
    packed[n, 0] = -1.0
    packed[:, 1:10] = transforms[:, :3, :3].reshape(n + 1, 9)
    packed[:, 10:] = transforms[:, :3, 3]
    return packed


def unpack_chain(packed: Array) -> Array:
    """Return the constant transforms C_0 .. C_n of a chain as it is packed.

    - ``packed``: see :class:`robomech_ros.robots.SerialChain`, shape (n + 1, 13) or (n + 1, 17).

    Returns a copy, (n + 1, 4, 4) (m).
    """
    transforms = np.zeros((len(packed), 4, 4))
    transforms[:, :3, :3] = packed[:, 1:10].reshape(-1, 3, 3)
    transforms[:, :3, 3] = packed[:, 10:13]
    transforms[:, 3, 3] = 1.0
    return transforms
