"""Topics and actions of the gripper."""

from collections.abc import Callable

from rclpy.node import Node

from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.commands import TrajectoryTopic
from robomech_ros.nodes.joint_trajectory_controller.goal_server import GoalServer
from robomech_ros.nodes.joint_trajectory_controller.gripper.gripper import Gripper
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings


def serve_gripper(
    node: Node, gripper: Gripper, settings: ControllerSettings, on_refused: Callable[[], None]
) -> list[ActionBase]:
    """Offer the topic joint_trajectory, and the actions where control_msgs is installed.

    - ``settings``: the names.
    - ``on_refused``: called when a trajectory of the topic was refused, whose sender gets no
      answer.

    Returns the servers of the actions.

    Raises ParameterError: the gripper has the name of the node.
    """
    parallel, own = settings.parallel_gripper_controller, node.resolve_topic_name("~/gripper_cmd")
    if node.resolve_topic_name(f"{gripper.place}/gripper_cmd") == own:
        allowed = "another name than that of the node, below which the arm has its trajectories"
        raise ParameterError("gripper_controller", gripper.place, allowed)
    TrajectoryTopic(node, gripper, on_refused)
    try:
        from control_msgs import action

        from robomech_ros.nodes.joint_trajectory_controller.follow_messages import FollowMessages
        from robomech_ros.nodes.joint_trajectory_controller.gripper.command_server import (
            CommandServer,
            GripperMessages,
            ParallelGripperMessages,
        )
    except ImportError as error:
        if getattr(error, "name", "") != "control_msgs":
            node.get_logger().warning(f"no gripper_cmd: {error}")
        return []
    servers: list[ActionBase] = [GoalServer(node, gripper, FollowMessages(gripper.joint_names))]
    for place, messages in ((gripper.place, GripperMessages), (parallel, ParallelGripperMessages)):
        if hasattr(action, messages.type_name):
            servers.append(CommandServer(node, gripper, place, messages()))
        else:
            text = f"no {place}/gripper_cmd: this control_msgs has no {messages.type_name}"
            node.get_logger().warning(text)
    return servers
