"""Parameters of every node that plans motions."""

from dataclasses import dataclass
from typing import Any

from robomech_ros.execution.joints import TIME_TO_ACCELERATION, TIME_TO_SPEED
from robomech_ros.nodes.common.joints.joint_positions import StateSettings
from robomech_ros.nodes.common.parameters import changeable, parameter

# Below this period (s) the jerk is lost in the rounding of the positions.
SHORTEST_PERIOD = 1e-4


@dataclass(frozen=True)
class PlanSettings(StateSettings):
    """Limits of the robot, and how large a plan may be."""

    joint_limits: str = parameter(
        "",
        "Path of a YAML file with limits missing from the robot description: MoveIt's "
        "joint_limits.yaml, or the format of a file next to a URDF. Empty = none",
    )
    assume_limits: bool = parameter(
        False,
        "Assume missing limits of acceleration and jerk: full speed in "
        f"{TIME_TO_SPEED:g} s, full acceleration in {TIME_TO_ACCELERATION:g} s; bringup sets it, "
        "in <node>.bringup.yaml",
    )
    sample_period: float = changeable(
        0.01,
        "Largest time between two points of a planned trajectory, for requests without one; "
        "lengthened to respect max_points",
        (SHORTEST_PERIOD, 10.0, "s"),
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
    stopped_velocity_tolerance: float = changeable(
        0.01,
        "Largest speed of a joint, rad/s or m/s, that counts as rest when a plan starts from the "
        "current state",
        (0.0, 10.0),
    )

    @property
    def most(self) -> dict[str, Any]:
        """Limits on the size of a plan, as keywords of planners."""
        return {"max_points": self.max_points, "max_duration": self.max_duration}
