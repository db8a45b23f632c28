"""Motions of a robot along paths of its tip: how far the joints can follow, and why not farther.

A pose path is followed until the arm has no posture, a joint would jump or leave its limits, or a
posture is too near to a singularity; the part that can be followed is timed within the limits of
all joints. Each part is loaded on first use.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.cartesian.arms import serial_arm
    from robomech_ros.cartesian.following import (
        PathFollowingResult,
        StopReason,
        follow_path,
        waypoint_fraction,
    )
    from robomech_ros.cartesian.link_speeds import link_speed_limit
    from robomech_ros.cartesian.path_checks import (
        PathCheck,
        PathStopLimits,
        relative_jump,
        stop_on_condition,
    )
    from robomech_ros.cartesian.planning import CartesianPlan, plan_along, plan_followed
    from robomech_ros.cartesian.sampling import Sampling
    from robomech_ros.cartesian.waypoint_paths import waypoint_path

__all__ = [
    "CartesianPlan",
    "PathCheck",
    "PathFollowingResult",
    "PathStopLimits",
    "Sampling",
    "StopReason",
    "follow_path",
    "link_speed_limit",
    "plan_along",
    "plan_followed",
    "relative_jump",
    "serial_arm",
    "stop_on_condition",
    "waypoint_fraction",
    "waypoint_path",
]

_MODULES = {
    "CartesianPlan": "planning",
    "PathFollowingResult": "following",
    "PathStopLimits": "path_checks",
    "PathCheck": "path_checks",
    "Sampling": "sampling",
    "StopReason": "following",
    "stop_on_condition": "path_checks",
    "follow_path": "following",
    "link_speed_limit": "link_speeds",
    "waypoint_path": "waypoint_paths",
    "plan_along": "planning",
    "plan_followed": "planning",
    "relative_jump": "path_checks",
    "serial_arm": "arms",
    "waypoint_fraction": "following",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
