"""Redundant sensing: several sensors that see one motion, or one matrix, each in its own frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import real_number
from robomech_ros.spatial.cross_product import cross
from robomech_ros.spatial.matrices import nearest_rotation
from robomech_ros.spatial.rotations.axis_angle import (
    rotation_vector_from_matrix,
)
from robomech_ros.spatial.rotations.quaternions import quaternion_from_matrix

__all__ = ["SensorAgreement", "frame_between_sensors", "sensor_agreement"]

Array = NDArray[np.float64]

# Difference of angles (rad) of one motion seen by sensors without noise.
_SAME_ANGLE = 1e-6
_LEAST_SENSORS = 2
# Ratio of singular values of axes below which they are all parallel.
_PARALLEL = 1e-9


@dataclass(frozen=True, eq=False)
class SensorAgreement:
    """Whether sensors agree on the motions that they see.

    Attributes
    ----------
    angles : ndarray, shape (s, k)
        Angles of k rotations by each of s sensors (rad): they are the same in all frames.
    consensus : ndarray, shape (k,)
        Their medians.
    errors : ndarray, shape (s,)
        Largest difference of each sensor from them (rad).
    faulty : tuple of int
        Sensors farther off than the tolerance.
    """

    angles: Array
    consensus: Array
    errors: Array
    faulty: tuple[int, ...]


def sensor_agreement(rotations: ArrayLike, tolerance: float = _SAME_ANGLE) -> SensorAgreement:
    """Check by invariants whether sensors, each in its own frame, have seen the same rotations.

    Parameters
    ----------
    rotations : array_like, shape (s, k, 3, 3)
        What each of s sensors, two or more, says of k rotations of one body, in its own frame.
        With three sensors or more one that is wrong can be told.
    tolerance : float, optional
        Largest difference of angles (rad) of sensors that agree: several times their noise.

    Returns
    -------
    SensorAgreement

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not rotations of this shape, or a tolerance that is not positive.

    See Also
    --------
    frame_between_sensors : how the sensors are mounted.
    same_in_two_frames : of any matrix.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.1.

    Examples
    --------
    >>> from robomech_ros.spatial import matrix_from_axis_angle, sensor_agreement
    >>> seen = [[matrix_from_axis_angle(e, a)] for e, a in (([1, 0, 0], 0.5), ([0, 1, 0], 0.5))]
    >>> sensor_agreement([*seen, [matrix_from_axis_angle([0, 0, 1], 0.6)]]).faulty
    (2,)
    """
    limit = real_number("tolerance", tolerance, "a positive number")
    if not limit > 0.0:
        raise BadValueError("tolerance", limit, "a positive number")
    vectors = rotation_vector_from_matrix(rotations)
    if vectors.ndim != 3 or vectors.shape[0] < _LEAST_SENSORS or not vectors.shape[1]:
        raise WrongSizeError("rotations", (*vectors.shape, 3), "(s, k, 3, 3) with s at least 2")
    angles = np.linalg.norm(vectors, axis=-1)
    consensus = np.median(angles, axis=0)
    errors = np.abs(angles - consensus).max(axis=1)
    faulty = tuple(int(one) for one in np.flatnonzero(errors > limit))
    return SensorAgreement(angles, consensus, errors, faulty)


def frame_between_sensors(first: ArrayLike, second: ArrayLike) -> Array:
    r"""Find how a sensor is mounted relative to another from rotations that both have seen.

    A rotation seen as A by the first and as B by the second sensor has
    :math:`\mathrm{vect}(A) = X \mathrm{vect}(B)`; the vectors used here are the Euler-Rodrigues
    parameters r, which do not vanish at half turns.  Of two rotations X is the book's; of more, and
    of noisy ones, it is that of least squares.

    Parameters
    ----------
    first, second : array_like, shape (k, 3, 3)
        k rotations, two or more, about axes that are not all parallel, in the frame of each sensor.

    Returns
    -------
    ndarray, shape (3, 3)
        ``R_first_second``.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not rotations of these shapes, or all axes parallel: X is then free to turn about them.

    See Also
    --------
    sensor_agreement : whether they have seen the same.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 2.7 and 2.7.1.
    """
    a, b = (quaternion_from_matrix(one) for one in (first, second))
    if a.ndim != 2 or a.shape != b.shape or len(a) < 2:
        raise WrongSizeError("rotations", (a.shape[:-1], b.shape[:-1]), "(k, 3, 3) each, k >= 2")
    # Half turns come with either sign of r; a further pair tells which one matches.
    signs = _matching_signs(a, b)
    r, s = a[:, :3], signs[:, None] * b[:, :3]
    values = np.linalg.svd(s, compute_uv=False)
    if not values[1] > _PARALLEL * values[0] or values[0] == 0.0:
        axis = s[int(np.argmax(np.linalg.norm(s, axis=1)))].tolist()
        raise BadValueError("axes of the rotations", axis, "at least two that are not parallel")
    normals = cross(r, np.roll(r, 1, axis=0)), cross(s, np.roll(s, 1, axis=0))
    return nearest_rotation(r.T @ s + normals[0].T @ normals[1])


def _matching_signs(a: Array, b: Array) -> Array:
    """Signs of the second quaternions with which their inner products match the first ones'."""
    signs = np.ones(len(a))
    free = np.minimum(a[:, 3], b[:, 3]) < 1e-6
    settled = np.flatnonzero(~free)
    start = settled if len(settled) else np.arange(1)
    used = [int(j) for j in start]
    for k in (int(i) for i in np.flatnonzero(free) if i not in start):
        inner_a = np.array([a[k, :3] @ a[j, :3] for j in used])
        inner_b = np.array([signs[j] * (b[k, :3] @ b[j, :3]) for j in used])
        signs[k] = -1.0 if inner_a @ inner_b < 0.0 else 1.0
        used.append(k)
    return signs
