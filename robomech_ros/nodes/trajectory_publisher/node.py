"""The node that sends planned trajectories to the controller and sees whether the robot arrives."""

import time
import traceback
from collections.abc import Sequence
from typing import Any

import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import Execute
from robomech_ros.errors import BadValueError, RobomechError, UnknownJointError, WrongSizeError
from robomech_ros.execution.client.comparison import off_goal, off_start
from robomech_ros.execution.client.delivery import Delivery, Report, Transport
from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.joints import Joints
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.nodes.common.error_codes import NoStateError, answer, code_of
from robomech_ros.nodes.common.message_fields import duration_from_seconds
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters, ParameterError
from robomech_ros.nodes.common.received_trajectory import received_trajectory
from robomech_ros.nodes.common.robot_description import RobotModel, when_robot_known
from robomech_ros.nodes.common.status_report import NodeCondition, StatusReport
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.trajectory_publisher.action_link import ActionLink
from robomech_ros.nodes.trajectory_publisher.controller_link import ControllerLink
from robomech_ros.nodes.trajectory_publisher.program import read_program
from robomech_ros.nodes.trajectory_publisher.program_runner import ProgramRunner
from robomech_ros.nodes.trajectory_publisher.settings import (
    PublisherSettings,
    answering_transport,
    asked_tolerances,
    dispatch_settings,
    goal_dialect,
)
from robomech_ros.nodes.trajectory_publisher.speed_control import SpeedControl
from robomech_ros.outcomes import name_of
from robomech_ros.robots import SerialChain

TOPIC = "planned_trajectory"
# Plans may come faster than they are taken.
_DEPTH = 100
# A request for the latest plan overtakes the plan itself by no more than this, s: they come by
# different ways.
_ON_ITS_WAY = 0.1


class NoPlanError(NoStateError):
    """The latest plan is asked for, and there is none."""

    def __init__(self, topics: str) -> None:
        RobomechError.__init__(self, f"no trajectory was planned yet, nothing came on {topics}")


