"""The parameters of the trajectory planner."""

from dataclasses import dataclass

from robomech_ros.nodes.common.joints.plan_settings import PlanSettings
from robomech_ros.nodes.common.parameters import changeable
from robomech_ros.nodes.common.robot.floating_base import FloatingSettings


@dataclass(frozen=True)
class PlannerSettings(FloatingSettings, PlanSettings):
    """Parameters of the node."""

    limit_margin: float = changeable(
        0.0,
        "Fraction by which planned motions stay below the limits of velocity, acceleration and "
        "jerk; such as 0.01 for a controller whose limiter reports rounding errors",
        (0.0, 0.5),
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
