"""A start without iteration: samples that agree by invariants, and both rotations at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.calibration import refinement
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.spatial.matrices import nearest_rotation
from robomech_ros.spatial.transformations.matching import rotations_between, top_vectors

__all__ = ["agreeing", "errors_at", "packed", "starts"]

Array = NDArray[np.float64]

_positions = direct(refinement.linear_positions)
_residuals = direct(refinement.residuals)

# Fewer samples have no majority.
_LEAST_TO_VOTE = 5
# The part of pairs by which their spread is judged: of samples a fifth of which is wrong, two
# thirds of the pairs are right.  So much of a normal distribution is within 0.45 deviations.
_JUDGED, _WITHIN = 0.35, 0.45
_AGREE = 4.0
# What rounding makes of angles (rad) near 0 and half turns, by their cosines.
_EXACT = 1e-6
_ROUNDS = 12


def packed(poses: Array) -> Array:
    """Give poses (n, 4, 4) as rows of rotation and origin (n, 12)."""
    rows = np.empty((len(poses), 12))
    rows[:, :9] = poses[:, :3, :3].reshape(-1, 9)
    rows[:, 9:] = poses[:, :3, 3]
    return rows


def _angles(rows: Array) -> Array:
    """Angles (n, n) between rotations."""
    flat = np.ascontiguousarray(rows[:, :9])
    quarter = 0.25 * (1.0 + flat @ flat.T)
    return 2.0 * np.arccos(np.sqrt(np.clip(quarter, 0.0, 1.0)))


def agreeing(A: Array, S: Array) -> NDArray[np.bool_]:
    """Find samples whose relative rotations have the same angles for robot and sensor.

    Parameters
    ----------
    A, S : ndarray, shape (n, 12)
        As :func:`packed` gives them.

    Returns
    -------
    ndarray of bool, shape (n,)
        Those that agree with at least half as many others as the best.
    """
    n = len(A)
    if n < _LEAST_TO_VOTE:
        return np.ones(n, bool)
    differences = np.abs(_angles(A) - _angles(S))
    pairs = np.sort(differences, axis=None)[n:]
    limit = max(_AGREE / _WITHIN * pairs[int(_JUDGED * len(pairs))], _EXACT)
    votes = (differences <= limit).sum(axis=1)
    return np.asarray(2 * votes > votes.max())


def starts(A: Array, S: Array, voters: NDArray[np.bool_]) -> list[Array]:
    """Find unknowns (24) to refine from: both rotations, then both positions; the best first.

    The rotations make the sum of the traces of ``R_Z^T R_A R_X R_S`` largest, which is bilinear
    in them; signs of vectors and half turns play no part.  Half turns about axes at right angles
    leave several rotations open.  The positions make the sum of distances least, which samples
    that are wrong hardly move.
    """
    both = A[voters, :9].T @ S[voters, :9]
    square = both.reshape(3, 3, 3, 3).transpose(0, 3, 1, 2).reshape(9, 9)
    _, values, vectors = np.linalg.svd(square)
    found = rotations_between(top_vectors(values, vectors))
    targets = nearest_rotation((found.reshape(-1, 9) @ square.T).reshape(-1, 3, 3))
    reach = float(np.mean(A[voters, 9:] ** 2 + S[voters, 9:] ** 2)) or 1.0
    ats, costs = [], []
    for X, Z in zip(found, targets, strict=True):
        at = np.zeros(24)
        at[:9], at[12:21] = X.reshape(9), Z.reshape(9)
        _positions(A, S, voters.astype(float), _ROUNDS, at)
        turns, shifts = errors_at(A, S, at)
        ats.append(at)
        costs.append(float(turns[voters].sum() + shifts[voters].sum() / reach))
    return [ats[int(k)] for k in np.argsort(costs, kind="stable")]


def errors_at(A: Array, S: Array, at: Array) -> tuple[Array, Array]:
    """Squared rotation errors (rad^2) and position errors (m^2), each (n,)."""
    out = np.empty((len(A), 6))
    _residuals(A, S, at, 0, out)
    return (out[:, :3] ** 2).sum(axis=1), (out[:, 3:] ** 2).sum(axis=1)
