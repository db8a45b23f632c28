"""One motion of the gripper of a running robot."""

import dataclasses
import time
from typing import Any

import rclpy
from control_msgs.action import GripperCommand
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.nodes.commands.service_client import (
    NoAnswerError,
    answer_of,
    command_node,
    latched_message,
)
from robomech_ros.nodes.common.robot.gripper_names import (
    GripperNames,
    gripper_goal,
    gripper_outcome,
    known_finger_joints,
    known_gripper,
)
from robomech_ros.nodes.common.robot.robot_description import TOPIC, RobotModel
from robomech_ros.nodes.common.robot.srdf_source import SemanticSource
from robomech_ros.nodes.middleware.queue_depth import ask_action
from robomech_ros.parallel.tree_description import load_tree_description
from robomech_ros.robots.gripper import GripperModel

OPEN, CLOSE = "open", "close"


class NoGripperError(RobomechError):
    """A robot has no gripper that one value moves; the text says why."""


def move_gripper(wanted: str, namespace: str, controller: str, timeout: float) -> tuple[str, bool]:
    """Open or close the gripper, and wait until it is there or stopped.

    - ``wanted``: ``open``, ``close``, or a width (m); a position (rad or m) if the width is not
      known.
    - ``namespace``: namespace of the robot's nodes.
    - ``controller``: name of the node whose parameters say which joints are the gripper.
    - ``timeout``: longest wait (s).

    Returns a text with the width or position of the gripper, and whether it is the wanted one.

    Raises BadValueError: ``wanted`` is not a number, or out of range. NoGripperError: the robot
    has no gripper. NoAnswerError: a node or the robot's description is missing, or there is no
    answer in time.
    """
    number = None if wanted in (OPEN, CLOSE) else _number(wanted)
    deadline = time.monotonic() + timeout
    with command_node("robomech_gripper", namespace) as node:
        settings = _settings(node, f"{controller}/get_parameters", timeout)
        gripper = _gripper(_model(node, settings, deadline, timeout), settings)
        if number is None:
            number = _end(gripper, wanted)
        goal, name = gripper_goal(gripper, number), f"{settings.gripper_controller}/gripper_cmd"
        client = ask_action(node, GripperCommand, name)
        if not client.wait_for_server(timeout_sec=max(0.0, deadline - time.monotonic())):
            raise NoAnswerError(f"action '{name}' is not there after {timeout:g} s")
        missing = f"action '{name}' did not answer within {timeout:g} s"
        handle = _done(node, client.send_goal_async(goal), deadline, missing)
        if not handle.accepted:
            return f"'{name}' rejected the goal; its log and /diagnostics say why", False
        answer = _done(node, handle.get_result_async(), deadline, missing)
        return gripper_outcome(gripper, answer.result)


def _number(wanted: str) -> float:
    try:
        return float(wanted)
    except ValueError:
        raise BadValueError("width", wanted, "open, close or a number in m") from None


def _settings(node: Node, service: str, timeout: float) -> GripperNames:
    """Ask the controller which joints are the gripper, and what commands it."""
    names = [field.name for field in dataclasses.fields(GripperNames)]
    full = node.resolve_service_name(service)
    answer = answer_of(node, full, "rcl_interfaces/srv/GetParameters", {"names": names}, timeout)
    texts: list[Any] = [
        tuple(value.string_array_value) if name == "groups" else value.string_value
        for name, value in zip(names, answer.values, strict=False)
    ]
    return GripperNames(**dict(zip(names, texts, strict=False)))


def _model(node: Node, settings: GripperNames, deadline: float, timeout: float) -> RobotModel:
    received = latched_message(node, String, TOPIC, deadline - time.monotonic())
    if received is None:
        topic = node.resolve_topic_name(TOPIC)
        raise NoAnswerError(f"nothing received on '{topic}' within {timeout:g} s")
    loaded = load_tree_description(received.data)
    semantic = SemanticSource(node, settings).semantic(loaded.description)
    return RobotModel(loaded.description, settings, semantic)


def _gripper(model: RobotModel, settings: GripperNames) -> GripperModel:
    gripper = known_gripper(model, settings)
    if gripper is not None:
        return gripper
    name, joints = model.chain.name, known_finger_joints(model, settings)
    if not joints:
        raise NoGripperError(
            f"robot '{name}' has no gripper: no joint moves behind '{model.chain.joint_names[-1]}'"
        )
    names = ", ".join(joint.name for joint in joints)
    text = "give the controller the parameter gripper_joint"
    raise NoGripperError(f"the gripper of '{name}' has the joints {names}: {text}")


def _end(gripper: GripperModel, wanted: str) -> float:
    low, high = gripper.limits
    if gripper.opening is None:
        name, unit = gripper.joints[0].name, gripper.unit
        raise BadValueError(
            "width",
            wanted,
            f"a position of joint '{name}', {low:.4g} to {high:.4g} {unit}; for widths give the "
            "controller the parameter gripper_finger_links",
        )
    return high if wanted == OPEN else low


def _done(node: Node, future: Future, deadline: float, missing: str) -> Any:
    left = max(0.0, deadline - time.monotonic())
    rclpy.spin_until_future_complete(node, future, timeout_sec=left)
    if not future.done():
        raise NoAnswerError(missing)
    return future.result()
