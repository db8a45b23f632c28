"""Hand-eye calibration from absolute poses: A_i X S_i = Z."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.calibration import refinement
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.calibration.motions import Spread, check_convention, check_units
from robomech_ros.calibration.result import HandEyeNoise, HandEyeResult, sensor_covariance
from robomech_ros.calibration.samples import checked_samples, distinct_samples
from robomech_ros.calibration.start import agreeing, errors_at, packed, starts
from robomech_ros.errors import (
    BadValueError,
    ContradictionError,
    UndeterminedError,
    WrongSizeError,
)
from robomech_ros.spatial.arrays import as_choice, as_finite, as_flag
from robomech_ros.spatial.poses import as_pose, assembled, inverse_pose

__all__ = ["MOUNTS", "hand_eye", "robot_world"]

Array = NDArray[np.float64]

MOUNTS = ("eye-in-hand", "eye-to-hand")

_refine = direct(refinement.refine)
_distances = direct(refinement.distances)

# Fewer leave too little to tell noises, or right samples from wrong ones.
_LEAST_FOR_SHARE, _LEAST_FOR_OUTLIERS, _LEAST_TO_CONTRADICT = 8, 5, 4
# Squared distance, of six normal numbers, that one sample in 400,000 exceeds; and the median of
# three.
_OUTLYING, _MEDIAN = 36.0, 2.366
# The same before the noise is known, by medians.
_GROSS = 100.0
_ROUNDS = 10
_LEAST_VARIANCE = 1e-26
# What misses by less (rad, and the same part of the distances) is no outlier: rounding at the
# end, and of exact samples what the start leaves.
_EXACT, _ROUGH = 1e-8, 1e-6
# What is off by so much (rad, and the same part of the distances) is not noise of a sensor.
_SUSPICIOUS = 0.02
# Nor is what is so many times farther away than the hand gets.
_FAR = 20.0
# Poses that have nothing to do with each other are a radian apart.
_CHAOS = 0.3
_WEAK = 5.0
# So few samples may leave nothing of the positions to tell their noise by; it is then at least this
# part of what the rotations' makes of the distance to the target, as with most cameras.
_FEW, _USUAL = 4, 0.1
# Fits farther apart than this (rad) are different ones, and so much (twice the logarithm of the
# likelihood) the best must be more likely.
_APART, _CLEARLY = 0.5, 20.0


@dataclass(eq=False)
class _Fit:
    """Unknowns (24), noise (3), samples in use (n,) and information (12, 12), as they improve."""

    known: bool
    at: Array
    noise: Array
    use: Array
    information: Array


def hand_eye(
    robot_poses: ArrayLike,
    sensor_poses: ArrayLike,
    *,
    mount: str = "eye-in-hand",
    robust: bool = True,
    noise: ArrayLike | None = None,
) -> HandEyeResult:
    r"""Find where a sensor is from poses of the robot and what the sensor saw at each.

    With the sensor in the hand all samples have
    :math:`T_{base,hand} \, X \, T_{sensor,target} = Z`; with the sensor beside the robot and the
    target in the hand, the same with :math:`T_{hand,base}`.  A start in closed form is refined to
    the maximum-likelihood estimate of both unknown poses, with noise of the sensor and of the
    robot, the variances of which are estimated from the residuals (restricted likelihood).

    Parameters
    ----------
    robot_poses : array_like, shape (n, 4, 4)
        ``T_base_hand`` of three samples or more.  Their order does not matter, and one that
        is given twice counts once.
    sensor_poses : array_like, shape (n, 4, 4)
        ``T_sensor_target`` of the same samples.
    mount : str, optional
        ``"eye-in-hand"`` or ``"eye-to-hand"``.
    robust : bool, optional
        Leave out samples that contradict the others, from five samples on, and refuse samples that
        all contradict each other, from four on.
    noise : array_like, shape (4,), optional
        Standard deviations of each coordinate, where they are known: rotation (rad) and position
        (m) of the sensor, then of the robot.

    Returns
    -------
    HandEyeResult

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Not poses, or fewer than three that differ.
    UndeterminedError
        Pure translations or parallel axes (the message and ``free`` give the direction), or half
        turns that several sensors fit.
    ContradictionError
        An exchanged mount or inverted poses, positions in two units (m and mm), or samples that
        contradict each other.

    See Also
    --------
    relative_hand_eye : the direct method, from relative motions.
    next_best_pose : where to take the next sample.
    robot_world : of A X = Z B.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.

    Shah, Solving the robot-world/hand-eye calibration problem using the Kronecker product, J.
    Mechanisms Robotics 5 (2013) 031007: the start.

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
    careful = as_flag("robust", robust)
    given = _variances(noise)
    robot, sensor = checked_samples(robot_poses, sensor_poses)
    first, back = distinct_samples(robot, sensor)
    moving = inverse_pose(robot) if kind == "eye-to-hand" else robot
    parent = "base" if kind == "eye-to-hand" else "hand"
    A, S = packed(moving[first]), packed(sensor[first])
    spread = Spread(moving[first], sensor[first])
    spread.check(parent)
    fit, others, squares = _started(A, S, given)
    if _suspicious(squares, S) or _far(fit.at, A):
        check_units(A, S, squares[1])
    if _suspicious(squares, S):
        check_convention(moving[first], sensor[first], kind, squares)
    _refined(fit, A, S, kind, careful)
    used = fit.use > 0.0
    if not used.all():
        spread = Spread(moving[first][used], sensor[first][used])
    spread.check(parent, _parts(fit.noise))
    _check_single(fit, others, A, S, kind)
    return _result(fit, robot, (packed(moving), packed(sensor)), back, kind)


