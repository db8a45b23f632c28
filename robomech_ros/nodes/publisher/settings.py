"""Parameters of the trajectory publisher."""

from dataclasses import dataclass

from robomech_ros.execution.delivery import Transport
from robomech_ros.execution.dispatching import DispatcherSettings
from robomech_ros.nodes.parameters import parameter
from robomech_ros.nodes.robot_description import RobotSettings

__all__ = ["PublisherSettings", "dispatcher_settings"]


@dataclass(frozen=True)
class PublisherSettings(RobotSettings):
    """Parameters of the node."""

    controller: str = parameter(
        "joint_trajectory_controller",
        "Name of the controller, before /joint_trajectory and /execute_trajectory",
    )
    planner_topic: str = parameter(
        "trajectory_planner/planned_trajectory",
        "Latched topic of the planner, taken beside planned_trajectory. Empty = none",
    )
    auto_execute: bool = parameter(
        True,
        "Whether every newly planned trajectory is executed; else only what ~/execute asks for",
        read_only=False,
    )
    program: str = parameter(
        "",
        "Path of a YAML file with the program that ~/run_program runs. Empty = none",
        read_only=False,
    )
    transport: str = parameter(
        Transport.TOPIC.value,
        "How planned trajectories get to the controller; ~/execute always uses the action",
        choices=tuple(transport.value for transport in Transport),
    )
    queue_size: int = parameter(
        50, "How many trajectories may wait for the present one to end", 1, 10_000, "trajectories"
    )
    start_tolerance: float = parameter(
        0.01,
        "How far the start of a trajectory may be from the present position, rad or m",
        0.0,
        10.0,
    )
    goal_tolerance: float = parameter(
        0.01, "How far from the last point the robot has still arrived, rad or m", 1e-9, 10.0
    )
    controller_timeout: float = parameter(
        3.0,
        "How long the controller may be away before those who wait for an answer get it",
        0.1,
        3600.0,
        "s",
    )
    arrival_timeout: float = parameter(
        2.0, "How long after its end a motion may take to arrive", 0.1, 3600.0, "s"
    )
    standstill_timeout: float = parameter(
        1.0,
        "How long the robot may stand away from the goal while a trajectory sent by topic should "
        "move it; then it counts as stopped",
        0.1,
        3600.0,
        "s",
    )
    watch_rate: float = parameter(
        20.0, "How often the joint states are looked at while something moves", 1.0, 1000.0, "Hz"
    )
    max_points: int = parameter(
        10_000, "Most points of a trajectory; longer ones are refused", 1, 1_000_000, "points"
    )
    max_duration: float = parameter(
        3600.0, "Longest trajectory; longer ones are refused", 0.001, 1e6, "s"
    )


def dispatcher_settings(settings: PublisherSettings) -> DispatcherSettings:
    """Pick what the dispatcher needs."""
    return DispatcherSettings(
        capacity=settings.queue_size,
        start_tolerance=settings.start_tolerance,
        goal_tolerance=settings.goal_tolerance,
        controller_timeout=settings.controller_timeout,
        arrival_timeout=settings.arrival_timeout,
        standstill_timeout=settings.standstill_timeout,
    )
