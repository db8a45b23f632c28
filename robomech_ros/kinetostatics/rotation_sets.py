"""Sets of orientations: spread evenly over all rotations, or over the turns about an axis."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros.errors import WrongSizeError
from robomech_ros.robots.entry_checks import whole_number
from robomech_ros.spatial import as_rotation, matrix_from_axis_angle, matrix_from_quaternion
from robomech_ros.spatial.arrays import as_single
from robomech_ros.typing import Array, ArrayLike

MOST_ORIENTATIONS = 1_000_000

# Of the spirals: the root of 2, and the positive root of x^4 = x + 4, by which one set after
# another of points on the torus falls into the largest gaps.
_PHI = math.sqrt(2.0)
_PSI = 1.533751168755204288118041


def uniform_rotations(count: int) -> Array:
    """Spread rotations nearly evenly over SO(3), the same for the same number.

    They are points of a super-Fibonacci spiral on the sphere of unit quaternions.

    Parameters
    ----------
    count : int
        From 1 to 1,000,000.

    Returns
    -------
    ndarray, shape (count, 3, 3)

    References
    ----------
    M. Alexa, Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3), IEEE/CVF Conference
    on Computer Vision and Pattern Recognition, 2022.
    """
    place = np.arange(_as_count(count)) + 0.5
    alpha, beta = 2.0 * math.pi * place / _PHI, 2.0 * math.pi * place / _PSI
    inner, outer = np.sqrt(place / count), np.sqrt(1.0 - place / count)
    q = (inner * np.sin(alpha), inner * np.cos(alpha), outer * np.sin(beta), outer * np.cos(beta))
    return matrix_from_quaternion(np.stack(q, axis=-1))


def uniform_turns(count: int, axis: ArrayLike, first: ArrayLike | None = None) -> Array:
    """Turn an orientation about an axis of the base in equal steps, once around.

    Parameters
    ----------
    count : int
        From 1 to 1,000,000.
    axis : array_like, shape (3,)
        In the base, of any length but zero.
    first : array_like, shape (3, 3), optional
        The orientation that is turned, itself the first; default that of the base.

    Returns
    -------
    ndarray, shape (count, 3, 3)
    """
    angles = 2.0 * math.pi / _as_count(count) * np.arange(count)
    along = as_single("axis", axis, (3,))
    start = as_rotation(np.eye(3) if first is None else first, what="first")
    if start.ndim != 2:
        raise WrongSizeError("first", start.shape, (3, 3))
    return matrix_from_axis_angle(along, angles) @ start


def as_orientations(orientations: ArrayLike) -> Array:
    """Check orientations (k, 3, 3), or spread this many evenly where a number is given."""
    if isinstance(orientations, int | np.integer) and not isinstance(orientations, bool):
        return uniform_rotations(int(orientations))
    rotations = as_rotation(orientations, what="orientations")
    if rotations.ndim != 3:
        raise WrongSizeError("orientations", rotations.shape, "(k, 3, 3)")
    _as_count(len(rotations))
    return np.ascontiguousarray(rotations)


def _as_count(count: int) -> int:
    expected = f"a whole number from 1 to {MOST_ORIENTATIONS:,}"
    return whole_number("number of orientations", count, 1, MOST_ORIENTATIONS, expected)
