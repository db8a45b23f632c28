"""Hand-eye calibration from absolute poses: A_i X S_i = Z."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from robomech_ros.calibration.conventions import (
    check_convention,
    check_units,
    rotations_exclude_inverse,
)
from robomech_ros.calibration.free_directions import FAR, rms_distance
from robomech_ros.calibration.identifiability import (
    UNRELATED,
    check_common_line,
    check_half_turns,
    check_rotations,
)
from robomech_ros.calibration.initial_guess import (
    MIN_VARIANCE,
    consistent_samples,
    invert_rows,
    pack_poses,
    squared_residuals,
)
from robomech_ros.calibration.maximum_likelihood import FEW, Fit
from robomech_ros.calibration.result import HandEyeNoise, HandEyeResult, sensor_covariance
from robomech_ros.errors import BadValueError, InconsistentDataError, WrongSizeError
from robomech_ros.spatial.arrays import as_choice, as_finite, as_flag
from robomech_ros.spatial.poses import as_pose, assembled, inverse_pose
from robomech_ros.typing import Array, ArrayLike

MOUNTS = ("eye-in-hand", "eye-to-hand")

_LEAST_SAMPLES = 3
# Positions farther away (m) are a mistake.
LARGEST_COORDINATE = 1e6
# Three samples fit both mounts equally well.
_MIN_TO_COMPARE = 4
_WEAK = 5.0


def hand_eye(
    robot_poses: ArrayLike,
    sensor_poses: ArrayLike,
    *,
    mount: str = "eye-in-hand",
    robust: bool = True,
    noise: ArrayLike | None = None,
) -> HandEyeResult:
    r"""Find the pose of a sensor from poses of the robot and of a target in the sensor's frame.

    With the sensor in the hand all samples have
    :math:`T_{base,hand} \, X \, T_{sensor,target} = Z`; with the sensor beside the robot and the
    target in the hand, the same with :math:`T_{hand,base}`.  A guess in closed form is refined to
    the maximum-likelihood estimate of both unknown poses.  The variances of the noise of sensor
    and robot are estimated from the residuals (restricted likelihood).

    Parameters
    ----------
    robot_poses : array_like, shape (n, 4, 4)
        ``T_base_hand`` of three samples or more.  Their order does not matter, and duplicates
        count once.
    sensor_poses : array_like, shape (n, 4, 4)
        ``T_sensor_target`` of the same samples.
    mount : str, optional
        ``"eye-in-hand"`` or ``"eye-to-hand"``.
    robust : bool, optional
        Reject outliers, from five samples on, and refuse samples that all contradict each other,
        from four on.
    noise : array_like, shape (4,), optional
        Known standard deviations of each coordinate: rotation (rad) and position (m) of the
        sensor, then of the robot.  By default they are estimated.

    Raises
    ------
    BadValueError, WrongSizeError
        Fewer than three that differ.
    UnderdeterminedError
        Pure translations, rotations about one line, or half turns that several poses of the sensor
        fit.
    InconsistentDataError
        The wrong mount, inverted poses, positions in two units (m and mm), or samples that
        contradict each other.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.

    Shah, Solving the robot-world/hand-eye calibration problem using the Kronecker product, J.
    Mechanisms Robotics 5 (2013) 031007: the initial guess.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.calibration import hand_eye
    >>> from robomech_ros.spatial import inverse_pose, pose_exponential
    >>> X, Z = pose_exponential([[0.1, 0.2, 0.3, 0.0, 0.1, 0.2], [0.0, 2.0, 0.5, 0.8, 0.0, 0.1]])
    >>> A = pose_exponential(np.random.default_rng(1).normal(size=(5, 6)))
    >>> found = hand_eye(A, inverse_pose(A @ X) @ Z)
    >>> np.allclose(found.sensor, X)
    True
    """
    kind = as_choice("mount", mount, MOUNTS)
    reject = as_flag("robust", robust)
    variances = _variances(noise)
    robot, sensor = _checked_samples(robot_poses, sensor_poses)
    side = MOUNTS.index(kind)
    rows = pack_poses(robot), pack_poses(sensor)
    first, back = _distinct_samples(*rows)
    if side:
        rows = invert_rows(rows[0]), rows[1]
    A, S = rows[0][first], rows[1][first]
    consistent = consistent_samples(A, S)
    fit, other = Fit.from_guess(A, S, consistent, side, variances), None
    comparable = len(A) >= _MIN_TO_COMPARE
    if comparable and not rotations_exclude_inverse(fit, consistent):
        other = Fit.from_guess(invert_rows(A), S, consistent, side, variances)
    if fit.guess.variances[0] <= UNRELATED**2:
        check_rotations(fit, other, kind)
    check_units(fit, other, consistent)
    fit.refine(reject)
    if other is not None:
        check_convention(fit, other, kind, reject)
    must_agree = (reject and comparable) or len(fit.free.directions) == 3
    if must_agree and fit.noise[0] > UNRELATED**2:
        raise InconsistentDataError(
            "rotation error of the samples (rad)",
            float(f"{np.sqrt(fit.noise[0]):.3g}"),
            f"at most {UNRELATED}: robot_poses and sensor_poses contradict each other; take both "
            "poses of a sample at the same moment",
        )
    check_rotations(fit, None, kind)
    check_common_line(fit)
    check_half_turns(fit)
    return _result(fit, robot, rows, back, kind)


def robot_world(
    A: ArrayLike, B: ArrayLike, *, robust: bool = True, noise: ArrayLike | None = None
) -> HandEyeResult:
    r"""Solve A X = Z B for both poses X and Z: hand-eye and robot-world calibration in one.

    Parameters
    ----------
    A : array_like, shape (n, 4, 4)
        ``T_base_hand`` of three samples or more.
    B : array_like, shape (n, 4, 4)
        ``T_world_sensor`` of the same samples: the sensor in the frame of its target.
    robust, noise
        As for :func:`hand_eye`.

    Returns
    -------
    HandEyeResult
        ``sensor`` is X, ``T_hand_sensor``; ``target`` is Z, ``T_base_world``.
    """
    return hand_eye(A, inverse_pose(as_pose(B, what="B")), robust=robust, noise=noise)


def _variances(noise: ArrayLike | None) -> Array | None:
    """Return variances of rotation and position, and the robot's share, of standard deviations."""
    if noise is None:
        return None
    four = as_finite("noise", noise, (4,))
    if four.ndim != 1:
        raise WrongSizeError("noise", four.shape, "(4,)")
    with np.errstate(over="ignore", under="ignore"):
        squares = four * four
    turn, shift = float(squares[0] + squares[2]), float(squares[1] + squares[3])
    if (four < 0.0).any() or not min(turn, shift) > MIN_VARIANCE or max(turn, shift) > 1e6:
        raise BadValueError(
            "noise", four.tolist(), "deviations of rotation and position, from 1e-12 to 1000"
        )
    return np.array([turn, shift, squares[2] / turn])


