"""Rotations and poses, with conversions in all directions.

Every function takes leading batch axes.  Quaternions are (r, r0): vector first, scalar last.
"""

from robomech_ros.spatial.axis_angle import (
    axis_angle_from_matrix,
    axis_angle_from_quaternion,
    matrix_from_axis_angle,
    matrix_from_rotation_vector,
    rotation_vector_from_matrix,
)
from robomech_ros.spatial.cross_product import axial_vector, cross_product_matrix
from robomech_ros.spatial.matrices import as_rotation, nearest_rotation, rotation_error
from robomech_ros.spatial.poses import (
    as_pose,
    compose_poses,
    inverse_pose,
    pose_error,
    pose_from_matrix,
    pose_from_position_quaternion,
    position_quaternion_from_pose,
)
from robomech_ros.spatial.quaternions import (
    compose_quaternions,
    inverse_quaternion,
    matrix_from_quaternion,
    quaternion_from_axis_angle,
    quaternion_from_matrix,
    unit_quaternion,
)
from robomech_ros.spatial.roll_pitch_yaw import (
    axis_angle_from_roll_pitch_yaw,
    matrix_from_roll_pitch_yaw,
    quaternion_from_roll_pitch_yaw,
    roll_pitch_yaw_from_axis_angle,
    roll_pitch_yaw_from_matrix,
    roll_pitch_yaw_from_quaternion,
)

__all__ = [
    "as_pose",
    "as_rotation",
    "axial_vector",
    "axis_angle_from_matrix",
    "axis_angle_from_quaternion",
    "axis_angle_from_roll_pitch_yaw",
    "compose_poses",
    "compose_quaternions",
    "cross_product_matrix",
    "inverse_pose",
    "inverse_quaternion",
    "matrix_from_axis_angle",
    "matrix_from_quaternion",
    "matrix_from_roll_pitch_yaw",
    "matrix_from_rotation_vector",
    "nearest_rotation",
    "pose_error",
    "pose_from_matrix",
    "pose_from_position_quaternion",
    "position_quaternion_from_pose",
    "quaternion_from_axis_angle",
    "quaternion_from_matrix",
    "quaternion_from_roll_pitch_yaw",
    "roll_pitch_yaw_from_axis_angle",
    "roll_pitch_yaw_from_matrix",
    "roll_pitch_yaw_from_quaternion",
    "rotation_error",
    "rotation_vector_from_matrix",
    "unit_quaternion",
]
