"""Adds services of MoveIt to nodes, where the package moveit_msgs is installed."""

from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.nodes.frames.robot_frames import RobotFrames


def add_moveit_services(
    node: Node,
    frames: RobotFrames,
    patience: Callable[[], float],
    check_size: Callable[[str, int], None],
) -> bool:
    """Add compute_ik and compute_fk to a node, if their types are installed; say whether they are.

    Parameters
    ----------
    node : Node
        Gets the services under its own name.
    frames : RobotFrames
        Of the robot, with its present state.
    patience : callable
        Gives the time (s) that a request waits for the present state.
    check_size : callable
        Raises where there is more of something than the node handles at once.
    """

    def add() -> None:
        from robomech_ros.nodes.moveit.services import MoveItServices
        from robomech_ros.nodes.moveit.whole_robot import WholeRobot

        MoveItServices(node, WholeRobot(frames), patience, check_size)

    return _added(node, frames.model, "compute_ik and compute_fk", add)


def add_cartesian_path_service(
    node: Node, frames: RobotFrames, settings: Callable[[], Any], worker: Worker
) -> bool:
    """Add compute_cartesian_path to a node, if its type is installed; say whether it is.

    What it computes is not published: the client has it executed.

    Parameters
    ----------
    node, frames
        As for `add_moveit_services`.
    settings : callable
        Gives the parameters of the planner.
    worker : Worker
        Plans, while the node serves others.
    """

    def add() -> None:
        from robomech_ros.nodes.moveit.cartesian_service import CartesianPathService
        from robomech_ros.nodes.moveit.whole_robot import WholeRobot

        CartesianPathService(node, WholeRobot(frames), settings, worker)

    return _added(node, frames.model, "compute_cartesian_path", add)


def _added(node: Node, model: RobotModel, services: str, add: Callable[[], None]) -> bool:
    """Add services of an arm, or log why there are none."""
    if model.mechanism is not None:
        # MoveIt cannot know its loops.
        node.get_logger().info(f"no {services}: '{model.chain.name}' is a parallel robot")
        return False
    try:
        add()
    except ImportError as error:
        # That the package is simply not installed is nothing to be logged.
        if getattr(error, "name", "") != "moveit_msgs":
            node.get_logger().warning(f"no {services}: {error}")
        return False
    return True
