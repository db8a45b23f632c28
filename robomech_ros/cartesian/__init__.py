"""Motions of a robot along paths of its tip: how far the joints can follow, and why not farther.

A pose path is followed until the arm has no posture, a joint would jump or leave its limits, or a
posture is too near to a singularity; the part that can be followed is timed within the limits of
all joints. Each part is loaded on first use.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.cartesian.arms import serial_arm as serial_arm
    from robomech_ros.cartesian.following import (
        PathFollowingResult as PathFollowingResult,
        StopReason as StopReason,
        follow_path as follow_path,
        waypoint_fraction as waypoint_fraction,
    )
    from robomech_ros.cartesian.link_speeds import link_speed_limit as link_speed_limit
    from robomech_ros.cartesian.path_checks import (
        PathCheck as PathCheck,
        PathStopLimits as PathStopLimits,
        relative_jump as relative_jump,
        stop_on_condition as stop_on_condition,
    )
    from robomech_ros.cartesian.planning import (
        CartesianPlan as CartesianPlan,
        plan_along as plan_along,
        plan_followed as plan_followed,
    )
    from robomech_ros.cartesian.sampling import Sampling as Sampling
    from robomech_ros.cartesian.waypoint_paths import waypoint_path as waypoint_path

__getattr__, __all__ = lazy_exports(__name__, globals())
