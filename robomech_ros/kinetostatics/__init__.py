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
    from robomech_ros.kinetostatics.workspace import (
        BoundaryCurve,
        Workspace,
        workspace_boundary,
    )
    from robomech_ros.kinetostatics.workspace_orientation import (
        OrientationWorkspace,
        orientation_workspace,
    )
    from robomech_ros.kinetostatics.workspace_reach import extreme_reach

__all__ = [
    "BoundaryCurve",
    "CharacteristicLength",
    "GlobalIndex",
    "NearestSingularity",
    "OrientationWorkspace",
    "ReachMap",
    "SingularityReport",
    "Workspace",
    "bias_acceleration",
    "characteristic_length",
    "condition_number",
    "condition_number_gradient",
    "even_rotations",
    "even_turns",
    "extreme_reach",
    "global_conditioning_index",
    "jacobian",
    "jacobian_rate",
    "least_singular_value",
    "least_singular_value_gradient",
    "load_reach_map",
    "manipulability",
    "manipulability_gradient",
    "nearest_singular_posture",
    "orientation_workspace",
    "point_jacobian",
    "reach_map",
    "singularity_report",
    "workspace_boundary",
]

_MODULES = {
    "BoundaryCurve": "workspace",
    "CharacteristicLength": "conditioning",
    "GlobalIndex": "global_indices",
    "NearestSingularity": "singularity_distance",
    "OrientationWorkspace": "workspace_orientation",
    "ReachMap": "reachability",
    "SingularityReport": "singularities",
    "Workspace": "workspace",
    "bias_acceleration": "accelerations",
    "characteristic_length": "conditioning",
    "condition_number": "indices",
    "condition_number_gradient": "indices",
    "even_rotations": "rotation_sets",
    "even_turns": "rotation_sets",
    "extreme_reach": "workspace_reach",
    "global_conditioning_index": "global_indices",
    "jacobian": "jacobians",
    "jacobian_rate": "accelerations",
    "least_singular_value": "indices",
    "least_singular_value_gradient": "indices",
    "load_reach_map": "reachability",
    "manipulability": "indices",
    "manipulability_gradient": "indices",
    "nearest_singular_posture": "singularity_distance",
    "orientation_workspace": "workspace_orientation",
    "point_jacobian": "points",
    "reach_map": "reachability",
    "singularity_report": "singularities",
    "workspace_boundary": "workspace",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
