"""The matrices of stacked twists and wrenches: mass, its root, angular velocity.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5.
"""

import numpy as np

from robomech_ros.spatial.screws.bodies import angular_velocity_dyad, inertia_dyad
from robomech_ros.typing import Array


def extended_mass(masses: Array, inertias: Array) -> Array:
    """Form M (..., 6 r, 6 r), blocks diag(I_i, m_i 1), of masses (r,), inertias (..., r, 3, 3)."""
    return _block_diagonal(inertia_dyad(masses, inertias))


def mass_roots(masses: Array, inertias: Array) -> Array:
    """H with ``H^T H`` the extended mass matrix, from principal moments and axes."""
    moments, axes = (np.asarray(one) for one in np.linalg.eigh(inertias))
    roots = np.zeros((*inertias.shape[:-2], 6, 6))
    roots[..., :3, :3] = np.sqrt(np.maximum(moments, 0.0))[..., None] * transposed(axes)
    roots[..., 3:, 3:] = np.sqrt(masses)[:, None, None] * np.eye(3)
    return _block_diagonal(roots)


def extended_angular_velocity(twists: Array) -> Array:
    """Form W (..., 6 r, 6 r), blocks diag(Omega_i, 0), for twists (..., r, 6)."""
    return _block_diagonal(angular_velocity_dyad(twists[..., :3]))


def _block_diagonal(blocks: Array) -> Array:
    """Set blocks of shape (..., r, 6, 6) along the diagonal of (..., 6 r, 6 r)."""
    n = blocks.shape[-3]
    matrix = np.zeros((*blocks.shape[:-3], 6 * n, 6 * n))
    for i in range(n):
        matrix[..., 6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = blocks[..., i, :, :]
    return matrix


def transposed(matrix: Array) -> Array:
    """Swap the last two axes."""
    return np.swapaxes(matrix, -1, -2)


def times(matrix: Array, vector: Array) -> Array:
    """Multiply matrices (..., m, n) and vectors (..., n)."""
    return (matrix @ vector[..., None])[..., 0]


def solve(matrix: Array, vector: Array) -> Array:
    """Solve for vectors (..., n) with regular matrices (..., n, n)."""
    return np.asarray(np.linalg.solve(matrix, vector[..., None])[..., 0], dtype=np.float64)
