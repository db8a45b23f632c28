"""Dynamics of serial chains, and of bodies under constraints of any kind.

Each part is loaded on first use, like those of the kinematics.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.dynamics.chain_dynamics import ChainDynamics
    from robomech_ros.dynamics.complement.constrained_bodies import ConstrainedBodies
    from robomech_ros.dynamics.complement.reactions import (
        ConstraintReactions,
        constraint_reactions,
    )
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
    from robomech_ros.dynamics.formulations.complexity import (
        ALGORITHMS,
        Operations,
        operation_counts,
    )
    from robomech_ros.dynamics.formulations.dynamics_by_complement import (
        forward_dynamics_by_cholesky,
        forward_dynamics_by_reflections,
        inverse_dynamics_by_orthogonal_complement,
    )
    from robomech_ros.dynamics.formulations.kane import (
        PartialVelocities,
        forward_dynamics_by_kane,
        inverse_dynamics_by_kane,
        partial_velocities,
    )
    from robomech_ros.dynamics.formulations.lagrange import (
        christoffel_symbols,
        forward_dynamics_by_lagrange,
        inverse_dynamics_by_lagrange,
        mass_matrix_gradient,
    )
    from robomech_ros.dynamics.formulations.newton_euler import (
        NewtonEuler,
        newton_euler,
    )
    from robomech_ros.dynamics.formulations.orthogonal_complement import (
        OrthogonalComplement,
        natural_orthogonal_complement,
    )
    from robomech_ros.dynamics.formulations.planar import (
        PlanarComplement,
        planar_orthogonal_complement,
    )
    from robomech_ros.dynamics.forward import (
        METHODS,
        forward_dynamics,
    )
    from robomech_ros.dynamics.friction import (
        dissipated_power,
        dissipation,
        friction_torque,
    )
    from robomech_ros.dynamics.identification.consistent_fit import (
        ConsistentFit,
        consistent_fit,
    )
    from robomech_ros.dynamics.identification.fit import (
        Identification,
        excitation,
        identify,
    )
    from robomech_ros.dynamics.identification.regressor import (
        BaseParameters,
        base_parameters,
        torque_regressor,
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
    from robomech_ros.dynamics.motion_torques import TorqueSummary, torque_summary
    from robomech_ros.dynamics.payload import (
        with_payload,
    )
    from robomech_ros.dynamics.pseudo_inertias import (
        bodies_from_parameters,
        is_physically_consistent,
        nearest_consistent,
        pseudo_inertia,
    )
    from robomech_ros.dynamics.simulation.controlled_arm import ControlledArm, ControlledMotion
    from robomech_ros.dynamics.simulation.simulate import Simulation, simulate
    from robomech_ros.dynamics.systems import DynamicSystem

__all__ = [
    "ALGORITHMS",
    "METHODS",
    "BaseParameters",
    "ChainDynamics",
    "ConsistentFit",
    "ConstrainedBodies",
    "ConstraintReactions",
    "ControlledArm",
    "ControlledMotion",
    "DynamicSystem",
    "ForwardDerivatives",
    "Identification",
    "InverseDerivatives",
    "NewtonEuler",
    "Operations",
    "OrthogonalComplement",
    "PartialVelocities",
    "PlanarComplement",
    "PowerBalance",
    "Simulation",
    "TorqueSummary",
    "base_parameters",
    "bias_torque",
    "bodies_from_parameters",
    "body_parameters",
    "center_of_mass",
    "christoffel_symbols",
    "consistent_fit",
    "constraint_reactions",
    "coriolis_matrix",
    "dissipated_power",
    "dissipation",
    "excitation",
    "forward_dynamics",
    "forward_dynamics_by_cholesky",
    "forward_dynamics_by_kane",
    "forward_dynamics_by_lagrange",
    "forward_dynamics_by_reflections",
    "forward_dynamics_derivatives",
    "friction_torque",
    "gravity_torque",
    "identify",
    "inverse_dynamics",
    "inverse_dynamics_by_kane",
    "inverse_dynamics_by_lagrange",
    "inverse_dynamics_by_orthogonal_complement",
    "inverse_dynamics_derivatives",
    "is_physically_consistent",
    "kinetic_energy",
    "mass_matrix",
    "mass_matrix_gradient",
    "momentum",
    "natural_orthogonal_complement",
    "nearest_consistent",
    "newton_euler",
    "operation_counts",
    "partial_velocities",
    "planar_orthogonal_complement",
    "potential_energy",
    "power_balance",
    "pseudo_inertia",
    "simulate",
    "torque_regressor",
    "torque_summary",
    "with_payload",
]

_MODULES = {
    "ALGORITHMS": "formulations.complexity",
    "METHODS": "forward",
    "BaseParameters": "identification.regressor",
    "ChainDynamics": "chain_dynamics",
    "DynamicSystem": "systems",
    "ConsistentFit": "identification.consistent_fit",
    "ConstrainedBodies": "complement.constrained_bodies",
    "ConstraintReactions": "complement.reactions",
    "ForwardDerivatives": "derivatives",
    "Identification": "identification.fit",
    "InverseDerivatives": "derivatives",
    "NewtonEuler": "formulations.newton_euler",
    "Operations": "formulations.complexity",
    "OrthogonalComplement": "formulations.orthogonal_complement",
    "PartialVelocities": "formulations.kane",
    "PlanarComplement": "formulations.planar",
    "PowerBalance": "energy",
    "ControlledArm": "simulation.controlled_arm",
    "ControlledMotion": "simulation.controlled_arm",
    "Simulation": "simulation.simulate",
    "TorqueSummary": "motion_torques",
    "base_parameters": "identification.regressor",
    "bias_torque": "inverse",
    "bodies_from_parameters": "pseudo_inertias",
    "body_parameters": "model",
    "center_of_mass": "energy",
    "christoffel_symbols": "formulations.lagrange",
    "consistent_fit": "identification.consistent_fit",
    "constraint_reactions": "complement.reactions",
    "coriolis_matrix": "matrices",
    "dissipated_power": "friction",
    "dissipation": "friction",
    "excitation": "identification.fit",
    "forward_dynamics": "forward",
    "forward_dynamics_by_cholesky": "formulations.dynamics_by_complement",
    "forward_dynamics_by_kane": "formulations.kane",
    "forward_dynamics_by_lagrange": "formulations.lagrange",
    "forward_dynamics_by_reflections": "formulations.dynamics_by_complement",
    "forward_dynamics_derivatives": "derivatives",
    "friction_torque": "friction",
    "gravity_torque": "inverse",
    "identify": "identification.fit",
    "inverse_dynamics": "inverse",
    "inverse_dynamics_by_kane": "formulations.kane",
    "inverse_dynamics_by_lagrange": "formulations.lagrange",
    "inverse_dynamics_by_orthogonal_complement": "formulations.dynamics_by_complement",
    "inverse_dynamics_derivatives": "derivatives",
    "is_physically_consistent": "pseudo_inertias",
    "kinetic_energy": "energy",
    "mass_matrix": "matrices",
    "mass_matrix_gradient": "formulations.lagrange",
    "momentum": "energy",
    "natural_orthogonal_complement": "formulations.orthogonal_complement",
    "nearest_consistent": "pseudo_inertias",
    "newton_euler": "formulations.newton_euler",
    "operation_counts": "formulations.complexity",
    "partial_velocities": "formulations.kane",
    "planar_orthogonal_complement": "formulations.planar",
    "potential_energy": "energy",
    "power_balance": "energy",
    "pseudo_inertia": "pseudo_inertias",
    "simulate": "simulation.simulate",
    "torque_regressor": "identification.regressor",
    "torque_summary": "motion_torques",
    "with_payload": "payload",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
