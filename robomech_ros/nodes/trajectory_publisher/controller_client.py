"""Client of the publisher for the controller: sending of trajectories, and the reported state."""

from collections.abc import Callable, Sequence

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.execution.client.position_check import STILL
from robomech_ros.execution.joints import JointKinds, Joints
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.rejection_status import read_refusal, trajectory_label
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.status_report import TOPIC
from robomech_ros.nodes.middleware.liveliness import LivelinessMonitor
from robomech_ros.nodes.trajectory_publisher.action_transport import ActionTransport, request_topic
from robomech_ros.nodes.trajectory_publisher.messages import message_from_execution
from robomech_ros.typing import Array

_DEPTH = 10


class ControllerRefusals:
    """Finds the controller's refusal of the last trajectory, if it publishes one.

    - ``on_refused``: called with an execution request, the controller's code and its reason.
    """

    def __init__(
        self, node: Node, controller: str, on_refused: Callable[[ExecutionRequest, int, str], None]
    ) -> None:
        self._name = f"{node.resolve_service_name(controller).lstrip('/')}: motion"
        self._on_refused = on_refused
        self._run, self._count = "", 0
        self._sent: tuple[ExecutionRequest, str, tuple[str, int]] | None = None
        node.create_subscription(DiagnosticArray, TOPIC, self._take, _DEPTH)

    def expect(self, execution: ExecutionRequest, message: JointTrajectory) -> None:
        """Note the message that is sent now."""
        self._sent = execution, trajectory_label(message), (self._run, self._count)

    def _take(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if status.name != self._name:
                continue
            refusal = read_refusal({entry.key: entry.value for entry in status.values})
            if refusal is None:
                continue
            self._run, self._count = refusal.run, refusal.number
            if self._sent is None:
                continue
            execution, label, (run, count) = self._sent
            # A controller that was started again counts from the beginning.
            is_new = refusal.number > (count if refusal.run == run else 0)
            if refusal.label == label and is_new and refusal.code:
                self._sent = None
                self._on_refused(execution, refusal.code, refusal.text)


class ControllerClient:
    """Sends trajectories to one controller.

    - ``action``: the way by action.
    - ``refusals``: what the controller says of trajectories sent by topic.
    - ``life``: whether the controller lives.
    """

    def __init__(
        self,
        node: Node,
        controller: str,
        clock: MotionClock,
        action: ActionTransport,
        refusals: ControllerRefusals,
        life: LivelinessMonitor,
        monitor: JointStateMonitor,
    ) -> None:
        self._action, self._life, self._refusals = action, life, refusals
        self.positions, self.update_count = monitor.positions, monitor.update_count
        self._publisher = node.create_publisher(
            JointTrajectory, f"{controller}/joint_trajectory", _DEPTH
        )
        self._continuous: frozenset[str] | None = None
        self._units: dict[str, str] = {}
        self._acceleration: dict[str, float] = {}
        self._clock = clock

    def know_robot(self, model: RobotModel) -> None:
        """Note which joints turn without limits, their units and acceleration limits."""
        self._units = {joint.name: joint.unit for joint in model.description.joints}
        self._continuous = frozenset(
            joint.name
            for joint in model.description.joints
            if joint.type != "prismatic" and np.isneginf(joint.lower) and np.isposinf(joint.upper)
        )
        joints = Joints.of(model.commanded)
        self._acceleration = dict(zip(joints.names, joints.acceleration.tolist(), strict=True))

    def missing(self, transport: Transport) -> str:
        """Say what is not there to send by; empty if all is."""
        if self.died:
            return "the process of the controller"
        if transport.answers:
            name = self._action.name
            there = self._action.ready and self._life.reads(request_topic(name), no_mangle=True)
            return "" if there else f"action '{name}'"
        topic = self._publisher.topic_name
        there = self._publisher.get_subscription_count() > 0 and self._life.reads(topic)
        return "" if there else f"subscriber of '{topic}'"

    @property
    def died(self) -> bool:
        """True if the controller was there and shows no sign of life any more."""
        return self._life.ended

    @property
    def replaced(self) -> bool:
        """True if the controller that was sent to last has died, and another process is there."""
        return self._life.has_successor(self._sent_to)

    def kinds(self, names: Sequence[str]) -> JointKinds:
        """Say which joints turn without limits; all may as long as the robot is not known.

        The controller has the last word on a start that is a whole turn away.
        """
        known = self._continuous
        continuous = np.array([known is None or name in known for name in names])
        return JointKinds(continuous, [self._units.get(name, "") for name in names])

    def acceleration(self, names: Sequence[str]) -> Array | None:
        """Return the acceleration limits, rad/s^2 or m/s^2; None where they are not all known."""
        if not all(name in self._acceleration for name in names):
            return None
        return np.array([self._acceleration[name] for name in names])

    def send(self, execution: ExecutionRequest) -> None:
        """Send by the transport of the execution request."""
        self._sent_to = self._life.server
        message = message_from_execution(execution, self._clock.stamp(execution.sent_at))
        if execution.transport is Transport.TOPIC:
            self._refusals.expect(execution, message)
            self._publisher.publish(message)
            return
        start = self.positions(execution.names)
        self._action.send(execution, message, lambda: self._left(start, execution.names))

    def runs_before(self, execution: ExecutionRequest) -> bool:
        """Return whether the controller still executes a goal before the last one."""
        return self._action.runs

    def cancel(self, execution: ExecutionRequest) -> None:
        """Ask the controller to give up all that was sent, also what it has not accepted yet."""
        self._action.cancel()

    def _left(self, start: Array | None, names: Sequence[str]) -> bool:
        """Return whether the robot is elsewhere than at a start, rad or m."""
        place = self.positions(names)
        if start is None or place is None:
            return False
        return bool(np.max(np.abs(place - start)) > STILL)