def _parts(noise: Array) -> tuple[float, float]:
    """Variances of the robot's and of the sensor's rotations."""
    return float(noise[2] * noise[0]), float((1.0 - noise[2]) * noise[0])


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

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`hand_eye`.
    """
    return hand_eye(A, inverse_pose(as_pose(B, what="B")), robust=robust, noise=noise)


def _variances(noise: ArrayLike | None) -> Array | None:
    """Variances of rotation and position, and the robot's share, of standard deviations.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
    """
    if noise is None:
        return None
    four = as_finite("noise", noise, (4,))
    if four.ndim != 1:
        raise WrongSizeError("noise", four.shape, "(4,)")
    with np.errstate(over="ignore", under="ignore"):
        squares = four * four
    turn, shift = float(squares[0] + squares[2]), float(squares[1] + squares[3])
    if (four < 0.0).any() or not min(turn, shift) > _LEAST_VARIANCE or max(turn, shift) > 1e6:
        raise BadValueError(
            "noise", four.tolist(), "deviations of rotation and position, from 1e-12 to 1000"
        )
    return np.array([turn, shift, squares[2] / turn])


def _started(
    A: Array, S: Array, given: Array | None
) -> tuple[_Fit, list[Array], tuple[float, float]]:
    """Start without iteration; also give other places to, and the median squared errors there."""
    at, *others = starts(A, S, agreeing(A, S))
    turns, shifts = errors_at(A, S, at)
    squares = float(np.median(turns)), float(np.median(shifts))
    fit = _Fit(
        given is not None, at, _noise(squares, len(A), given), np.ones(len(A)), np.zeros((12, 12))
    )
    return fit, others, squares


def _noise(squares: tuple[float, float], n: int, given: Array | None = None) -> Array:
    """Variances of which the median squared errors of n samples speak."""
    if given is not None:
        return given.copy()
    freed = 1.0 / max(1.0 - 2.0 / n, 0.25)
    turn, shift = (max(one * freed / _MEDIAN, _LEAST_VARIANCE) for one in squares)
    return np.array([turn, shift, 0.0])


def _suspicious(squares: tuple[float, float], S: Array) -> bool:
    """Whether errors are larger than those of any sensor."""
    reach = float(np.mean(S[:, 9:] ** 2)) * 3.0
    return squares[0] > _SUSPICIOUS**2 or squares[1] > _SUSPICIOUS**2 * reach


def _far(at: Array, A: Array) -> bool:
    """Whether sensor or target are farther away than they can be, for the reach of the hand."""
    reach = float(np.sqrt(3.0 * np.mean(A[:, 9:] ** 2)))
    return float(np.abs(at[[9, 10, 11, 21, 22, 23]]).max()) > _FAR * reach


def _refined(fit: _Fit, A: Array, S: Array, mount: str, robust: bool) -> None:
    """Refine, leaving out what contradicts the rest, until it is the same samples.

    Raises
    ------
    ContradictionError
    """
    side = MOUNTS.index(mount)
    wary = robust and len(A) >= _LEAST_FOR_OUTLIERS
    if wary:
        for _ in range(_ROUNDS):
            turns, shifts = errors_at(A, S, fit.at)
            scale = _noise((float(np.median(turns)), float(np.median(shifts))), len(A))
            gross = turns / scale[0] + shifts / scale[1] > _GROSS
            if not _left_out(fit, gross & ~_missed_by_less(_ROUGH, A, S, fit.at)):
                break
            _refine(A, S, fit.use, fit.at, fit.noise, side, fit.known, False, fit.information)
    for _ in range(_ROUNDS):
        shared = not fit.known and bool(fit.use.sum() >= _LEAST_FOR_SHARE)
        _refine(A, S, fit.use, fit.at, fit.noise, side, fit.known, shared, fit.information)
        squares = np.empty(len(A))
        _distances(A, S, fit.at, fit.noise, side, squares)
        if not wary or not _left_out(
            fit, (squares > _OUTLYING) & ~_missed_by_less(_EXACT, A, S, fit.at)
        ):
            break
    _keep_position_noise(fit, A, S, side)
    if robust and len(A) >= _LEAST_TO_CONTRADICT and fit.noise[0] > _CHAOS**2:
        raise ContradictionError(
            "rotation error of the samples",
            f"{float(np.sqrt(fit.noise[0])):.3g} rad",
            f"at most {_CHAOS} rad: the robot's and the sensor's poses contradict each other; "
            "are they of the same moments?",
        )


def _keep_position_noise(fit: _Fit, A: Array, S: Array, side: int) -> None:
    """Refine once more where few samples have let the noise of the positions vanish.

    Positions without noise would determine the rotations, too, and without any error.
    """
    if fit.known or fit.use.sum() > _FEW:
        return
    reach = 3.0 * float(np.mean(S[fit.use > 0.0, 9:] ** 2))
    least = _USUAL**2 * reach * float(fit.noise[0])
    if fit.noise[1] < least:
        fit.noise[1] = least
        _refine(A, S, fit.use, fit.at, fit.noise, side, True, False, fit.information)


def _check_single(fit: _Fit, others: list[Array], A: Array, S: Array, mount: str) -> None:
    """Refuse half turns that other poses of the sensor fit as well.

    Raises
    ------
    UndeterminedError
    """
    side = MOUNTS.index(mount)
    squares, unused = np.empty(len(A)), np.empty((12, 12))
    _distances(A, S, fit.at, fit.noise, side, squares)
    best = float(fit.use @ squares)
    for at in others:
        _refine(A, S, fit.use, at, fit.noise.copy(), side, True, False, unused)
        apart = float(at[:9] @ fit.at[:9])
        _distances(A, S, at, fit.noise, side, squares)
        if apart < 1.0 + 2.0 * np.cos(_APART) and float(fit.use @ squares) - best < _CLEARLY:
            raise UndeterminedError(
                "axes of the robot's rotations",
                "those of half turns at right angles to each other",
                "a turn by another angle or about another axis: several sensors fit equally well",
            )


def _missed_by_less(limit: float, A: Array, S: Array, at: Array) -> NDArray[np.bool_]:
    """Say which samples miss by less than an angle and that part of the distances."""
    turns, shifts = errors_at(A, S, at)
    reach = 1.0 + float(np.mean(A[:, 9:] ** 2 + S[:, 9:] ** 2))
    return np.asarray((turns < limit**2) & (shifts < limit**2 * reach))


def _left_out(fit: _Fit, wrong: NDArray[np.bool_]) -> bool:
    """Leave out samples; say whether they are other ones than before."""
    use = np.where(wrong, 0.0, 1.0)
    changed = not np.array_equal(use, fit.use)
    fit.use = use
    return changed


def _freedom(fit: _Fit) -> int:
    """Residuals that are left over for one variance, fewer where the robot's share is another."""
    left = 3 * int(fit.use.sum()) - 9
    return max(left // 2 if fit.noise[2] > 0.0 else left, 1)


@lru_cache(maxsize=256)
def _widening(freedom: int) -> float:
    """Quantile of 95 % of six numbers of estimated variance, over that of known variance."""
    from scipy.special import chdtri, fdtri  # 10 MB that only who calibrates shall load

    return float(6.0 * fdtri(6.0, float(freedom), 0.95) / chdtri(6.0, 0.05))


def _result(
    fit: _Fit, robot: Array, rows: tuple[Array, Array], back: NDArray[np.intp], mount: str
) -> HandEyeResult:
    """Say it in the frame of the sensor's parent, for the samples as they were given."""
    X, Z = (
        assembled(part[:9].reshape(3, 3), part[9:].copy()) for part in (fit.at[:12], fit.at[12:])
    )
    turns, shifts = errors_at(*rows, fit.at)
    covariance = sensor_covariance(fit.information, X)
    if not fit.known:
        covariance *= _widening(_freedom(fit))
    values, axes = np.linalg.eigh(covariance[3:, 3:])
    weak = values > _WEAK**2 * values[0]
    return HandEyeResult(
        sensor=X,
        target=Z,
        covariance=covariance,
        residuals=np.sqrt(np.stack((turns, shifts), axis=1)),
        inlier=(fit.use > 0.0)[back],
        weak_directions=axes.T[weak][::-1].copy(),
        noise=HandEyeNoise(*(float(x) for x in (*np.sqrt(fit.noise[:2]), fit.noise[2]))),
        mount=mount,
        information=fit.information,
        robot_poses=robot,
    )
