"""Interfaces of joint_trajectory_controller with types of control_msgs, where it is installed."""

from rclpy.node import Node

from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.joint_trajectory_controller.goal_server import GoalServer
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot


class ControlInterfaces:
    """The action follow_joint_trajectory, and topics and services of the controller's state.

    Parameters
    ----------
    node : Node
        Gets them under its own name.
    robot : SimulatedRobot
        What executes.
    clock : MotionClock
        Its time.

    Attributes
    ----------
    servers : list of GoalServer
        That of the action; empty where control_msgs is not installed.
    """

    def __init__(self, node: Node, robot: SimulatedRobot, clock: MotionClock) -> None:
        self.servers: list[GoalServer] = []
        try:
            from robomech_ros.nodes.joint_trajectory_controller.follow_messages import (
                FollowMessages,
            )
            from robomech_ros.nodes.joint_trajectory_controller.state_topics import StateTopics
        except ImportError as error:
            if getattr(error, "name", "") != "control_msgs":
                node.get_logger().warning(f"no follow_joint_trajectory: {error}")
            return
        self.servers.append(GoalServer(node, robot, FollowMessages(robot.joint_names)))
        self._state = StateTopics(node, robot, clock)

    def publish(self) -> None:
        """Publish controller_state."""
        if self.servers:
            self._state.publish()
