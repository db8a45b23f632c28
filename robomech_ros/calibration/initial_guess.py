"""Initial guess of X and Z in closed form, from samples that are consistent by invariants."""

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.calibration import starting
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.calibration.free_directions import FreeDirections, find_free_directions
from robomech_ros.spatial.transformations.matching import rotations_between, top_vectors
from robomech_ros.typing import Array

_make_rotations = direct(starting.make_rotations)
_positions = direct(starting.linear_positions)
_squared_errors = direct(starting.squared_errors)

# Fewer samples have no majority.
_MIN_TO_VOTE = 5
# Quantile of pairs that gives their deviation: if a fifth of the samples is wrong, two thirds of
# the pairs are right.  This part of a normal distribution is within 0.45 deviations.
_QUANTILE, _WITHIN = 0.35, 0.45
_CONSISTENT = 4.0  # deviations
# Rounding error of angles (rad) near 0 and half turns, by their cosines.
_ROUNDING = 1e-6
_ROUNDS = 12
_MEDIAN = 2.366  # of the sum of three squared normal numbers
MIN_VARIANCE = 1e-26
# Entries of the transposed matrix, row by row.
TRANSPOSED = [0, 3, 6, 1, 4, 7, 2, 5, 8]


@dataclass(eq=False)
class InitialGuess:
    """Unknowns X and Z (24,) to refine, and other solutions (24,), which fit nearly as well.

    The residuals (2, n) are squared, of rotation (rad^2) and position (m^2), the variances those of
    each coordinate of both, by medians.
    """

    at: Array
    others: list[Array]
    residuals: Array
    variances: tuple[float, float]
    free: FreeDirections


def pack_poses(poses: Array) -> Array:
    """Return poses (n, 4, 4) as rows of rotation and origin (n, 12)."""
    rows = np.empty((len(poses), 12))
    rows[:, :9] = poses[:, :3, :3].reshape(-1, 9)
    rows[:, 9:] = poses[:, :3, 3]
    return rows


def invert_rows(rows: Array) -> Array:
    """Invert poses in rows (n, 12)."""
    rotations = rows[:, TRANSPOSED]
    origins = np.matmul(rotations.reshape(-1, 3, 3), rows[:, 9:, None])[:, :, 0]
    return np.concatenate((rotations, -origins), axis=1)


def _angles(rows: Array) -> Array:
    """Return the angles (n, n) between rotations."""
    flat = np.ascontiguousarray(rows[:, :9])
    quarter = 0.25 * (1.0 + flat @ flat.T)
    return 2.0 * np.arccos(np.sqrt(np.minimum(np.maximum(quarter, 0.0), 1.0)))


def consistent_samples(A: Array, S: Array) -> Array:
    """Find samples whose relative rotations have the same angles for robot and sensor.

    Returns 1 for those (n,) that agree with at least half as many others as the best, 0 for others.
    """
    n = len(A)
    if n < _MIN_TO_VOTE:
        return np.ones(n)
    differences = np.abs(_angles(A) - _angles(S))
    # The first n are those of each with itself.
    index = n + int(_QUANTILE * (n * n - n))
    quantile = float(np.partition(differences, index, axis=None)[index])
    votes = (differences <= max(_CONSISTENT / _WITHIN * quantile, _ROUNDING)).sum(axis=1)
    return np.where(2 * votes > votes.max(), 1.0, 0.0)


def rotation_products(rotations: Array, S: Array, consistent: Array) -> Array:
    """Return the matrix (9, 9) that maps the entries of R_X to those of the sum of R_A R_X R_S."""
    both = (rotations * consistent[:, None]).T @ S[:, :9]
    return both.reshape(3, 3, 3, 3).transpose(0, 3, 1, 2).reshape(9, 9)


def closed_form_guess(A: Array, S: Array, consistent: Array, variance: float = 0.0) -> InitialGuess:
    """Solve for both rotations, then for both positions; return the best of several solutions.

    The rotations maximise the sum of the traces of ``R_Z^T R_A R_X R_S``, which is bilinear in them
    and does not depend on signs of vectors or half turns.  Half turns about axes at right angles
    leave several rotations open.  The positions minimise the sum of distances, on which outliers
    have little effect; if all axes are parallel they also give the rotation about them.
    """
    products = rotation_products(A[:, :9], S, consistent)
    _, values, vectors = np.linalg.svd(products)
    space = top_vectors(values, vectors)
    matrices = space if len(space) == 1 else rotations_between(space)
    ats = [_complete(A, S, consistent, products, matrix) for matrix in matrices]
    if len(ats) > 1:
        squares = float(consistent @ (A[:, 9:] ** 2 + S[:, 9:] ** 2).sum(axis=1))
        distance = squares / (3.0 * consistent.sum())
        scale = np.array([1.0, 1.0 / (distance or 1.0)])
        ats.sort(key=lambda at: float(scale @ squared_residuals(A, S, at) @ consistent))
    at = ats[0]
    residuals = squared_residuals(A, S, at)
    variance = max(median_variances(residuals)[0], variance)
    free = find_free_directions(A, S, consistent, at, variance)
    if free.is_axis:
        solve_about_axis(A, S, consistent, at, free)
        residuals = squared_residuals(A, S, at)
    return InitialGuess(at, ats[1:], residuals, median_variances(residuals), free)


def _complete(A: Array, S: Array, consistent: Array, products: Array, matrix: Array) -> Array:
    """Return X and Z (24) for a matrix near the rotation of X."""
    at = np.zeros(24)
    at[:9] = matrix.reshape(9)
    _make_rotations(products, at)
    _positions(A, S, consistent.copy(), _ROUNDS, at)
    return at


def solve_about_axis(A: Array, S: Array, use: Array, at: Array, free: FreeDirections) -> None:
    """Find in place the rotation about parallel axes by positions, then the positions."""
    free.rotate_about_axis(A, S, use, at)
    _positions(A, S, use.copy(), _ROUNDS, at)
    free.zero_along_axis(at)


def squared_residuals(A: Array, S: Array, at: Array) -> Array:
    """Return squared rotation residuals (rad^2) and position residuals (m^2), shape (2, n)."""
    out = np.empty((2, len(A)))
    _squared_errors(A, S, at, out)
    return out


def medians(residuals: Array) -> tuple[float, float]:
    """Return the medians of two rows (2, n), in less time than numpy.median."""
    ordered, n = np.sort(residuals, axis=1), residuals.shape[1]
    one, two = 0.5 * (ordered[:, (n - 1) // 2] + ordered[:, n // 2])
    return float(one), float(two)


def median_variances(residuals: Array) -> tuple[float, float]:
    """Estimate the variances per coordinate from medians of squared residuals (2, n)."""
    scale = 1.0 / (_MEDIAN * max(1.0 - 2.0 / residuals.shape[1], 0.25))
    turn, shift = (max(one * scale, MIN_VARIANCE) for one in medians(residuals))
    return turn, shift
