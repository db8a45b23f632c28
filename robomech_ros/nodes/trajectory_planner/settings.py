"""The parameters of the trajectory planner."""

from dataclasses import dataclass
from typing import Any

from robomech_ros.execution.joints import TIME_TO_ACCELERATION, TIME_TO_SPEED
from robomech_ros.nodes.common.joint_positions import StateSettings
from robomech_ros.nodes.common.parameters import changeable, parameter

# Between samples nearer than this (s) the jerk drowns in the rounding of the positions.
SHORTEST_PERIOD = 1e-4


@dataclass(frozen=True)
class PlannerSettings(StateSettings):
    """Parameters of the node."""

    joint_limits: str = parameter(
        "",
        "Path of a YAML file with limits missing from the robot description: MoveIt's "
        "joint_limits.yaml, or the format of a file next to a URDF. Empty = none",
    )
    assume_limits: bool = parameter(
        False,
        "Assume missing limits of acceleration and jerk: full speed in "
        f"{TIME_TO_SPEED:g} s, full acceleration in {TIME_TO_ACCELERATION:g} s; bringup sets it, "
        "in trajectory_planner.bringup.yaml",
    )
    sample_period: float = changeable(
        0.01,
        "Largest time between two points of a planned trajectory, for requests without one; "
        "lengthened to respect max_points",
        (SHORTEST_PERIOD, 10.0, "s"),
    )
    limit_margin: float = changeable(
        0.0,
        "Fraction by which planned motions stay below the limits of velocity, acceleration and "
        "jerk; such as 0.01 for a controller whose limiter reports rounding errors",
        (0.0, 0.5),
    )
    max_points: int = changeable(
        10_000,
        "Largest number of points of a planned trajectory; a request that needs more is rejected",
        (10, 1_000_000, "points"),
    )
    max_duration: float = changeable(
        3600.0, "Longest trajectory; a request that needs more is rejected", (0.001, 1e6, "s")
    )
    max_waypoints: int = changeable(
        200,
        "Largest number of via points, or waypoints of a Cartesian path. Each takes up to about "
        "60 ms to plan, while other such requests wait",
        (1, 100_000, "points"),
    )
    max_step: float = changeable(
        0.01,
        "Spacing of neighbouring poses for the jump check along a Cartesian path, for requests "
        "without one",
        (1e-4, 1.0, "m"),
    )
    revolute_jump_threshold: float = changeable(
        0.5,
        "Largest move of a revolute joint between neighbouring poses, for requests without one",
        (1e-3, 10.0, "rad"),
    )
    prismatic_jump_threshold: float = changeable(
        0.1,
        "Largest move of a prismatic joint between neighbouring poses, for requests without one",
        (1e-4, 10.0, "m"),
    )
    condition_limit: float = changeable(
        200.0,
        "Condition number of the Jacobian (lengths divided by the size of the arm) at which a "
        "posture counts as singular, for requests without one",
        (1.0, 1e6),
    )
    position_only_ik: bool = changeable(
        False,
        "compute_cartesian_path keeps only the position of the link and leaves its orientation "
        "free, as MoveIt does for a group whose solver has this parameter",
    )
    stopped_velocity_tolerance: float = changeable(
        0.01,
        "Largest speed of a joint, rad/s or m/s, that counts as rest when a plan starts from the "
        "current state",
        (0.0, 10.0),
    )

    @property
    def most(self) -> dict[str, Any]:
        """How large a plan may be, as keywords of what plans."""
        return {"max_points": self.max_points, "max_duration": self.max_duration}
