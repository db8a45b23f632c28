"""The simulated robot: follows trajectories as ros2_control's joint_trajectory_controller does."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.errors.formatting import counted
from robomech_ros.execution.controller.follower import Phase
from robomech_ros.execution.controller.simulated_joints import Faults
from robomech_ros.nodes.common.cooperative_wait import steady_timer, wake
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters, ParameterError
from robomech_ros.nodes.common.robot.floating_base import FloatingRobot
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.status_report import StatusReport
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.commands import Commands, TrajectoryTopic
from robomech_ros.nodes.joint_trajectory_controller.constraints import (
    CONSTRAINTS,
    constraint_rows,
    default_tolerances,
)
from robomech_ros.nodes.joint_trajectory_controller.control_cycle import (
    ControlCycle,
    Cycles,
    serve_control,
)
from robomech_ros.nodes.joint_trajectory_controller.diagnostics import (
    gripper_condition,
    robot_condition,
)
from robomech_ros.nodes.joint_trajectory_controller.goal_server import ExecuteMessages, GoalServer
from robomech_ros.nodes.joint_trajectory_controller.gripper.gripper import Gripper, gripper_of
from robomech_ros.nodes.joint_trajectory_controller.gripper.interfaces import serve_gripper
from robomech_ros.nodes.joint_trajectory_controller.robot import (
    SimulatedRobot,
    legged_robot,
    serial_robot,
)
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    ControllerSettings,
    check_simulation,
    faults_of,
)
from robomech_ros.nodes.joint_trajectory_controller.state_publisher import ReportedEfforts
from robomech_ros.nodes.process.run import run_node
from robomech_ros.outcomes import Code

_SHUTDOWN_TEXT = "the controller shuts down; the robot holds"
# How long the robot may take to slow down when the node ends, s; then it holds at once.
_LONGEST_STOP = 2.0


class Shutdown:
    """Stops the robot and waits until it stands.

    - ``node``: the node that ends.
    - ``commanded``: the joints to stop; they share a lock.
    """

    def __init__(self, node: Node, commanded: Sequence[CommandedJoints]) -> None:
        self._node, self._commanded = node, commanded
        self._lock = commanded[0].lock
        self._standing: Future | None = None

    async def stand(self) -> None:
        """Refuse all trajectories from now on, slow down, and hold."""
        deadline = steady_timer(self._node, _LONGEST_STOP, self._halt)
        standing: Future = Future()
        with self._lock:
            self._standing = standing
            for joints in self._commanded:
                joints.close(_SHUTDOWN_TEXT)
            self.look()
        await standing
        self._node.destroy_timer(deadline)

    def look(self) -> None:
        """Resume `stand` once the robot stands still; the joints' lock must be held."""
        standing = all(joints.follower.phase is Phase.HOLDING for joints in self._commanded)
        if self._standing is not None and standing and not self._standing.done():
            self._standing.set_result(None)
            wake(self._node)

    def _halt(self) -> None:
        with self._lock:
            for joints in self._commanded:
                if joints.follower.phase is not Phase.HOLDING:
                    joints.follower.halt(Code.PREEMPTED, _SHUTDOWN_TEXT)
            self.look()


