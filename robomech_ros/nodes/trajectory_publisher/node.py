"""The node that sends planned trajectories to the controller and sees whether the robot arrives."""

from functools import partial
from typing import Any

from rclpy.node import Node

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.execute_goals import ExecuteGoals
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.status_report import NodeHealth, StatusReport
from robomech_ros.nodes.middleware.liveliness import LivelinessMonitor
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.trajectory_publisher.action_transport import ActionTransport
from robomech_ros.nodes.trajectory_publisher.controller_client import (
    ControllerClient,
    ControllerRefusals,
)
from robomech_ros.nodes.trajectory_publisher.dispatch_loop import DispatchLoop
from robomech_ros.nodes.trajectory_publisher.execute_service import ExecuteService
from robomech_ros.nodes.trajectory_publisher.messages import ExecutionReader
from robomech_ros.nodes.trajectory_publisher.program_runner import ProgramRunner
from robomech_ros.nodes.trajectory_publisher.program_service import (
    ProgramService,
    check_program_change,
)
from robomech_ros.nodes.trajectory_publisher.received_plans import ReceivedPlans
from robomech_ros.nodes.trajectory_publisher.scene_check import SceneCheck
from robomech_ros.nodes.trajectory_publisher.settings import (
    PublisherSettings,
    action_goals,
    answering_transport,
    asked_tolerances,
)
from robomech_ros.nodes.trajectory_publisher.speed_services import SpeedServices


class TrajectoryPublisherNode(Node):
    """Sends planned trajectories to the controller, in order, and reports how they ended."""

    SETTINGS = PublisherSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("trajectory_publisher", **options)
        self._table = table = NodeParameters(self, PublisherSettings, check=self._check)
        settings, clock = table.settings, MotionClock(self)
        transport = answering_transport(settings)
        limits = settings.max_points, settings.max_duration
        self._action = action = ActionTransport(
            self,
            settings.controller,
            action_goals(transport),
            asked_tolerances(settings),
            self._take_result,
        )
        refusals = ControllerRefusals(self, settings.controller, self._take_result)
        action_name = f"{settings.controller}/{ExecuteGoals.name}"
        monitor = JointStateMonitor(self)
        # Reports of a controller do not hold for the joints of the next.
        life = LivelinessMonitor(self, action_name, settings.controller_lease, monitor.forget)
        self._link = ControllerClient(
            self, settings.controller, clock, action, refusals, life, monitor
        )
        self._scene = SceneCheck(self, monitor, lambda: table.settings)
        self._loop = DispatchLoop(self, clock, self._link, settings, self._scene.obstruction)
        self._reader = ExecutionReader(clock, *limits)
        self._plans = ReceivedPlans(self, table, self._reader, self._loop)
        ExecuteService(self, settings, self._plans, self._link)
        self._runner = ProgramRunner(self, clock, self._loop.offer, transport, limits)
        self._programs = ProgramService(self, table, self._runner, self._loop, self._link)
        SpeedServices(self, self._loop, self._runner.cancel, self._plans.give_up)
        if settings.robot_description:
            when_robot_known(self, settings, self._know_robot, parallel=True)
        else:
            # Who only sends trajectories needs no robot.
            Readiness(self)
        self._status = StatusReport(self, "execution", settings.controller, self._condition)
        how = f"by {settings.transport}" if settings.auto_execute else "on request only"
        self.get_logger().info(f"ready: sends trajectories to '{settings.controller}', {how}")

    def _check(self, settings: PublisherSettings) -> None:
        check_program_change(self._table.settings, settings)

    def _know_robot(self, model: RobotModel) -> None:
        self._link.know_robot(model)
        self._reader.robot_joints = tuple(model.joint_names)
        self._programs.model = model
        self._scene.know_robot(model)

    def _take_result(self, execution: ExecutionRequest, code: int, text: str) -> None:
        self._loop.conclude(execution, code, text)

    def _condition(self) -> NodeHealth:
        """Describe what is executed; a warning while something waits, and after a failure."""
        dispatcher, refusal = self._loop.dispatcher, self._plans.refusal
        tally = dispatcher.tally
        trouble = dispatcher.queue.stalled or refusal or tally.last_failure
        summary = "executing" if dispatcher.current is not None else "idle"
        summary = "paused" if dispatcher.paused else summary
        values = {
            "speed": f"{dispatcher.speed:g}",
            "waiting": len(dispatcher.queue),
            "sent": tally.sent,
            "arrived": tally.arrived,
            "failed": tally.failed,
            "last failure": tally.last_failure,
            "last refusal": refusal,
            "program": self._runner.condition,
        }
        return NodeHealth(f"{summary}; {trouble}" if trouble else summary, bool(trouble), values)

    def stop(self) -> None:
        """Answer the waiting requests; a motion that was sent goes on."""
        reason = "the trajectory publisher shuts down"
        self._programs.give_up(reason)
        self._runner.cancel(reason)
        self._loop.dispatcher.close(reason)
        # Who sent a plan by topic has no answer to wait for.
        self._status.publish()

    def destroy_node(self) -> None:
        """Destroy the node and, what rclpy leaves out, its action client."""
        if hasattr(self, "_action"):
            self._action.destroy()
        if hasattr(self, "_scene"):
            self._scene.destroy()
        if hasattr(self, "_programs"):
            self._programs.destroy()
        super().destroy_node()


main = partial(run_node, TrajectoryPublisherNode)

if __name__ == "__main__":
    raise SystemExit(main())
