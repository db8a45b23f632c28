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
    from robomech_ros.kinetostatics.singularities import SingularityReport, singularity_report
    from robomech_ros.kinetostatics.singularity_distance import (
        NearestSingularity,
        nearest_singular_posture,
    )

__all__ = [
    "CharacteristicLength",
    "NearestSingularity",
    "SingularityReport",
    "bias_acceleration",
    "characteristic_length",
    "condition_number",
    "condition_number_gradient",
    "jacobian",
    "jacobian_rate",
    "joint_rates",
    "least_singular_value",
    "least_singular_value_gradient",
    "manipulability",
    "manipulability_gradient",
    "nearest_singular_posture",
    "point_jacobian",
    "singularity_report",
]

_MODULES = {
    "CharacteristicLength": "conditioning",
    "NearestSingularity": "singularity_distance",
    "SingularityReport": "singularities",
    "bias_acceleration": "accelerations",
    "characteristic_length": "conditioning",
    "condition_number": "indices",
    "condition_number_gradient": "indices",
    "jacobian": "jacobians",
    "jacobian_rate": "accelerations",
    "joint_rates": "rates",
    "least_singular_value": "indices",
    "least_singular_value_gradient": "indices",
    "manipulability": "indices",
    "manipulability_gradient": "indices",
    "nearest_singular_posture": "singularity_distance",
    "point_jacobian": "points",
    "singularity_report": "singularities",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
