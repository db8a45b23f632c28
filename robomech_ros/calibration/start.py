"""A start without iteration: samples that agree by invariants, and both rotations at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.calibration import starting
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.calibration.freedom import Freedom, freedom_of
from robomech_ros.spatial.transformations.matching import rotations_between, top_vectors

Array = NDArray[np.float64]

_make_rotations = direct(starting.make_rotations)
_positions = direct(starting.linear_positions)
_squared_errors = direct(starting.squared_errors)

# Fewer samples have no majority.
_LEAST_TO_VOTE = 5
# The part of pairs by which their spread is judged: of samples a fifth of which is wrong, two
# thirds of the pairs are right.  So much of a normal distribution is within 0.45 deviations.
_JUDGED, _WITHIN = 0.35, 0.45
_AGREE = 4.0
# What rounding makes of angles (rad) near 0 and half turns, by their cosines.
_EXACT = 1e-6
_ROUNDS = 12
_MEDIAN = 2.366  # of the sum of three squared normal numbers
_LEAST_VARIANCE = 1e-26
_TRANSPOSED = [0, 3, 6, 1, 4, 7, 2, 5, 8]


@dataclass(eq=False)
class Start:
    """Unknowns (24) to refine from, others that fit nearly as well, and what holds there.

    The squared errors of rotation (rad^2) and position (m^2) are two rows (2, n); variances are
    those of each coordinate, by medians.
    """

    at: Array
    others: list[Array]
    errors: Array
    variances: tuple[float, float]
    freedom: Freedom


def packed(poses: Array) -> Array:
    """Return poses (n, 4, 4) as rows of rotation and origin (n, 12)."""
    rows = np.empty((len(poses), 12))
    rows[:, :9] = poses[:, :3, :3].reshape(-1, 9)
    rows[:, 9:] = poses[:, :3, 3]
    return rows


def inverted(rows: Array) -> Array:
    """Invert poses in rows (n, 12)."""
    turned = rows[:, _TRANSPOSED]
    back = np.matmul(turned.reshape(-1, 3, 3), rows[:, 9:, None])[:, :, 0]
    return np.concatenate((turned, -back), axis=1)


def _angles(rows: Array) -> Array:
    """Angles (n, n) between rotations."""
    flat = np.ascontiguousarray(rows[:, :9])
    quarter = 0.25 * (1.0 + flat @ flat.T)
    return 2.0 * np.arccos(np.sqrt(np.minimum(np.maximum(quarter, 0.0), 1.0)))


def agreeing(A: Array, S: Array) -> Array:
    """Find samples whose relative rotations have the same angles for robot and sensor.

    Parameters
    ----------
    A, S : ndarray, shape (n, 12)
        As :func:`packed` gives them.

    Returns
    -------
    ndarray, shape (n,)
        1 for those that agree with at least half as many others as the best, 0 for others.
    """
    n = len(A)
    if n < _LEAST_TO_VOTE:
        return np.ones(n)
    differences = np.abs(_angles(A) - _angles(S))
    # The first n are those of each with itself.
    place = n + int(_JUDGED * (n * n - n))
    spread = float(np.partition(differences, place, axis=None)[place])
    votes = (differences <= max(_AGREE / _WITHIN * spread, _EXACT)).sum(axis=1)
    return np.where(2 * votes > votes.max(), 1.0, 0.0)


def started(A: Array, S: Array, voters: Array, least: float = 0.0) -> Start:
    """Find unknowns to refine from: both rotations, then both positions; the best of several.

    The rotations make the sum of the traces of ``R_Z^T R_A R_X R_S`` largest, which is bilinear
    in them; signs of vectors and half turns play no part.  Half turns about axes at right angles
    leave several rotations open.  The positions make the sum of distances least, which samples
    that are wrong hardly move; where all axes are parallel they also tell the turn about them.

    Parameters
    ----------
    A, S : ndarray, shape (n, 12)
    voters : ndarray, shape (n,)
        1 for samples to start from, 0 for others.
    least : float, optional
        Variance of the rotations (rad^2) where it is known.
    """
    both = (A[:, :9] * voters[:, None]).T @ S[:, :9]
    square = both.reshape(3, 3, 3, 3).transpose(0, 3, 1, 2).reshape(9, 9)
    _, values, vectors = np.linalg.svd(square)
    space = top_vectors(values, vectors)
    found = space if len(space) == 1 else rotations_between(space)
    ats = [_completed(A, S, voters, square, matrix) for matrix in found]
    if len(ats) > 1:
        reach = float(voters @ (A[:, 9:] ** 2 + S[:, 9:] ** 2).sum(axis=1)) / (3.0 * voters.sum())
        scale = np.array([1.0, 1.0 / (reach or 1.0)])
        ats.sort(key=lambda at: float(scale @ errors_at(A, S, at) @ voters))
    at = ats[0]
    errors = errors_at(A, S, at)
    freedom = freedom_of(A, S, voters, at, max(variances_of(errors)[0], least))
    if freedom.is_axis:
        put_on_axis(A, S, voters, at, freedom)
        errors = errors_at(A, S, at)
    return Start(at, ats[1:], errors, variances_of(errors), freedom)


def _completed(A: Array, S: Array, voters: Array, square: Array, matrix: Array) -> Array:
    """Complete X and Z (24) of a matrix near X's rotation."""
    at = np.zeros(24)
    at[:9] = matrix.reshape(9)
    _make_rotations(square, at)
    _positions(A, S, voters.copy(), _ROUNDS, at)
    return at


def put_on_axis(A: Array, S: Array, use: Array, at: Array, freedom: Freedom) -> None:
    """Find what positions tell where all turns are about parallel axes."""
    freedom.turn_about_axis(A, S, use, at)
    _positions(A, S, use.copy(), _ROUNDS, at)
    freedom.settle(at)


def errors_at(A: Array, S: Array, at: Array) -> Array:
    """Squared rotation errors (rad^2) and position errors (m^2), shape (2, n)."""
    out = np.empty((2, len(A)))
    _squared_errors(A, S, at, out)
    return out


def variances_of(errors: Array) -> tuple[float, float]:
    """Estimate the variances per coordinate from medians of squared errors (2, n)."""
    freed = 1.0 / (_MEDIAN * max(1.0 - 2.0 / errors.shape[1], 0.25))
    ordered, n = np.sort(errors, axis=1), errors.shape[1]
    medians = 0.5 * (ordered[:, (n - 1) // 2] + ordered[:, n // 2])
    turn, shift = (max(float(one) * freed, _LEAST_VARIANCE) for one in medians)
    return turn, shift
