"""Parameters of the node move_group."""

from dataclasses import dataclass

from robomech_ros.collision.libraries import PLANNERS
from robomech_ros.nodes.common.joints.plan_settings import PlanSettings
from robomech_ros.nodes.common.parameters import changeable, parameter


@dataclass(frozen=True)
class MoveGroupSettings(PlanSettings):
    """Parameters of the node."""

    controller: str = parameter(
        "joint_trajectory_controller",
        "Name of the controller, before /follow_joint_trajectory, which any ros2_control "
        "controller serves",
    )
    controller_timeout: float = changeable(
        3.0, "Absence of the controller after which a motion fails", (0.1, 3600.0, "s")
    )
    start_tolerance: float = changeable(
        0.01,
        "Largest distance of a trajectory's start from the current position, rad or m, for "
        "execute_trajectory",
        (0.0, 10.0),
    )
    padding: float = parameter(
        0.0, "Thickness that is added to every link for the check of collisions", (0.0, 1.0, "m")
    )
    clearance: float = changeable(
        0.0,
        "Distance that planned motions keep between the robot and everything else",
        (0.0, 1.0, "m"),
    )
    planning_time: float = changeable(
        5.0, "Time limit of a plan, for requests without one", (0.01, 600.0, "s")
    )
    planner: str = changeable(
        PLANNERS[0], "Planner of OMPL, for requests without one", choices=PLANNERS
    )
    seed: int = changeable(
        0,
        "Seed of the planner: the same request with the same seed has the same answer",
        (0, 2**31 - 2),
    )
    max_links: int = changeable(
        10_000, "Largest number of links in one request of compute_fk", (1, 10_000_000, "links")
    )
    position_only_ik: bool = changeable(
        False,
        "compute_cartesian_path keeps only the position of the link and leaves its orientation "
        "free, as MoveIt does for a group whose solver has this parameter",
    )
