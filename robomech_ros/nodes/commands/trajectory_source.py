"""Trajectories from a topic, or from a file in YAML."""

from pathlib import Path
from typing import Any

from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import BadValueError
from robomech_ros.execution.received_trajectory import ReceivedTrajectory, read_waypoints
from robomech_ros.nodes.commands.message_yaml import fill_message, parse_yaml
from robomech_ros.nodes.commands.service_client import command_node, latched_message
from robomech_ros.nodes.common.messages.message_fields import seconds_from_duration
from robomech_ros.trajectory import Waypoints

# Most points and longest time (s) of a picture.
_MOST_POINTS, _LONGEST = 1_000_000, 1e7
_LARGEST_FILE = 1 << 28


def from_topic(topic: str, timeout: float) -> JointTrajectory | None:
    """Wait for a latched trajectory."""
    with command_node("robomech_plot") as node:
        return latched_message(node, JointTrajectory, topic, timeout)


def from_file(path: Path) -> JointTrajectory:
    """Read a trajectory, or the one in the answer of a planner, or of MoveIt."""
    try:
        with path.open("rb") as stream:
            text = stream.read(_LARGEST_FILE + 1).decode()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise BadValueError("file", str(path), f"a YAML file ({reason})") from None
    if len(text) > _LARGEST_FILE:
        raise BadValueError("file", str(path), f"one of at most {_LARGEST_FILE} bytes")
    # `ros2 topic echo` ends a message with a line of dashes.
    values: Any = parse_yaml(text.split("\n---", 1)[0])
    for key in ("solution", "trajectory", "joint_trajectory"):
        values = values.get(key, values) if isinstance(values, dict) else values
    if not isinstance(values, dict) or "points" not in values:
        expected = "a JointTrajectory, or an answer with a trajectory or solution"
        raise BadValueError("file", str(path), expected)
    message = JointTrajectory()
    fill_message(message, values)
    return message


def waypoints_of(message: JointTrajectory) -> Waypoints:
    """Read the points of a trajectory, in the order of its own joints."""
    times = [
        seconds_from_duration(point.time_from_start, f"points[{k}].time_from_start")
        for k, point in enumerate(message.points)
    ]
    given = ReceivedTrajectory(message.joint_names, times, message.points)
    return read_waypoints(given, message.joint_names, _MOST_POINTS, _LONGEST, to_rest=False)
