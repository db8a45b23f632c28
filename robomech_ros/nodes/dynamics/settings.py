"""Parameters of the node dynamics."""

from dataclasses import dataclass

from robomech_ros.nodes.common.joints.joint_positions import StateSettings
from robomech_ros.nodes.common.parameters import ParameterError, changeable
from robomech_ros.nodes.common.robot.floating_base import FloatingSettings, check_momentum


@dataclass(frozen=True)
class DynamicsSettings(FloatingSettings, StateSettings):
    """Parameters of the node."""

    gravity: tuple[float, ...] = changeable(
        (0.0, 0.0, -9.81),
        "Gravity vector (down) in the base link of the chain, for requests without one",
        (-1000.0, 1000.0, "m/s^2"),
    )
    momentum: tuple[float, ...] = changeable(
        (),
        "Floating base: momentum of the whole robot in the axes of its base, angular about the "
        "mass centre (N m s), then linear (N s). Empty = zero",
        (-1e9, 1e9),
    )
    max_batch_size: int = changeable(
        10_000,
        "Largest number of points in one InverseDynamics or SummarizeTorques request",
        (1, 1_000_000, "points"),
    )
    summary_period: float = changeable(
        0.002,
        "Largest time step of SummarizeTorques; increased if there would be more than 100,000 "
        "steps",
        (1e-4, 1.0, "s"),
    )
    max_duration: float = changeable(
        3600.0, "Longest trajectory for SummarizeTorques", (0.001, 1e6, "s")
    )


def check_settings(settings: DynamicsSettings) -> None:
    """Refuse a gravity that is no vector, and a momentum without six numbers."""
    check_momentum(settings.momentum)
    if len(settings.gravity) != 3:
        raise ParameterError("gravity", list(settings.gravity), "a list of 3 numbers: x, y, z")
