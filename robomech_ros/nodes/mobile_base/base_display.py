"""A mobile base as RViz shows it: its description, and the frames of its wheels."""

from __future__ import annotations

from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.display.robot_display import AUTO, NEVER, RobotDisplay
from robomech_ros.nodes.mobile_base.settings import MobileBaseSettings
from robomech_ros.rolling import RollingRobot, WheelJoints, rolling_description


class BaseDisplay:
    """Publishes the tree from the base on; where the base is, odometry says.

    A robot that no URDF can describe is not shown, with a warning, and drives all the same.

    Parameters
    ----------
    node : Node
        Owner of the publishers.
    robot : RollingRobot
    joints : WheelJoints
        As joint_states has them.
    settings : MobileBaseSettings
    prefix : str
        What the names of frames begin with.
    """

    def __init__(
        self,
        node: Node,
        robot: RollingRobot,
        joints: WheelJoints,
        settings: MobileBaseSettings,
        prefix: str,
    ) -> None:
        frames = settings.publish_frames
        if frames == AUTO and not settings.enable_odom_tf:
            frames = NEVER
        rate = min(settings.frame_rate, settings.publish_rate)
        self._states_per_frames = max(round(settings.publish_rate / rate), 1)
        self._states = 0
        self._display: RobotDisplay | None = None
        link = settings.base_frame_id
        try:
            tree = rolling_description(robot.base, joints, base_link=link, placed=False)
        except RobomechError as error:
            node.get_logger().warning(f"no robot_description and no frames of wheels: {error}")
            return
        self._display = RobotDisplay(
            node,
            tree,
            prefix=prefix,
            frames=frames,
            rate=rate,
            describe=settings.publish_description,
        )

    def publish(self, states: JointState) -> None:
        """Publish the frames of the wheels where these are due."""
        self._states += 1
        if self._display is None or self._states % self._states_per_frames:
            return
        when = states.header.stamp
        positions = dict(zip(states.name, states.position, strict=True))
        self._display.publish(positions, (when.sec, when.nanosec))
