"""Motions of a mechanism: its platform along a path, or its drives from place to place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomech_ros.cartesian import (
    CartesianPlan,
    PathCheck,
    PathStopLimits,
    Sampling,
    StopReason,
    plan_along,
)
from robomech_ros.errors import BadValueError, DurationTooShortError, WrongSizeError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.motion.drive_paths import (
    LARGEST_CONDITION,
    DrivePath,
    follow_drives,
    require_closed,
)
from robomech_ros.parallel.motion.path_model import MechanismPathModel
from robomech_ros.parallel.motion.singularity_check import crossing_cut, require_possible
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.trajectory import (
    JointLimits,
    JointPath,
    Limits,
    PathCut,
    PathTrackingStatus,
    PiecewisePolynomial,
    PosePath,
    SampledPlan,
    TipSpeeds,
    Waypoints,
    verify,
)
from robomech_ros.trajectory.curves.motion_to_rest import MotionToRest
from robomech_ros.trajectory.paths.path_cuts import last_valid_coordinate
from robomech_ros.trajectory.plans.fitting_plan import fitting_plan
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array, ArrayLike

# Passive joints may be so much over their limits, as a part: rounding.
_ROUNDING = 1e-9
# How often a motion is slowed down for passive joints, and by which part more than needed.
_ROUNDS, _SLOWER = 5, 1e-3
# How far outside its cone a joint may be at the places looked at (rad).
_SLACK = 1e-9
# How far beyond its last good place a path is looked at for the joint to blame, as its part.
_BEYOND = 1e-6


@dataclass(frozen=True, eq=False)
class DrivePlan:
    """A motion of the drives from place to place, and all joints on its way.

    Attributes
    ----------
    sampled : SampledPlan
        The motion of the drives, its samples and their verification.
    way : DrivePath
        All joints at the samples, as far as they can follow in one assembly mode.
    """

    sampled: SampledPlan
    way: DrivePath


def plan_platform(
    mechanism: Mechanism,
    path: PosePath,
    start: ArrayLike,
    *,
    task_mask: Sequence[bool] | None = None,
    bounds: PathStopLimits | None = None,
    limits: JointLimits | Any = None,
    profile: str = "poly345",
    speeds: TipSpeeds | None = None,
    sampling: Sampling | None = None,
) -> CartesianPlan:
    """Plan a motion of the platform along a path, as far as all limbs can follow it.

    In one assembly mode and one branch of every limb; position limits of all joints end the path,
    and limits of velocity, acceleration and jerk of the drives, and of passive joints that have
    some, hold for the curve through the samples.

    Parameters
    ----------
    mechanism : Mechanism
        Mechanism of n joints.
    path : PosePath
        Path of the platform in the base, such as `waypoint_path` makes it.
    start : array_like, shape (n,)
        All joints (rad or m), loops closed, at the start of the path.
    task_mask : sequence of six bool, optional
        Of the full pose: all or none of them.
    bounds : PathStopLimits, optional
        As for `plan_along`.  No platform passes a singularity, where the drives do not hold it: a
        condition number of 1e3 always ends the path.
    limits : JointLimits, optional
        Limits of all n joints, within which to move; default those of the mechanism.
    profile, speeds, sampling
        As for `plan_along`.

    Returns
    -------
    CartesianPlan
        Its samples hold the drives, in the order of ``mechanism.actuated``.

    Raises
    ------
    BadValueError
        A start with open loops; a path that leaves the freedoms of the platform.
    RobomechError
        As `plan_along` does.

    Examples
    --------
    >>> from robomech_ros.cartesian import waypoint_path
    >>> from robomech_ros.parallel import load_parallel, plan_platform
    >>> delta = load_parallel("delta").mechanism
    >>> here = delta.pose(delta.home())
    >>> there = here.copy()
    >>> there[:3, 3] += 0.1, 0.2, 0.05
    >>> plan = plan_platform(delta, waypoint_path(here, [there]), delta.home())
    >>> plan.fraction, plan.samples.positions.shape[1]
    (1.0, 3)
    """
    follower = MechanismPathModel(mechanism, limits)
    q = require_closed(mechanism, start)
    if not isinstance(path, PosePath):
        raise BadValueError("path", path, "a PosePath")
    require_possible(mechanism, q, path.sample(0.0).twist)
    ends = path.sample(path.breaks[1:]).pose if path.waypoints is None else path.waypoints
    missed = [_missed(mechanism, pose, k, q) for k, pose in enumerate(ends)]
    known = PathStopLimits() if bounds is None else bounds
    if isinstance(known, PathStopLimits):
        most = min(known.condition, LARGEST_CONDITION)
        checks = (crossing_cut(mechanism, most), _cone_cut(mechanism), *known.checks)
        known = replace(known, condition=most, checks=checks)
    plan = plan_along(
        follower,
        path,
        q,
        task_mask=task_mask,
        bounds=known,
        profile=profile,
        speeds=speeds,
        sampling=sampling,
    )
    plan = _of_drives(follower, plan)
    stop = plan.stop
    if stop is None or not missed[stop.index]:
        return plan
    told = StopReason(stop.index, stop.joint, stop.kind, f"{stop.text}; {missed[stop.index]}")
    return replace(plan, followed=replace(plan.followed, stop=told))


def _cone_cut(mechanism: Mechanism) -> PathCheck:
    """End a joint path where a joint bends beyond its cone, which each joint's own limits enclose.

    A start that is outside by no more than the slack of a start may stay where it is.
    """
    columns = (mechanism.bent[0][:, None] + [0, 1]).ravel()

    def check(joints: JointPath) -> PathCut | None:
        if not len(columns):
            return None
        first = mechanism.limit_excess(joints.derivatives(0.0)[0])[columns]
        allowed = np.where(first <= POSITION_SLACK, first, 0.0) + _SLACK

        def excess(q: Array) -> Array:
            return np.asarray(mechanism.limit_excess(q)[..., columns] - allowed)

        s = last_valid_coordinate(joints, lambda q: np.asarray((excess(q) > 0.0).any(axis=1)))
        if s is None:
            return None
        beyond = min(s + _BEYOND * joints.length, joints.length)
        joint = int(columns[np.argmax(excess(joints.derivatives(beyond)[0]))])
        text = f"joint '{mechanism.joint_names[joint]}' would leave its limits"
        return PathCut(s, PathTrackingStatus.LIMIT, text, joint)

    return check


def _of_drives(follower: MechanismPathModel, plan: CartesianPlan) -> CartesianPlan:
    """Leave out passive joints that were timed, too."""
    drives = follower.mechanism.drive_index.tolist()
    if plan.sampled is None or list(follower.timed) == drives:
        return plan
    kept = np.searchsorted(follower.timed, drives)
    pieces, points = plan.sampled.trajectory.pieces, plan.sampled.waypoints
    rows = (points.positions, points.velocities, points.accelerations)
    waypoints = Waypoints(points.times, *(row[:, kept] for row in rows if row is not None))
    motion = MotionToRest(
        waypoints.positions[-1], PiecewisePolynomial(pieces.breaks, pieces.coefficients[:, :, kept])
    )
    report = verify(waypoints, follower.limits.only(drives), start=waypoints.positions[0])
    return replace(plan, sampled=SampledPlan(motion, waypoints, report))


def plan_drives(
    mechanism: Mechanism,
    points: ArrayLike,
    start: ArrayLike,
    *,
    limits: JointLimits | Any = None,
    profile: str = "poly345",
    condition: float = LARGEST_CONDITION,
    **options: Any,
) -> DrivePlan:
    """Plan a motion of the drives from place to place, and follow it with all joints.

    The motion is slowed down where passive joints would exceed limits of their rates.

    Parameters
    ----------
    mechanism : Mechanism
        Mechanism of n joints and m drives.
    points : array_like, shape (k, m)
        Start, via points and goal of the drives (rad or m).
    start : array_like, shape (n,)
        All joints (rad or m) at the first point, loops closed: they say which assembly mode.
    limits : JointLimits, optional
        Limits of all n joints; default those of the mechanism.
    profile : str
        One of `robomech_ros.trajectory.PROFILES`, or with via points of `VIA_PROFILES`.
    condition : float, optional
        As for `follow_drives`.
    **options
        As for `robomech_ros.trajectory.plans.fitting_plan.fitting_plan`: duration, scales, periods
        and the like; samples by default as `Sampling` says.

    Returns
    -------
    DrivePlan
        Its `way` says whether, and before which sample, a singularity or a passive joint's limit
        stops the platform.

    Raises
    ------
    RobomechError
        As `fitting_plan` and `follow_drives` do, and DurationTooShortError where passive joints
        would be too fast in the wanted duration.
    """
    allowed = MechanismPathModel(mechanism, limits).limits
    q = require_closed(mechanism, start)
    places = as_finite("points", points, (mechanism.dof,))
    if places.ndim != 2 or len(places) < 2:
        raise WrongSizeError("points", places.shape, f"(k, {mechanism.dof}) with k at least 2")
    drives = allowed.only(mechanism.drive_index.tolist())
    sampling = Sampling()
    options = {
        "wanted_period": 0.0,
        "usual_period": sampling.period,
        "max_points": sampling.max_points,
        "max_duration": sampling.max_duration,
        **options,
    }
    slower, names = 1.0, ("velocity_scale", "acceleration_scale", "jerk_scale")
    scales = np.array([options.pop(name, 1.0) for name in names])
    for _ in range(_ROUNDS):
        parts = scales / slower ** np.arange(1.0, 4.0)
        scaled = dict(zip(names, parts.tolist(), strict=True))
        sampled = fitting_plan(drives, places, profile=profile, **scaled, **options)
        way = follow_drives(mechanism, sampled.waypoints.positions, q, condition=condition)
        over, joint = _passive_excess(mechanism, sampled, way, allowed, scales)
        if over <= 1.0 + _ROUNDING:
            break
        if options.get("duration"):
            least = sampled.trajectory.duration * over
            name = mechanism.joint_names[joint]
            raise DurationTooShortError(options["duration"], least, name, "velocity")
        slower *= over * (1.0 + _SLOWER)
    return DrivePlan(sampled, way)


def _passive_excess(
    mechanism: Mechanism, plan: SampledPlan, way: DrivePath, limits: Limits, scales: Array
) -> tuple[float, int]:
    """Say by how much a plan must be slowed down for passive joints, and for which."""
    passive = np.ones(mechanism.n, bool)
    passive[mechanism.drive_index] = False
    limited = np.isfinite(limits.velocity) | np.isfinite(limits.acceleration)
    if not (passive & limited).any() or not len(way.q):
        return 1.0, 0
    points, reached = plan.waypoints, len(way.q)
    assert points.velocities is not None
    assert points.accelerations is not None
    qd, _ = mechanism.rates(way.q, points.velocities[:reached])
    qdd, _ = mechanism.accelerations(way.q, qd, points.accelerations[:reached])
    speeds = np.abs(qd).max(axis=0) / (scales[0] * limits.velocity)
    rises = np.sqrt(np.abs(qdd).max(axis=0) / (scales[1] * limits.acceleration))
    over = np.where(passive, np.maximum(speeds, rises), 0.0)
    joint = int(np.argmax(over))
    return float(over[joint]), joint


def _missed(mechanism: Mechanism, pose: Array, k: int, near: Array) -> str:
    """Say why no posture holds the platform in a pose of a path; empty where one does."""
    try:
        found = mechanism.postures(pose, seed=near)
    except BadValueError as error:
        raise BadValueError(f"waypoints[{k}]: {error.what}", error.value, error.expected) from None
    return "" if found.status in (Code.NONE, Code.SINGULAR_CONTINUUM) else found.reason
