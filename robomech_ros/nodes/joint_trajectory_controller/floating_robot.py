"""The simulated arm on a floating base, which reacts to the motion of the joints."""

from collections.abc import Callable, Sequence

import numpy as np
from rclpy.node import Node

from robomech_ros.dynamics import FloatingBase, FloatingChain
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.robot.odometry_frame import LEAST, OdometryPublisher
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.display.robot_display import NEVER
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    ControllerSettings,
    check_simulation,
    initial_position,
)
from robomech_ros.robots import Body
from robomech_ros.spatial.plain_poses import plain_pose
from robomech_ros.trajectory.limits import Limits

# The simulation knows pose and twist; filters invert these matrices.
_COVARIANCE = (LEAST * np.eye(6)).ravel()


class FloatingArm(SimulatedRobot):
    """An arm whose base conserves the momentum of all bodies.

    Raises ParameterError: the initial position does not fit the robot, or forces of drives are to
    be simulated.
    """

    floats = True

    def __init__(
        self, robot: FloatingChain, settings: ControllerSettings, clock: MotionClock
    ) -> None:
        check_simulation(settings, True, f"the base of '{robot.chain.name}' floats")
        self._robot, self._momentum = robot, settings.momentum or None
        initial = initial_position(settings, Limits.of(robot.chain), robot.chain.home())
        self._load, self._moved_at = _load(settings), clock.now()
        #: The base at the published state.
        self.base = FloatingBase(robot, initial, self._momentum)
        super().__init__(robot.chain.name, robot.chain, initial, settings, clock)
        self._capture(settings)

    def advance_to(self, time: float) -> None:
        """Move on to a time (s), and let the base react."""
        super().advance_to(time)
        now, shown = self.follower.now, self._shown
        self.base.move(shown.position, shown.velocity, max(now - self._moved_at, 0.0))
        self._moved_at = now

    def reset(self, text: str) -> None:
        """Put the joints and the base back to where they were at start, at once."""
        super().reset(text)
        self.base = FloatingBase(self._robot, self._start, self._momentum)
        self._capture(self._settings)

    def publications(
        self, node: Node, model: RobotModel, settings: ControllerSettings
    ) -> Sequence[Callable[[tuple[int, int]], None]]:
        """Publish the base, too."""
        return (BasePublisher(node, self, model, settings).publish,)

    def carry(self, settings: ControllerSettings) -> None:
        """Capture the payload of these settings, or release it."""
        if _load(settings) != self._load:
            self._load = _load(settings)
            self.advance()
            self._capture(settings)
        self._settings = settings

    def _capture(self, settings: ControllerSettings) -> None:
        mass, com = settings.payload_mass, np.array(settings.payload_com)
        body = Body(mass, com, np.zeros((3, 3))) if mass else None
        self.base.capture(body, settings.payload_velocity)


class BasePublisher:
    """Publishes the pose and the twist of a floating base on odom, and its frame on /tf."""

    def __init__(
        self, node: Node, arm: FloatingArm, model: RobotModel, settings: ControllerSettings
    ) -> None:
        self._arm = arm
        odom = model.frame_prefix + settings.odom_frame_id
        frames = "" if settings.publish_frames == NEVER else "/tf"
        self._odometry = OdometryPublisher(node, "odom", frames, odom, model.base_frame)

    def publish(self, stamp: tuple[int, int]) -> None:
        """Publish them at a ROS time (s and ns); the lock of the arm is to be held."""
        base, nanoseconds = self._arm.base, stamp[0] * NANO + stamp[1]
        covariances = _COVARIANCE, _COVARIANCE
        self._odometry.publish(plain_pose(base.pose), base.rates[:6], covariances, nanoseconds)


def _load(settings: ControllerSettings) -> tuple[object, ...]:
    return settings.payload_mass, settings.payload_com, settings.payload_velocity