class JointTrajectoryControllerNode(Node):
    """A simulated robot that executes joint trajectories and publishes joint_states."""

    SETTINGS = ControllerSettings

    def __init__(self, **options: Any) -> None:
        self._servers: list[ActionBase] = []
        self._robot: SimulatedRobot | None = None
        self._gripper: Gripper | None = None
        self._cycles: Cycles | None = None
        super().__init__("joint_trajectory_controller", **options)
        self._table = NodeParameters(
            self, ControllerSettings, self._change, self._check, later=CONSTRAINTS
        )
        self._settings = self._table.settings
        when_robot_known(self, self._settings, self._serve, parallel=True, legged=True)

    def _serve(self, model: RobotModel) -> None:
        clock, settings = MotionClock(self), self._settings
        robot = _robot(model, settings, clock)
        gripper = gripper_of(model, settings, clock, robot.lock)
        self._robot, self._gripper = robot, gripper
        self._check(settings)
        names = [*robot.joint_names, *(() if gripper is None else gripper.joint_names)]
        self._table.declare(self, constraint_rows(names))
        self._hold_to(settings)
        robot.simulated_joints.inject(self._faults(settings))
        servers, publish_control = serve_control(self, robot, clock)
        passive = [name for name in robot.shown_names if name not in robot.joint_names]
        execute = GoalServer(self, robot, ExecuteMessages(robot.joint_names, passive))
        hardware = f"{robot.name} (simulated)"
        report = StatusReport(self, "motion", hardware, lambda: robot_condition(robot))
        self._servers = [execute, *servers]
        if gripper is not None:
            condition = partial(gripper_condition, gripper)
            of_gripper = StatusReport(self, "gripper", hardware, condition)
            self._servers += serve_gripper(self, gripper, settings, of_gripper.publish)
        commanded = [robot] if gripper is None else [robot, gripper]
        self._shutdown = Shutdown(self, commanded)
        self._control_cycle = ControlCycle(
            self, commanded, model, settings, publish_control, self._servers, self._shutdown.look
        )
        self._control_cycle.others += robot.publications(self, model, settings)
        if model.legged is not None and settings.walk_efforts_topic:
            states = self._control_cycle.states
            states.reported = ReportedEfforts(
                self, settings.walk_efforts_topic, states.names, robot.lock
            )
        TrajectoryTopic(self, robot, report.publish)
        Commands(self, commanded, self._control_cycle.publish_joint_states)
        self._cycles = Cycles(self, clock, settings.publish_rate, self._control_cycle.run)
        self._log_start(robot)

    def _log_start(self, robot: SimulatedRobot) -> None:
        settings = self._settings
        kind = f" by {settings.dynamic_control}" if robot.dynamic else ""
        rate = f"{counted(len(robot.shown_names), 'joint')} at {settings.publish_rate:g} Hz"
        self.get_logger().info(f"ready: {robot.name} simulated{kind}, {rate}")
        if self._gripper is not None:
            self.get_logger().info(f"gripper: {self._gripper.says()}")
        if unlimited := robot.unlimited_joints():
            text = (
                f"no effort limit is known of {', '.join(unlimited)}: nothing limits their drives"
            )
            self.get_logger().warning(text)

    def _change(self, settings: ControllerSettings) -> None:
        """Take what was asked for at run time: faults, payload, object, tolerances."""
        self._settings = settings
        if self._robot is None:
            return
        self._hold_to(settings)
        with self._robot.lock:
            self._robot.simulated_joints.inject(self._faults(settings))
            self._robot.carry(settings)
            if self._gripper is not None:
                self._gripper.change(settings)

    def _hold_to(self, settings: ControllerSettings) -> None:
        """Hold the motions that begin from now on to the tolerances of the parameters."""
        for joints in (self._robot, self._gripper):
            if joints is not None:
                given = self._table.further
                joints.tolerances = default_tolerances(settings, joints.joint_names, given)

    def _check(self, settings: ControllerSettings) -> None:
        """Refuse faults, payloads and objects that the robot cannot have."""
        check_simulation(settings, self._robot is not None and self._robot.floats)
        if self._robot is None:
            return
        self._faults(settings)
        if self._gripper is not None:
            self._gripper.check(settings)
        elif settings.gripper_object_width:
            allowed = "0: nothing moves behind the chain of this robot"
            raise ParameterError("gripper_object_width", settings.gripper_object_width, allowed)

    def _faults(self, settings: ControllerSettings) -> Faults:
        """Read the faults of the arm; fingers may be stuck, too."""
        assert self._robot is not None
        fingers = () if self._gripper is None else self._gripper.joint_names
        return faults_of(settings, self._robot.joint_names, fingers)

    async def stop(self) -> None:
        """Slow down and hold, say so, abort what was to be done, and let the clients know."""
        robot = self._robot
        if robot is None:
            return
        await self._shutdown.stand()
        with robot.lock:
            robot.advance()
            self._control_cycle.publish_joint_states()
        for server in self._servers:
            await server.all_ended()

    def destroy_node(self) -> None:
        """Destroy the node and, what rclpy leaves out, its cycles and action servers."""
        if self._cycles is not None:
            self._cycles.stop()
        for server in self._servers:
            server.destroy()
        super().destroy_node()


def _robot(model: RobotModel, settings: ControllerSettings, clock: MotionClock) -> SimulatedRobot:
    """Make the simulated robot: an arm, all limbs of a parallel robot, or all legs."""
    if model.legged is not None:
        return legged_robot(model.legged, settings, clock)
    floating = FloatingRobot(model, settings)
    if floating.floats:
        # Compiled code is loaded only where it is needed.
        from robomech_ros.nodes.joint_trajectory_controller.floating_robot import FloatingArm

        return FloatingArm(floating.carrying(model.chain), settings, clock)
    if model.mechanism is None:
        return serial_robot(model.chain, settings, clock)
    # Compiled code for loops is loaded only if there are some.
    from robomech_ros.nodes.joint_trajectory_controller.parallel_robot import ParallelRobot

    return ParallelRobot(model.mechanism, settings, clock)


main = partial(run_node, JointTrajectoryControllerNode)

if __name__ == "__main__":
    raise SystemExit(main())
