"""The arm of the simulated robot, as the topic, the action and the services command it."""

import threading
from typing import TYPE_CHECKING

import numpy as np

from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.joints import Joints
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    DYNAMIC,
    ControllerSettings,
    check_simulation,
    initial_position,
)
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.node import Node

    from robomech_ros.dynamics import DynamicSystem
    from robomech_ros.nodes.common.robot.robot_description import RobotModel
    from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant
    from robomech_ros.walking import LeggedRobot


class SimulatedRobot(CommandedJoints):
    """The joints that trajectories command, moved exactly, with a lag, or by forces of drives.

    - ``name``: name of the robot.
    - ``limits``: names and limits of the n joints.
    - ``initial``: initial positions of these joints (rad or m), shape (n,).
    - ``plant``: drives and bodies of a simulation with forces.
    - ``start``: initial positions of all joints (rad or m), if more than these n are published.
    - ``floats``: whether its base moves freely.
    """

    floats = False

    def __init__(
        self,
        name: str,
        limits: JointLimits,
        initial: Array,
        settings: ControllerSettings,
        clock: MotionClock,
        plant: "DynamicPlant | None" = None,
        start: Array | None = None,
    ) -> None:
        self.name, self._plant = name, plant
        joints = Joints.of(limits)
        simulated = SimulatedJoints(initial, settings.tracking_lag, plant, joints.limits)
        super().__init__("~", joints, simulated, settings, clock, threading.RLock(), start)

    def _assume(self, real: Array) -> None:
        if self._plant is not None:
            self._plant.assume(real)

    def publications(
        self, node: "Node", model: "RobotModel", settings: ControllerSettings
    ) -> "Sequence[Callable[[tuple[int, int]], None]]":
        """Return what else is published with each joint state, by its stamp (s and ns)."""
        return ()

    @property
    def dynamic(self) -> bool:
        """True if forces move it."""
        return self._plant is not None

    def unlimited_joints(self) -> list[str]:
        """Name the joints that forces without a limit move."""
        if self._plant is None:
            return []
        unlimited = np.flatnonzero(~np.isfinite(self._plant.effort))
        return [self.joint_names[int(joint)] for joint in unlimited]

    def carry(self, settings: ControllerSettings) -> None:
        """Set the payload from these settings."""
        if self._plant is not None:
            self._plant.carry(settings)


def serial_robot(
    chain: SerialChain, settings: ControllerSettings, clock: MotionClock
) -> SimulatedRobot:
    """Make the simulated arm of a chain.

    Raises ParameterError: the initial position does not fit the robot, or parameters do not go
    together. MissingInertiaError, BadValueError: the robot is to be simulated with its dynamics,
    and its bodies are not known or impossible.
    """
    check_simulation(settings)
    initial = initial_position(settings, Limits.of(chain), chain.home())
    plant = dynamic_plant(lambda: chain, settings, initial)
    return SimulatedRobot(chain.name, chain, initial, settings, clock, plant)


def legged_robot(
    legs: "LeggedRobot", settings: ControllerSettings, clock: MotionClock
) -> SimulatedRobot:
    """Make the simulated joints of all legs.

    Raises ParameterError: the initial position does not fit the robot, or its forces are to be
    simulated.
    """
    check_simulation(settings, why_kinematic=f"'{legs.name}' is a walking machine")
    limits = Limits.of(legs)
    initial = initial_position(settings, limits, legs.home)
    return SimulatedRobot(legs.name, limits, initial, settings, clock)


def dynamic_plant(
    robot: "Callable[[], SerialChain | DynamicSystem]", settings: ControllerSettings, posture: Array
) -> "DynamicPlant | None":
    """Make the drives and what they move; None where no forces are simulated."""
    if settings.simulation != DYNAMIC:
        return None
    # Compiled code is loaded only where it is needed.
    from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant

    return DynamicPlant(robot(), settings, posture)