def _degrees_of_freedom(fit: Fit) -> int:
    """Return the redundant residuals for one variance, fewer if the robot's share is estimated.

    The share uses fewer of them for few samples, whose position noise has a lower bound.
    """
    n = int(fit.use.sum())
    redundant = 3 * n - 9
    if fit.noise[2] > 0.0:
        redundant = (3 * redundant + 3) // 4 if n <= FEW else redundant // 2
    return max(redundant, 1)


@lru_cache(maxsize=256)
def _widening(degrees: int) -> float:
    """Return the quantile of 95 % of six numbers for estimated variance over that for known one."""
    from scipy.special import chdtri, fdtri  # 10 MB that only calibrations load

    return float(6.0 * fdtri(6.0, float(degrees), 0.95) / chdtri(6.0, 0.05))


def _result(
    fit: Fit, robot: Array, rows: tuple[Array, Array], back: NDArray[np.intp], mount: str
) -> HandEyeResult:
    """Return the result in the frame of the sensor's parent, for the samples in their order."""
    X, Z = (
        assembled(part[:9].reshape(3, 3), part[9:].copy()) for part in (fit.at[:12], fit.at[12:])
    )
    residuals = np.sqrt(squared_residuals(*rows, fit.at).T)
    covariance = sensor_covariance(fit.information, X)
    if not fit.known:
        covariance *= _widening(_degrees_of_freedom(fit))
    free, kept = fit.free.directions, np.eye(3)
    if len(free):
        kept = np.linalg.eigh(np.outer(free, free))[1][:, :2]
    values, axes = np.linalg.eigh(kept.T @ covariance[3:, 3:] @ kept)
    weak = (kept @ axes).T[values > _WEAK**2 * values[0]][::-1]
    if len(free):
        still = np.eye(6)
        still[3:, 3:] = kept @ kept.T
        covariance = still @ covariance @ still
        covariance[3:, 3:] += np.outer(free, free) * (FAR * (rms_distance(fit.A) or 1.0)) ** 2
    return HandEyeResult(
        sensor=X,
        target=Z,
        covariance=covariance,
        residuals=residuals,
        inlier=(fit.use > 0.0)[back],
        weak_directions=np.concatenate((free, weak)),
        free_directions=free,
        noise=HandEyeNoise(*(float(x) for x in (*np.sqrt(fit.noise[:2]), fit.noise[2]))),
        mount=mount,
        information=fit.information,
        robot_poses=robot,
    )


def _checked_samples(robot_poses: ArrayLike, sensor_poses: ArrayLike) -> tuple[Array, Array]:
    """Check both lists of poses; gives them as arrays, shape (n, 4, 4)."""
    robot = as_pose(robot_poses, what="robot_poses")
    sensor = as_pose(sensor_poses, what="sensor_poses")
    if robot.ndim != 3 or robot.shape != sensor.shape:
        shapes = robot.shape, sensor.shape
        expected = "(n, 4, 4) both, one of each for each sample"
        raise WrongSizeError("robot_poses and sensor_poses", shapes, expected)
    for what, poses in (("robot_poses", robot), ("sensor_poses", sensor)):
        most = float(np.abs(poses[:, :3, 3]).max(initial=0.0))
        if most > LARGEST_COORDINATE:
            expected = f"at most {LARGEST_COORDINATE:g} m"
            raise BadValueError(f"largest coordinate of {what}", most, expected)
    return robot, sensor


def _distinct_samples(robot: Array, sensor: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers of samples (n, 12) that differ, in an order of their own, and of each among them."""
    rows = np.concatenate((robot, sensor), axis=1) + 0.0
    keys = [row.tobytes() for row in rows]
    places = {key: k for k, key in enumerate(sorted(set(keys)))}
    first = np.zeros(len(places), np.intp)
    back = np.array([places[key] for key in keys], np.intp)
    first[back] = np.arange(len(keys))
    if len(first) < _LEAST_SAMPLES:
        raise WrongSizeError(
            "samples that differ from each other", len(first), "3 or more; five or more are better"
        )
    return first, back
