"""Redundant sensing: several sensors that see one motion, and which of them is wrong."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.spatial.poses import as_pose
from robomech_ros.spatial.rotations.quaternions import quaternion_from_matrix
from robomech_ros.typing import Array, ArrayLike

_LEAST_SENSORS = 2
# Cosine of half an angle, near half turns, below which noise turns an axis round.
_HALF_TURN = 0.05
# So many deviations are no noise, as the median of the differences tells it (of a normal
# distribution 0.6745 deviations): long motions have a few times the noise of short ones.
# Differences (rad, m) below the last are rounding.
_FAR, _MEDIAN, _ROUNDING = 10.0, 0.6745, 1e-8


@dataclass(frozen=True, eq=False)
class MotionAgreement:
    """Agreement of sensors on k motions, by quantities independent of their poses.

    Attributes
    ----------
    angles : ndarray, shape (s, k)
        Angles of the motions by each of s sensors (rad).
    slides : ndarray, shape (s, k)
        Displacements along the axis of the screw, times the sine of half the angle (m): small turns
        leave all digits of this product.  Near half turns without their sign.
    angle_errors, slide_errors : ndarray, shape (s, k)
        Differences from the medians over all sensors (rad, m).
    tolerance : tuple of float
        Largest difference of angles (rad) and of slides (m) of sensors that agree: as given, or as
        most differences scatter.
    outliers : tuple of (int, int)
        Sensor and motion of each difference beyond them.
    faulty : tuple of int
        Sensors with such differences.  Of two sensors that differ both are named.
    """

    angles: Array
    slides: Array
    angle_errors: Array
    slide_errors: Array
    tolerance: tuple[float, float]
    outliers: tuple[tuple[int, int], ...]
    faulty: tuple[int, ...]


def motion_agreement(motions: ArrayLike, tolerance: ArrayLike | None = None) -> MotionAgreement:
    r"""Check by invariants whether sensors on one body have seen the same motions.

    A motion A of the hand is for a sensor mounted at X the motion :math:`B = X^{-1} A X`.  Angle
    and displacement along the axis of its screw are the same for all X, so they need no
    calibration.

    Parameters
    ----------
    motions : array_like, shape (s, k, 4, 4)
        What each of s sensors, two or more, says of k motions, in its own frame before the motion.
        The robot may be one of them.  From three sensors on the one that is wrong can be told.
    tolerance : array_like, shape (2,), optional
        Largest difference of angles (rad) and of slides (m) of sensors that agree: several times
        their noise.  Default ten deviations of most differences, for which five motions or more
        are good.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.1.

    H. H. Chen, A screw motion approach to uniqueness analysis of head-eye geometry, CVPR 1991.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.calibration import motion_agreement
    >>> from robomech_ros.spatial import inverse_pose, pose_exponential
    >>> rng = np.random.default_rng(1)
    >>> A, mounts = pose_exponential(rng.normal(size=(6, 6))), pose_exponential(np.eye(3, 6))
    >>> seen = inverse_pose(mounts)[:, None] @ A @ mounts[:, None]
    >>> seen[2, 4, 0, 3] += 0.1
    >>> motion_agreement(seen).faulty
    (2,)
    """
    T = as_pose(motions, what="motions")
    if T.ndim != 4 or len(T) < _LEAST_SENSORS or not T.shape[1]:
        raise WrongSizeError("motions", T.shape, "(s, k, 4, 4) with s at least 2, k at least 1")
    q = quaternion_from_matrix(T[..., :3, :3])
    angles = 2.0 * np.arctan2(np.linalg.norm(q[..., :3], axis=-1), q[..., 3])
    with np.errstate(over="ignore", invalid="ignore"):
        slides = np.sum(q[..., :3] * T[..., :3, 3], axis=-1)
    if not np.isfinite(slides).all():
        most = float(np.abs(T[..., :3, 3]).max())
        raise BadValueError("largest coordinate of motions", most, "numbers that do not overflow")
    slides = np.where(np.median(q[..., 3], axis=0) < _HALF_TURN, np.abs(slides), slides)
    errors = [np.abs(one - np.median(one, axis=0)) for one in (angles, slides)]
    limits = _limits(tolerance, errors, float(np.abs(T[..., :3, 3]).max()))
    wrong = (errors[0] > limits[0]) | (errors[1] > limits[1])
    return MotionAgreement(
        angles,
        slides,
        errors[0],
        errors[1],
        limits,
        tuple((int(i), int(j)) for i, j in np.argwhere(wrong)),
        tuple(int(i) for i in np.flatnonzero(wrong.any(axis=1))),
    )


def _limits(given: ArrayLike | None, errors: list[Array], reach: float) -> tuple[float, float]:
    """Largest differences of angles (rad) and of slides (m) that are noise."""
    if given is not None:
        two = as_finite("tolerance", given, (2,))
        if two.ndim != 1:
            raise WrongSizeError("tolerance", two.shape, "(2,)")
        if (two <= 0.0).any():
            raise BadValueError("tolerance", two.tolist(), "two positive numbers")
        return float(two[0]), float(two[1])
    # With an odd number of sensors one is the median itself, without a difference.
    count = len(errors[0])
    own = [np.sort(one, axis=0)[1 if count % 2 and count > 1 else 0 :] for one in errors]
    noise = [_FAR * float(np.median(one)) / _MEDIAN for one in own]
    return max(noise[0], _ROUNDING), max(noise[1], _ROUNDING * (1.0 + reach))
