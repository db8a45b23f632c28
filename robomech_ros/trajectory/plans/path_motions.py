"""Motions whose tool follows a pose path, within the limits of every joint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, DurationTooShortError
from robomech_ros.spatial.arrays import as_choice, check_kind
from robomech_ros.trajectory.curves.motion_to_rest import MotionToRest, check_positions
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial, joined
from robomech_ros.trajectory.curves.time_scaling import checked_duration, stretch_needed
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.paths.arms import Arm, Tracked
from robomech_ros.trajectory.paths.curve_arguments import as_positive
from robomech_ros.trajectory.paths.joint_path import JointPath, check_follows
from robomech_ros.trajectory.paths.partial_poses import is_partial, tip_rates
from robomech_ros.trajectory.paths.path_tracking import track_path
from robomech_ros.trajectory.paths.pose_path import PosePath
from robomech_ros.trajectory.paths.tracking_result import PathTracking
from robomech_ros.trajectory.timing.path_limits import SpeedLimit, checked_list
from robomech_ros.trajectory.timing.path_sections import jump
from robomech_ros.trajectory.timing.section_timing import SECTION_TIMINGS, PathSection
from robomech_ros.trajectory.tolerances import DURATION_ROUNDING
from robomech_ros.typing import Array, ArrayLike

# How the path coordinate may be run through from corner to corner.
PATH_PROFILES = tuple(SECTION_TIMINGS)
# A step of the second derivative along a path, in parts of the largest, that is no rounding.
_SMOOTH = 1e-6
# A joint limit slows a curve down if the curve comes within this fraction of it.
_BINDING = 0.03


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

    @property
    def fraction(self) -> float:
        """Part of the path that is followed, 0 to 1."""
        return self.tracking.fraction

    @property
    def reason(self) -> str:
        """Reason why the path is not followed to its end; empty if it is."""
        return self.tracking.reason


def along_path(
    path: PosePath,
    ik: Arm,
    *,
    limits: JointLimits | Any,
    start: ArrayLike,
    profile: str = "poly345",
    duration: float | None = None,
    speeds: TipSpeeds | None = None,
    condition_limit: float = 1e6,
) -> PathMotion:
    """Follow a pose path from rest to rest, as fast as the limits allow.

    The joint path comes from the path's differential geometry (:func:`track_path`).  From corner
    to corner the path coordinate follows the law of ``poly345``, ``poly4567``, ``cycloidal`` or
    ``cubic_spline``, or a double-S profile whose shape makes the motion short (``ruckig``: joint
    jerk limits are needed and kept); or it is everywhere as fast as the limits allow
    (``time_optimal``, jerk-limited where the joints are, and accelerations take 20 ms to rise).

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
        Wanted duration of the motion in s, whatever part of the path it follows; None for the
        shortest.
    speeds : TipSpeeds, optional
        Largest speeds of the tool.
    condition_limit : float
        Condition number of the Jacobian at which the path ends.

    Returns
    -------
    PathMotion
        The motion as far as the path can be followed; where it cannot even begin, rest at the
        start, of no duration.  Its `fraction` says how far that is, and its `reason` why not
        farther: no posture, a jump, a singularity, or a joint that would leave its position limits.

    Raises
    ------
    BadValueError, WrongSizeError
        If the path, the arm, the start or an option is invalid.
    MissingLimitsError
        If a joint lacks a velocity or acceleration limit.
    DurationTooShortError
        If the limits do not allow the wanted duration.

    See Also
    --------
    robomech_ros.cartesian.plan_along : The same for a chain, with more that may end the path.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.5.

    Examples
    --------
    >>> from functools import partial
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
    >>> from robomech_ros.kinetostatics import jacobian
    >>> from robomech_ros.robots import load_robot
    >>> from robomech_ros.trajectory import SerialArm, along_path, straight_path
    >>> puma = load_robot("puma560")
    >>> arm = SerialArm(
    ...     partial(forward_kinematics, puma),
    ...     lambda T, near: inverse_kinematics(puma, T, seed=near).q[0],
    ...     partial(jacobian, puma),
    ... )
    >>> start = np.array([0.1, -0.5, 0.4, 0.3, 0.8, 0.2])
    >>> goal = arm.forward(start)
    >>> goal[2, 3] -= 0.1
    >>> path = straight_path([arm.forward(start), goal])
    >>> motion = along_path(path, arm, limits=puma, start=start, profile="poly345")
    >>> np.allclose(arm.forward(motion.sample(motion.duration).position), goal, atol=1e-6)
    True
    """
    tracking = track_path(path, ik, start, limits=limits, condition_limit=condition_limit)
    if tracking.path is None:
        rest = np.array(start, dtype=np.float64)
        return PathMotion(rest, PiecewisePolynomial(np.zeros(1), rest[None, None]), tracking)
    return along_joint_path(
        path, tracking, limits=limits, profile=profile, duration=duration, speeds=speeds, arm=ik
    )


def along_joint_path(
    path: PosePath,
    tracking: PathTracking,
    *,
    limits: JointLimits | Any,
    profile: str = "poly345",
    duration: float | None = None,
    speeds: TipSpeeds | None = None,
    speed_limits: Sequence[SpeedLimit] = (),
    arm: Tracked | None = None,
) -> PathMotion:
    """Run along a joint path that follows a pose path.

    Parameters
    ----------
    path, limits, profile, duration, speeds
        As for `along_path`.
    tracking : PathTracking
        With a joint path.
    speed_limits : sequence of SpeedLimit
        Further speeds, over the path coordinate.
    arm : Arm, optional
        The one that follows the path.  With a task mask `speeds` hold for its tip, which then turns
        or moves otherwise than the poses of the path.

    Raises
    ------
    RobomechError
        As `along_path` does, and LimitExceededError if the joint path leaves the position limits.
    """
    check_kind("tracking", tracking, PathTracking, "a PathTracking")
    joints = tracking.path
    if joints is None:
        raise BadValueError("tracking", tracking.reason, "one that has found a joint path")
    check_follows(path, joints)
    timing = SECTION_TIMINGS[as_choice("profile", profile, PATH_PROFILES)]
    allowed = Limits.of(limits)
    allowed.require(*timing.required)
    others = checked_list("speed_limits", speed_limits, SpeedLimit)
    twists = tip_rates(arm, joints) if is_partial(arm) else lambda s: path.sample(s).twist
    slow = (*_speed_limits(twists, speeds), *others)
    curve = joined(
        [
            timing.timed(PathSection(joints, low, high, allowed, slow))
            for low, high in _edges(joints, timing.needs_smooth)
        ]
    )
    seconds = checked_duration(duration)
    if seconds is not None:
        if seconds < curve.duration - DURATION_ROUNDING * (1.0 + curve.duration):
            factor, joint, rate = stretch_needed(curve, allowed)
            name = allowed.joint_names[joint] if factor > 1.0 - _BINDING else "of the tool"
            raise DurationTooShortError(seconds, curve.duration, name, rate)
        curve = curve.stretched(max(seconds / curve.duration, 1.0))
    check_positions(curve, joints.pieces.coefficients[0, 0], allowed)
    return PathMotion(joints.derivatives(joints.length)[0], curve, tracking)


def _edges(joints: JointPath, needs_smooth: bool) -> list[tuple[float, float]]:
    """Return the parts of a joint path between which the motion must rest.

    At its stops the first derivative steps; where the second one does, the acceleration would.
    """
    inner = joints.pieces.breaks[1:-1]
    after = joints.derivatives(inner)[2]
    before = joints.derivatives(np.nextafter(inner, 0.0))[2]
    largest = max(float(np.abs(after).max(initial=0.0)), float(np.abs(before).max(initial=0.0)))
    steps = np.abs(after - before).max(axis=1, initial=0.0) > _SMOOTH * (1.0 + largest)
    if needs_smooth and len(inner):
        steps |= jump(joints.pieces, 2)
    rests = np.unique(np.concatenate([[0.0], joints.stops, inner[steps], [joints.length]]))
    return list(pairwise(rests.tolist()))


def _speed_limits(twists: Callable[[Array], Array], most: TipSpeeds | None) -> list[SpeedLimit]:
    """Limit the speeds of the tool, whose twists (m, 6) over the path coordinate are given."""
    if most is None:
        return []
    check_kind("speeds", most, TipSpeeds, "a TipSpeeds")

    def rate(part: slice) -> Callable[[Array], Array]:
        def of(s: Array) -> Array:
            return np.linalg.norm(twists(s)[:, part], axis=1)

        return of

    kinds = (("linear", most.linear, slice(3, 6)), ("angular", most.angular, slice(0, 3)))
    return [
        SpeedLimit(rate(part), as_positive(f"{what} speed", speed))
        for what, speed, part in kinds
        if not (isinstance(speed, float) and speed == np.inf)
    ]
