"""compute_cartesian_path: straight lines of a link, timed within the limits of every joint."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from moveit_msgs.msg import MoveItErrorCodes
from moveit_msgs.srv import GetCartesianPath
from numpy.typing import NDArray
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics, tip_poses
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.cartesian_planning import (
    FollowedPath,
    PathBounds,
    follow,
    last_before,
    plan_along,
)
from robomech_ros.nodes.common.joint_messages import joint_trajectory
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.pauses import Worker
from robomech_ros.nodes.common.waypoint_paths import path_through
from robomech_ros.nodes.moveit.cartesian_request import CartesianQuestion, read_question
from robomech_ros.nodes.moveit.refusals import refused_as
from robomech_ros.nodes.moveit.serving import answering
from robomech_ros.nodes.moveit.whole_robot import WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.poses import pose_error
from robomech_ros.trajectory import (
    JointPath,
    Limits,
    PosePath,
    SampledPlan,
    SpeedLimit,
    TipSpeeds,
    discretise,
    sampled_through_points,
    verify,
)

__all__ = ["CartesianPathService"]

Array = NDArray[np.float64]
# Points between which a relative jump is looked for, at least: of fewer the mean says nothing.
_FEWEST = 10
# Places at which constraints are looked at, at least.
_PLACES = 500
# A little finer than wanted: the fastest part may lie between two points.
_FINER = 0.95
_CODES = {
    ErrorCode.NONE: MoveItErrorCodes.SUCCESS,
    ErrorCode.IK_LOST: MoveItErrorCodes.NO_IK_SOLUTION,
    ErrorCode.LIMIT: MoveItErrorCodes.NO_IK_SOLUTION,
}


class CartesianPathService:
    """The service compute_cartesian_path of one node.

    Parameters
    ----------
    node : Node
        Gets the service under its own name.
    robot : WholeRobot
    monitor : JointStateMonitor
        Its present state.
    settings : callable
        Gives the parameters of the planner.
    worker : Worker
        Plans, while the node serves others.
    """

    def __init__(
        self,
        node: Node,
        robot: WholeRobot,
        monitor: JointStateMonitor,
        settings: Callable[[], Any],
        worker: Worker,
    ) -> None:
        self._robot = robot
        self._monitor = monitor
        self._settings = settings
        self._worker = worker
        node.create_service(
            GetCartesianPath,
            "~/compute_cartesian_path",
            answering(node, self._compute),
            callback_group=ReentrantCallbackGroup(),
        )

    async def _compute(self, request: Any, response: Any) -> tuple[int, str]:
        settings = self._settings()
        question = await read_question(
            request,
            self._robot,
            settings.max_waypoints,
            self._state,
            settings.stopped_velocity_tolerance,
        )
        response.start_state.joint_state = self._robot.state(question.positions)
        response.start_state.is_diff = len(question.positions) < len(self._robot.joint_names)
        found = await self._worker.do(partial(_solved, question, settings))
        response.fraction = found.fraction
        if found.plan is not None:
            response.solution.joint_trajectory = self._trajectory(question, found.plan)
        return found.code, found.text

    async def _state(self, given: dict[str, float], needed: list[str]) -> dict[str, float]:
        """Add the present positions to those given; a robot that is asked for them must stand."""
        settings = self._settings()
        missing = [name for name in needed if name not in given]
        if missing:
            tolerance = settings.stopped_velocity_tolerance
            await self._monitor.wait_for(missing, settings.state_timeout, tolerance)
            self._monitor.require_rest(missing, tolerance)
        return self._robot.with_present(given)

    def _trajectory(self, question: CartesianQuestion, plan: SampledPlan) -> Any:
        """Make the message of all joints of the group; those that are not on the way stand."""
        chain, points = question.chain, plan.waypoints
        assert points.velocities is not None
        assert points.accelerations is not None
        still = [
            name
            for name in self._robot.model.chain.joint_names
            if name not in chain.joint_names and name in question.positions
        ]
        places = np.array([question.positions[name] for name in still])
        count = len(points.times)
        message = joint_trajectory(
            (*chain.joint_names, *still),
            points.times,
            np.hstack([points.positions, np.tile(places, (count, 1))]),
            np.hstack([points.velocities, np.zeros((count, len(still)))]),
            np.hstack([points.accelerations, np.zeros((count, len(still)))]),
        )
        message.header.frame_id = chain.base
        return message


@dataclass(frozen=True, eq=False)
class _Found:
    """What came of a request: a plan if there is one, and how much of the waypoints it reaches."""

    plan: SampledPlan | None
    fraction: float
    code: int
    text: str


def _solved(question: CartesianQuestion, settings: Any) -> _Found:
    """Lay the path, follow it as far as it goes, and plan; raise a RobomechError otherwise."""
    with refused_as(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS):
        start = forward_kinematics(question.chain, question.start)
        path = path_through(start, question.waypoints, 0)
    if path is None:
        return _Found(_standstill(question, settings), 1.0, int(MoveItErrorCodes.SUCCESS), "")
    followed = _followed(question, path)
    plan = _planned(question, followed, settings)
    fraction = _fraction(start, question.waypoints, followed)
    return _Found(plan, fraction, *_outcome(followed, fraction))


def _followed(question: CartesianQuestion, path: PosePath) -> FollowedPath:
    bounds = PathBounds(math.inf, question.step, question.revolute_jump, question.prismatic_jump)

    def jumping(
        chain: SerialChain, joints: JointPath, _: PathBounds
    ) -> tuple[float, int, str] | None:
        return _relative_jump(question, chain, joints)

    def breaking(
        chain: SerialChain, joints: JointPath, _: PathBounds
    ) -> tuple[float, int, str] | None:
        return _broken(question, chain, joints)

    with refused_as(MoveItErrorCodes.START_STATE_INVALID):
        return follow(
            question.chain, path, question.waypoints, question.start, bounds, (jumping, breaking)
        )


def _relative_jump(
    question: CartesianQuestion, chain: SerialChain, joints: JointPath
) -> tuple[float, int, str] | None:
    """Find where the joints move by much more than on average between two points."""
    if math.isinf(question.relative_jump):
        return None
    count = max(math.ceil(joints.length / question.step), _FEWEST)
    places = np.linspace(0.0, joints.length, count + 1)
    moves = np.abs(np.diff(joints.derivatives(places)[0], axis=0))
    total = moves.sum(axis=1)
    most = question.relative_jump * float(total.mean())
    far = np.flatnonzero(total > most)
    if not len(far):
        return None
    k = int(far[0])
    joint = chain.joint_names[int(np.argmax(moves[k]))]
    reason = (
        f"all joints together would move by {total[k]:.3g}, most of it joint '{joint}', over "
        f"jump_threshold {question.relative_jump:g} times the mean {total.mean():.3g}"
    )
    return float(places[k]), int(ErrorCode.JUMP), reason


def _broken(
    question: CartesianQuestion, chain: SerialChain, joints: JointPath
) -> tuple[float, int, str] | None:
    """Find where a constraint of the path breaks."""
    if not question.conditions:
        return None

    def text(q: Array) -> str:
        moved = zip(chain.joint_names, q.tolist(), strict=True)
        return question.conditions.broken({**question.positions, **dict(moved)})

    count = max(math.ceil(joints.length / question.step), _PLACES)
    s = last_before(joints, count, lambda rows: np.array([bool(text(q)) for q in rows]))
    if s is None:
        return None
    beyond = min(s + joints.length / count, joints.length)
    why = text(joints.derivatives(s)[0]) or text(joints.derivatives(beyond)[0])
    return s, int(ErrorCode.REJECTED), why


def _planned(question: CartesianQuestion, followed: FollowedPath, settings: Any) -> Any:
    """Plan the motion in steps of the wanted length at the most; None where it does not begin."""
    limits = Limits.of(question.chain).scaled(
        velocity=question.velocity_scale, acceleration=question.acceleration_scale
    )
    plan = plan_along(
        question.chain,
        followed,
        profile="time_optimal",
        speeds=TipSpeeds(),
        limits=limits,
        speed_limits=_speed_limits(question, followed),
        usual_period=settings.sample_period,
        max_points=settings.max_points,
        max_duration=settings.max_duration,
    )
    return None if plan is None else _in_steps(question, plan, limits, settings.max_points)


def _speed_limits(question: CartesianQuestion, followed: FollowedPath) -> list[SpeedLimit]:
    joints, link = followed.tracking.path, question.limited
    if math.isinf(question.speed) or joints is None:
        return []
    names = question.chain.joint_names
    still = np.array([question.positions[name] for name in link.joint_names])
    columns = [k for k, name in enumerate(link.joint_names) if name in names]
    sources = [names.index(link.joint_names[k]) for k in columns]

    def rate(s: Array) -> Array:
        q, first = joints.derivatives(np.minimum(s, joints.length))[:2]
        rows = np.tile(still, (len(s), 1))
        rows[:, columns] = q[:, sources]
        moving = jacobian(link, rows)[:, 3:][:, :, columns]
        velocity = np.einsum("mij,mj->mi", moving, first[:, sources])
        speed: Array = np.linalg.norm(velocity, axis=1)
        return speed

    return [SpeedLimit(rate, question.speed)]


def _in_steps(
    question: CartesianQuestion, plan: SampledPlan, limits: Limits, max_points: int
) -> SampledPlan:
    """Sample a plan finer where its points are farther apart than wanted."""
    points = plan.waypoints
    places = tip_poses(question.chain, points.positions)[:, :3, 3]
    apart = np.linalg.norm(np.diff(places, axis=0), axis=1)
    longest = float((apart / np.diff(points.times)).max(initial=0.0))
    if apart.max(initial=0.0) <= question.step:
        return plan
    try:
        finer = discretise(plan.trajectory, _FINER * question.step / longest, max_points)
    except BadValueError:
        expected = f"one for which {max_points} points, the parameter max_points, are enough"
        raise BadValueError("max_step", question.step, expected) from None
    report = verify(finer, limits, start=points.positions[0])
    report.require_ok()
    return replace(plan, waypoints=finer, verification=report)


def _standstill(question: CartesianQuestion, settings: Any) -> SampledPlan:
    """Plan a motion of no length."""
    return sampled_through_points(
        [question.start, question.start],
        limits=question.chain,
        profile="time_optimal",
        period=settings.sample_period,
        max_points=settings.max_points,
    )


def _fraction(start: Array, waypoints: Array, followed: FollowedPath) -> float:
    """Tell which part of the waypoints is reached; the way to each counts the same."""
    if followed.code == ErrorCode.NONE:
        return 1.0
    errors = pose_error(waypoints, np.concatenate([start[None], waypoints[:-1]]))
    turns, ways = (np.linalg.norm(part, axis=1) for part in (errors[:, :3], errors[:, 3:]))
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(ways, followed.path.radius * turns))])
    passed = int(np.searchsorted(ends[1:-1], followed.tracking.reached, side="right"))
    part = (followed.tracking.reached - ends[passed]) / (ends[passed + 1] - ends[passed])
    return float((passed + np.clip(part, 0.0, 1.0)) / len(waypoints))


def _outcome(followed: FollowedPath, fraction: float) -> tuple[int, str]:
    if followed.code == ErrorCode.NONE:
        return int(MoveItErrorCodes.SUCCESS), ""
    code = _CODES.get(followed.code, MoveItErrorCodes.PLANNING_FAILED)
    if followed.code == ErrorCode.REJECTED and followed.tracking.path is None:
        code = MoveItErrorCodes.START_STATE_VIOLATES_PATH_CONSTRAINTS
    return int(code), f"{100.0 * fraction:.4g} % of the waypoints: {followed.tracking.reason}"
