"""Motions along pose paths within the limits of every joint, in a limited number of samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from robomech_ros.cartesian.following import PathFollowingResult, StopReason, follow_path
from robomech_ros.cartesian.path_checks import PathStopLimits
from robomech_ros.cartesian.path_models import PathModel
from robomech_ros.cartesian.sampling import Sampling, in_steps
from robomech_ros.printing import Printed
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.trajectory import (
    JointLimits,
    Limits,
    PathMotion,
    PosePath,
    SampledPlan,
    SpeedLimit,
    TipSpeeds,
    Waypoints,
    along_joint_path,
    sampled_motion,
)
from robomech_ros.trajectory.plans.fitting_plan import sampled_to_fit
from robomech_ros.trajectory.waypoints import PiecewiseTrajectory
from robomech_ros.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class CartesianPlan(Printed):
    """A motion along a pose path, as far as the joints can follow it.

    Attributes
    ----------
    followed : PathFollowingResult
        The joint path, and where it ends.
    sampled : SampledPlan or None
        The motion, its samples and their verification; None where the path does not even begin.
    """

    followed: PathFollowingResult
    sampled: SampledPlan | None

    @property
    def trajectory(self) -> PiecewiseTrajectory | None:
        """The motion, with ``.duration`` (s) and ``.sample(t)``; None where there is none."""
        return None if self.sampled is None else self.sampled.trajectory

    @property
    def samples(self) -> Waypoints | None:
        """States of the timed joints, as messages take them; None where there are none."""
        return None if self.sampled is None else self.sampled.waypoints

    @property
    def fraction(self) -> float:
        """Part of the path that the motion follows, 0 to 1."""
        return self.followed.fraction

    @property
    def stop(self) -> StopReason | None:
        """Position and reason of an early end of the motion; None if the path is complete."""
        return self.followed.stop


def plan_along(
    chain: SerialChain | PathModel,
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
    """Plan a motion along a pose path, as far as the joints can follow it.

    From rest to rest, at rest at every corner of the path, as fast as the limits allow.

    Parameters
    ----------
    chain : SerialChain or PathModel
        Chain of n joints; parallel robots have a follower of their own.
    path : PosePath
        Path of its tip in its base, such as `waypoint_path` makes it.
    start : array_like, shape (n,)
        Joint values (rad or m) at the start of the path, or near: they choose the branch.
    task_mask : sequence of six bool, optional
        Which of x, y, z, rx, ry, rz are held; see `follow_path`.
    bounds : PathStopLimits, optional
        Condition number, jumps and checks of the caller that end the path.
    limits : JointLimits, optional
        Within which to move; default those of the chain.
    profile : str
        One of `robomech_ros.trajectory.PATH_PROFILES`.
    speeds : TipSpeeds, optional
        Largest speeds of the tip.
    sampling : Sampling, optional
        How finely to sample the motion, and how long it may be.

    Returns
    -------
    CartesianPlan
        With ``.trajectory``, ``.samples``, ``.fraction`` and ``.stop``.

    Raises
    ------
    SeedOutsideLimitsError
        The start is outside the limits.
    MissingLimitsError
        A joint lacks a limit that the profile needs.
    BadValueError, WrongSizeError
        A motion that takes too long or too many samples.

    Examples
    --------
    >>> from robomech_ros.cartesian import waypoint_path, plan_along
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.robots import load_robot
    >>> chain, q = load_robot("puma560"), [0.3, -0.4, 0.2, 0.5, 0.6, -0.7]
    >>> here = forward_kinematics(chain, q)
    >>> there = here.copy()
    >>> there[0, 3] += 0.1
    >>> plan = plan_along(chain, waypoint_path(here, [there]), q, profile="time_optimal")
    >>> plan.fraction, plan.stop
    (1.0, None)
    >>> plan.trajectory.sample(plan.trajectory.duration).velocity.tolist()
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    followed = follow_path(chain, path, start, task_mask=task_mask, bounds=bounds, limits=limits)
    sampled = plan_followed(
        followed, limits=limits, profile=profile, speeds=speeds, sampling=sampling
    )
    return CartesianPlan(followed, sampled)


def plan_followed(
    followed: PathFollowingResult,
    *,
    limits: JointLimits | Any = None,
    profile: str = "poly345",
    speeds: TipSpeeds | None = None,
    speed_limits: Sequence[SpeedLimit] = (),
    sampling: Sampling | None = None,
) -> SampledPlan | None:
    """Plan a motion along what can be followed of a path.

    Parameters
    ----------
    followed : PathFollowingResult
    limits, profile, speeds, sampling
        As for `plan_along`.
    speed_limits : sequence of SpeedLimit
        Further speeds over the path coordinate, such as `link_speed_limit`.

    Returns
    -------
    SampledPlan or None
        None where the path does not even begin.

    Raises
    ------
    RobomechError
        As `plan_along` does.
    """
    check_kind("followed", followed, PathFollowingResult, "a PathFollowingResult")
    fine = Sampling() if sampling is None else sampling
    check_kind("sampling", fine, Sampling, "a Sampling")
    if followed.joints is None:
        return None
    robot = followed.robot
    timed = list(robot.timed)
    tracking = replace(followed.tracking, path=followed.joints.only(timed))
    start = followed.joints.derivatives(0.0)[0]
    allowed = (robot.limits if limits is None else Limits.of(limits)).only(timed)

    def planner(tightened: Limits) -> PathMotion:
        return along_joint_path(
            followed.path,
            tracking,
            limits=tightened,
            profile=profile,
            speeds=speeds,
            speed_limits=speed_limits,
            arm=robot.arm,
        )

    plan = sampled_to_fit(
        lambda period: sampled_motion(
            planner, start[timed], allowed, period=period, max_points=fine.max_points
        ),
        lambda: planner(allowed).duration,
        usual_period=fine.period,
        max_points=fine.max_points,
        max_duration=fine.max_duration,
    )
    return in_steps(lambda q: robot.tip_poses(q, start), plan, fine, allowed)
