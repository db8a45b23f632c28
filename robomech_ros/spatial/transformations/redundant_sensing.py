"""Redundant sensing: several sensors that see one motion, or one matrix, each in its own frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import InconsistentDataError, UnderdeterminedError, WrongSizeError
from robomech_ros.spatial.arrays import positive_number, readable_axis
from robomech_ros.spatial.cross_product import cross
from robomech_ros.spatial.matrices import as_rotation, nearest_rotation
from robomech_ros.spatial.rotations.axis_angle import rotation_vector_from_matrix
from robomech_ros.spatial.rotations.quaternions import quaternion_from_matrix
from robomech_ros.spatial.transformations.matching import rotations_between, top_vectors
from robomech_ros.typing import Array, ArrayLike

# Difference of angles (rad) of one motion seen by sensors without noise.
_SAME_ANGLE = 1e-6
_LEAST_SENSORS = 2
# Ratio of singular values of axes below which they are all parallel.
_PARALLEL = 1e-9
# Difference of angles (rad) beyond which both have not seen the same.
_CHAOS = 0.3
# Sines of half turns below which there is no rotation but rounding.
_NO_TURN = 1e-12
# Frames nearer to each other than this (rad) are one; sums of squares below this are rounding.
_APART, _ROUNDING = 0.5, 1e-24
# Logarithm of how much more likely the best frame must be than any other.
_CLEARLY = 10.0


@dataclass(frozen=True, eq=False)
class SensorAgreement:
    """Agreement of sensors on their measured motions.

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
    limit = positive_number("tolerance", tolerance)
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
    InconsistentDataError, UnderdeterminedError
        Other angles for both sensors, or rotations that no X matches, such as inverted ones; no
        rotations, all about parallel axes, about which X is then free to turn, or half turns about
        axes at right angles, which four X match.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 2.7 and 2.7.1.
    """
    A, B = (as_rotation(one, what=what) for one, what in ((first, "first"), (second, "second")))
    if A.ndim != 3 or A.shape != B.shape or len(A) < 2:
        raise WrongSizeError("rotations", (A.shape[:-2], B.shape[:-2]), "(k, 3, 3) each, k >= 2")
    frames, misfits = frames_between(A, B)
    return frames[single_match(frames, misfits, 3 * len(A) - 3)]


def frames_between(first: Array, second: Array) -> tuple[Array, Array]:
    """Find the frames (c, 3, 3) that match checked rotations (k, 3, 3) best, by invariants.

    There is one, or several after half turns.  Returns also sums of squared differences (rad^2),
    (c,).
    """
    a, b = (quaternion_from_matrix(one) for one in (first, second))
    r, s = a[:, :3], b[:, :3]
    angles = [2.0 * np.arctan2(np.linalg.norm(one[:, :3], axis=1), one[:, 3]) for one in (a, b)]
    _check_axes(r, s, angles[0] - angles[1])
    pairs = np.einsum("kab,kcd->acbd", first, second).reshape(9, 9)
    values, vectors = np.linalg.eigh(0.5 * (pairs + pairs.T))
    frames = []
    for X in rotations_between(top_vectors(values[::-1], vectors[:, ::-1].T)):
        # Half turns come with either sign of r; X tells which one matches.
        signs = np.where(np.sum(r * (s @ X.T), axis=1) < 0.0, -1.0, 1.0)
        matched = signs[:, None] * s
        normals = cross(r, np.roll(r, 1, axis=0)), cross(matched, np.roll(matched, 1, axis=0))
        frames.append(nearest_rotation(r.T @ matched + normals[0].T @ normals[1]))
    found = np.stack(frames)
    differences = first @ found[:, None] - found[:, None] @ second
    misfits = 0.5 * (differences**2).sum(axis=(1, 2, 3))
    off = float(np.sqrt(misfits.min() / len(first)))
    if off > _CHAOS:
        raise InconsistentDataError(
            "difference of the rotations of both sensors",
            f"{off:.3g} rad (root mean square) in the frame that fits best",
            f"at most {_CHAOS} rad: rotations in the same order, none of them inverted",
        )
    return found, misfits


def _check_axes(r: Array, s: Array, differences: Array) -> None:
    """Refuse rotations about parallel axes, as far as the angles of both sensors can tell.

    r and s (k, 3) are Euler-Rodrigues parameters; the differences (k,) of the angles are noise.
    """
    most = float(np.median(np.abs(differences)))
    if most > _CHAOS:
        raise InconsistentDataError(
            "difference of the angles of both sensors",
            f"{most:.3g} rad (median)",
            f"at most {_CHAOS} rad: all sensors see a rotation turn by the same angle",
        )
    noise = 0.5 * float(np.linalg.norm(differences))
    sizes = np.min([np.linalg.svd(one, compute_uv=False) for one in (r, s)], axis=0)
    if sizes[0] <= max(_NO_TURN, noise):
        raise UnderdeterminedError(
            "rotation of the motions",
            f"{2.0 * float(np.arcsin(min(sizes[0], 1.0))):.3g} rad: pure translations",
            "turns about two axes that are not parallel: all directions are free",
            np.eye(3).tolist(),
        )
    if sizes[1] <= max(_PARALLEL * sizes[0], noise):
        axis = readable_axis(np.linalg.eigh(r.T @ r)[1][:, 2])
        raise UnderdeterminedError(
            "axes of the rotations",
            f"all parallel to {axis}",
            f"at least two that are not parallel: along {axis} of the first frame it is free",
            [axis],
        )


def single_match(frames: Array, misfits: Array, freedom: int) -> int:
    """Return the number of the frame that clearly fits best, with `freedom` spare equations."""
    best = int(np.argmin(misfits))
    between = np.trace(frames @ frames[best].T, axis1=1, axis2=2)
    others = misfits[between < 1.0 + 2.0 * np.cos(_APART)]
    if len(others):
        better = np.log((others.min() + _ROUNDING) / (misfits[best] + _ROUNDING))
        if 0.5 * freedom * better < _CLEARLY:
            raise UnderdeterminedError(
                "axes of the rotations",
                "those of half turns at right angles to each other",
                "a turn by another angle or about another axis: several frames match equally well",
            )
    return best
