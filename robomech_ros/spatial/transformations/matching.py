"""Rotations that take the axes of motions as one sensor sees them to those that another sees.

Where all motions commute with a half turn D, as half turns about axes at right angles do, X and D X
match them equally well.
"""

from itertools import product

import numpy as np

from robomech_ros.spatial.matrices import nearest_rotation
from robomech_ros.typing import Array

# Values this near to the largest may be as large but for noise.
_NEARLY = 0.9
_MOST = 3


def top_vectors(values: Array, vectors: Array) -> Array:
    """Return those rows (9,) whose values are nearly the largest, as matrices (m, 3, 3)."""
    count = min(int((values > _NEARLY * values[0]).sum()), _MOST)
    return vectors[: max(count, 1)].reshape(-1, 3, 3)


def rotations_between(space: Array) -> Array:
    """Find the rotations in the span of matrices M X, for symmetric M that commute.

    `space` (m, 3, 3) holds the best matches, the best first, m at most 3.  Returns the rotation
    nearest to the first; of more matrices also X and the three D X, where D is a half turn about a
    common principal axis of all M.  What matches is among them.
    """
    best = _rotation(space[0])
    if len(space) == 1:
        return best[None]
    weights = np.array([one for one in product((-1.0, 0.0, 1.0), repeat=len(space)) if any(one)])
    mixed = np.einsum("cm,mij->cij", weights, space)
    sizes = np.linalg.svd(mixed, compute_uv=False)
    X = _rotation(mixed[int(np.argmax(sizes[:, 2] / sizes[:, 0]))])
    parts = mixed @ X.T
    values, axes = np.linalg.eigh(0.5 * (parts + np.swapaxes(parts, 1, 2)))
    # All three axes where all values differ; else the one whose value does.
    gaps = np.diff(values, axis=1)
    e = axes[int(np.argmax(gaps.min(axis=1) + 0.1 * gaps.max(axis=1)))].T
    half_turns = 2.0 * e[:, :, None] * e[:, None, :] - np.eye(3)
    return np.concatenate((best[None], X[None], half_turns @ X))


def _rotation(matrix: Array) -> Array:
    """Find the rotation nearest to a matrix or to its opposite, whose determinant is positive."""
    return nearest_rotation(matrix if np.linalg.det(matrix) > 0.0 else -matrix)
