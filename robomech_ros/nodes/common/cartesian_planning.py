"""Motions of the tip along paths in space: where they can go, and why not farther."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_interfaces.msg import ErrorCode
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.plan_sampling import fitting_plan
from robomech_ros.robots import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.poses import pose_error
from robomech_ros.trajectory import (
    JointPath,
    Limits,
    PathMotion,
    PathTracking,
    PathTrackingStatus,
    PosePath,
    SampledPlan,
    SerialArm,
    SpeedLimit,
    TipSpeeds,
    along_joint_path,
    sampled_motion,
    track_path,
)

__all__ = [
    "FollowedPath",
    "PathBounds",
    "PathCheck",
    "follow",
    "last_before",
    "load_inverse_kinematics",
    "plan_along",
]

Array = NDArray[np.float64]
# Where a path must end: its coordinate (m), one of ErrorCode, and why; None where nowhere.
_Found = tuple[float, int, str] | None
PathCheck = Callable[[SerialChain, JointPath, "PathBounds"], _Found]
# Places looked at along a path at least, and halvings between two of them.
_PLACES, _HALVINGS = 500, 40
# What ends sooner than at this part of the path is no motion at all.
_SHORTEST = 1e-6
# How far outside its limits a joint may be, rad or m.
_SLACK = 1e-9
_CODES = {
    PathTrackingStatus.COMPLETE: ErrorCode.NONE,
    PathTrackingStatus.NO_START: ErrorCode.IK_LOST,
    PathTrackingStatus.LOST: ErrorCode.IK_LOST,
    PathTrackingStatus.JUMP: ErrorCode.JUMP,
    PathTrackingStatus.SINGULAR: ErrorCode.SINGULAR,
}


@dataclass(frozen=True)
class PathBounds:
    """What ends a path.

    Attributes
    ----------
    condition : float
        Condition number of the Jacobian with lengths over the size of the arm; infinite to pass
        singular postures as slowly as the joints need.
    step : float
        Distance of neighbouring poses (m) between which a joint may move by no more than
    revolute_jump, prismatic_jump : float
        rad, m.
    """

    condition: float
    step: float
    revolute_jump: float
    prismatic_jump: float


@dataclass(frozen=True, eq=False)
class FollowedPath:
    """A path as far as the joints can follow it.

    Attributes
    ----------
    path : PosePath
    tracking : PathTracking
        The joint path is None where it does not even begin.
    code : int
        One of ErrorCode: NONE for the whole path.
    fraction : float
        Part of the path that is followed, 0 to 1.
    stop_index : int
        The waypoint on the way to which it ends; their number for the whole path.
    """

    path: PosePath
    tracking: PathTracking
    code: int
    fraction: float
    stop_index: int


def follow(
    chain: SerialChain,
    path: PosePath,
    waypoints: Array,
    start: Array,
    bounds: PathBounds,
    further: Sequence["PathCheck"] = (),
) -> FollowedPath:
    """Follow a path with the joints as far as they can.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    path : PosePath
        From the pose of `start` on.
    waypoints : ndarray, shape (m, 4, 4)
        Which it goes through.
    start : ndarray, shape (n,)
        Joint values (rad or m).
    bounds : PathBounds
    further : sequence of callable
        Each finds where else a joint path must end.

    Raises
    ------
    SeedOutsideLimitsError
        The start is outside the limits.
    """
    Limits.of(chain).check_start(start)
    tracking = track_path(path, _arm(chain), start)
    code = int(_CODES[tracking.status])
    if tracking.path is None:
        return FollowedPath(path, tracking, code, 0.0, 0)
    checks = [(_outside_limits, 0.0), (_singular, 0.0), (_jumping, bounds.step)]
    for check, reach in (*checks, *((one, 0.0) for one in further)):
        found = check(chain, tracking.path, bounds)
        # Joints that move far in the last step do so for the reason that is found already.
        if found is not None and found[0] + reach * (code != ErrorCode.NONE) < tracking.reached:
            s, code, reason = found
            reason = f"at s = {s:.6g} of {path.length:.6g} m: {reason}"
            kept = tracking.path.until(s) if s > _SHORTEST * path.length else None
            tracking = PathTracking(kept, s if kept else 0.0, tracking.status, reason)
            if kept is None:
                break
    whole = code == ErrorCode.NONE
    fraction = 1.0 if whole else min(tracking.reached / path.length, 1.0)
    stop = len(waypoints) if whole else _on_the_way_to(path, waypoints, tracking.reached)
    return FollowedPath(path, tracking, code, fraction, stop)


def plan_along(
    chain: SerialChain,
    followed: FollowedPath,
    *,
    profile: str,
    speeds: TipSpeeds,
    limits: Limits | None = None,
    speed_limits: Sequence[SpeedLimit] = (),
    usual_period: float,
    max_points: int,
    max_duration: float,
) -> SampledPlan | None:
    """Plan a motion along what can be followed of a path.

    Parameters
    ----------
    chain : SerialChain
    followed : FollowedPath
    profile, speeds, speed_limits
        As for `along_joint_path`.
    limits : Limits, optional
        Those of the chain, scaled.
    usual_period, max_points, max_duration
        As for `fitting_plan`.

    Returns
    -------
    SampledPlan or None
        None where the path does not even begin.

    Raises
    ------
    RobomechError
        As `along_joint_path` and `fitting_plan` do.
    """
    joints = followed.tracking.path
    if joints is None:
        return None
    start, allowed = joints.derivatives(0.0)[0], limits or Limits.of(chain)
    latest: list[PathMotion] = []

    def planner(tightened: Limits) -> PathMotion:
        motion = along_joint_path(
            followed.path,
            followed.tracking,
            limits=tightened,
            profile=profile,
            speeds=speeds,
            speed_limits=speed_limits,
        )
        latest[:] = [motion]
        return motion

    return fitting_plan(
        lambda period: sampled_motion(
            planner, start, allowed, period=period, max_points=max_points
        ),
        lambda: latest[0].duration,
        usual_period=usual_period,
        max_points=max_points,
        max_duration=max_duration,
    )


def load_inverse_kinematics() -> None:
    """Load what the first path of a process waits for otherwise: compiled code, some seconds."""
    import robomech_ros.kinematics.inverse.inverse_kinematics  # noqa: F401


def _arm(chain: SerialChain) -> SerialArm:
    # Loaded here, since a planner begins to serve before all of it is there.
    from robomech_ros.kinematics import inverse_kinematics

    def inverse(T: Array, near: Array) -> Array | None:
        seed = np.clip(near, chain.lower, chain.upper)
        found = inverse_kinematics(chain, T, seed=seed, max_solutions=1).q
        return found[0] if len(found) else None

    return SerialArm(lambda q: forward_kinematics(chain, q), inverse, lambda q: jacobian(chain, q))


def _outside_limits(chain: SerialChain, joints: JointPath, _: PathBounds) -> _Found:
    """Find where a joint leaves its position limits."""

    def excess(q: Array) -> Array:
        return np.maximum(chain.lower - q, q - chain.upper)

    def outside(q: Array) -> NDArray[np.bool_]:
        return np.asarray((excess(q) > _SLACK).any(axis=1))

    s = last_before(joints, _PLACES, outside)
    if s is None:
        return None
    beyond = min(s + _SHORTEST * joints.length, joints.length)
    joint = int(np.argmax(excess(joints.derivatives(beyond)[0])))
    return s, ErrorCode.LIMIT, f"joint '{chain.joint_names[joint]}' would leave its limits"


def _jumping(chain: SerialChain, joints: JointPath, bounds: PathBounds) -> _Found:
    """Find where a joint moves too far between neighbouring poses."""
    largest = np.where(chain.types == PRISMATIC, bounds.prismatic_jump, bounds.revolute_jump)
    count = max(int(np.ceil(joints.length / bounds.step)), 1)
    places = np.linspace(0.0, joints.length, count + 1)
    moves = np.abs(np.diff(joints.derivatives(places)[0], axis=0))
    far = np.flatnonzero((moves > largest).any(axis=1))
    if not len(far):
        return None
    k = int(far[0])
    joint = int(np.argmax(moves[k] / largest))
    reason = (
        f"joint '{chain.joint_names[joint]}' would move by {moves[k, joint]:.3g} in "
        f"{places[k + 1] - places[k]:.3g} m, over the threshold of a jump, {largest[joint]:.3g}"
    )
    return float(places[k]), ErrorCode.JUMP, reason


def _singular(chain: SerialChain, joints: JointPath, bounds: PathBounds) -> _Found:
    """Find where the condition number goes over its bound."""
    if not np.isfinite(bounds.condition):
        return None
    scale = np.repeat([1.0, 1.0 / arm_size(chain)], 3)[:, None]

    def over(q: Array) -> NDArray[np.bool_]:
        singular = np.linalg.svd(scale * jacobian(chain, q), compute_uv=False)
        above: NDArray[np.bool_] = singular[:, 0] > bounds.condition * singular[:, -1]
        return above

    s = last_before(joints, _PLACES, over)
    if s is None:
        return None
    reason = f"the condition number rises over {bounds.condition:.6g}: too near to a singularity"
    return s, ErrorCode.SINGULAR, reason


def last_before(
    joints: JointPath, count: int, wrong: Callable[[Array], NDArray[np.bool_]]
) -> float | None:
    """Find the last coordinate (m) before something is wrong with the joint values (m, n).

    It is looked for at `count` places, and from the first one found nearer and nearer.
    """
    places = np.linspace(0.0, joints.length, count + 1)
    bad = np.flatnonzero(wrong(joints.derivatives(places)[0]))
    if not len(bad):
        return None
    high = float(places[bad[0]])
    low = float(places[max(int(bad[0]) - 1, 0)])
    for _ in range(_HALVINGS if bad[0] else 0):
        middle = 0.5 * (low + high)
        if wrong(joints.derivatives(np.array([middle]))[0])[0]:
            high = middle
        else:
            low = middle
    return low


def _on_the_way_to(path: PosePath, waypoints: Array, reached: float) -> int:
    """Find the waypoint on the way to which a coordinate is: each is where the path is nearest."""
    places = np.linspace(0.0, path.length, 10 * _PLACES + 1)
    poses = path.sample(places).pose
    k = 0
    for index, waypoint in enumerate(waypoints):
        apart = np.linalg.norm(pose_error(waypoint, poses[k:]), axis=1)
        k += int(np.argmin(apart))
        if reached < places[k] - _SHORTEST * path.length:
            return index
    return len(waypoints) - 1
