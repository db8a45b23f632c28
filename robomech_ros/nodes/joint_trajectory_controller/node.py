"""The simulated robot: follows trajectories as ros2_control's joint_trajectory_controller does."""

import traceback
from collections.abc import Sequence
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.follower import Phase
from robomech_ros.execution.controller.trajectory_goal import End, Outcome
from robomech_ros.nodes.common.error_codes import code_of
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.pauses import wake
from robomech_ros.nodes.common.robot_description import RobotModel, when_robot_known
from robomech_ros.nodes.common.status_report import StatusReport
from robomech_ros.nodes.joint_trajectory_controller.condition import robot_condition
from robomech_ros.nodes.joint_trajectory_controller.control_interfaces import ControlInterfaces
from robomech_ros.nodes.joint_trajectory_controller.cycles import Cycles
from robomech_ros.nodes.joint_trajectory_controller.execute_action import ExecuteAction
from robomech_ros.nodes.joint_trajectory_controller.fault_settings import faults_of
from robomech_ros.nodes.joint_trajectory_controller.frame_publisher import frame_publisher
from robomech_ros.nodes.joint_trajectory_controller.goal_server import GoalServer
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    ControllerSettings,
    check_simulation,
)
from robomech_ros.nodes.joint_trajectory_controller.state_publisher import StatePublisher
from robomech_ros.nodes.process.run import run_node
from robomech_ros.outcomes import Code, name_of

_DEPTH = 10
_SHUTS_DOWN = "the controller shuts down; the robot holds"
# How long the robot may take to slow down when the node ends, s; then it holds at once.
_LONGEST_STOP = 2.0
_STEADY = ClockType.STEADY_TIME
# A stream replaces its trajectory a hundred times a second: that is said this often at the most, s.
_SELDOM = 5.0


