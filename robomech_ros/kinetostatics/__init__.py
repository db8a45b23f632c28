"""Kinetostatics of serial chains; each part is loaded on first use."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinetostatics.accelerations import (
        bias_acceleration as bias_acceleration,
        jacobian_rate as jacobian_rate,
        joint_accelerations as joint_accelerations,
    )
    from robomech_ros.kinetostatics.best_posture import (
        BestPosture as BestPosture,
        best_conditioned_posture as best_conditioned_posture,
    )
    from robomech_ros.kinetostatics.conditioning import (
        CharacteristicLength as CharacteristicLength,
        ConditioningIndex as ConditioningIndex,
        LengthGradient as LengthGradient,
        characteristic_length as characteristic_length,
        characteristic_length_gradient as characteristic_length_gradient,
        conditioning_index as conditioning_index,
    )
    from robomech_ros.kinetostatics.decoupled_blocks import (
        DecoupledJacobian as DecoupledJacobian,
        decoupled_jacobian as decoupled_jacobian,
    )
    from robomech_ros.kinetostatics.ellipsoids import (
        ManipulabilityEllipsoid as ManipulabilityEllipsoid,
        manipulability_ellipsoid as manipulability_ellipsoid,
    )
    from robomech_ros.kinetostatics.global_indices import (
        GlobalIndex as GlobalIndex,
        global_conditioning_index as global_conditioning_index,
    )
    from robomech_ros.kinetostatics.indices import (
        condition_number as condition_number,
        condition_number_gradient as condition_number_gradient,
        least_singular_value_gradient as least_singular_value_gradient,
        manipulability as manipulability,
        manipulability_gradient as manipulability_gradient,
        min_singular_value as min_singular_value,
    )
    from robomech_ros.kinetostatics.isotropic_designs import (
        IsotropicDesign as IsotropicDesign,
        isotropic_planar_2r as isotropic_planar_2r,
        isotropic_planar_3r as isotropic_planar_3r,
        isotropic_spatial_3r as isotropic_spatial_3r,
        isotropic_wrist as isotropic_wrist,
    )
    from robomech_ros.kinetostatics.jacobians import jacobian as jacobian
    from robomech_ros.kinetostatics.loci import (
        ConditionLoci as ConditionLoci,
        condition_loci as condition_loci,
    )
    from robomech_ros.kinetostatics.maps.engines import DaskUnavailableError as DaskUnavailableError
    from robomech_ros.kinetostatics.maps.reachability import (
        ReachMap as ReachMap,
        load_reach_map as load_reach_map,
        reach_map as reach_map,
    )
    from robomech_ros.kinetostatics.point_jacobians import point_jacobian as point_jacobian
    from robomech_ros.kinetostatics.rates import joint_rates as joint_rates
    from robomech_ros.kinetostatics.reduced_jacobians import (
        planar_jacobian as planar_jacobian,
        planar_rows as planar_rows,
        task_jacobian as task_jacobian,
    )
    from robomech_ros.kinetostatics.rotation_sets import (
        uniform_rotations as uniform_rotations,
        uniform_turns as uniform_turns,
    )
    from robomech_ros.kinetostatics.self_motions import (
        SelfMotionCurve as SelfMotionCurve,
        self_motion_curve as self_motion_curve,
    )
    from robomech_ros.kinetostatics.singularities.distance import (
        NearestSingularity as NearestSingularity,
        nearest_singular_posture as nearest_singular_posture,
    )
    from robomech_ros.kinetostatics.singularities.free_intervals import (
        SingularityFree as SingularityFree,
        singularity_free as singularity_free,
    )
    from robomech_ros.kinetostatics.singularities.report import (
        SingularityReport as SingularityReport,
        SingularityReports as SingularityReports,
        singularity_report as singularity_report,
    )
    from robomech_ros.kinetostatics.statics import (
        joint_torques as joint_torques,
        wrench_from_torques as wrench_from_torques,
    )
    from robomech_ros.kinetostatics.workspace.boundary import (
        BoundaryCurve as BoundaryCurve,
        Workspace as Workspace,
        workspace_boundary as workspace_boundary,
    )
    from robomech_ros.kinetostatics.workspace.orientation import (
        OrientationWorkspace as OrientationWorkspace,
        orientation_workspace as orientation_workspace,
    )
    from robomech_ros.kinetostatics.workspace.reach import reach_limits as reach_limits

__getattr__, __all__ = lazy_exports(__name__, globals())
