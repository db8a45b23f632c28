"""Published state of a mobile base: odometry, frames, wheels and their commands."""

import math

import numpy as np
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.message_fields import fill_header, floats
from robomech_ros.nodes.common.messages.pose_messages import PlainPose, fill_place, fill_twist
from robomech_ros.nodes.common.robot.odometry_frame import (
    POSE,
    TWIST,
    OdometryPublisher,
    full_covariance,
)
from robomech_ros.nodes.display.robot_display import AUTO, NEVER, RobotDisplay
from robomech_ros.nodes.mobile_base.mobile_base import MobileBase
from robomech_ros.nodes.mobile_base.settings import MobileBaseSettings
from robomech_ros.rolling import RollingRobot, WheelJoints, rolling_description
from robomech_ros.typing import Array

_DEPTH = 10


def _display(
    node: Node, robot: RollingRobot, joints: WheelJoints, settings: MobileBaseSettings, prefix: str
) -> RobotDisplay | None:
    """Publish the tree from the base on; where the base is, odometry says.

    A robot that no URDF can describe is not shown, with a warning, and drives all the same.
    """
    frames, link = settings.publish_frames, settings.base_frame_id
    if frames == AUTO and not settings.enable_odom_tf:
        frames = NEVER
    try:
        tree = rolling_description(robot.base, joints, base_link=link, placed=False)
    except RobomechError as error:
        node.get_logger().warning(f"no robot_description and no frames of wheels: {error}")
        return None
    rate, describe = min(settings.frame_rate, settings.publish_rate), settings.publish_description
    return RobotDisplay(node, tree, prefix=prefix, frames=frames, rate=rate, describe=describe)


def frame_prefix(settings: MobileBaseSettings, namespace: str) -> str:
    """Return what the names of frames begin with, as ros2_controllers have it."""
    if not settings.tf_frame_prefix_enable:
        return ""
    given = settings.tf_frame_prefix
    prefix = (namespace if given in ("", "~") else given).lstrip("/")
    return f"{prefix}/" if prefix and not prefix.endswith("/") else prefix


class BasePublication:
    """Publishes where a base is."""

    def __init__(
        self, node: Node, base: MobileBase, joints: WheelJoints, settings: MobileBaseSettings
    ) -> None:
        self._base = base
        prefix = frame_prefix(settings, node.get_namespace())
        self._odom, self._frame = prefix + settings.odom_frame_id, prefix + settings.base_frame_id
        self._wheels = np.array([number for _, number in joints.rolling])
        self._states = JointState(name=list(joints.names))
        # The driven wheels in the order of their joints, for commands.
        order = np.flatnonzero(base.simulated.driven).tolist()
        self._commanded = [order.index(number) for number in self._wheels if number in order]
        self._of_pose, self._of_twist = _constant_covariances(settings, base)
        self._joint_states = node.create_publisher(JointState, "joint_states", _DEPTH)
        topic, frames = base.interface.odometry, base.interface.frames
        frames = frames if settings.enable_odom_tf else ""
        self._odometry = OdometryPublisher(node, topic, frames, self._odom, self._frame)
        self._truth = node.create_publisher(PoseStamped, "~/simulated_base", _DEPTH)
        self._commands = node.create_publisher(Float64MultiArray, "~/commands", _DEPTH)
        self._limited = None
        if settings.publish_limited_velocity:
            self._limited = node.create_publisher(TwistStamped, "~/cmd_vel_out", _DEPTH)
        self._display = _display(node, base.robot, joints, settings, prefix)
        self._states_per_frames = max(round(settings.publish_rate / settings.frame_rate), 1)
        self._count = 0

    def publish_commands(self, stamp: int) -> None:
        """Publish what the wheels are commanded, at a ROS time (ns)."""
        rates = self._base.wheel_rates[self._commanded]
        values = np.concatenate([rates, self._base.motion.steering])
        self._commands.publish(Float64MultiArray(data=floats(values)))
        if self._limited is not None:
            message = TwistStamped()
            fill_header(message.header, self._frame, stamp)
            fill_twist(message.twist, _twist_in_space(self._base.motion.twist))
            self._limited.publish(message)

    def publish_states(self, stamp: int) -> None:
        """Publish where the base and its wheels are, at a ROS time (ns)."""
        base, simulated = self._base, self._base.simulated
        fill_header(self._states.header, "", stamp)
        positions = [simulated.positions[self._wheels], simulated.steering, simulated.brackets]
        self._states.position = floats(np.concatenate(positions))
        rates = [simulated.rates[self._wheels], base.steering_rates, simulated.bracket_rates]
        self._states.velocity = floats(np.concatenate(rates))
        if simulated.torques is not None:
            driving, steering = np.split(simulated.torques, [int(simulated.driven.sum())])
            wheels = np.zeros(len(simulated.driven))
            wheels[simulated.driven] = driving
            efforts = [wheels[self._wheels], steering, np.zeros(len(simulated.brackets))]
            self._states.effort = floats(np.concatenate(efforts))
        self._joint_states.publish(self._states)
        self._count += 1
        if self._display is not None and self._count % self._states_per_frames == 0:
            when = self._states.header.stamp
            at = dict(zip(self._states.name, self._states.position, strict=True))
            self._display.publish(at, (when.sec, when.nanosec))
        odometry, of_pose, of_twist = base.odometry, self._of_pose, self._of_twist
        if of_pose is None:
            of_pose = full_covariance(odometry.covariance, POSE)
        if of_twist is None:
            of_twist = full_covariance(odometry.twist_covariance, TWIST)
        place, twist = _in_space(odometry.pose), _twist_in_space(base.mean_twist)
        self._odometry.publish(place, twist, (of_pose, of_twist), stamp)
        truth = PoseStamped()
        fill_header(truth.header, self._odom, stamp)
        fill_place(truth.pose.position, truth.pose.orientation, _in_space(simulated.pose))
        self._truth.publish(truth)


def _constant_covariances(
    settings: MobileBaseSettings, base: MobileBase
) -> tuple[Array | None, Array | None]:
    omni = base.robot.drive == "omni"
    pose = (omni and settings.diagonal_covariance__pose) or settings.pose_covariance_diagonal
    twist = (omni and settings.diagonal_covariance__twist) or settings.twist_covariance_diagonal
    made = [np.diag(given).ravel() if given else None for given in (pose, twist)]
    return made[0], made[1]


def _twist_in_space(twist: Array) -> Array:
    return np.array([0.0, 0.0, *twist, 0.0])


def _in_space(pose: Array) -> PlainPose:
    x, y, heading = pose.tolist()
    return (x, y, 0.0), (0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))
