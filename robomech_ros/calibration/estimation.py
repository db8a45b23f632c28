"""Hand-eye calibration from absolute poses: A_i X S_i = Z."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.calibration import refinement
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.calibration.conventions import check_units, misfit, refuse_convention
from robomech_ros.calibration.freedom import FAR, Freedom, freedom_of, reach_of
from robomech_ros.calibration.result import HandEyeNoise, HandEyeResult, sensor_covariance
from robomech_ros.calibration.samples import checked_samples, distinct_samples
from robomech_ros.calibration.start import (
    Start,
    agreeing,
    errors_at,
    inverted,
    packed,
    put_on_axis,
    started,
    variances_of,
)
from robomech_ros.errors import (
    BadValueError,
    ContradictionError,
    UndeterminedError,
    WrongSizeError,
)
from robomech_ros.spatial.arrays import as_choice, as_finite, as_flag
from robomech_ros.spatial.poses import as_pose, assembled, inverse_pose

Array = NDArray[np.float64]

MOUNTS = ("eye-in-hand", "eye-to-hand")

_refine = direct(refinement.refine)
_distances = direct(refinement.distances)

# Fewer leave too little to tell noises, or right samples from wrong ones.
_LEAST_FOR_SHARE, _LEAST_FOR_OUTLIERS, _LEAST_TO_CONTRADICT = 5, 5, 4
# Squared distance, of six normal numbers, that one sample in 400,000 exceeds.
_OUTLYING = 36.0
# The same before the noise is known, by medians.
_GROSS = 100.0
_ROUNDS = 10
_LEAST_VARIANCE = 1e-26
# What misses by less (rad, and the same part of the distances) is no outlier: rounding at the
# end, and of exact samples what the start leaves.
_EXACT, _ROUGH = 1e-8, 1e-6
# Poses that have nothing to do with each other are a radian apart.
_CHAOS = 0.3
_WEAK = 5.0
# So few samples may leave nothing of the positions to tell their noise by; it is then at least this
# part of what the rotations' makes of the distance to the target, as with most cameras.
_FEW, _USUAL = 7, 0.1
# Fits farther apart than this (rad) are different ones, and so much (twice the logarithm of the
# likelihood) the best must be more likely.
_APART, _CLEARLY = 0.5, 20.0
# The turn of the sensor about parallel axes is to be known so well (rad); what noise makes of it,
# in squares for each sample, is no motion.
_TURN, _CHANCE = 0.1, 12.0
# A convention is wrong where another one's misfit is less by the first over (n - 3), once both are
# refined: by chance it is not.  The other need not be refined where its start's is so much more.
_BETTER, _WORSE = 2.0, 6.0


@dataclass(eq=False)
class _Fit:
    """Samples (n, 12), unknowns (24), noise (3), samples in use (n,) and information (12, 12)."""

    A: Array
    S: Array
    side: int
    known: bool
    start: Start
    at: Array
    noise: Array
    use: Array
    information: Array
    freedom: Freedom

    def refine(self, at: Array, noise: Array, *, known: bool, shared: bool = False) -> None:
        """Refine unknowns and noise in place, with the information there."""
        held, into = self.freedom.held, self.information
        _refine(self.A, self.S, self.use, at, noise, held, self.side, known, shared, into)

    def distances(self, at: Array) -> Array:
        """Squared distances (n,) of the samples from unknowns, by their noise."""
        squares = np.empty(len(self.A))
        _distances(self.A, self.S, at, self.noise, self.side, squares)
        return squares


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
        Pure translations, or half turns that several sensors fit.
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
    side = MOUNTS.index(kind)
    rows = packed(robot), packed(sensor)
    first, back = distinct_samples(*rows)
    if side:
        rows = inverted(rows[0]), rows[1]
    A, S = rows[0][first], rows[1][first]
    voters = agreeing(A, S)
    fit = _started(A, S, voters, side, given)
    other = None
    if len(A) >= _LEAST_TO_CONTRADICT:
        other = _started(inverted(A), S, voters, side, given)
    _check_turns(fit, other, kind)
    both = (fit,) if other is None else (fit, other)
    check_units(S, voters, [(one.A, one.start) for one in both])
    _refined(fit, careful)
    _check_convention(fit, other, kind, careful)
    if careful and len(A) >= _LEAST_TO_CONTRADICT and fit.noise[0] > _CHAOS**2:
        raise ContradictionError(
            "rotation error of the samples",
            f"{float(np.sqrt(fit.noise[0])):.3g} rad",
            f"at most {_CHAOS} rad: the robot's and the sensor's poses contradict each other; "
            "are they of the same moments?",
        )
    _check_turns(fit, None, kind)
    _check_line(fit)
    _check_single(fit)
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


def _started(A: Array, S: Array, voters: Array, side: int, given: Array | None) -> _Fit:
    """Start without iteration."""
    start = started(A, S, voters, 0.0 if given is None else float(given[0]))
    noise = np.array([*start.variances, 0.0]) if given is None else given.copy()
    use, known = np.ones(len(A)), given is not None
    return _Fit(
        A, S, side, known, start, start.at.copy(), noise, use, np.zeros((12, 12)), start.freedom
    )


def _refined(fit: _Fit, robust: bool) -> None:
    """Refine, leaving out what contradicts the rest, until it is the same samples.

    The noise of the refined unknowns decides which directions are free.
    """
    _refined_as_free(fit, robust)
    errors = errors_at(fit.A, fit.S, fit.at)
    variance = float(fit.use @ errors[0]) / (3.0 * fit.use.sum() - 6.0)
    if not robust:
        variance = min(variance, variances_of(errors)[0])
    variance = max(variance, _LEAST_VARIANCE, float(fit.noise[0]) if fit.known else 0.0)
    before = fit.freedom.is_axis
    fit.freedom = freedom_of(fit.A, fit.S, fit.use, fit.at, variance)
    if fit.freedom.is_axis and not before:
        fit.at = fit.start.at.copy()
        put_on_axis(fit.A, fit.S, fit.use, fit.at, fit.freedom)
        if not fit.known:
            fit.noise[:2] = variances_of(errors_at(fit.A, fit.S, fit.at))
    if fit.freedom.is_axis or before:
        _refined_as_free(fit, robust)


def _refined_as_free(fit: _Fit, robust: bool) -> None:
    """Refine, leaving out what contradicts the rest, until it is the same samples."""
    wary = robust and len(fit.A) >= _LEAST_FOR_OUTLIERS
    if wary:
        for _ in range(_ROUNDS):
            errors = errors_at(fit.A, fit.S, fit.at)
            turn, shift = variances_of(errors)
            gross = errors[0] / turn + errors[1] / shift > _GROSS
            if not _left_out(fit, gross & ~_missed_by_less(_ROUGH, fit, errors)):
                break
            fit.refine(fit.at, fit.noise, known=fit.known)
    for _ in range(_ROUNDS):
        shared = not fit.known and bool(fit.use.sum() >= _LEAST_FOR_SHARE)
        fit.refine(fit.at, fit.noise, known=fit.known, shared=shared)
        wrong = fit.distances(fit.at) > _OUTLYING
        if not wary or not (wrong.any() or fit.use.min() < 1.0):
            break
        if not _left_out(fit, wrong & ~_missed_by_less(_EXACT, fit)):
            break
    _keep_position_noise(fit)


def _keep_position_noise(fit: _Fit) -> None:
    """Refine once more where few samples have let the noise of the positions vanish.

    Positions without noise would determine the rotations, too, and without any error.
    """
    if fit.known or fit.use.sum() > _FEW:
        return
    least = _USUAL**2 * reach_of(fit.S[fit.use > 0.0]) ** 2 * float(fit.noise[0])
    if fit.noise[1] < least:
        fit.noise[1] = least
        fit.refine(fit.at, fit.noise, known=True)


def _check_turns(fit: _Fit, other: _Fit | None, mount: str) -> None:
    """Refuse motions without turns, in another convention, too.

    Raises
    ------
    UndeterminedError
    """
    if any(len(one.freedom.directions) < 3 for one in (fit, other) if one is not None):
        return
    if fit.start.variances[0] > _CHAOS**2:
        return
    A = fit.A[fit.use > 0.0, :9]
    most = float(np.sqrt(((A - A.mean(axis=0)) ** 2).sum(axis=1).mean() / 2.0))
    parent = "base" if mount == "eye-to-hand" else "hand"
    raise UndeterminedError(
        "rotation of the robot's poses",
        f"{most:.3g} rad: pure translations",
        "turns about two axes that are not parallel; the sensor's position in the "
        f"{parent} frame is free in all directions",
        np.eye(3).tolist(),
    )


def _check_line(fit: _Fit) -> None:
    """Refuse turns about one line, which leave the sensor's turn about it free, too.

    Raises
    ------
    UndeterminedError
    """
    if not fit.freedom.is_axis:
        return
    off = fit.freedom.motion_off_line(fit.A, fit.S, fit.use, fit.at)
    by_chance = float(fit.noise[1]) * (_TURN**-2 + _CHANCE * float(fit.use.sum()))
    if off**2 > by_chance and off > _EXACT * reach_of(fit.S):
        return
    raise UndeterminedError(
        "axes of the robot's rotations",
        "all on one line",
        "turns about axes that are not parallel, or motions across that line; the sensor's "
        "turn about the line and its position along it are free",
        fit.freedom.directions.tolist(),
    )


def _check_convention(fit: _Fit, other: _Fit | None, mount: str, robust: bool) -> None:
    """Refuse samples that another convention fits better.

    Raises
    ------
    ContradictionError
    """
    if other is None:
        return
    reach = reach_of(fit.S)
    start, least = misfit(other.start.errors, reach), _misfit(fit, reach)
    if start > least + _WORSE:
        return
    _refined(other, robust)
    gain = least - min(start, _misfit(other, reach))
    if gain > _BETTER / (len(fit.A) - 3):
        refuse_convention(mount, gain)


def _misfit(fit: _Fit, reach: float) -> float:
    """Misfit of a fit or of its start, which wrong samples cannot spoil, whichever is less."""
    refined = misfit(errors_at(fit.A, fit.S, fit.at), reach)
    return min(refined, misfit(fit.start.errors, reach))


def _check_single(fit: _Fit) -> None:
    """Refuse half turns that other poses of the sensor fit as well.

    Raises
    ------
    UndeterminedError
    """
    if not fit.start.others or fit.freedom.is_axis:
        return
    best = float(fit.use @ fit.distances(fit.at))
    information = fit.information.copy()
    for at in fit.start.others:
        fit.refine(at, fit.noise.copy(), known=True)
        apart = float(at[:9] @ fit.at[:9])
        likely = float(fit.use @ fit.distances(at)) - best < _CLEARLY
        if apart < 1.0 + 2.0 * np.cos(_APART) and likely:
            raise UndeterminedError(
                "axes of the robot's rotations",
                "those of half turns at right angles to each other",
                "a turn by another angle or about another axis: several sensors fit equally well",
            )
    fit.information = information


def _missed_by_less(limit: float, fit: _Fit, errors: Array | None = None) -> NDArray[np.bool_]:
    """Say which samples miss by less than an angle and that part of the distances."""
    turns, shifts = errors_at(fit.A, fit.S, fit.at) if errors is None else errors
    reach = 1.0 + (reach_of(fit.A) ** 2 + reach_of(fit.S) ** 2) / 3.0
    return np.asarray((turns < limit**2) & (shifts < limit**2 * reach))


def _left_out(fit: _Fit, wrong: NDArray[np.bool_]) -> bool:
    """Leave out samples, if most remain; say whether they are other ones than before."""
    if 2 * wrong.sum() >= len(wrong):
        return False
    use = np.where(wrong, 0.0, 1.0)
    changed = not np.array_equal(use, fit.use)
    fit.use = use
    return changed


def _freedom(fit: _Fit) -> int:
    """Residuals left over for one variance, fewer where the robot's share takes some of them.

    It takes less of few samples, whose positions are not believed to be better than usual.
    """
    n = int(fit.use.sum())
    left = 3 * n - 9
    if fit.noise[2] > 0.0:
        left = (3 * left + 3) // 4 if n <= _FEW else left // 2
    return max(left, 1)


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
    errors = errors_at(*rows, fit.at)
    covariance = sensor_covariance(fit.information, X)
    if not fit.known:
        covariance *= _widening(_freedom(fit))
    free, kept = fit.freedom.directions, np.eye(3)
    if len(free):
        kept = np.linalg.eigh(np.outer(free, free))[1][:, :2]
    values, axes = np.linalg.eigh(kept.T @ covariance[3:, 3:] @ kept)
    weak = (kept @ axes).T[values > _WEAK**2 * values[0]][::-1]
    if len(free):
        still = np.eye(6)
        still[3:, 3:] = kept @ kept.T
        covariance = still @ covariance @ still
        covariance[3:, 3:] += np.outer(free, free) * (FAR * (reach_of(fit.A) or 1.0)) ** 2
    return HandEyeResult(
        sensor=X,
        target=Z,
        covariance=covariance,
        residuals=np.sqrt(errors.T),
        inlier=(fit.use > 0.0)[back],
        weak_directions=np.concatenate((free, weak)),
        free_directions=free,
        noise=HandEyeNoise(*(float(x) for x in (*np.sqrt(fit.noise[:2]), fit.noise[2]))),
        mount=mount,
        information=fit.information,
        robot_poses=robot,
    )
