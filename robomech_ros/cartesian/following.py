"""Pose paths followed by the joints of a robot, as far as they can."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros.cartesian.dead_ends import dead_end
from robomech_ros.cartesian.path_checks import PathCheck, PathStopLimits, jump_cut, singular_cut
from robomech_ros.cartesian.path_models import ChainPathModel, PathModel, as_path_model
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.arrays import as_finite, check_kind, shaped_array
from robomech_ros.spatial.poses import as_pose
from robomech_ros.spatial.screws.pose_conversions import pose_error
from robomech_ros.trajectory import (
    JointLimits,
    JointPath,
    Limits,
    PathCut,
    PathTracking,
    PathTrackingStatus,
    PosePath,
    track_path,
)
from robomech_ros.typing import Array, ArrayLike

# Places among which the nearest one to a waypoint is looked for.
_PLACES = 5000
# A waypoint is reached from this part of the path before it on.
_REACHED = 1e-6


@dataclass(frozen=True)
class StopReason:
    """Position and reason of an early end of a path.

    Attributes
    ----------
    index : int
        Number of the waypoint, from 0, on the way to which it ends; of a path without waypoints
        the number of its part between two `breaks`.
    joint : str or None
        The joint that ends it, where it is one.
    kind : PathTrackingStatus
        ``NO_START``, ``LOST``, ``JUMP``, ``SINGULAR``, ``LIMIT``, or ``REJECTED`` by a check of
        the caller; its `code` is the one of the planner's answer.
    text : str
        The place and the reason in words.
    """

    index: int
    joint: str | None
    kind: PathTrackingStatus
    text: str


@dataclass(frozen=True, eq=False)
class PathFollowingResult:
    """A pose path as far as the joints of a robot can follow it.

    Attributes
    ----------
    robot : PathModel
        Robot of n joints.
    path : PosePath
    start : ndarray, shape (n,)
        Joint values (rad or m) that chose the branch.
    tracking : PathTracking
        With the joint path, which is None where it does not even begin.
    stop : StopReason or None
        None where the whole path is followed.
    """

    robot: PathModel
    path: PosePath
    start: Array
    tracking: PathTracking
    stop: StopReason | None

    @property
    def joints(self) -> JointPath | None:
        """The joint path, as far as possible; None where it does not even begin."""
        return self.tracking.path

    @property
    def fraction(self) -> float:
        """Part of the path that is followed, 0 to 1."""
        return self.tracking.fraction


def follow_path(
    chain: SerialChain | PathModel,
    path: PosePath,
    start: ArrayLike,
    *,
    task_mask: Sequence[bool] | None = None,
    bounds: PathStopLimits | None = None,
    limits: JointLimits | Any = None,
) -> PathFollowingResult:
    """Follow a pose path with the joints of a chain as far as they can.

    Parameters
    ----------
    chain : SerialChain or PathModel
        Chain of n joints; parallel robots have a follower of their own.
    path : PosePath
        Path of its tip in its base.
    start : array_like, shape (n,)
        Joint values (rad or m) that choose the branch: those at the start of the path, or near.
    task_mask : sequence of six bool, optional
        Which of x, y, z, rx, ry, rz are held, along and about the axes of the path's pose, as for
        `inverse_kinematics`; default (and all False) the full pose.  What is free is chosen for the
        smallest motion of the joints, away from their limits.
    bounds : PathStopLimits, optional
        Condition number, jumps and checks of the caller that end the path.
    limits : JointLimits, optional
        Whose position limits end the path; default those of the chain.

    Raises
    ------
    SeedOutsideLimitsError
        The start is outside the limits.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.5.

    Examples
    --------
    A line of the wrist of a PUMA 560 that leaves its reach:

    >>> from robomech_ros.cartesian import follow_path, waypoint_path
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.robots import load_robot
    >>> chain, q = load_robot("puma560"), [0.3, -0.4, 0.2, 0.5, 0.6, -0.7]
    >>> here = forward_kinematics(chain, q)
    >>> there = here.copy()
    >>> there[0, 3] += 2.0
    >>> followed = follow_path(chain, waypoint_path(here, [there]), q)
    >>> round(followed.fraction, 2), followed.stop.kind.name, followed.stop.index
    (0.16, 'SINGULAR', 0)
    """
    robot = as_path_model(chain, task_mask)
    values = _as_start(robot, start)
    allowed = robot.limits if limits is None else Limits.of(limits)
    most = PathStopLimits() if bounds is None else bounds
    check_kind("bounds", most, PathStopLimits, "a PathStopLimits")
    allowed.check_start(values)
    tracking = track_path(path, robot.arm, values, limits=allowed)
    end = dead_end(tracking, robot, allowed)
    tracking = tracking if end is None else tracking.cut(end)
    return checked_following(robot, path, values, tracking, most)


def checked_following(
    robot: PathModel, path: PosePath, start: Array, tracking: PathTracking, bounds: PathStopLimits
) -> PathFollowingResult:
    """End a joint path that follows a pose path at the first bound, and say why.

    - ``robot``: model of a robot with n joints.
    - ``start``: joint values at the start (rad or m), shape (n,).
    - ``tracking``: joint path from the start.
    """
    tracking = _cut(tracking, robot, bounds)
    if tracking.status is PathTrackingStatus.COMPLETE:
        return PathFollowingResult(robot, path, start, tracking, None)
    joint = None if tracking.joint is None else robot.limits.joint_names[tracking.joint]
    index = 0 if tracking.path is None else _on_the_way_to(path, tracking.reached)
    text = f"before waypoints[{index}], " if path.waypoints is not None else ""
    text += tracking.reason
    stop = StopReason(index, joint, tracking.status, text)
    return PathFollowingResult(robot, path, start, tracking, stop)


def waypoint_fraction(followed: PathFollowingResult, waypoints: ArrayLike) -> float:
    """Say which part of the waypoints a straight path reaches; the way to each counts the same.

    This is the fraction of MoveIt.

    Parameters
    ----------
    followed : PathFollowingResult
        Of a path from the posture at its start along straight lines.
    waypoints : array_like, shape (m, 4, 4)
        The poses (m) that it goes through.

    Returns
    -------
    float
        0 to 1.
    """
    check_kind("followed", followed, PathFollowingResult, "a PathFollowingResult")
    shape = as_pose(waypoints, what="waypoints").shape
    if len(shape) != 3 or not shape[0]:
        raise WrongSizeError("waypoints", shape, "(m, 4, 4) with m at least 1")
    # With their rounding.
    poses = np.asarray(waypoints, dtype=np.float64)
    if followed.stop is None:
        return 1.0
    timed = followed.start[None, list(followed.robot.timed)]
    start = followed.robot.tip_poses(timed, followed.start)[0]
    errors = pose_error(poses, np.concatenate([start[None], poses[:-1]]))
    turns, ways = (np.linalg.norm(part, axis=1) for part in (errors[:, :3], errors[:, 3:]))
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(ways, followed.path.radius * turns))])
    reached = followed.tracking.reached
    passed = int(np.searchsorted(ends[1:-1], reached, side="right"))
    part = (reached - ends[passed]) / (ends[passed + 1] - ends[passed])
    return float((passed + np.clip(part, 0.0, 1.0)) / len(poses))


def _as_start(robot: PathModel, start: ArrayLike) -> Array:
    """Check joint values (n,)."""
    n = len(robot.limits.joint_names)
    if isinstance(robot, ChainPathModel):
        values = as_joint_values(robot.chain, start, "start")
    else:
        values = as_finite("start", start, (n,))
    return shaped_array("start", values, (n,))


def _cut(tracking: PathTracking, robot: PathModel, bounds: PathStopLimits) -> PathTracking:
    """End a tracking where it is singular, jumps, or breaks a check first."""
    own: tuple[tuple[PathCheck, float], ...] = (
        (lambda joints: singular_cut(robot, joints, bounds), 0.0),
        (lambda joints: jump_cut(robot, joints, bounds), bounds.step),
    )
    for check, reach in (*own, *((one, 0.0) for one in bounds.checks)):
        if tracking.path is None:
            return tracking
        cut = check(tracking.path)
        check_kind("result of a check", cut, PathCut | None, "a PathCut or None")
        # Joints that move far in the last step do so for the reason that is found already.
        before = 0.0 if tracking.status is PathTrackingStatus.COMPLETE else reach
        if cut is not None and cut.s + before < tracking.reached:
            tracking = tracking.cut(cut)
    return tracking


def _on_the_way_to(path: PosePath, reached: float) -> int:
    """Find the waypoint on the way to which a coordinate is: each is where the path is nearest."""
    slack, waypoints = _REACHED * path.length, path.waypoints
    if waypoints is None:
        ends = path.breaks[1:]
        return min(int(np.searchsorted(ends, reached + slack, side="right")), len(ends) - 1)
    places = np.linspace(0.0, path.length, _PLACES + 1)
    poses = path.sample(places).pose
    k = 0
    for index, waypoint in enumerate(waypoints):
        apart = np.linalg.norm(pose_error(waypoint, poses[k:]), axis=1)
        k += int(np.argmin(apart))
        if reached < places[k] - slack:
            return index
    return len(waypoints) - 1
