"""The arm of the simulated robot, as the topic, the action and the services command it."""

import threading
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robomech_ros.execution.controller.saturation import saturation_text
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

if TYPE_CHECKING:
    from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant

__all__ = ["SimulatedRobot"]


class SimulatedRobot(CommandedJoints):
    """The joints of a chain, moved exactly, with a lag, or by the forces of their drives.

    Parameters
    ----------
    chain : SerialChain
        The robot.
    settings : ControllerSettings
        Parameters of the node.
    clock : MotionClock
        The time.

    Raises
    ------
    ParameterError
        The initial position does not fit the robot, or parameters do not go together.
    MissingInertiaError, BadValueError
        The robot is to be simulated with its dynamics, and its bodies are not known or impossible.
    """

    def __init__(
        self, chain: SerialChain, settings: ControllerSettings, clock: MotionClock
    ) -> None:
        check_simulation(settings)
        self.chain = chain
        initial = initial_position(settings, chain)
        self._plant = _dynamic_plant(chain, settings, initial)
        simulated = SimulatedJoints(initial, settings.tracking_lag, self._plant)
        super().__init__("~", Joints.of(chain), simulated, settings, clock, threading.RLock())

    @property
    def dynamic(self) -> bool:
        """Whether forces move it."""
        return self._plant is not None

    def unlimited_joints(self) -> list[str]:
        """Name the joints that forces without a limit move."""
        limited = np.isfinite(self.chain.effort) | (not self.dynamic)
        return [self.joint_names[int(joint)] for joint in np.flatnonzero(~limited)]

    def saturation(self) -> str:
        """Say which drives were at their limits since the last motion began; empty for none."""
        return saturation_text(self.simulated_joints.at_limit, self.joint_names)

    def carry(self, settings: ControllerSettings) -> None:
        """Have it carry the payload of these settings from now on."""
        if self._plant is not None:
            self._plant.carry(settings)


def _dynamic_plant(
    chain: SerialChain, settings: ControllerSettings, position: NDArray[np.float64]
) -> "DynamicPlant | None":
    """Make the drives and what they move; None where no forces are simulated."""
    if settings.simulation != DYNAMIC:
        return None
    # Compiled code is loaded only where it is needed.
    from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant

    return DynamicPlant(chain, settings, position)