class TrajectoryPublisherNode(Node):
    """Sends planned trajectories to the controller, in order, and reports how they ended."""

    SETTINGS = PublisherSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("trajectory_publisher", **options)
        self._started = time.time_ns()
        self._table = NodeParameters(self, PublisherSettings)
        settings = self._table.settings
        self._motion_clock = MotionClock(self)
        self._latest: Delivery | None = None
        self._next_plan: Future | None = None
        self._robot_joints: tuple[str, ...] = ()
        self._chain: SerialChain | None = None
        self._refusal = ""
        self._answering = answering_transport(settings)
        action = ActionLink(
            self,
            settings.controller,
            goal_dialect(self._answering),
            asked_tolerances(settings),
            self._take_result,
        )
        self._link = ControllerLink(self, settings.controller, self._motion_clock, action)
        self._dispatcher = Dispatcher(
            self._link, dispatch_settings(settings), self._log_end, self._log_stall
        )
        self._timer = self.create_timer(
            1.0 / settings.watch_rate, self._look, clock=self._motion_clock.clock
        )
        self._timer.cancel()
        # A timer that has not fired since it was reset would wait until its old time comes again.
        self._motion_clock.on_jump(self._take_jump)
        if settings.robot_description:
            when_robot_known(self, settings, self._know_robot)
        self._listen(settings.planner_topic)
        self.create_service(
            Execute, "~/execute", self._execute, callback_group=ReentrantCallbackGroup()
        )
        limits = settings.max_points, settings.max_duration
        self._runner = ProgramRunner(self, self._motion_clock, self._offer, self._answering, limits)
        SpeedControl(self, self._dispatcher, self._motion_clock, self._watch, self._runner.cancel)
        self.create_service(Trigger, "~/run_program", self._run_program)
        StatusReport(self, "execution", settings.controller, self._condition)
        how = f"by {settings.transport}" if settings.auto_execute else "on request only"
        self.get_logger().info(f"ready: sends trajectories to '{settings.controller}', {how}")

    def _know_robot(self, model: RobotModel) -> None:
        endless = [
            joint.name
            for joint in model.description.joints
            if joint.type != "prismatic" and np.isneginf(joint.lower) and np.isposinf(joint.upper)
        ]
        chain = model.chain
        acceleration = Joints.of(chain).acceleration.tolist()
        self._link.know_robot(endless, dict(zip(chain.joint_names, acceleration, strict=True)))
        self._robot_joints = tuple(model.joint_names)
        self._chain = model.chain

    def _listen(self, planner_topic: str) -> None:
        """Subscribe to plans, to none twice."""
        plain = self.create_subscription(JointTrajectory, TOPIC, self._take_plan, _DEPTH)
        self._topics = f"'{plain.topic_name}'"
        if not planner_topic or self.resolve_topic_name(planner_topic) == plain.topic_name:
            return
        latched = QoSProfile(depth=_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        planner = self.create_subscription(
            JointTrajectory, planner_topic, self._take_latched, latched
        )
        self._topics += f" or '{planner.topic_name}'"

    def _take_latched(self, plan: JointTrajectory, info: dict[str, Any]) -> None:
        """Take a plan from a latched topic, unless it is from before this node's time."""
        made = info["source_timestamp"]
        if made and made < self._started:
            age = (self._started - made) * 1e-9
            self.get_logger().info(f"a plan made {age:.1f} s before this node started is ignored")
            return
        self._take_plan(plan)

    def _take_plan(self, plan: JointTrajectory) -> None:
        settings = self._table.settings
        arrived, self._next_plan = self._next_plan, None
        if arrived is not None and not arrived.done():
            arrived.set_result(None)
        try:
            self._latest = self._delivery(plan, Transport(settings.transport))
            if settings.auto_execute:
                self._offer(self._latest)
            self._refusal = ""
        except RobomechError as error:
            self._refusal = str(error)
            code = code_of(error)
            self.get_logger().error(f"plan refused ({code} {name_of(code)}): {error}")

    def _delivery(self, trajectory: JointTrajectory, transport: Transport) -> Delivery:
        settings, names = self._table.settings, list(trajectory.joint_names)
        if not names:
            raise WrongSizeError("joint_names", 0, "at least one joint")
        for name in names:
            if self._robot_joints and name not in self._robot_joints:
                raise UnknownJointError(name, self._robot_joints)
        waypoints = read_waypoints(
            received_trajectory(trajectory), names, settings.max_points, settings.max_duration
        )
        delay = self._motion_clock.until(trajectory.header.stamp, self._motion_clock.now())
        return Delivery(trajectory, names, waypoints, transport, delay)

    def _offer(self, delivery: Delivery) -> None:
        self._dispatcher.offer(delivery, self._motion_clock.now())
        self._watch()

    def _watch(self) -> None:
        """Look at the robot again and again while there is something to see."""
        if self._dispatcher.busy:
            self._timer.reset()

    def _take_jump(self, by: float) -> None:
        """Have what waits for its stamp watched by the new time (s)."""
        self._dispatcher.clock_jumped(by, self._motion_clock.now())
        self._watch()

    def _look(self) -> None:
        self._dispatcher.step(self._motion_clock.now())
        if not self._dispatcher.busy:
            self._timer.cancel()

    def _take_result(self, delivery: Delivery, code: int, text: str) -> None:
        self._dispatcher.concluded(delivery, code, text, self._motion_clock.now())

    async def _execute(self, request: Any, response: Any) -> Any:
        if not (request.trajectory.points or request.trajectory.joint_names):
            await self._plan_on_its_way()
        try:
            delivery = self._asked_for(request.trajectory)
            before = delivery.report is not None and delivery is self._latest
        except RobomechError as error:
            return answer(response, code_of(error), str(error))
        except Exception as error:
            self.get_logger().error(f"execute failed, please report:\n{traceback.format_exc()}")
            return answer(
                response, ErrorCode.INTERNAL, f"internal error, please report it: {error}"
            )
        ended: Future = Future()
        delivery.listen(lambda report: ended.done() or ended.set_result(report))
        report: Report = await ended
        response.duration = duration_from_seconds(report.duration)
        done = "executed before this request; the robot stands at its end"
        return answer(response, report.code, done if before and not report.code else report.text)

    def _run_program(self, request: Any, response: Any) -> Any:
        try:
            response.message = self._start_program(self._table.settings.program)
            response.success = True
        except RobomechError as error:
            response.message = str(error)
        return response

    def _start_program(self, path: str) -> str:
        """Read a program and begin it; says so."""
        chain = self._chain
        if not path:
            raise BadValueError("the parameter program", path, "the path of a YAML file")
        if chain is None:
            allowed = "a robot, for a program to be planned"
            raise ParameterError("robot_description", "", allowed)
        if self._runner.runs or self._dispatcher.busy:
            raise TrajectoryRefusedError("something is being executed already; ~/cancel ends it")
        program = read_program(path, chain)
        position = self._link.positions(chain.joint_names)
        if position is None:
            raise NoStateError(chain.joint_names, "joint_states")
        self._runner.start(program, chain, position)
        count = f"{program.cycles} cycles" if program.cycles else "cycles until cancelled"
        return f"{len(program.steps)} steps, {count}"

    async def _plan_on_its_way(self) -> None:
        """Wait a moment for a plan that was made before the request but has not arrived."""
        if self._next_plan is None or self._next_plan.done():
            self._next_plan = Future()
        arrived = self._next_plan
        timer = self.create_timer(
            _ON_ITS_WAY,
            lambda: arrived.done() or arrived.set_result(None),
            clock=self._motion_clock.clock,
        )
        await arrived
        self.destroy_timer(timer)

    def _asked_for(self, trajectory: JointTrajectory) -> Delivery:
        """Find the delivery that a request means: a new one, or the latest plan's."""
        if trajectory.points or trajectory.joint_names:
            delivery = self._delivery(trajectory, self._answering)
            self._offer(delivery)
            return delivery
        latest = self._latest
        if latest is None:
            raise NoPlanError(self._topics)
        if self._in_hand(latest) or self._stands_at_the_end_of(latest):
            return latest
        self._latest = self._delivery(latest.trajectory, self._answering)
        self._offer(self._latest)
        return self._latest

    def _in_hand(self, delivery: Delivery) -> bool:
        return delivery is self._dispatcher.current or delivery in self._dispatcher.queue

    def _stands_at_the_end_of(self, delivery: Delivery) -> bool:
        """Whether it was executed, and the robot is still where it ended and not at its start."""
        if delivery.report is None or delivery.report.code:
            return False
        names, settings = delivery.names, self._table.settings
        positions = self._link.positions(names)
        if positions is None:
            return False
        given = delivery, positions, self._link.continuous(names)
        there = not off_goal(*given, settings.goal_tolerance)
        return there and bool(off_start(*given, settings.start_tolerance))

    def _log_end(self, delivery: Delivery) -> None:
        report = delivery.report
        assert report is not None
        if report.code:
            text = f"trajectory failed ({report.code} {name_of(report.code)}): {report.text}"
            self.get_logger().error(text)
        elif report.text:
            self.get_logger().warning(report.text)
        else:
            self.get_logger().info(f"arrived after {report.duration:.2f} s")

    def _log_stall(self, text: str) -> None:
        waiting = len(self._dispatcher.queue)
        self.get_logger().warning(f"{waiting} trajectories wait: {text}")

    def _condition(self) -> NodeCondition:
        dispatcher, tally = self._dispatcher, self._dispatcher.tally
        trouble = tally.stalled or self._refusal or tally.last_failure
        summary = "executing" if dispatcher.current is not None else "idle"
        summary = "paused" if dispatcher.paused else summary
        values = {
            "speed": f"{dispatcher.speed:g}",
            "waiting": len(dispatcher.queue),
            "sent": tally.sent,
            "arrived": tally.arrived,
            "failed": tally.failed,
            "last failure": tally.last_failure,
            "last refusal": self._refusal,
            "program": self._runner.condition,
        }
        return NodeCondition(f"{summary}; {trouble}" if trouble else summary, bool(trouble), values)

    def stop(self) -> None:
        """Answer those who wait; a motion that was sent goes on."""
        self._runner.cancel("the trajectory publisher shuts down")
        self._dispatcher.close("the trajectory publisher shuts down")

    def destroy_node(self) -> None:
        """Destroy the node and, what rclpy leaves out, its action client."""
        if hasattr(self, "_link"):
            self._link.destroy()
        super().destroy_node()


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(TrajectoryPublisherNode, args)


if __name__ == "__main__":
    raise SystemExit(main())
