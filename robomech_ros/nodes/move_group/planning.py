"""Motions to a goal around obstacles, as MoveIt's clients ask for them."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from moveit_msgs.msg import DisplayTrajectory, MoveItErrorCodes, RobotState, RobotTrajectory
from rclpy.node import Node
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.collision import PlanningScene, PlanStatus, timed_path
from robomech_ros.collision.planning import PlanRequest, plan_path
from robomech_ros.errors import MissingLimitsError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.nodes.common.cooperative_wait import Worker, pause
from robomech_ros.nodes.common.joints.joint_limits import NoLimitsForPlanError
from robomech_ros.nodes.common.messages.joint_messages import joint_trajectory
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.nodes.move_group.settings import MoveGroupSettings
from robomech_ros.nodes.moveit.motion_request import (
    MotionGoal,
    MotionRequest,
    PoseTarget,
    read_motion_request,
)
from robomech_ros.nodes.moveit.serving import RejectedError, refused_as
from robomech_ros.nodes.moveit.whole_robot import WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import Waypoints
from robomech_ros.typing import Array

_CODES = {
    PlanStatus.START_IN_CONTACT: MoveItErrorCodes.START_STATE_IN_COLLISION,
    PlanStatus.GOAL_IN_CONTACT: MoveItErrorCodes.GOAL_IN_COLLISION,
    PlanStatus.NO_POSTURE: MoveItErrorCodes.NO_IK_SOLUTION,
    PlanStatus.NO_PATH: MoveItErrorCodes.TIMED_OUT,
}
_FULL_POSE = 6


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A motion in messages."""

    start: Any  #: Start of the motion, a RobotState of the whole robot.
    trajectory: Any  #: The motion, a RobotTrajectory.
    seconds: float  #: How long planning took.
    note: str  #: Remark on the plan; may be empty.


class MotionPlanning:
    """Plans the motions of all requests, one after the other, beside the executor.

    - ``node``: owner of the topic display_planned_path.
    """

    def __init__(
        self,
        node: Node,
        robot: WholeRobot,
        scenes: Scenes,
        worker: Worker,
        settings: Callable[[], MoveGroupSettings],
    ) -> None:
        self._node, self._robot, self._scenes = node, robot, scenes
        self._worker, self._settings = worker, settings
        self._ends = ""
        self._display = node.create_publisher(DisplayTrajectory, "display_planned_path", 10)

    def give_up(self, reason: str) -> None:
        """Refuse all that waits for a plan."""
        self._ends = reason

    async def plan(
        self, request: Any, cancelled: Callable[[], bool] | None = None
    ) -> PlannedMotion:
        """Plan the motion of a MotionPlanRequest.

        - ``request``: MotionPlanRequest.
        - ``cancelled``: whether the client has cancelled its goal.

        Raises RejectedError: there is no such motion; the code and the text say why.
        """
        settings = self._settings()
        question = await read_motion_request(request, self._robot, settings)
        scene = await self._scenes.of(question.chain, question.positions)
        work = partial(_planned, question, scene.copy(), settings, cancelled or bool)
        planned = self._unless(cancelled, work) if cancelled else self._worker.do(work)
        message, seconds, note = await planned
        message.header.frame_id = self._robot.model.base_frame
        trajectory = RobotTrajectory(joint_trajectory=message)
        start = RobotState(joint_state=self._robot.state(question.positions))
        self._display.publish(
            DisplayTrajectory(
                model_id=self._robot.model.description.name,
                trajectory=[trajectory],
                trajectory_start=start,
            )
        )
        notes = filter(None, (note, self._scenes.unchecked))
        return PlannedMotion(start, trajectory, seconds, "; ".join(notes))

    async def _unless(self, cancelled: Callable[[], bool], work: Callable[[], Any]) -> Any:
        """Return the result of work in the worker's thread, unless the client cancels it."""
        done = self._worker.begin(work)
        # Nobody may be left to ask for its error.
        done.add_done_callback(Future.exception)
        while not done.done():
            if self._ends:
                raise RejectedError(MoveItErrorCodes.ABORT, self._ends)
            if cancelled():
                raise RejectedError(MoveItErrorCodes.PREEMPTED, "cancelled while it was planned")
            await pause(self._node)
        return done.result()


def _planned(
    question: MotionRequest,
    scene: PlanningScene,
    settings: MoveGroupSettings,
    cancelled: Callable[[], bool],
) -> tuple[JointTrajectory, float, str]:
    """Plan in the worker's thread; return the trajectory, the time it took (s), and a note."""
    chain, begin = question.chain, time.monotonic()
    start = _at_limits(chain, question.start, settings.start_tolerance)
    goals = _postures(question, start)
    planner = question.planner or settings.planner
    request = PlanRequest(question.time, settings.seed, settings.clearance, planner, cancelled)
    with refused_as(MoveItErrorCodes.START_STATE_INVALID):
        found = plan_path(scene, start, goals, request)
    if found.status is not PlanStatus.SOLVED:
        raise RejectedError(_CODES[found.status], found.reason)
    try:
        timed = timed_path(
            scene,
            found.waypoints,
            clearance=settings.clearance,
            period=settings.sample_period,
            max_points=settings.max_points,
            velocity_scale=question.velocity_scale,
            acceleration_scale=question.acceleration_scale,
        ).waypoints
    except MissingLimitsError as error:
        raise NoLimitsForPlanError(error) from None
    message = _message(question, timed, settings)
    return message, time.monotonic() - begin, found.reason


