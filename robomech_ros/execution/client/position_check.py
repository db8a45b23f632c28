"""The robot's position, compared with where a trajectory begins and ends."""

import numpy as np

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.joints import JointKinds
from robomech_ros.execution.rejections import start_mismatch
from robomech_ros.typing import Array, BoolArray

# A robot whose joints move by less than this (rad, m) between two looks stands.
STILL = 1e-3


def joint_distance(first: Array, second: Array, continuous: BoolArray) -> Array:
    """Return distances (..., n) of joint positions, without whole turns of continuous joints."""
    difference = np.asarray(first - second)
    turned = difference - np.round(difference / (2.0 * np.pi)) * (2.0 * np.pi)
    return np.abs(np.where(continuous, turned, difference))


def _worst(wanted: Array, positions: Array, kinds: JointKinds) -> tuple[int, float]:
    """Return the joint that is farthest from where it is wanted, and how far that is."""
    distance = joint_distance(wanted, positions, kinds.continuous)
    worst = int(np.argmax(distance))
    return worst, float(distance[worst])


def off_start(
    delivery: ExecutionRequest, positions: Array, kinds: JointKinds, tolerance: float
) -> str:
    """Say how a robot is off the start of a delivery; empty if it is there, or need not be."""
    if delivery.start is None:
        return ""
    worst, apart = _worst(delivery.start, positions, kinds)
    if apart <= tolerance:
        return ""
    start, present = float(delivery.start[worst]), float(positions[worst])
    name, unit = delivery.names[worst], kinds.units[worst]
    return start_mismatch(name, start, present, apart, tolerance, unit)


def off_goal(
    delivery: ExecutionRequest,
    positions: Array,
    kinds: JointKinds,
    tolerance: float,
    moved: bool = False,
) -> str:
    """Say by how much which joint is off the goal of a delivery; empty if the robot is there.

    It has ``moved`` if it was seen elsewhere since the delivery was sent.
    """
    worst, apart = _worst(delivery.goal, positions, kinds)
    if apart <= tolerance:
        return ""
    unit = f" {kinds.units[worst]}" if kinds.units[worst] else ""
    text = (
        f"joint '{delivery.names[worst]}' is at {positions[worst]:.6g}{unit}, "
        f"{apart:.3g}{unit} off its goal {delivery.goal[worst]:.6g}{unit}, "
        f"allowed is {tolerance:.3g}{unit}"
    )
    start = delivery.start
    if start is not None and _worst(start, positions, kinds)[1] <= STILL:
        still = "the robot has not moved, the controller's log may say why"
        text += f"; {'the robot is back at its start' if moved else still}"
    return text
