"""Rotations, poses, lines, screws and bodies: chapters 2, 3 and 8 and appendix A of the book.

Every function takes leading batch axes.  Quaternions are (r, r0): vector first, scalar last; twists
and wrenches have the angular part first.  Each part is loaded on first use: most compile their
loops, which reading a robot does without.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.spatial.cross_product import (
        axial_vector as axial_vector,
        cross_product_matrix as cross_product_matrix,
        linear_invariants as linear_invariants,
    )
    from robomech_ros.spatial.matrices import (
        as_rotation as as_rotation,
        nearest_rotation as nearest_rotation,
        rotation_error as rotation_error,
    )
    from robomech_ros.spatial.points.from_points import (
        angular_acceleration_from_points as angular_acceleration_from_points,
        angular_velocity_from_points as angular_velocity_from_points,
    )
    from robomech_ros.spatial.points.rigidity import (
        Rigidity as Rigidity,
        angular_velocity_covariance as angular_velocity_covariance,
        require_rigid as require_rigid,
        rigidity as rigidity,
    )
    from robomech_ros.spatial.points.tracks import (
        TrackedMotion as TrackedMotion,
        motion_from_tracks as motion_from_tracks,
    )
    from robomech_ros.spatial.poses import (
        as_pose as as_pose,
        compose_poses as compose_poses,
        inverse_pose as inverse_pose,
        pose_from_matrix as pose_from_matrix,
    )
    from robomech_ros.spatial.rotations.axis_angle import (
        axis_angle_from_matrix as axis_angle_from_matrix,
        axis_angle_from_quaternion as axis_angle_from_quaternion,
        matrix_from_axis_angle as matrix_from_axis_angle,
        matrix_from_rotation_vector as matrix_from_rotation_vector,
        quaternion_from_rotation_vector as quaternion_from_rotation_vector,
        rotation_vector_from_matrix as rotation_vector_from_matrix,
        rotation_vector_from_quaternion as rotation_vector_from_quaternion,
    )
    from robomech_ros.spatial.rotations.composition import (
        compose_rotations as compose_rotations,
        slerp as slerp,
    )
    from robomech_ros.spatial.rotations.conversions import (
        REPRESENTATIONS as REPRESENTATIONS,
        SEQUENCES as SEQUENCES,
        convert_rotation as convert_rotation,
    )
    from robomech_ros.spatial.rotations.euler_angles import (
        axis_angle_from_roll_pitch_yaw as axis_angle_from_roll_pitch_yaw,
        euler_angles_from_matrix as euler_angles_from_matrix,
        euler_angles_from_quaternion as euler_angles_from_quaternion,
        matrix_from_euler_angles as matrix_from_euler_angles,
        quaternion_from_euler_angles as quaternion_from_euler_angles,
        quaternion_from_roll_pitch_yaw as quaternion_from_roll_pitch_yaw,
        roll_pitch_yaw_from_axis_angle as roll_pitch_yaw_from_axis_angle,
        roll_pitch_yaw_from_quaternion as roll_pitch_yaw_from_quaternion,
    )
    from robomech_ros.spatial.rotations.quaternions import (
        compose_quaternions as compose_quaternions,
        inverse_quaternion as inverse_quaternion,
        matrix_from_quaternion as matrix_from_quaternion,
        quaternion_from_axis_angle as quaternion_from_axis_angle,
        quaternion_from_matrix as quaternion_from_matrix,
    )
    from robomech_ros.spatial.rotations.rates import (
        angular_motion as angular_motion,
        rotation_rates as rotation_rates,
    )
    from robomech_ros.spatial.rotations.rodrigues_vectors import (
        matrix_from_linear_invariants as matrix_from_linear_invariants,
        matrix_from_rodrigues_vector as matrix_from_rodrigues_vector,
        quaternion_from_rodrigues_vector as quaternion_from_rodrigues_vector,
        rodrigues_vector_from_matrix as rodrigues_vector_from_matrix,
        rodrigues_vector_from_quaternion as rodrigues_vector_from_quaternion,
    )
    from robomech_ros.spatial.rotations.roll_pitch_yaw import (
        matrix_from_roll_pitch_yaw as matrix_from_roll_pitch_yaw,
        roll_pitch_yaw_from_matrix as roll_pitch_yaw_from_matrix,
    )
    from robomech_ros.spatial.rotations.unit_quaternions import unit_quaternion as unit_quaternion
    from robomech_ros.spatial.screws.accelerations import (
        MovingAxesMotion as MovingAxesMotion,
        acceleration_pole as acceleration_pole,
        angular_acceleration_matrix as angular_acceleration_matrix,
        moving_axes_motion as moving_axes_motion,
        point_acceleration as point_acceleration,
    )
    from robomech_ros.spatial.screws.bodies import (
        PrincipalInertia as PrincipalInertia,
        angular_velocity_dyad as angular_velocity_dyad,
        inertia_about_point as inertia_about_point,
        inertia_dyad as inertia_dyad,
        inertia_of_point_mass as inertia_of_point_mass,
        momentum_screw as momentum_screw,
        newton_euler_wrench as newton_euler_wrench,
        principal_inertia as principal_inertia,
        radii_of_gyration as radii_of_gyration,
        twist_kinetic_energy as twist_kinetic_energy,
    )
    from robomech_ros.spatial.screws.exponential import (
        pose_exponential as pose_exponential,
        pose_logarithm as pose_logarithm,
    )
    from robomech_ros.spatial.screws.finite_screw import (
        FiniteScrew as FiniteScrew,
        finite_screw as finite_screw,
        pose_from_screw as pose_from_screw,
    )
    from robomech_ros.spatial.screws.instant_screw import (
        InstantScrew as InstantScrew,
        instant_screw as instant_screw,
        wrench_axis as wrench_axis,
    )
    from robomech_ros.spatial.screws.lines import (
        CommonNormal as CommonNormal,
        common_normal as common_normal,
        line_distance as line_distance,
        line_intersection as line_intersection,
        line_nearest_point as line_nearest_point,
        line_reciprocity as line_reciprocity,
        line_through as line_through,
        line_through_points as line_through_points,
        transfer_line as transfer_line,
    )
    from robomech_ros.spatial.screws.pose_conversions import (
        pose_array_from_pose as pose_array_from_pose,
        pose_error as pose_error,
        pose_from_pose_array as pose_from_pose_array,
        pose_from_position_quaternion as pose_from_position_quaternion,
        position_quaternion_from_pose as position_quaternion_from_pose,
    )
    from robomech_ros.spatial.screws.transfers import (
        pose_adjoint as pose_adjoint,
        transfer_twist as transfer_twist,
        transfer_wrench as transfer_wrench,
        twist_transfer_matrix as twist_transfer_matrix,
        wrench_transfer_matrix as wrench_transfer_matrix,
    )
    from robomech_ros.spatial.transformations.frames import (
        homogeneous_coordinates as homogeneous_coordinates,
        moments as moments,
        points_from_homogeneous as points_from_homogeneous,
        same_in_two_frames as same_in_two_frames,
        similarity_transform as similarity_transform,
        transform_points as transform_points,
        transform_vectors as transform_vectors,
    )
    from robomech_ros.spatial.transformations.linear_maps import (
        LinearMap as LinearMap,
        linear_map as linear_map,
        orthogonal_projection as orthogonal_projection,
        projection_on_line as projection_on_line,
        projection_on_plane as projection_on_plane,
    )
    from robomech_ros.spatial.transformations.redundant_sensing import (
        SensorAgreement as SensorAgreement,
        frame_between_sensors as frame_between_sensors,
        sensor_agreement as sensor_agreement,
    )
    from robomech_ros.spatial.transformations.reflections import (
        compose_reflections as compose_reflections,
        reflection as reflection,
        reflection_normal as reflection_normal,
        reflections_from_matrix as reflections_from_matrix,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
