"""Dynamics of serial chains, and of bodies under any constraints, loaded on first use."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.dynamics.chain_dynamics import ChainDynamics as ChainDynamics
    from robomech_ros.dynamics.complement.constrained_bodies import (
        ConstrainedBodies as ConstrainedBodies,
    )
    from robomech_ros.dynamics.complement.reactions import (
        ConstraintReactions as ConstraintReactions,
        constraint_reactions as constraint_reactions,
    )
    from robomech_ros.dynamics.derivatives import (
        ForwardDerivatives as ForwardDerivatives,
        InverseDerivatives as InverseDerivatives,
        forward_dynamics_derivatives as forward_dynamics_derivatives,
        inverse_dynamics_derivatives as inverse_dynamics_derivatives,
    )
    from robomech_ros.dynamics.energy import (
        PowerBalance as PowerBalance,
        center_of_mass as center_of_mass,
        kinetic_energy as kinetic_energy,
        momentum as momentum,
        potential_energy as potential_energy,
        power_balance as power_balance,
    )
    from robomech_ros.dynamics.floating.base_motion import FloatingBase as FloatingBase
    from robomech_ros.dynamics.floating.chain import FloatingChain as FloatingChain
    from robomech_ros.dynamics.floating.motion import (
        FloatingMotion as FloatingMotion,
        simulate_floating as simulate_floating,
    )
    from robomech_ros.dynamics.floating.system import FloatingDynamics as FloatingDynamics
    from robomech_ros.dynamics.floating.tip_motion import (
        follow_floating_path as follow_floating_path,
        move_floating_tip as move_floating_tip,
    )
    from robomech_ros.dynamics.formulations.complexity import (
        ALGORITHMS as ALGORITHMS,
        Operations as Operations,
        operation_counts as operation_counts,
    )
    from robomech_ros.dynamics.formulations.dynamics_by_complement import (
        forward_dynamics_by_cholesky as forward_dynamics_by_cholesky,
        forward_dynamics_by_reflections as forward_dynamics_by_reflections,
        inverse_dynamics_by_orthogonal_complement as inverse_dynamics_by_orthogonal_complement,
    )
    from robomech_ros.dynamics.formulations.kane import (
        PartialVelocities as PartialVelocities,
        forward_dynamics_by_kane as forward_dynamics_by_kane,
        inverse_dynamics_by_kane as inverse_dynamics_by_kane,
        partial_velocities as partial_velocities,
    )
    from robomech_ros.dynamics.formulations.lagrange import (
        christoffel_symbols as christoffel_symbols,
        forward_dynamics_by_lagrange as forward_dynamics_by_lagrange,
        inverse_dynamics_by_lagrange as inverse_dynamics_by_lagrange,
        mass_matrix_gradient as mass_matrix_gradient,
    )
    from robomech_ros.dynamics.formulations.newton_euler import (
        NewtonEuler as NewtonEuler,
        newton_euler as newton_euler,
    )
    from robomech_ros.dynamics.formulations.orthogonal_complement import (
        OrthogonalComplement as OrthogonalComplement,
        natural_orthogonal_complement as natural_orthogonal_complement,
    )
    from robomech_ros.dynamics.formulations.planar import (
        PlanarComplement as PlanarComplement,
        planar_orthogonal_complement as planar_orthogonal_complement,
    )
    from robomech_ros.dynamics.forward import (
        METHODS as METHODS,
        forward_dynamics as forward_dynamics,
    )
    from robomech_ros.dynamics.friction import (
        dissipated_power as dissipated_power,
        dissipation as dissipation,
        friction_torque as friction_torque,
    )
    from robomech_ros.dynamics.identification.consistent_fit import (
        ConsistentFit as ConsistentFit,
        consistent_fit as consistent_fit,
    )
    from robomech_ros.dynamics.identification.fit import (
        Identification as Identification,
        excitation as excitation,
        identify as identify,
    )
    from robomech_ros.dynamics.identification.regressor import (
        BaseParameters as BaseParameters,
        base_parameters as base_parameters,
        torque_regressor as torque_regressor,
    )
    from robomech_ros.dynamics.inverse import (
        bias_torque as bias_torque,
        gravity_torque as gravity_torque,
        inverse_dynamics as inverse_dynamics,
    )
    from robomech_ros.dynamics.matrices import (
        coriolis_matrix as coriolis_matrix,
        mass_matrix as mass_matrix,
    )
    from robomech_ros.dynamics.model import body_parameters as body_parameters
    from robomech_ros.dynamics.motion_torques import (
        TorqueSummary as TorqueSummary,
        torque_summary as torque_summary,
    )
    from robomech_ros.dynamics.payload import with_payload as with_payload
    from robomech_ros.dynamics.pseudo_inertias import (
        bodies_from_parameters as bodies_from_parameters,
        is_physically_consistent as is_physically_consistent,
        nearest_consistent as nearest_consistent,
        pseudo_inertia as pseudo_inertia,
    )
    from robomech_ros.dynamics.simulation.controlled_arm import (
        ControlledArm as ControlledArm,
        ControlledMotion as ControlledMotion,
    )
    from robomech_ros.dynamics.simulation.simulate import (
        Simulation as Simulation,
        simulate as simulate,
    )
    from robomech_ros.dynamics.systems import (
        DynamicSystem as DynamicSystem,
        LostPostureError as LostPostureError,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