class JointStateSimulatorNode(Node):
    """A simulated robot that executes joint trajectories and publishes joint_states."""

    SETTINGS = ControllerSettings

    def __init__(self, **options: Any) -> None:
        self._servers: list[GoalServer] = []
        self._robot: SimulatedRobot | None = None
        self._cycles: Cycles | None = None
        super().__init__("joint_trajectory_controller", **options)
        self._settings = NodeParameters(
            self, ControllerSettings, self._change, self._check
        ).settings
        self._standing: Future | None = None
        when_robot_known(self, self._settings, self._serve)

    def _serve(self, model: RobotModel) -> None:
        clock = MotionClock(self)
        robot = self._robot = SimulatedRobot(model.chain, self._settings, clock)
        robot.follower.simulation.inject(faults_of(self._settings, model.chain))
        self._states = StatePublisher(self, model, robot.dynamic)
        self._frames = frame_publisher(self, model.description, self._settings.publish_frames)
        self._servers = [GoalServer(self, robot, ExecuteAction(robot.joint_names))]
        self._control = ControlInterfaces(self, robot, clock)
        self._servers += self._control.servers
        hardware = f"{model.chain.name} (simulated)"
        StatusReport(self, "motion", hardware, lambda: robot_condition(robot))
        self.create_subscription(JointTrajectory, "~/joint_trajectory", self._take, _DEPTH)
        self.create_service(Trigger, "~/hold", self._hold)
        self.create_service(Trigger, "~/reset", self._reset)
        rate = self._settings.publish_rate
        self._feedback_cycles = max(round(rate / self._settings.action_monitor_rate), 1)
        self._frame_cycles = max(round(rate / self._settings.frame_rate), 1)
        self._state_cycles = max(round(rate / self._settings.state_publish_rate), 1)
        self._cycle = 0
        self._limited = False
        self._cycles = Cycles(self, clock, rate, self._tick)
        kind = f" by {self._settings.dynamic_control}" if robot.dynamic else ""
        self.get_logger().info(
            f"ready: {model.chain.name} simulated{kind}, {model.chain.n} joints at {rate:g} Hz"
        )
        if unlimited := robot.unlimited_joints():
            text = (
                f"no effort limit is known of {', '.join(unlimited)}: nothing limits their drives"
            )
            self.get_logger().warning(text)

    def _change(self, settings: ControllerSettings) -> None:
        """Have the simulated joints the faults and the payload that were asked for at run time."""
        self._settings = settings
        if self._robot is not None:
            faults = faults_of(settings, self._robot.chain)
            with self._robot.lock:
                self._robot.follower.simulation.inject(faults)
                self._robot.carry(settings)

    def _check(self, settings: ControllerSettings) -> None:
        """Refuse faults and payloads that the robot cannot have."""
        check_simulation(settings)
        if self._robot is not None:
            faults_of(settings, self._robot.chain)

    def _tick(self) -> None:
        robot = self._robot
        assert robot is not None
        with robot.lock:
            self._move(robot)

    def _move(self, robot: SimulatedRobot) -> None:
        """Move on, and tell what is due in this cycle."""
        try:
            robot.advance()
        except RobomechError as error:
            self.get_logger().error(str(error), throttle_duration_sec=_SELDOM)
            robot.follower.halt(Code.PATH_TOLERANCE, str(error))
        except Exception:
            self.get_logger().error(f"motion failed, please report:\n{traceback.format_exc()}")
            robot.follower.halt(Code.INTERNAL, "internal error of the controller, see its log")
        self._publish_state(robot)
        self._tell_saturation(robot)
        self._tell_standing()
        self._cycle += 1
        if self._frames is not None and self._cycle % self._frame_cycles == 0:
            self._frames.publish(self._states.positions)
        if self._cycle % self._state_cycles == 0:
            self._control.publish()
        if self._cycle % self._feedback_cycles == 0:
            for server in self._servers:
                server.publish_feedback()

    def _publish_state(self, robot: SimulatedRobot) -> None:
        follower = robot.follower
        self._states.publish(follower.actual, follower.simulation.effort, robot.stamp())

    def _tell_saturation(self, robot: SimulatedRobot) -> None:
        """Log once in each motion that drives are at their limits."""
        limited = bool(robot.follower.simulation.at_limit.any())
        if limited and not self._limited:
            text = f"the robot may not follow: {robot.saturation()} so far"
            self.get_logger().warning(text, throttle_duration_sec=_SELDOM)
        self._limited = limited

    def _take(self, trajectory: JointTrajectory) -> None:
        assert self._robot is not None
        try:
            by = "a trajectory on the topic joint_trajectory"
            self._robot.execute(trajectory, by, self._log_end)
        except RobomechError as error:
            code = code_of(error)
            self.get_logger().error(f"trajectory refused ({code} {name_of(code)}): {error}")

    def _log_end(self, outcome: Outcome) -> None:
        if outcome.code:
            self.get_logger().warning(
                f"trajectory ended early: {outcome.text}", throttle_duration_sec=_SELDOM
            )

    def _hold(self, request: Any, response: Any) -> Any:
        assert self._robot is not None
        text = "stopped by the service hold"
        with self._robot.lock:
            stopped = self._robot.follower.stop(End.ABORTED, Code.PREEMPTED, text)
        response.success = True
        response.message = "the robot slows down and holds" if stopped else "the robot holds"
        return response

    def _reset(self, request: Any, response: Any) -> Any:
        assert self._robot is not None
        with self._robot.lock:
            self._robot.advance()
            self._robot.reset("ended by the service reset")
            self._publish_state(self._robot)
        response.success = True
        response.message = "the robot is at its initial position"
        return response

    async def stop(self) -> None:
        """Slow down and hold, say so, abort what was to be done, and let the clients know."""
        robot = self._robot
        if robot is None:
            return
        # By the machine's time: simulated time may stand still.
        deadline = self.create_timer(_LONGEST_STOP, self._halt, clock=Clock(clock_type=_STEADY))
        standing: Future = Future()
        with robot.lock:
            robot.refuse_all = _SHUTS_DOWN
            self._standing = standing
            robot.follower.stop(End.ABORTED, Code.PREEMPTED, _SHUTS_DOWN)
            self._tell_standing()
        await standing
        self.destroy_timer(deadline)
        with robot.lock:
            robot.advance()
            self._publish_state(robot)
        for server in self._servers:
            await server.all_ended()

    def _halt(self) -> None:
        """Hold at once."""
        assert self._robot is not None
        with self._robot.lock:
            self._robot.follower.halt(Code.PREEMPTED, _SHUTS_DOWN)
            self._tell_standing()

    def _tell_standing(self) -> None:
        """Let `stop` go on as soon as the robot stands."""
        assert self._robot is not None
        standing = self._robot.follower.phase is Phase.HOLDING
        if self._standing is not None and standing and not self._standing.done():
            self._standing.set_result(None)
            wake(self)

    def destroy_node(self) -> None:
        """Destroy the node and, what rclpy leaves out, its cycles and action servers."""
        if self._cycles is not None:
            self._cycles.stop()
        for server in self._servers:
            server.destroy()
        super().destroy_node()


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(JointStateSimulatorNode, args)


if __name__ == "__main__":
    raise SystemExit(main())
