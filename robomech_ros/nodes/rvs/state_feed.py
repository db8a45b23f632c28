"""Positions of the joints and status of the servo, for the page while it has a viewer."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

from nav_msgs.msg import Odometry
from rclpy.node import Node

from robomech_interfaces.msg import ServoStatus
from robomech_ros.nodes.common.messages.error_codes import NoStateError
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.robot.floating_base import FloatingRobot
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.middleware.polled_subscription import Inbox
from robomech_ros.nodes.rvs.messages import servo_state
from robomech_ros.nodes.rvs.poll_thread import DEPTH, PollThread
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.nodes.servo.status import status_topic
from robomech_ros.rvs.model.running.live_robot import ServoState

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live import LiveLayer

# At rest the servo speaks once a second.
_SERVO_TIMEOUT = 3.0


class StateFeed(PollThread):
    """Reads joint states and the servo's status by hand, from a thread of its own."""

    def __init__(
        self, node: Node, model: RobotModel, settings: RvsSettings, view: LiveLayer
    ) -> None:
        # The pose of a parallel robot depends on all joints.
        moved = model.chain if model.mechanism is None else model.mechanism
        super().__init__(node, settings, view, moved.joint_names)
        self._view, self._all_joints = view, model.joint_names
        self._inbox = Inbox(node, ServoStatus, status_topic(node, settings.servo), DEPTH)
        self._base, self._placed_at = model.base_frame, -math.inf
        floats = FloatingRobot(model, settings).floats
        self._odometry = Inbox(node, Odometry, "odom", DEPTH) if floats else None
        #: Latest known joints (rad or m), while somebody looks.
        self.positions: dict[str, float] = {}
        self._servo: ServoState | None = None
        self._servo_at = -math.inf
        self._thread.start()

    @property
    def servo_is_silent(self) -> bool:
        """True if messages of the servo have stopped while a browser is connected."""
        return math.isfinite(self._servo_at) and self._since_servo > _SERVO_TIMEOUT

    @property
    def _since_servo(self) -> float:
        return time.monotonic() - self._servo_at

    def show(self, now: float) -> None:
        """Show where the joints are, and the base of a robot that floats."""
        if self._odometry is not None:
            bases = [one for one in self._odometry.take() if one.child_frame_id == self._base]
            if bases:
                self._view.show_base(matrix_from_pose(bases[-1].pose.pose, "odometry"))
                self._placed_at = now
        self.positions = self._monitor.known_positions(self._all_joints)
        if self._updated_at == now:
            self._view.show_joints(self.positions)

    def fault(self, now: float) -> str:
        """Show what the servo says, and say what is wrong with the joint states."""
        for status in self._inbox.take():
            self._servo, self._servo_at = servo_state(status), now
        self._view.show_servo(None if self._since_servo > _SERVO_TIMEOUT else self._servo)
        age = now - self._updated_at
        if age <= self._settings.state_timeout:
            return self._base_fault(now)
        if math.isfinite(age):
            return (
                f"No joint states on '{self._topic}' for {age:.0f} s: the robot may be elsewhere."
            )
        try:
            self._monitor.require(self._joints)
        except NoStateError as error:
            return f"{str(error)[:1].upper()}{str(error)[1:]}."
        return ""

    def _base_fault(self, now: float) -> str:
        """Say what is wrong with the odometry of a base that floats."""
        if self._odometry is None or now - self._placed_at <= self._settings.state_timeout:
            return ""
        topic = self._odometry.topic
        if math.isinf(self._placed_at):
            return f"Nothing yet on '{topic}': the pose of the floating base is unknown."
        age = now - self._placed_at
        return f"Nothing on '{topic}' for {age:.0f} s: the base may be elsewhere."
