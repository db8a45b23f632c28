"""Jogs the robot through the servo, while a page holds a button.

The module :mod:`robomech_ros.rvs.model.running.jog` says what ends a press, and how soon.
"""

from collections.abc import Callable
from typing import NamedTuple

from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.rvs.jog_thread import JogThread
from robomech_ros.nodes.rvs.messages import joint_jog, twist_jog
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.rvs.model.running.jog import HoldHeartbeat, JogDirection

# How often the servo is commanded (s): well within the time after which it brakes by itself.
_PERIOD = 0.02


class _Jog(NamedTuple):
    """Pressed jog button: direction, frame of its axes, and fraction of the greatest speed."""

    direction: JogDirection
    frame: str
    speed: float


class Jogger(JogThread[_Jog]):
    """Sends commands to the servo from a thread of its own, which nothing else delays.

    - ``servo_is_silent``: returns whether the status messages of the servo have stopped.
    - ``complain``: as for ``JogThread``.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        settings: RvsSettings,
        servo_is_silent: Callable[[], bool],
        complain: Callable[[str], None],
    ) -> None:
        super().__init__(node, settings.jog_timeout, _PERIOD, complain)
        self._model, self._settings = model, settings
        self._servo_is_silent = servo_is_silent
        servo = settings.servo
        self._twists = node.create_publisher(TwistStamped, f"{servo}/delta_twist_cmds", 10)
        self._joints = node.create_publisher(JointState, f"{servo}/joint_velocity_cmds", 10)

    def hold(self, beat: HoldHeartbeat, frame: str, speed: float) -> None:
        """Go on with a press, or begin one; see ``LiveRobot``."""
        self.press(_Jog(beat.direction, frame, speed), beat)

    def missing(self, what: _Jog) -> str:
        """Say what is missing of the servo; empty for nothing."""
        publisher = self._joints if what.direction.kind == "joint" else self._twists
        if not publisher.get_subscription_count():
            return f"No servo listens on '{publisher.topic_name}'."
        if self._servo_is_silent():
            return f"'{self._settings.servo}' has said nothing for some time: no jog."
        return ""

    def send(self, what: _Jog, moves: bool) -> None:
        """Command the servo."""
        speed, settings, chain = what.speed if moves else 0.0, self._settings, self._model.chain
        linear, direction = speed * settings.jog_linear_speed, what.direction
        if direction.kind == "joint":
            publisher = self._joints
            command = joint_jog(chain, direction, speed * settings.jog_joint_speed, linear)
        else:
            publisher = self._twists
            frame = self._model.frame_of(chain.tip if what.frame == "tip" else chain.base)
            command = twist_jog(frame, direction, linear, speed * settings.jog_angular_speed)
        command.header.stamp = self._clock.now().to_msg()
        publisher.publish(command)
