"""The node that plans motions within the limits of every joint."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_interfaces.srv import PlanCartesian, PlanJoint
from robomech_ros.cartesian import Sampling
from robomech_ros.errors import BadValueError, MissingLimitsError, RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_limits import NoLimitsForPlanError, robot_limits
from robomech_ros.nodes.common.joints.joint_positions import JointPositions, is_empty
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.robot.floating_base import FloatingRobot
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.move_group.monitored_scene import MonitoredScene
from robomech_ros.nodes.process.memory import settle_pages
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.trajectory_planner.cartesian_messages import (
    encode_path_plan,
    in_base,
    read_path_request,
)
from robomech_ros.nodes.trajectory_planner.chain_motions import ChainMotions
from robomech_ros.nodes.trajectory_planner.plan_messages import (
    OFFERED,
    encode_plan,
    plan_points,
    read_plan_request,
)
from robomech_ros.nodes.trajectory_planner.plans_around import ending_before_contact, plan_around
from robomech_ros.nodes.trajectory_planner.publication import PlanPublication
from robomech_ros.nodes.trajectory_planner.settings import PlannerSettings
from robomech_ros.trajectory import PROFILES, nearest_turns, sampled_through_points
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.nodes.trajectory_planner.platform_motions import PlatformMotions

_P = TypeVar("_P")


class TrajectoryPlannerNode(Node):
    """Plans motions, through via points where wanted, within the limits of every joint."""

    SETTINGS = PlannerSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("trajectory_planner", **options)
        # Plans through many points, and paths, take seconds.
        self._worker = Worker(self)
        self._table = NodeParameters(self, PlannerSettings)
        self._monitor = JointStateMonitor(self)
        settings = self._table.settings
        when_robot_known(self, settings, self._serve, parallel=True, **robot_limits(self, settings))

    def _serve(self, model: RobotModel) -> None:
        self._joints = JointPositions(model, self._monitor)
        self._motions = _motions_of(model, self._joints)
        self._model, self._floating = model, FloatingRobot(model, self._table.settings)
        self._limits = self._motions.limits
        self._frames = RobotFrames(self, model, self._monitor, lambda: self._table.settings)
        self._points = TrajectoryPoints()
        self._scene = MonitoredScene(self, model, self._monitor, self._worker)
        self._plan_once("poly345")
        self._plans = PlanPublication(self, model)
        # While one request waits for a joint state or a frame, others are served.
        for kind, name, callback in (
            (PlanJoint, "~/plan_joint", self._plan_joint),
            (PlanCartesian, "~/plan_cartesian", self._plan_cartesian),
        ):
            serve(self, kind, name, callback, callback_group=ReentrantCallbackGroup())
        count = len(self._limits.joint_names)
        self.get_logger().info(
            f"ready: {model.chain.name}, {counted(count, 'joint')}, profiles: {OFFERED}"
        )
        self._warm_up()

    def stop(self) -> None:
        """Answer all requests that wait for a plan."""
        self._worker.give_up("the trajectory planner shuts down")

    def destroy_node(self) -> None:
        """Take leave of ROS, and of the thread for long work."""
        self._worker.close()
        super().destroy_node()

    def _warm_up(self) -> None:
        """Load what later requests would wait for, while the first ones are served."""
        for profile in PROFILES:
            # The search for the best knots of a spline is left to who first asks for it: it takes
            # 20 MB and a third of a second to load.
            self._worker.begin(partial(self._plan_once, profile, profile != "cubic_spline"))
        self._worker.begin(self._motions.warm_up)
        self._worker.begin(settle_pages)

    def _plan_once(self, profile: str, via: bool = True) -> None:
        """Plan, also through a via point if wanted, so that the next request finds all loaded."""
        here = self._limits.ranges.mean(axis=0)
        near = here + 1e-3 * np.minimum(self._limits.ranges[1] - here, 1.0)
        for points in ([here, near], [here, near, here])[: 1 + via]:
            with suppress(RobomechError):  # requests that need missing limits get the error
                sampled_through_points(
                    points, limits=self._limits, profile=profile, period=0.1, max_points=10_000
                )

    async def _plan_joint(self, request: Any, response: Any) -> Any:
        settings = self._table.settings
        via, wanted = read_plan_request(request, self._limits, settings)
        goal, posture = self._motions.read_goal(request.goal)
        start = await self._start(request.start, settings)
        given = plan_points(self._motions.commanded(start), via, goal, self._limits)
        points, turns = given, np.zeros(given.shape, dtype=np.int64)
        if self._limits.continuous.any() and not request.keep_turns:
            points, turns = nearest_turns(given, self._limits.continuous)
        options = {**wanted, **settings.most, "usual_period": settings.sample_period}
        plan = partial(self._motions.through, points, start, posture, options)
        scene = await self._scene.of(self._motions.way, request.ignore_collisions)
        if scene is not None:
            plan = partial(plan_around, scene.copy(), plan, points, options)
        found = await self._planned(plan, beside=len(via) > 0 or scene is not None)
        self._plans.publish_waiting()
        response.turns = turns[-1].tolist()
        encode_plan(found.sampled, self._limits, wanted, self._points, response)
        if not request.answer_only:
            self._plans.publish_soon(response.trajectory, found.poses)
        return self._scene.add_note(scene, answer(response))

    async def _plan_cartesian(self, request: Any, response: Any) -> Any:
        settings = self._table.settings
        asked = read_path_request(request, settings)
        start = await self._start(request.start, settings)
        at = dict(zip(self._motions.way.joint_names, start.tolist(), strict=True))
        wanted = await in_base(asked, request, self._frames, at, settings.state_timeout)
        path = wanted.path_from(self._motions.tip_pose(start))
        sampling = Sampling(settings.sample_period, **settings.most)
        options = {**wanted.options, "sampling": sampling}
        scene = await self._scene.of(self._motions.way, request.ignore_collisions)
        if scene is not None:
            options["bounds"] = ending_before_contact(scene.copy(), start, options["bounds"])
        kept = 1.0 - settings.limit_margin
        plan = partial(self._motions.along, path, start, kept, options)
        frames = [one.header.frame_id for one in request.waypoints]
        if self._floating.floats and self._are_apart(frames):
            # Compiled code is loaded only for such a robot.
            from robomech_ros.nodes.common.robot.inertial_paths import plan_inertial

            robot = self._floating.carrying(self._model.chain)
            plan = partial(plan_inertial, robot, path, start, kept=kept, **options)
        found = await self._planned(plan, beside=True)
        self._plans.publish_waiting()
        encode_path_plan(found, wanted, self._limits.joint_names, self._points, response)
        # The client judges a partial path; it is not executed unasked.
        if found.sampled is not None and found.stop is None:
            poses = partial(self._motions.poses_along, found)
            self._plans.publish_soon(response.trajectory, poses)
        return self._scene.add_note(scene, response)

    def _are_apart(self, frames: list[str]) -> bool:
        """Return whether frames stay in inertial space, or move with the floating base."""
        apart = [self._frames.is_apart(frame) for frame in frames]
        if any(apart) and not all(apart):
            expected = "all in inertial space, or all in frames of the robot: its base floats"
            raise BadValueError("frames of the waypoints", ", ".join(frames), expected)
        return all(apart)

    async def _planned(self, plan: Callable[[], _P], *, beside: bool) -> _P:
        """Plan, beside serving others where that takes long; say where missing limits go."""
        try:
            return await self._worker.do(plan) if beside else plan()
        except MissingLimitsError as error:
            raise NoLimitsForPlanError(error) from None

    async def _start(self, given: JointState, settings: PlannerSettings) -> Array:
        way = self._motions.way
        if is_empty(given):
            tolerance = settings.stopped_velocity_tolerance
            return await self._joints.at_rest(way, settings.state_timeout, tolerance)
        start = self._joints.read(way, given, "start")
        self._motions.check_start(start)
        return start


def _motions_of(model: RobotModel, joints: JointPositions) -> "ChainMotions | PlatformMotions":
    if model.mechanism is None:
        return ChainMotions(model.chain, joints)
    from robomech_ros.nodes.trajectory_planner.platform_motions import PlatformMotions

    return PlatformMotions(model.mechanism, joints)


main = partial(run_node, TrajectoryPlannerNode)

if __name__ == "__main__":
    raise SystemExit(main())
