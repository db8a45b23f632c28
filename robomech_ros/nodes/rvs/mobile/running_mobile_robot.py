"""A robot of a page that runs over the ground: it is jogged by twists, and stopped by one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import Pose, TwistStamped
from rclpy.node import Node
from std_msgs.msg import String

from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.rvs.jog_thread import JoggedRobot, JogThread
from robomech_ros.nodes.rvs.messages import twist_jog
from robomech_ros.nodes.rvs.mobile.mobile_robot_feed import MobileRobotFeed
from robomech_ros.nodes.rvs.mobile.mobile_robots import MobileRobot
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.rvs.model.running.jog import HoldHeartbeat, JogDirection
from robomech_ros.spatial import matrix_from_roll_pitch_yaw
from robomech_ros.spatial.poses import assembled

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live_mobile_robot import LiveMobileRobotLayer

_DEPTH = 10
_Jog = tuple[JogDirection, float]


class TwistJogger(JogThread[_Jog]):
    """Commands a robot over the ground by twists while a button is held.

    - ``complain``: as for ``JogThread``.
    """

    def __init__(
        self,
        node: Node,
        mobile_robot: MobileRobot,
        settings: RvsSettings,
        complain: Callable[[str], None],
    ) -> None:
        super().__init__(node, settings.jog_timeout, mobile_robot.period, complain)
        self._settings = settings
        self._twists = node.create_publisher(TwistStamped, mobile_robot.command, _DEPTH)

    def missing(self, _: _Jog | None = None) -> str:
        """Say what is missing to move; empty for nothing."""
        if not self._twists.get_subscription_count():
            return f"Nobody listens on '{self._twists.topic_name}'."
        return ""

    def send(self, what: _Jog, moves: bool) -> None:
        """Command the robot to move, or to stand."""
        direction, part = what[0], what[1] if moves else 0.0
        speeds = part * self._settings.jog_linear_speed, part * self._settings.jog_angular_speed
        self.publish(twist_jog("", direction, *speeds))

    def publish(self, twist: TwistStamped) -> None:
        """Command a twist from now."""
        twist.header.stamp = self._clock.now().to_msg()
        self._twists.publish(twist)


class RunningMobileRobot(JoggedRobot):
    """Carries out the requests of a page, see ``LiveMobileRobot``, and reports to it."""

    _jogger: TwistJogger

    def __init__(self, node: Node, mobile_robot: MobileRobot, settings: RvsSettings) -> None:
        self._node, self._robot, self._settings = node, mobile_robot, settings
        self._gaits = self._poses = None
        if mobile_robot.legged is not None:
            self._poses = node.create_publisher(Pose, "body_pose", _DEPTH)
            self._gaits = node.create_publisher(String, f"{mobile_robot.node}/gait", _DEPTH)

    def begin(self, view: LiveMobileRobotLayer) -> None:
        """Report to this page, from now on."""
        self._view = view
        self._feed = MobileRobotFeed(self._node, self._robot, self._settings, view)
        self._jogger = TwistJogger(self._node, self._robot, self._settings, view.show_jog)

    def hold(self, beat: HoldHeartbeat, speed: float) -> None:
        """Jog while this call is repeated, at a fraction of the greatest jogging speed."""
        self._jogger.press((beat.direction, speed), beat)

    def stop(self) -> None:
        """End the jog, and command to stand."""
        self._jogger.let_go()
        missing = self._jogger.missing()
        self._jogger.publish(TwistStamped())
        text = f"Stop may have failed: {missing}" if missing else "Commanded to stand."
        self._view.show_result(text, failed=bool(missing))

    def choose_gait(self, gait: str) -> None:
        """Request another gait."""
        if self._gaits is not None:
            self._command(self._gaits, String(data=gait), f"Gait '{gait}': as soon as it stands.")

    def move_trunk(self, shift: Sequence[float]) -> None:
        """Request a trunk pose relative to the level one: x, y, z (m), roll, pitch, yaw (rad)."""
        if self._poses is not None:
            position, angles = np.array(shift[:3]), np.array(shift[3:])
            T = assembled(matrix_from_roll_pitch_yaw(angles), position)
            self._command(self._poses, pose_from_matrix(T), "Pose of the trunk commanded.")

    def _command(self, publisher: Any, message: Any, text: str) -> None:
        """Publish, and say so, or that nobody listens."""
        subscribed = publisher.get_subscription_count()
        publisher.publish(message)
        nobody = f"Nobody listens on '{publisher.topic_name}'."
        self._view.show_result(text if subscribed else nobody, failed=not subscribed)
