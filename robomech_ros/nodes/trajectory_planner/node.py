"""The node that plans motions in joint space within the limits of every joint."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanCartesian, PlanJoint
from robomech_ros.errors import BadValueError, MissingLimitsError, RobomechError
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.cartesian_planning import (
    FollowedPath,
    follow,
    load_inverse_kinematics,
    plan_along,
)
from robomech_ros.nodes.common.error_codes import answer, guarded
from robomech_ros.nodes.common.joint_limits import NoLimitsForPlanError, read_joint_limits
from robomech_ros.nodes.common.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.joint_positions import JointPositions, StateSettings, is_empty
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.parameters import NodeParameters, parameter
from robomech_ros.nodes.common.pauses import Worker
from robomech_ros.nodes.common.plan_sampling import plan_that_fits
from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel, when_robot_known
from robomech_ros.nodes.common.waypoint_paths import path_through
from robomech_ros.nodes.moveit import add_cartesian_path_service
from robomech_ros.nodes.process.compiler_pages import release_compiler_pages
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.trajectory_planner.cartesian_messages import (
    encode_path_plan,
    path_bounds,
    path_profile,
    tip_speeds,
    waypoint_poses,
)
from robomech_ros.nodes.trajectory_planner.plan_messages import (
    OFFERED,
    SHORTEST_PERIOD,
    encode_plan,
    plan_options,
    plan_points,
    via_points,
    wanted_period,
)
from robomech_ros.nodes.trajectory_planner.planned_path import PlannedPath
from robomech_ros.trajectory import (
    PROFILES,
    Limits,
    SampledPlan,
    sampled_through_points,
)


@dataclass(frozen=True)
class PlannerSettings(StateSettings):
    """Parameters of the node."""

    joint_limits: str = parameter(
        "",
        "Path of a YAML file with limits that the robot's description lacks: MoveIt's "
        "joint_limits.yaml, or the form of a file beside a URDF. Empty = none",
    )
    sample_period: float = parameter(
        0.01,
        "Largest time between two points of a planned trajectory, where a request names none; "
        "longer where a trajectory would otherwise have too many",
        SHORTEST_PERIOD,
        10.0,
        "s",
        read_only=False,
    )
    max_points: int = parameter(
        10_000,
        "Most points of a planned trajectory; a request that needs more is refused",
        10,
        1_000_000,
        "points",
        read_only=False,
    )
    max_duration: float = parameter(
        3600.0,
        "Longest trajectory; a request that needs more is refused",
        0.001,
        1e6,
        "s",
        read_only=False,
    )
    max_waypoints: int = parameter(
        200,
        "Most via points, or waypoints of a Cartesian path; planning takes up to some 60 ms for "
        "each of them, in which other such requests wait",
        1,
        100_000,
        "points",
        read_only=False,
    )
    max_step: float = parameter(
        0.01,
        "Along a Cartesian path, where a request names none: distance of neighbouring poses "
        "between which no joint may jump",
        1e-4,
        1.0,
        "m",
        read_only=False,
    )
    revolute_jump_threshold: float = parameter(
        0.5,
        "Largest move of a revolute joint between neighbouring poses, where a request names none",
        1e-3,
        10.0,
        "rad",
        read_only=False,
    )
    prismatic_jump_threshold: float = parameter(
        0.1,
        "Largest move of a prismatic joint between neighbouring poses, where a request names none",
        1e-4,
        10.0,
        "m",
        read_only=False,
    )
    condition_limit: float = parameter(
        200.0,
        "Condition number of the Jacobian, lengths over the size of the arm, at which a posture "
        "counts as singular, where a request names none",
        1.0,
        1e6,
        read_only=False,
    )
    stopped_velocity_tolerance: float = parameter(
        0.01,
        "How fast a joint may be, rad/s or m/s, where a motion is to start from the present "
        "state; every plan starts at rest",
        0.0,
        10.0,
        read_only=False,
    )


class TrajectoryPlannerNode(Node):
    """Plans motions, through via points where wanted, within the limits of every joint."""

    SETTINGS = PlannerSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("trajectory_planner", **options)
        self._table = NodeParameters(self, PlannerSettings)
        self._monitor = JointStateMonitor(self)
        # Plans through many points, and paths, take seconds.
        self._worker = Worker(self)
        settings = self._table.settings
        limits = read_joint_limits(settings.joint_limits) if settings.joint_limits else None
        when_robot_known(self, settings, self._serve, limits.on if limits else None)

    def _serve(self, model: RobotModel) -> None:
        self._model, self._chain = model, model.chain
        self._limits = Limits.of(model.chain)
        self._joints = JointPositions(model, self._monitor)
        self._points = TrajectoryPoints()
        self._unpublished: tuple[JointTrajectory, SampledPlan] | None = None
        self._plan_once("poly345")
        self._trajectories = self.create_publisher(JointTrajectory, "~/planned_trajectory", LATCHED)
        self._path = PlannedPath(self, model.chain)
        # While one request waits for a joint state, others are served.
        for kind, name, callback in (
            (PlanJoint, "~/plan_joint", self._plan_joint),
            (PlanCartesian, "~/plan_cartesian", self._plan_cartesian),
        ):
            self.create_service(kind, name, callback, callback_group=ReentrantCallbackGroup())
        moveit = add_cartesian_path_service(
            self, model, self._monitor, lambda: self._table.settings, self._worker
        )
        self.get_logger().info(
            f"ready: {model.chain.name}, {model.chain.n} joints, profiles: {OFFERED}"
            f"{', compute_cartesian_path' if moveit else ''}"
        )
        self._warm_up()

    def stop(self) -> None:
        """Answer those who wait for a plan."""
        self._worker.give_up(TrajectoryRefusedError("the trajectory planner shuts down"))

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
        self._worker.begin(load_inverse_kinematics)
        self._worker.begin(release_compiler_pages)

    def _plan_once(self, profile: str, via: bool = True) -> None:
        """Plan, also through a via point if wanted, so that the next request finds all loaded."""
        here = self._chain.midrange()
        near = here + 1e-3 * np.minimum(self._chain.upper - here, 1.0)
        for points in ([here, near], [here, near, here])[: 1 + via]:
            with suppress(RobomechError):  # limits that are missing are told to who asks
                sampled_through_points(
                    points, limits=self._limits, profile=profile, period=0.1, max_points=10_000
                )

    @guarded
    async def _plan_joint(self, request: Any, response: Any) -> Any:
        settings = self._table.settings
        options = plan_options(request, settings.max_duration)
        via = via_points(request, self._limits, settings.max_waypoints)
        goal = self._joints.given(self._chain, request.goal, "goal")
        period = wanted_period(request)
        start = await self._start(request.start, settings)
        points = plan_points(start, via, goal, self._limits)

        def planned() -> SampledPlan:
            return plan_that_fits(
                self._limits,
                points,
                wanted_period=period,
                usual_period=settings.sample_period,
                max_points=settings.max_points,
                max_duration=settings.max_duration,
                **options,
            )

        try:
            plan = await self._worker.do(planned) if len(via) else planned()
        except MissingLimitsError as error:
            raise NoLimitsForPlanError(error) from None
        self._publish()
        encode_plan(plan, self._limits, options, self._points, response)
        self._publish_soon(response.trajectory, plan)
        return answer(response)

    @guarded
    async def _plan_cartesian(self, request: Any, response: Any) -> Any:
        settings = self._table.settings
        profile, speeds = path_profile(request.profile), tip_speeds(request)
        bounds = path_bounds(request, settings)
        poses = waypoint_poses(request, self._model, settings.max_waypoints)
        start = await self._start(request.start, settings)
        path = path_through(forward_kinematics(self._chain, start), poses, request.path)
        if path is None:
            given, expected = f"{len(poses)} poses equal to the start", "at least one other pose"
            raise BadValueError("waypoints", given, expected)

        def planned() -> tuple[FollowedPath, SampledPlan | None]:
            followed = follow(self._chain, path, poses, start, bounds)
            return followed, plan_along(
                self._chain,
                followed,
                profile=profile,
                speeds=speeds,
                limits=self._limits,
                usual_period=settings.sample_period,
                max_points=settings.max_points,
                max_duration=settings.max_duration,
            )

        try:
            followed, plan = await self._worker.do(planned)
        except MissingLimitsError as error:
            raise NoLimitsForPlanError(error) from None
        self._publish()
        encode_path_plan(followed, plan, self._chain.joint_names, self._points, response)
        # What ends on the way is for who asked to judge, not to be executed as it comes.
        if plan is not None and response.error_code == ErrorCode.NONE:
            self._publish_soon(response.trajectory, plan)
        return response

    async def _start(self, given: JointState, settings: PlannerSettings) -> NDArray[np.float64]:
        if not is_empty(given):
            return self._joints.given(self._chain, given, "start")
        return await self._joints.at_rest(
            self._chain, settings.state_timeout, settings.stopped_velocity_tolerance
        )

    def _publish_soon(self, trajectory: JointTrajectory, plan: SampledPlan) -> None:
        """Publish the plan after the answer has left, before the next one is encoded."""
        self._unpublished = (trajectory, plan)
        if self.executor is None:
            self._publish()
        else:
            self.executor.create_task(self._publish)

    def _publish(self) -> None:
        """Publish the plan that is not published yet, if there is one."""
        if self._unpublished is None:
            return
        trajectory, plan = self._unpublished
        self._unpublished = None
        self._trajectories.publish(trajectory)
        self._path.show(plan.waypoints.positions)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(TrajectoryPlannerNode, args)


if __name__ == "__main__":
    raise SystemExit(main())
