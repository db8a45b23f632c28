"""Joints and controller of a gripper, from the parameters of a node, and its goals."""

from dataclasses import dataclass
from typing import Any

from robomech_ros.errors import RobomechError, UnknownJointError
from robomech_ros.nodes.common.parameters import ParameterError, parameter
from robomech_ros.nodes.common.robot.robot_description import RobotModel, RobotSettings
from robomech_ros.robots import Joint
from robomech_ros.robots.fingers import finger_joints
from robomech_ros.robots.gripper import GripperModel, gripper_model


@dataclass(frozen=True)
class GripperNames(RobotSettings):
    """Parameters of every node that knows the gripper."""

    gripper_controller: str = parameter(
        "gripper_controller",
        "Name before /gripper_cmd (GripperCommand), /joint_trajectory and "
        "/follow_joint_trajectory of the gripper, if the robot has one",
    )
    gripper_joints: str = parameter(
        "",
        "Gripper joints, separated by commas. Empty = those of the end effector at the end of the "
        "chain in the SRDF parameter, else all joints behind the chain that mimic no other",
    )
    gripper_joint: str = parameter(
        "",
        "Gripper joint that gripper_cmd moves. Empty = the only one, or both if they are two "
        "prismatic joints",
    )
    gripper_finger_links: str = parameter(
        "",
        "Two links, separated by a comma, between which the gripper width is measured. Empty = "
        "the last links behind the gripper joints, if there are two",
    )


def listed_names(text: str) -> list[str]:
    """Read names with commas between."""
    return [name.strip() for name in text.split(",") if name.strip()]


def known_finger_joints(model: RobotModel, settings: GripperNames) -> tuple[Joint, ...]:
    """Find the joints of the gripper behind the chain; none if the robot has no gripper."""
    names = listed_names(settings.gripper_joints)
    if not names and settings.robot_description_semantic:
        names = list(model.semantic.tool_joints(model.chain))
    try:
        return finger_joints(model.description, model.chain, names)
    except RobomechError as error:
        raise ParameterError("gripper_joints", settings.gripper_joints, str(error)) from None


def known_gripper(model: RobotModel, settings: GripperNames) -> GripperModel | None:
    """Return the gripper that one value moves, or None; ParameterError for wrong parameters."""
    names = [joint.name for joint in known_finger_joints(model, settings)]
    links = listed_names(settings.gripper_finger_links)
    try:
        return gripper_model(model.description, model.chain, names, settings.gripper_joint, links)
    except UnknownJointError as error:
        allowed = f"one of {', '.join(error.available)}, or empty"
        raise ParameterError("gripper_joint", settings.gripper_joint, allowed) from None
    except RobomechError as error:
        value = settings.gripper_finger_links
        raise ParameterError("gripper_finger_links", value, str(error)) from None


def gripper_goal(gripper: GripperModel, value: float) -> Any:
    """Make the GripperCommand goal of a width (m) or position; BadValueError outside the range."""
    from control_msgs.action import GripperCommand

    goal = GripperCommand.Goal()
    goal.command.position = gripper.position(value)
    return goal


def gripper_outcome(gripper: GripperModel, result: Any) -> tuple[str, bool]:
    """Describe the position of a gripper after a command, and whether it is the goal.

    - ``result``: GripperCommand.Result.
    """
    value = gripper.value({gripper.joints[0].name: result.position})
    wide = " wide" if gripper.opening is not None else ""
    # Rounding of a closed gripper is no width.
    at = f"{round(value, 6) + 0.0:.4g} {gripper.unit}{wide}"
    if result.reached_goal:
        return at, True
    if result.stalled:
        return f"stopped by something at {at}", False
    return f"the motion ended early, at {at}", False
