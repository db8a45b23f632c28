"""Dynamics of serial chains.

Each part is loaded when first asked for, as those of the kinematics are.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.dynamics.derivatives import (
        ForwardDerivatives,
        InverseDerivatives,
        forward_dynamics_derivatives,
        inverse_dynamics_derivatives,
    )
    from robomech_ros.dynamics.energy import (
        PowerBalance,
        center_of_mass,
        kinetic_energy,
        momentum,
        potential_energy,
        power_balance,
    )
    from robomech_ros.dynamics.forward import (
        forward_dynamics,
    )
    from robomech_ros.dynamics.friction import (
        dissipated_power,
        dissipation,
        friction_torque,
    )
    from robomech_ros.dynamics.inverse import (
        bias_torque,
        gravity_torque,
        inverse_dynamics,
    )
    from robomech_ros.dynamics.matrices import (
        coriolis_matrix,
        mass_matrix,
    )
    from robomech_ros.dynamics.model import (
        body_parameters,
    )
    from robomech_ros.dynamics.payload import (
        with_payload,
    )
    from robomech_ros.dynamics.regressor import (
        BaseParameters,
        base_parameters,
        torque_regressor,
    )
    from robomech_ros.dynamics.torque_summary import TorqueSummary, torque_summary

__all__ = [
    "BaseParameters",
    "ForwardDerivatives",
    "InverseDerivatives",
    "PowerBalance",
    "TorqueSummary",
    "base_parameters",
    "bias_torque",
    "body_parameters",
    "center_of_mass",
    "coriolis_matrix",
    "dissipated_power",
    "dissipation",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "friction_torque",
    "gravity_torque",
    "inverse_dynamics",
    "inverse_dynamics_derivatives",
    "kinetic_energy",
    "mass_matrix",
    "momentum",
    "potential_energy",
    "power_balance",
    "torque_regressor",
    "torque_summary",
    "with_payload",
]

_MODULES = {
    "BaseParameters": "regressor",
    "ForwardDerivatives": "derivatives",
    "InverseDerivatives": "derivatives",
    "PowerBalance": "energy",
    "TorqueSummary": "torque_summary",
    "base_parameters": "regressor",
    "bias_torque": "inverse",
    "body_parameters": "model",
    "center_of_mass": "energy",
    "coriolis_matrix": "matrices",
    "dissipated_power": "friction",
    "dissipation": "friction",
    "forward_dynamics": "forward",
    "forward_dynamics_derivatives": "derivatives",
    "friction_torque": "friction",
    "gravity_torque": "inverse",
    "inverse_dynamics": "inverse",
    "inverse_dynamics_derivatives": "derivatives",
    "kinetic_energy": "energy",
    "mass_matrix": "matrices",
    "momentum": "energy",
    "potential_energy": "energy",
    "power_balance": "energy",
    "torque_regressor": "regressor",
    "torque_summary": "torque_summary",
    "with_payload": "payload",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
