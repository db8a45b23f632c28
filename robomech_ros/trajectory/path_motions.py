"""Motions whose tool follows a pose path, within the limits of every joint."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros._kernels import tolerances
from robomech_ros.errors import BadValueError, DurationTooShortError
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory.interpolation import interpolant
from robomech_ros.trajectory.laws import CYCLOIDAL, POLY345, POLY4567, Law
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.motion_to_rest import MotionToRest, check_positions
from robomech_ros.trajectory.paths.curve import as_positive
from robomech_ros.trajectory.paths.joint_path import JointPath
from robomech_ros.trajectory.paths.path_tracking import PathTracking, track_path
from robomech_ros.trajectory.paths.pose_path import PosePath
from robomech_ros.trajectory.paths.posture import Arm
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray
from robomech_ros.trajectory.time_scaling import checked_duration, fitted, stretch_needed

__all__ = ["PATH_PROFILES", "PathMotion", "TipSpeeds", "along_joint_path", "along_path"]

# Instants of a section to begin with, and at most; between them the joints follow quintics.
_FEWEST, _MOST = 32, 4096
# How far these may be off the path, rad or m, where more instants could help.
_ON_PATH = 1e-7
# A step of the second derivative along a path, in parts of the largest, that is no rounding.
_SMOOTH = 1e-6


@dataclass(frozen=True)
class TipSpeeds:
    """Largest speeds of the tool.

    Attributes
    ----------
    linear : float
        Of its origin, m/s; infinite for none.
    angular : float
        Of its rotation, rad/s; infinite for none.
    """

    linear: float = np.inf
    angular: float = np.inf


@dataclass(frozen=True, eq=False)
class PathMotion(MotionToRest):
    """A motion along a path, from rest to rest, at rest at every corner.

    Attributes
    ----------
    tracking : PathTracking
        How far the path is followed, why not farther, and the joint path.
    """

    tracking: PathTracking


def along_path(
    path: PosePath,
    ik: Arm,
    *,
    limits: JointLimits | Any,
    start: npt.ArrayLike,
    profile: str = "poly345",
    duration: float | None = None,
    speeds: TipSpeeds | None = None,
    condition_limit: float = 1e6,
) -> PathMotion | PathTracking:
    """Follow a pose path from rest to rest, as fast as the limits allow.

    The joint path comes from the path's differential geometry (:func:`track_path`).  From corner
    to corner the path coordinate follows the profile's law.

    Parameters
    ----------
    path : PosePath
    ik : Arm
        Forward and inverse kinematics and Jacobian of an arm of n joints.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes; velocity and acceleration
        limits of every joint, and those jerk limits that are there.
    start : array_like, shape (n,)
        Joint values (rad or m) that choose the branch.
    profile : str
        One of `PATH_PROFILES`.
    duration : float, optional
        Wanted duration in s; None for the shortest.
    speeds : TipSpeeds, optional
        Largest speeds of the tool.
    condition_limit : float
        Condition number of the Jacobian at which the path ends.

    Returns
    -------
    PathMotion or PathTracking
        The motion as far as the path can be followed; the latter where it cannot even begin.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        If the path, the arm, the start, or an option is none.
    MissingLimitsError
        If a joint lacks a velocity or acceleration limit.
    LimitExceededError
        If the path leaves the position limits.
    DurationTooShortError
        If the limits do not allow the wanted duration.

    References
    ----------
    Angeles, 4th ed., ch. 11.
    """
    tracking = track_path(path, ik, start, condition_limit=condition_limit)
    if tracking.path is None:
        return tracking
    return along_joint_path(
        path, tracking, limits=limits, profile=profile, duration=duration, speeds=speeds
    )


def along_joint_path(
    path: PosePath,
    tracking: PathTracking,
    *,
    limits: JointLimits | Any,
    profile: str = "poly345",
    duration: float | None = None,
    speeds: TipSpeeds | None = None,
) -> PathMotion:
    """Run along a joint path that follows a pose path.

    Parameters
    ----------
    path, limits, profile, duration, speeds
        As for `along_path`.
    tracking : PathTracking
        With a joint path.

    Returns
    -------
    PathMotion

    Raises
    ------
    RobomechError
        As `along_path` does.
    """
    joints = tracking.path
    if joints is None:
        raise BadValueError("tracking", tracking.reason, "one that has found a joint path")
    law = PATH_PROFILES[as_choice("profile", profile, tuple(PATH_PROFILES))]
    allowed = Limits.of(limits)
    allowed.require("velocity", "acceleration")
    most = speeds or TipSpeeds()
    for what, speed in (("linear", most.linear), ("angular", most.angular)):
        if speed != np.inf:
            as_positive(f"{what} speed", speed)
    sections = [_section(path, joints, edges, law, allowed, most) for edges in _edges(joints)]
    curve = _joined(sections)
    seconds = checked_duration(duration)
    if seconds is not None:
        _check_wanted(seconds, curve, allowed)
        curve = curve.stretched(max(seconds / curve.duration, 1.0))
    check_positions(curve, joints.pieces.coefficients[0, 0], allowed)
    return PathMotion(joints.derivatives(joints.length)[0], curve, tracking)


def _edges(joints: JointPath) -> list[tuple[float, float]]:
    """Give the parts of a joint path between which the motion must rest.

    At its stops the first derivative steps; where the second one does, the acceleration would.
    """
    inner = joints.pieces.breaks[1:-1]
    after = joints.derivatives(inner)[2]
    before = joints.derivatives(np.nextafter(inner, 0.0))[2]
    largest = max(float(np.abs(after).max(initial=0.0)), float(np.abs(before).max(initial=0.0)))
    steps = np.abs(after - before).max(axis=1, initial=0.0) > _SMOOTH * (1.0 + largest)
    rests = np.unique(np.concatenate([[0.0], joints.stops, inner[steps], [joints.length]]))
    return list(pairwise(rests.tolist()))


def _section(
    path: PosePath,
    joints: JointPath,
    edges: tuple[float, float],
    law: Law,
    limits: Limits,
    speeds: TipSpeeds,
) -> PiecewisePolynomial:
    """Time one part: as fast as joints and tool may move."""
    count, error = _FEWEST, np.inf
    while True:
        unit = _timed(joints, edges, law, count)
        before, error = error, _deviation(unit, joints, edges, law)
        # Rounding, too, ends this: twice as many instants must help.
        if error <= _ON_PATH or count >= _MOST or error > 0.5 * before:
            break
        count *= 2
    curve = fitted(unit, limits)
    least = _least_duration(path, edges, law, speeds, count)
    return curve.stretched(max(least / curve.duration, 1.0))


def _coordinates(edges: tuple[float, float], law: Law, tau: FloatArray) -> tuple[FloatArray, ...]:
    """Path coordinate and its first two rates over a duration of 1, shape (m, 1)."""
    low, high = edges
    done = np.where(tau < 0.5, law.progress(tau), 1.0 - law.progress(1.0 - tau))
    rates = law.rates(tau)
    # The limit from the left at the end, where the next part begins with other derivatives.
    s = np.minimum(low + (high - low) * done, np.nextafter(high, low))
    length = high - low
    return s[:, None], length * rates.velocity[:, None], length * rates.acceleration[:, None]


def _timed(
    joints: JointPath, edges: tuple[float, float], law: Law, count: int
) -> PiecewisePolynomial:
    """Interpolate the joints over a duration of 1, by exact values and rates."""
    tau = np.linspace(0.0, 1.0, count + 1)
    s, v, a = _coordinates(edges, law, tau)
    q, first, second, _ = joints.derivatives(s[:, 0])
    q[-1] = joints.derivatives(edges[1])[0]
    return interpolant(tau, q, first * v, second * v**2 + first * a)


def _deviation(
    unit: PiecewisePolynomial, joints: JointPath, edges: tuple[float, float], law: Law
) -> float:
    """How far (rad or m) the joints are off the path in the middle between instants."""
    middle = 0.5 * (unit.breaks[1:] + unit.breaks[:-1])
    exact = joints.derivatives(_coordinates(edges, law, middle)[0][:, 0])[0]
    return float(np.abs(unit.sample(middle).position - exact).max())


def _least_duration(
    path: PosePath, edges: tuple[float, float], law: Law, speeds: TipSpeeds, count: int
) -> float:
    """Shortest time (s) for a part in which the tool keeps its speeds."""
    s, v, _ = _coordinates(edges, law, np.linspace(0.0, 1.0, 2 * count + 1))
    twists = path.sample(s[:, 0]).twist * v
    turning, moving = (
        np.linalg.norm(part, axis=1).max() for part in (twists[:, :3], twists[:, 3:])
    )
    return max(float(turning) / speeds.angular, float(moving) / speeds.linear)


def _joined(curves: list[PiecewisePolynomial]) -> PiecewisePolynomial:
    """Put motions one after another."""
    ends = np.cumsum([0.0, *(curve.duration for curve in curves)])
    breaks = [curve.breaks[1:] + begin for curve, begin in zip(curves, ends, strict=False)]
    order = max(len(curve.coefficients) for curve in curves)
    padded = [
        np.pad(curve.coefficients, ((0, order - len(curve.coefficients)), (0, 0), (0, 0)))
        for curve in curves
    ]
    return PiecewisePolynomial(np.concatenate([[0.0], *breaks]), np.concatenate(padded, axis=1))


def _check_wanted(seconds: float, curve: PiecewisePolynomial, limits: Limits) -> None:
    slack = tolerances.DURATION_ROUNDING * (1.0 + curve.duration)
    if seconds < curve.duration - slack:
        factor, joint, rate = stretch_needed(curve, limits)
        name = limits.joint_names[joint] if factor > 1.0 - _SMOOTH else "of the tool"
        raise DurationTooShortError(seconds, curve.duration, name, rate)


# Laws of the path coordinate from corner to corner.
PATH_PROFILES: dict[str, Law] = {"poly345": POLY345, "poly4567": POLY4567, "cycloidal": CYCLOIDAL}
