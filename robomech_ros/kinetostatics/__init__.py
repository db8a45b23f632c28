"""Kinetostatics of serial chains.

Each part is loaded on first use, like those of the kinematics.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinetostatics.accelerations import (
        bias_acceleration,
        jacobian_rate,
        joint_accelerations,
    )
    from robomech_ros.kinetostatics.best_posture import BestPosture, best_conditioned_posture
    from robomech_ros.kinetostatics.conditioning import (
        CharacteristicLength,
        ConditioningIndex,
        characteristic_length,
        conditioning_index,
    )
    from robomech_ros.kinetostatics.decoupled_blocks import DecoupledJacobian, decoupled_jacobian
    from robomech_ros.kinetostatics.ellipsoids import (
        ManipulabilityEllipsoid,
        manipulability_ellipsoid,
    )
    from robomech_ros.kinetostatics.global_indices import GlobalIndex, global_conditioning_index
    from robomech_ros.kinetostatics.indices import (
        condition_number,
        condition_number_gradient,
        least_singular_value_gradient,
        manipulability,
        manipulability_gradient,
        min_singular_value,
    )
    from robomech_ros.kinetostatics.jacobians import jacobian
    from robomech_ros.kinetostatics.maps.reachability import ReachMap, load_reach_map, reach_map
    from robomech_ros.kinetostatics.point_jacobians import point_jacobian
    from robomech_ros.kinetostatics.rates import joint_rates
    from robomech_ros.kinetostatics.reduced_jacobians import (
        planar_jacobian,
        planar_rows,
        task_jacobian,
    )
    from robomech_ros.kinetostatics.rotation_sets import uniform_rotations, uniform_turns
    from robomech_ros.kinetostatics.self_motions import SelfMotionCurve, self_motion_curve
    from robomech_ros.kinetostatics.singularities.distance import (
        NearestSingularity,
        nearest_singular_posture,
    )
    from robomech_ros.kinetostatics.singularities.free_intervals import (
        SingularityFree,
        singularity_free,
    )
    from robomech_ros.kinetostatics.singularities.report import (
        SingularityReport,
        SingularityReports,
        singularity_report,
    )
    from robomech_ros.kinetostatics.statics import joint_torques, wrench_from_torques
    from robomech_ros.kinetostatics.workspace.boundary import (
        BoundaryCurve,
        Workspace,
        workspace_boundary,
    )
    from robomech_ros.kinetostatics.workspace.orientation import (
        OrientationWorkspace,
        orientation_workspace,
    )
    from robomech_ros.kinetostatics.workspace.reach import reach_limits

__all__ = [
    "BestPosture",
    "BoundaryCurve",
    "CharacteristicLength",
    "ConditioningIndex",
    "DecoupledJacobian",
    "GlobalIndex",
    "ManipulabilityEllipsoid",
    "NearestSingularity",
    "OrientationWorkspace",
    "ReachMap",
    "SelfMotionCurve",
    "SingularityFree",
    "SingularityReport",
    "SingularityReports",
    "Workspace",
    "best_conditioned_posture",
    "bias_acceleration",
    "characteristic_length",
    "condition_number",
    "condition_number_gradient",
    "conditioning_index",
    "decoupled_jacobian",
    "global_conditioning_index",
    "jacobian",
    "jacobian_rate",
    "joint_accelerations",
    "joint_rates",
    "joint_torques",
    "least_singular_value_gradient",
    "load_reach_map",
    "manipulability",
    "manipulability_ellipsoid",
    "manipulability_gradient",
    "min_singular_value",
    "nearest_singular_posture",
    "orientation_workspace",
    "planar_jacobian",
    "planar_rows",
    "point_jacobian",
    "reach_limits",
    "reach_map",
    "self_motion_curve",
    "singularity_free",
    "singularity_report",
    "task_jacobian",
    "uniform_rotations",
    "uniform_turns",
    "workspace_boundary",
    "wrench_from_torques",
]

_MODULES = {
    "BestPosture": "best_posture",
    "best_conditioned_posture": "best_posture",
    "ManipulabilityEllipsoid": "ellipsoids",
    "manipulability_ellipsoid": "ellipsoids",
    "SelfMotionCurve": "self_motions",
    "self_motion_curve": "self_motions",
    "BoundaryCurve": "workspace.boundary",
    "CharacteristicLength": "conditioning",
    "GlobalIndex": "global_indices",
    "NearestSingularity": "singularities.distance",
    "OrientationWorkspace": "workspace.orientation",
    "ReachMap": "maps.reachability",
    "ConditioningIndex": "conditioning",
    "DecoupledJacobian": "decoupled_blocks",
    "SingularityFree": "singularities.free_intervals",
    "SingularityReport": "singularities.report",
    "SingularityReports": "singularities.report",
    "Workspace": "workspace.boundary",
    "bias_acceleration": "accelerations",
    "characteristic_length": "conditioning",
    "condition_number": "indices",
    "condition_number_gradient": "indices",
    "uniform_rotations": "rotation_sets",
    "uniform_turns": "rotation_sets",
    "reach_limits": "workspace.reach",
    "global_conditioning_index": "global_indices",
    "conditioning_index": "conditioning",
    "decoupled_jacobian": "decoupled_blocks",
    "jacobian": "jacobians",
    "jacobian_rate": "accelerations",
    "joint_accelerations": "accelerations",
    "joint_rates": "rates",
    "joint_torques": "statics",
    "min_singular_value": "indices",
    "least_singular_value_gradient": "indices",
    "load_reach_map": "maps.reachability",
    "manipulability": "indices",
    "manipulability_gradient": "indices",
    "nearest_singular_posture": "singularities.distance",
    "orientation_workspace": "workspace.orientation",
    "point_jacobian": "point_jacobians",
    "reach_map": "maps.reachability",
    "singularity_report": "singularities.report",
    "workspace_boundary": "workspace.boundary",
    "planar_jacobian": "reduced_jacobians",
    "planar_rows": "reduced_jacobians",
    "singularity_free": "singularities.free_intervals",
    "task_jacobian": "reduced_jacobians",
    "wrench_from_torques": "statics",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
