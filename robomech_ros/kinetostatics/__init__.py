"""Kinetostatics of serial chains.

Each part is loaded when first asked for, as those of the kinematics are.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinetostatics.accelerations import (
        bias_acceleration,
        jacobian_rate,
        joint_accelerations,
    )
    from robomech_ros.kinetostatics.conditioning import (
        CharacteristicLength,
        ConditioningIndex,
        characteristic_length,
        conditioning_index,
    )
    from robomech_ros.kinetostatics.decoupled_blocks import DecoupledJacobian, decoupled_jacobian
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
    from robomech_ros.kinetostatics.rates import joint_rates
    from robomech_ros.kinetostatics.reduced import planar_jacobian, planar_rows, task_jacobian
    from robomech_ros.kinetostatics.singularities import SingularityReport, singularity_report
    from robomech_ros.kinetostatics.singularity_distance import (
        NearestSingularity,
        nearest_singular_posture,
    )
    from robomech_ros.kinetostatics.singularity_free import SingularityFree, singularity_free
    from robomech_ros.kinetostatics.statics import joint_torques, wrench_from_torques

__all__ = [
    "CharacteristicLength",
    "ConditioningIndex",
    "DecoupledJacobian",
    "NearestSingularity",
    "SingularityFree",
    "SingularityReport",
    "bias_acceleration",
    "characteristic_length",
    "condition_number",
    "condition_number_gradient",
    "conditioning_index",
    "decoupled_jacobian",
    "jacobian",
    "jacobian_rate",
    "joint_accelerations",
    "joint_rates",
    "joint_torques",
    "least_singular_value",
    "least_singular_value_gradient",
    "manipulability",
    "manipulability_gradient",
    "nearest_singular_posture",
    "planar_jacobian",
    "planar_rows",
    "point_jacobian",
    "singularity_free",
    "singularity_report",
    "task_jacobian",
    "wrench_from_torques",
]

_MODULES = {
    "CharacteristicLength": "conditioning",
    "ConditioningIndex": "conditioning",
    "DecoupledJacobian": "decoupled_blocks",
    "NearestSingularity": "singularity_distance",
    "SingularityFree": "singularity_free",
    "SingularityReport": "singularities",
    "bias_acceleration": "accelerations",
    "characteristic_length": "conditioning",
    "condition_number": "indices",
    "condition_number_gradient": "indices",
    "conditioning_index": "conditioning",
    "decoupled_jacobian": "decoupled_blocks",
    "jacobian": "jacobians",
    "jacobian_rate": "accelerations",
    "joint_accelerations": "accelerations",
    "joint_rates": "rates",
    "joint_torques": "statics",
    "least_singular_value": "indices",
    "least_singular_value_gradient": "indices",
    "manipulability": "indices",
    "manipulability_gradient": "indices",
    "nearest_singular_posture": "singularity_distance",
    "planar_jacobian": "reduced",
    "planar_rows": "reduced",
    "point_jacobian": "points",
    "singularity_free": "singularity_free",
    "singularity_report": "singularities",
    "task_jacobian": "reduced",
    "wrench_from_torques": "statics",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
