"""Paths of the tip in inertial space, followed by an arm whose floating base reacts."""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from robomech_ros.cartesian import CartesianPlan, PathStopLimits, plan_followed
from robomech_ros.cartesian.following import PathFollowingResult, checked_following
from robomech_ros.cartesian.path_models import ChainPathModel
from robomech_ros.dynamics import FloatingChain, follow_floating_path
from robomech_ros.dynamics.floating.tip_motion import SINGULAR
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.trajectory import JointPath, Limits, PathTracking, PathTrackingStatus, PosePath
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

# Pieces of a joint path, and the fewest between two stops.
_PIECES, _FEWEST = 100, 10


class InertialPath(NamedTuple):
    """A path followed from rest at zero momentum."""

    tracking: PathTracking  #: Joint values over the path coordinate.
    q: Array  #: Joint values (rad or m) at its end, shape (n,).
    base: Array  #: Base at its end, in the base at its start (m), shape (4, 4).


class FloatingPathModel(ChainPathModel):
    """A chain on a free base as a path follower."""

    def __init__(self, robot: FloatingChain) -> None:
        super().__init__(robot.chain)
        self._robot = robot

    def singular_values(self, q: Array) -> Array:
        """Compute those of the generalised Jacobian of rows (m, n), lengths over the arm's size."""
        scale = np.repeat([1.0, 1.0 / arm_size(self.chain)], 3)[:, None]
        J = np.array([self._robot.generalized_jacobian(row) for row in q])
        return np.asarray(np.linalg.svd(scale * J, compute_uv=False))

    def singular_part(self, joints: JointPath) -> str:
        """Return no name: such a singularity depends on the masses of all bodies."""
        return ""


def follow_inertial(robot: FloatingChain, path: PosePath, start: Array) -> InertialPath:
    """Follow a path of the tip in inertial space, from rest, as far as possible.

    - ``robot``: chain of n joints; at zero momentum the base depends on the path of the joints
      alone.
    - ``path``: in the base at the start.
    - ``start``: joint values (rad or m), shape (n,).
    """
    q, base, reason = start, np.eye(4), ""
    breaks: list[float] = [0.0]
    parts: list[Array] = []
    for low, high in pairwise([0.0, *path.stops.tolist(), path.length]):
        span = high - low
        count = max(round(_PIECES * span / path.length), _FEWEST)
        along = partial(_along, path, low, float(np.nextafter(high, low)))
        motion = follow_floating_path(
            robot, base, q, along, span, times=np.linspace(0.0, span, count + 1),
            velocity_limits=False,
        )  # fmt: skip
        if len(motion.t) > 1:
            parts.append(_cubics(motion.t, motion.q, motion.rates[:, 6:]))
            breaks += (low + motion.t[1:]).tolist()
            q, base = motion.q[-1], motion.poses[-1]
        if motion.reason != "finished":
            reason = motion.reason.rsplit(" at ", 1)[0]
            break
    joints = None
    if parts:
        pieces = PiecewisePolynomial(np.array(breaks), np.concatenate(parts, axis=1))
        joints = JointPath(pieces, path.stops[path.stops < breaks[-1]])
    return InertialPath(_tracking(robot, path, joints, q, reason), q, base)


def plan_inertial(
    robot: FloatingChain,
    path: PosePath,
    start: Array,
    *,
    kept: float,
    bounds: PathStopLimits,
    task_mask: Sequence[bool],
    **options: Any,
) -> CartesianPlan:
    """Plan a motion in inertial space within a part of the rate limits, as `plan_followed`."""
    if any(task_mask) and not all(task_mask):
        expected = "all true or all false for a path in inertial space"
        raise BadValueError("task_mask", list(task_mask), expected)
    limits = Limits.of(robot.chain).scaled(velocity=kept, acceleration=kept, jerk=kept)
    limits.check_start(start)
    tracking = follow_inertial(robot, path, start).tracking
    model = FloatingPathModel(robot)
    followed: PathFollowingResult = checked_following(model, path, start, tracking, bounds)
    return CartesianPlan(followed, plan_followed(followed, limits=limits, **options))


def _along(path: PosePath, low: float, high: float, s: float) -> tuple[Array, Array]:
    """Return pose and twist of the tip between two stops."""
    sample = path.sample(min(max(low + s, low), high))
    return sample.pose, sample.twist


def _cubics(t: Array, q: Array, slopes: Array) -> Array:
    """Return coefficients (4, m - 1, n) of the spline with these slopes at its ends."""
    from scipy.interpolate import CubicSpline

    curve = CubicSpline(t, q, bc_type=((1, slopes[0]), (1, slopes[-1])))
    return np.asarray(curve.c[::-1])


def _tracking(
    robot: FloatingChain, path: PosePath, joints: JointPath | None, q: Array, reason: str
) -> PathTracking:
    """Return the followed part of a path, and the reason for its end."""
    if not reason and joints is not None:
        done = PathTrackingStatus.COMPLETE
        return PathTracking(joints, path.length, done, "", path.length)
    reached, joint = 0.0 if joints is None else joints.length, None
    status = PathTrackingStatus.SINGULAR
    if not reason.startswith(SINGULAR):
        status = PathTrackingStatus.LIMIT
        chain = robot.chain
        joint = int(np.nanargmin(np.minimum(q - chain.lower, chain.upper - q)))
    text = f"at s = {reached:.6g} of {path.length:.6g} m in inertial space: {reason}"
    return PathTracking(joints, reached, status, text, path.length, joint)
