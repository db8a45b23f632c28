"""Rotation vectors of motions between orientations, and their rates in the moving frame."""

import numpy as np

from robomech_ros.spatial.rotations.rates import angular_motion
from robomech_ros.typing import Array


def turning_acceleration(theta: Array, rate: Array) -> Array:
    """Part of the angular acceleration that is quadratic in the rate of the rotation vector."""
    return angular_motion(theta, "rotation-vector", rate)[1]


def body_rate_matrix(theta: Array) -> Array:
    """Matrices (m, 3, 3) from the rate of a rotation vector to the moving frame's own velocity."""
    # Seen from the moving frame, the fixed one turns back.
    turns = np.repeat(-theta[:, None], 3, axis=1)
    rates = np.broadcast_to(np.eye(3), turns.shape)
    return np.swapaxes(angular_motion(turns, "rotation-vector", rates)[0], -1, -2)


def applied(matrices: Array, vectors: Array) -> Array:
    """Products of matrices (m, 3, 3) with vectors (m, 3), one by one."""
    return (matrices @ vectors[..., None])[..., 0]
