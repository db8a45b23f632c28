"""The node that plans motions in joint space within the limits of every joint."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from nav_msgs.msg import Path
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import PlanJoint
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.error_codes import answer, guarded
from robomech_ros.nodes.joint_positions import JointPositions
from robomech_ros.nodes.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.parameters import NodeParameters, parameter
from robomech_ros.nodes.plan_messages import SHORTEST_PERIOD, encode_plan, plan_options, tip_path
from robomech_ros.nodes.robot_description import RobotModel, RobotSettings, when_robot_known
from robomech_ros.nodes.run import run_node
from robomech_ros.trajectory import PROFILES, SampledPlan, sampled_point_to_point

_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class PlannerSettings(RobotSettings):
    """Parameters of the node."""

    sample_period: float = parameter(
        0.01,
        "Largest time between two points of a planned trajectory, where a request names none",
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


class TrajectoryPlannerNode(Node):
    """Plans motions from point to point within the limits of every joint."""

    SETTINGS = PlannerSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("trajectory_planner", **options)
        self._table = NodeParameters(self, PlannerSettings)
        self._monitor = JointStateMonitor(self)
        when_robot_known(self, self._table.settings, self._serve)

    def _serve(self, model: RobotModel) -> None:
        self._chain = model.chain
        self._joints = JointPositions(model, self._monitor)
        self._warm_up()
        self._trajectories = self.create_publisher(
            JointTrajectory, "~/planned_trajectory", _LATCHED
        )
        self._paths = self.create_publisher(Path, "~/planned_path", _LATCHED)
        self.create_service(PlanJoint, "~/plan_joint", self._plan_joint)
        profiles = ", ".join(name.upper() for name in PROFILES)
        self.get_logger().info(
            f"ready: {model.chain.name}, {model.chain.n} joints, profiles: {profiles}"
        )

    def _warm_up(self) -> None:
        """Plan once with every profile, so that the first request finds all in memory."""
        here = self._chain.midrange()
        for profile in PROFILES:
            with suppress(RobomechError):  # limits that are missing are told to who asks
                plan = sampled_point_to_point(
                    here, here, limits=self._chain, profile=profile, period=0.1, max_points=10
                )
                tip_path(self._chain, plan.waypoints.positions)

    @guarded
    def _plan_joint(self, request: Any, response: Any) -> Any:
        settings = self._table.settings
        options = plan_options(request, settings.sample_period)
        goal = self._joints.given(self._chain, request.goal, "goal")
        start = self._joints.given_or_present(self._chain, request.start, "start")
        plan = sampled_point_to_point(
            start, goal, limits=self._chain, max_points=settings.max_points, **options
        )
        encode_plan(plan, self._chain, options, response)
        self._publish_soon(response.trajectory, plan)
        return answer(response)

    def _publish_soon(self, trajectory: JointTrajectory, plan: SampledPlan) -> None:
        """Publish the plan after the answer has left."""

        def publish() -> None:
            self._trajectories.publish(trajectory)
            self._paths.publish(tip_path(self._chain, plan.waypoints.positions))

        if self.executor is None:
            publish()
        else:
            self.executor.create_task(publish)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(TrajectoryPlannerNode, args)


if __name__ == "__main__":
    raise SystemExit(main())