def _at_limits(chain: SerialChain, q: Array, most: float) -> Array:
    """Clip the posture (n,) of a robot that stands slightly beyond its limits."""
    inside = np.clip(q, chain.lower, chain.upper)
    return inside if np.max(np.abs(inside - q), initial=0.0) <= most else q


def _postures(question: MotionRequest, start: Array) -> Array:
    """Find all postures (k, n) that reach one of the goals, or raise RejectedError."""
    rows, reasons, codes = [], [], []
    for i, goal in enumerate(question.goals):
        what = f"goal_constraints[{i}]: " if len(question.goals) > 1 else ""
        if goal.target is None:
            found, reason, code = _of_joints(goal, question.chain, start)
        else:
            found, reason, code = _of_pose(goal.target, question.chain, start)
        for q in found:
            at = dict(zip(question.chain.joint_names, q.tolist(), strict=True))
            broken = goal.conditions.broken({**question.positions, **at})
            if broken and not reason:
                reason, code = broken, int(MoveItErrorCodes.GOAL_CONSTRAINTS_VIOLATED)
            elif not broken:
                rows.append(q)
        reasons.append(f"{what}{reason}")
        codes.append(code)
    if not rows:
        raise RejectedError(codes[0], "; ".join(reasons))
    return np.array(rows)


def _of_joints(goal: MotionGoal, chain: SerialChain, start: Array) -> tuple[list[Array], str, int]:
    """Return the posture that a goal names; joints that it does not name stay where they are."""
    code = int(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS)
    if not goal.joints:
        return [], "there are no constraints, expected joints, a position or an orientation", code
    wanted = [
        goal.joints.get(name, now) for name, now in zip(chain.joint_names, start, strict=True)
    ]
    q = np.array(wanted)
    inside = np.clip(q, chain.lower, chain.upper)
    worst = int(np.argmax(np.abs(inside - q)))
    name, unit = chain.joint_names[worst], chain.units[worst]
    reason = (
        f"joint '{name}' is to go to {q[worst]:.6g} {unit}, expected {chain.lower[worst]:.6g} to "
        f"{chain.upper[worst]:.6g} {unit}"
    )
    return [inside], reason if inside[worst] != q[worst] else "", code


def _of_pose(target: PoseTarget, chain: SerialChain, start: Array) -> tuple[list[Array], str, int]:
    """Return all postures that bring a link to a pose, in all windings of its joints."""
    own = target.chain
    index = [chain.joint_names.index(name) for name in own.joint_names]
    options: dict[str, Any] = {}
    if not all(target.task_mask):
        options["task_mask"] = target.task_mask
    if own.n < _FULL_POSE:
        # Such an arm reaches few poses exactly.
        tolerances = {
            "position_tolerance": target.position_tolerance,
            "orientation_tolerance": target.orientation_tolerance,
        }
        options |= {name: value for name, value in tolerances.items() if value > 0.0}
    result = inverse_kinematics(
        own, target.pose, seed=start[index], include_windings=True, **options
    )
    rows = np.tile(start, (len(result), 1))
    rows[:, index] = result.q
    return list(rows), result.reason, int(MoveItErrorCodes.NO_IK_SOLUTION)


def _message(question: MotionRequest, timed: Waypoints, settings: MoveGroupSettings) -> Any:
    """Make the message of a motion; slower, if a link would be too fast."""
    assert timed.velocities is not None
    assert timed.accelerations is not None
    slower = _slower(question, timed.times, timed.positions)
    duration = slower * float(timed.times[-1])
    if duration > settings.max_duration:
        text = f"the motion takes {duration:.6g} s, up to {settings.max_duration:g} s are allowed"
        raise RejectedError(MoveItErrorCodes.PLANNING_FAILED, f"{text} by max_duration")
    return joint_trajectory(
        question.chain.joint_names,
        timed.times * slower,
        timed.positions,
        timed.velocities / slower,
        timed.accelerations / slower**2,
    )


def _slower(question: MotionRequest, times: Array, q: Array) -> float:
    """Return the time factor of a motion q (m, n) for the link to keep its speed limit."""
    if math.isinf(question.speed) or times[-1] == 0.0:
        return 1.0
    names = question.chain.joint_names
    moving = dict(zip(names, q.T, strict=True))
    rows = [
        moving.get(name, np.full(len(q), question.positions[name]))
        for name in question.limited.joint_names
    ]
    places = forward_kinematics(question.limited, np.stack(rows, axis=-1))[:, :3, 3]
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
    return max(1.0, float(speeds.max()) / question.speed)
