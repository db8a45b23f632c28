"""Joint paths that follow pose paths, by the differential geometry of the path."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import check_kind, shaped_array
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import chained
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.paths.arms import Tracked, as_near, as_tracked
from robomech_ros.trajectory.paths.curve_arguments import as_positive
from robomech_ros.trajectory.paths.joint_path import JointPath
from robomech_ros.trajectory.paths.path_cuts import limit_cut
from robomech_ros.trajectory.paths.pose_path import PosePath, PoseSample
from robomech_ros.trajectory.paths.posture import (
    Posture,
    corrected,
    is_redundant,
    pose_deviation,
    posture,
)
from robomech_ros.trajectory.paths.tracking_result import PathTracking, PathTrackingStatus
from robomech_ros.typing import Array, ArrayLike

# A joint that moves farther than this (rad, m) between two postures has jumped: they lie closer.
JUMP = 0.5

# Deviation (rad, m) of the given joint values from the start of a path that a correction may take
# away; from farther off inverse kinematics is asked.
AT_START = 1e-3
# Least tolerance (rad, m) of a joint path between its postures: rounding, with room.
LEAST_TOLERANCE = 1e-10
# Least step along a path, as part of the distance of two breaks: a path that needs shorter ones is
# singular there.
SHORTEST_STEP = 1e-7
# Steps between two breaks at most; with the least tolerance a loop of a metre takes a few hundred.
MOST_STEPS = 10_000

# First step, as part of the path between two breaks, and bounds of the change from step to step.
_FIRST = 0.125
_SHRINK, _GROW = 0.3, 3.0
# Least step as part of the coordinate: a few units of its last digit.
_ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
# A rest of the part not much longer than a step is taken in one.
_NEARLY_ALL = 1.05
# How far beyond its last posture the arm is asked for another, as part of the path.
_BEYOND = 1e-3
_DERIVATIVES = ("q", "first", "second")


def track_path(
    path: PosePath,
    arm: Tracked,
    near: ArrayLike,
    *,
    limits: JointLimits | Any = None,
    tolerance: float = 1e-7,
    condition_limit: float = 1e6,
) -> PathTracking:
    r"""Follow a pose path with the joints, on one branch.

    From a posture on the path the next one is predicted by the derivatives of the joint values
    and corrected by Newton steps; between both every joint follows the quintic through values and
    two derivatives, all exact.  The step is chosen so that the pose in its middle, where the
    quintic is farthest off, is on the path within the tolerance: the error falls with its sixth
    power.

    With the twist t of the path per unit of s

    .. math::

       q' = J^{-1} t, \qquad q'' = J^{-1} (t' - J' q'), \qquad
       \Delta q = J^{-1} \begin{bmatrix} \mathrm{vect}(\Delta Q) \\ \Delta p \end{bmatrix}

    Parameters
    ----------
    path : PosePath
    arm : Arm or JoinedArms
        Of any number of joints; a redundant one moves with the least joint rates.  Joined arms
        follow the path together, such as the limbs of a parallel robot.
    near : array_like, shape (n,)
        Joint values (rad or m) that choose the branch at the start of the path.
    limits : JointLimits, optional
        A chain model, `Limits`, or anything with the same attributes: the path ends where a joint
        would leave its position limits, and the arm's `inverse` is asked near postures within.
    tolerance : float, optional
        Largest deviation of a pose from the path (rad, and m).
    condition_limit : float, optional
        Largest condition number of the Jacobian; above it the path ends as singular.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.5.
    """
    check_kind("path", path, PosePath, "a PosePath")
    q = as_near(as_tracked(arm), near)
    allowed = as_positive("tolerance", tolerance)
    if allowed < LEAST_TOLERANCE:
        raise BadValueError("tolerance", allowed, f"at least {LEAST_TOLERANCE:g}")
    limit = as_positive("condition_limit", condition_limit, math.inf)
    within = None if limits is None else Limits.of(limits)
    if within is not None and len(within.joint_names) != len(q):
        raise WrongSizeError("joints of limits", len(within.joint_names), len(q))
    begin = _start(path, arm, q, within)
    if begin is None:
        reason = "the arm has no posture for the pose at the start of the path"
        return PathTracking(None, 0.0, PathTrackingStatus.NO_START, reason, path.length)
    tracking = _tracked(path, arm, begin, (allowed, limit), within)
    if tracking.path is None or within is None:
        return tracking
    cut = limit_cut(tracking.path, within)
    return tracking if cut is None or cut.s >= tracking.reached else tracking.cut(cut)


def _tracked(
    path: PosePath, arm: Tracked, begin: Array, bounds: tuple[float, float], limits: Limits | None
) -> PathTracking:
    """Follow a path from joint values at its start, within a tolerance and a condition number."""
    parts: list[_Nodes] = []
    for low, high in zip(path.breaks[:-1], path.breaks[1:], strict=True):
        part = _followed(path, arm, begin, (float(low), float(high)), *bounds)
        parts.append(part)
        begin = part.postures[-1].q
        if part.at[-1] < high:
            return _cut_short(path, arm, parts, bounds[1], limits)
    complete = PathTrackingStatus.COMPLETE
    return PathTracking(_assembled(path, parts), path.length, complete, "", path.length)


class _Nodes(NamedTuple):
    """Postures at coordinates of a smooth part of a path, the rates at its ends from within.

    `beyond` is the condition number of the first posture past them that was too close to a
    singularity, 0 if there was none.
    """

    at: list[float]
    postures: list[Posture]
    beyond: float


def _followed(
    path: PosePath,
    arm: Tracked,
    q: Array,
    part: tuple[float, float],
    tolerance: float,
    limit: float,
) -> _Nodes:
    """Follow the part of a path between two breaks as far as possible."""
    low, high = part
    at, here = low, posture(arm, q, path.sample(low))
    places, postures = [at], [here]
    h = _FIRST * (high - low)
    beyond = here.condition if here.condition > limit else 0.0
    shortest = max(SHORTEST_STEP * (high - low), _ROUNDING * high)
    while at < high and h > shortest and here.condition <= limit and len(places) < MOST_STEPS:
        last = high - at <= h * _NEARLY_ALL
        h = high - at if last else h
        # The limit from the left, where the next part begins with other rates.
        end = float(np.nextafter(high, low)) if last else at + h
        there, error = _stepped(path, arm, here, (at, end))
        if there is not None and error <= tolerance and there.condition > limit:
            beyond, h = there.condition, 0.5 * h
            continue
        if there is not None and error <= tolerance:
            at, here = (high if last else end), there
            places.append(at)
            postures.append(here)
        h *= _change(error / tolerance)
    return _Nodes(places, postures, beyond if at < high else 0.0)


def _stepped(
    path: PosePath, arm: Tracked, here: Posture, step: tuple[float, float]
) -> tuple[Posture | None, float]:
    """Posture at the end of a step, and the error of the pose in the middle (rad, m)."""
    h = step[1] - step[0]
    places = path.sample(np.array([0.5 * (step[0] + step[1]), step[1]]))
    middle, end = (PoseSample(*(value[k] for value in places)) for k in range(2))
    guess = here.q + h * (here.first + 0.5 * h * here.second)
    there = _reached(arm, guess, end)
    if there is not None and is_redundant(arm, guess):
        # The pose leaves the spare joints where they are predicted: once more, by both ends.
        guess = (
            here.q
            + 0.5 * h * (here.first + there.first)
            + h**2 / 12.0 * (here.second - there.second)
        )
        there = _reached(arm, guess, end)
    if there is None:
        return None, np.inf
    between = (
        0.5 * (here.q + there.q)
        + 5.0 / 32.0 * h * (here.first - there.first)
        + h**2 / 64.0 * (here.second + there.second)
    )
    return there, float(np.abs(pose_deviation(arm, between, middle.pose)).max())


def _reached(arm: Tracked, guess: Array, place: PoseSample) -> Posture | None:
    """Posture at a place of the path from predicted joint values; None where there is none."""
    q = corrected(arm, guess, place.pose) if np.isfinite(guess).all() else None
    return None if q is None else posture(arm, q, place)


def _change(ratio: float) -> float:
    """By how much the next step may be longer; the error grows with its sixth power."""
    if not ratio > 0.0:
        return _GROW
    return min(max(float(0.9 * ratio ** (-1.0 / 6.0)), _SHRINK), _GROW)


def _assembled(path: PosePath, parts: list[_Nodes]) -> JointPath | None:
    """Join the quintics through all postures; None without any."""
    curves = [
        interpolant(
            part.at, *([getattr(one, name) for one in part.postures] for name in _DERIVATIVES)
        )
        for part in parts
        if len(part.at) > 1
    ]
    if not curves:
        return None
    pieces = chained(curves)
    return JointPath(pieces, path.stops[path.stops < pieces.breaks[-1]])


def _cut_short(
    path: PosePath, arm: Tracked, parts: list[_Nodes], limit: float, limits: Limits | None
) -> PathTracking:
    """Say why a path is not followed to its end."""
    reached, here = parts[-1].at[-1], parts[-1].postures[-1]
    status, joint, jump = PathTrackingStatus.SINGULAR, None, 0.0
    if parts[-1].beyond > limit:
        reason = f"the condition number rises to {parts[-1].beyond:.3g}, over {limit:.3g}"
    else:
        beyond = min(reached + _BEYOND * path.length, path.length)
        found = _nearest(arm, path.sample(beyond).pose, here.q, limits)
        if found is None:
            status = PathTrackingStatus.LOST
            reason = f"the arm has no posture for the pose at s = {beyond:.6g} m"
        else:
            move = np.abs(found - here.q)
            reason = f"joint values change too fast, condition number {here.condition:.3g}"
            if move.max() > JUMP:
                status, joint = PathTrackingStatus.JUMP, int(np.argmax(move))
                jump = float(move[joint])
                name = f"number {joint}" if limits is None else f"'{limits.joint_names[joint]}'"
                unit = "" if limits is None else limits.unit(joint)
                amount = f"{jump:.3g} {unit}" if unit else f"{jump:.3g} (rad or m)"
                reason = f"joint {name} would have to jump by {amount}"
    reason = f"at s = {reached:.6g} of {path.length:.6g} m: {reason}"
    return PathTracking(_assembled(path, parts), reached, status, reason, path.length, joint, jump)


def _start(path: PosePath, arm: Tracked, near: Array, limits: Limits | None) -> Array | None:
    """Joint values at the start of the path: near themselves if they are there."""
    pose = path.sample(0.0).pose
    if np.abs(pose_deviation(arm, near, pose)).max() < AT_START:
        q = corrected(arm, near, pose)
        if q is not None:
            return q
    found = _nearest(arm, pose, near, limits)
    return None if found is None else corrected(arm, found, pose)


def _nearest(arm: Tracked, pose: Array, near: Array, limits: Limits | None) -> Array | None:
    """Ask the arm for joint values at a pose, near others that are put within the limits."""
    seed = near if limits is None else np.clip(near, limits.lower, limits.upper)
    found = arm.inverse(pose, seed)
    return None if found is None else shaped_array("joint values of inverse", found, near.shape)
