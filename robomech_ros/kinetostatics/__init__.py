"""Kinetostatics of serial chains.

Each part is loaded when first asked for, as those of the kinematics are.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinetostatics.accelerations import bias_acceleration, jacobian_rate
    from robomech_ros.kinetostatics.conditioning import (
        CharacteristicLength,
        characteristic_length,
    )
    from robomech_ros.kinetostatics.global_indices import GlobalIndex, global_conditioning_index
    from robomech_ros.kinetostatics.indices import (
        condition_number,
        condition_number_gradient,
        least_singular_value,
        least_singular_value_gradient,
        manipulability,
        manipulability_gradient,
    )
    from robomech_ros.kinetostatics.jacobians import jacobian
    from robomech_ros.kinetostatics.points import point_jacobian
    from robomech_ros.kinetostatics.reachability import ReachMap, load_reach_map, reach_map
    from robomech_ros.kinetostatics.rotation_sets import even_rotations, even_turns
    from robomech_ros.kinetostatics.singularities import SingularityReport, singularity_report
    from robomech_ros.kinetostatics.singularity_distance import (
        NearestSingularity,
        nearest_singular_posture,
    )

__all__ = [
    "CharacteristicLength",
    "GlobalIndex",
    "NearestSingularity",
    "ReachMap",
    "SingularityReport",
    "bias_acceleration",
    "characteristic_length",
    "condition_number",
    "condition_number_gradient",
    "even_rotations",
    "even_turns",
    "global_conditioning_index",
    "jacobian",
    "jacobian_rate",
    "least_singular_value",
    "least_singular_value_gradient",
    "load_reach_map",
    "manipulability",
    "manipulability_gradient",
    "nearest_singular_posture",
    "point_jacobian",
    "reach_map",
    "singularity_report",
]

_MODULES = {
    "CharacteristicLength": "conditioning",
    "GlobalIndex": "global_indices",
    "NearestSingularity": "singularity_distance",
    "ReachMap": "reachability",
    "SingularityReport": "singularities",
    "bias_acceleration": "accelerations",
    "characteristic_length": "conditioning",
    "condition_number": "indices",
    "condition_number_gradient": "indices",
    "even_rotations": "rotation_sets",
    "even_turns": "rotation_sets",
    "global_conditioning_index": "global_indices",
    "jacobian": "jacobians",
    "jacobian_rate": "accelerations",
    "least_singular_value": "indices",
    "least_singular_value_gradient": "indices",
    "load_reach_map": "reachability",
    "manipulability": "indices",
    "manipulability_gradient": "indices",
    "nearest_singular_posture": "singularity_distance",
    "point_jacobian": "points",
    "reach_map": "reachability",
    "singularity_report": "singularities",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
