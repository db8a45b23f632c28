"""Parameters of the trajectory publisher."""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.execution_request import Transport
from robomech_ros.nodes.common.messages.execute_goals import AskedTolerances, ExecuteGoals
from robomech_ros.nodes.common.parameters import ParameterError, changeable, parameter
from robomech_ros.nodes.common.robot.robot_description import RobotSettings
from robomech_ros.nodes.middleware.liveliness import SHORTEST_LEASE

if TYPE_CHECKING:
    from robomech_ros.nodes.common.messages.follow_goals import FollowGoals


@dataclass(frozen=True)
class PublisherSettings(RobotSettings):
    """Parameters of the node."""

    controller: str = parameter(
        "joint_trajectory_controller",
        "Name of the controller, before /joint_trajectory, /execute_trajectory and "
        "/follow_joint_trajectory",
    )
    planner_topic: str = parameter(
        "trajectory_planner/planned_trajectory",
        "Latched topic of the planner, besides planned_trajectory. Empty = none",
    )
    auto_execute: bool = changeable(
        False, "Execute every new plan at once; otherwise only on request through ~/execute"
    )
    program: str = changeable(
        "",
        "YAML file of the program for ~/run_program: its path, or its name in program_folder. "
        "Only such a name may be set at run time. Empty = none",
    )
    program_folder: str = parameter(
        "", "Folder of all programs that may run. Empty = only the one named at startup"
    )
    transport: str = parameter(
        Transport.TOPIC.value,
        "Transport of plans to the controller: topic, action = execute_trajectory, or "
        "follow_joint_trajectory of control_msgs, which any ros2_control controller serves. "
        "~/execute and programs always use an action, by default execute_trajectory",
        choices=tuple(transport.value for transport in Transport),
    )
    controller_path_tolerance: float = parameter(
        0.0,
        "Path tolerance sent with every action goal, rad or m; 0 = the controller's default, -1 = "
        "any distance",
        (-1.0, 10.0),
    )
    controller_goal_tolerance: float = parameter(
        0.0,
        "Tolerance at the last point, sent with every action goal, rad or m; 0 = the controller's "
        "default, -1 = any distance",
        (-1.0, 10.0),
    )
    controller_goal_time: float = parameter(
        0.0,
        "Time to reach the goal after the end of a trajectory, sent with every action goal; 0 = "
        "the controller's default",
        (0.0, 3600.0, "s"),
    )
    queue_size: int = parameter(
        50,
        "Largest number of trajectories that wait for the current one",
        (1, 10_000, "trajectories"),
    )
    check_collisions: bool = changeable(
        True,
        "With a planning scene on monitored_planning_scene, refuse motions into contact, and stop "
        "before contact if the scene changes on the way; needs robot_description",
    )
    start_tolerance: float = parameter(
        0.01,
        "Largest distance of a trajectory's start from the current position, rad or m",
        (0.0, 10.0),
    )
    goal_tolerance: float = parameter(
        0.01, "Largest distance of the robot from the last point at arrival, rad or m", (1e-9, 10.0)
    )
    controller_timeout: float = parameter(
        3.0, "Absence of the controller after which it counts as disconnected", (0.1, 3600.0, "s")
    )
    controller_lease: float = parameter(
        1.0,
        "Liveliness lease of the simulated controller; when it expires, the process counts as "
        "dead at once. controller_timeout applies to other controllers",
        (SHORTEST_LEASE, 3600.0, "s"),
    )
    arrival_timeout: float = parameter(
        2.0, "Longest time from the end of a motion to its arrival", (0.1, 3600.0, "s")
    )
    standstill_timeout: float = parameter(
        1.0,
        "Longest standstill away from the goal during a trajectory sent by topic; then the robot "
        "counts as stopped",
        (0.1, 3600.0, "s"),
    )
    watch_rate: float = parameter(
        20.0, "Rate of joint state checks during a motion", (1.0, 1000.0, "Hz")
    )
    max_points: int = parameter(
        10_000,
        "Largest number of points; longer trajectories are rejected",
        (1, 1_000_000, "points"),
    )
    max_duration: float = parameter(
        3600.0, "Longest trajectory; longer ones are rejected", (0.001, 1e6, "s")
    )


def answering_transport(settings: PublisherSettings) -> Transport:
    """Return the transport by which the controller says how a motion ended."""
    wanted = Transport(settings.transport)
    return wanted if wanted.answers else Transport.ACTION


def asked_tolerances(settings: PublisherSettings) -> AskedTolerances:
    """Return the tolerances of goals; ParameterError for one between -1 and 0."""
    asked = AskedTolerances(
        path=settings.controller_path_tolerance,
        goal=settings.controller_goal_tolerance,
        goal_time=settings.controller_goal_time,
    )
    for what, value in (("path", asked.path), ("goal", asked.goal)):
        if -1.0 < value < 0.0:
            allowed = "-1 (any distance), 0 (the controller's default), or a number up to 10"
            raise ParameterError(f"controller_{what}_tolerance", value, allowed)
    return asked


def action_goals(transport: Transport) -> "ExecuteGoals | FollowGoals":
    """Return the action of a transport; ParameterError if its package is not installed."""
    if transport is not Transport.FOLLOW:
        return ExecuteGoals()
    try:
        from robomech_ros.nodes.common.messages.follow_goals import FollowGoals
    except ImportError as error:
        allowed = f"'topic' or 'action', since control_msgs cannot be used ({error})"
        raise ParameterError("transport", transport.value, allowed) from None
    return FollowGoals()


def dispatch_settings(settings: PublisherSettings) -> DispatchSettings:
    """Pick what the dispatcher needs."""
    names = (row.name for row in fields(DispatchSettings) if row.name != "capacity")
    same = {name: getattr(settings, name) for name in names}
    return DispatchSettings(capacity=settings.queue_size, **same)
