"""Trajectories: profiles from point to point, curves through waypoints, paths, and verification."""

from robomech_ros.trajectory.interpolation import interpolant
from robomech_ros.trajectory.jerk_limited import JerkLimited
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.paths.arc_length import ArcLength, ByArcLength, arc_length
from robomech_ros.trajectory.paths.blends import blended_polyline
from robomech_ros.trajectory.paths.closed_form import (
    arc_about,
    arc_through,
    cylinder_intersection,
    helix,
    line,
    viviani,
)
from robomech_ros.trajectory.paths.curve import Curve, FunctionCurve, join_curves
from robomech_ros.trajectory.paths.frenet import FrenetSerret, frenet_serret
from robomech_ros.trajectory.paths.joint_path import JointMotion, JointPath
from robomech_ros.trajectory.paths.joint_synthesis import joint_spline, tracking_error
from robomech_ros.trajectory.paths.orientation import (
    Orientation,
    Turning,
    constant_orientation,
    frenet_orientation,
    geodesic_orientation,
)
from robomech_ros.trajectory.paths.orientation_spline import orientation_spline
from robomech_ros.trajectory.paths.path_tracking import (
    PathTracking,
    PathTrackingStatus,
    track_path,
)
from robomech_ros.trajectory.paths.pose_lists import arc_path, spline_path, straight_path
from robomech_ros.trajectory.paths.pose_path import PosePath, PoseSample, pose_path
from robomech_ros.trajectory.paths.posture import Arm
from robomech_ros.trajectory.paths.serial_arm import SerialArm
from robomech_ros.trajectory.paths.splines import spline_curve
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.polynomial import Polynomial345
from robomech_ros.trajectory.profiles import PROFILES, point_to_point
from robomech_ros.trajectory.sample import Sample, Trajectory
from robomech_ros.trajectory.sampled_plan import SampledPlan, sampled_point_to_point
from robomech_ros.trajectory.verification import Verification, Violation, verify
from robomech_ros.trajectory.waypoints import Waypoints, discretise

__all__ = [
    "PROFILES",
    "ArcLength",
    "Arm",
    "ByArcLength",
    "Curve",
    "FrenetSerret",
    "FunctionCurve",
    "JerkLimited",
    "JointLimits",
    "JointMotion",
    "JointPath",
    "Limits",
    "Orientation",
    "PathTracking",
    "PathTrackingStatus",
    "PiecewisePolynomial",
    "Polynomial345",
    "PosePath",
    "PoseSample",
    "Sample",
    "SampledPlan",
    "SerialArm",
    "Trajectory",
    "Turning",
    "Verification",
    "Violation",
    "Waypoints",
    "arc_about",
    "arc_length",
    "arc_path",
    "arc_through",
    "blended_polyline",
    "constant_orientation",
    "cylinder_intersection",
    "discretise",
    "frenet_orientation",
    "frenet_serret",
    "geodesic_orientation",
    "helix",
    "interpolant",
    "join_curves",
    "joint_spline",
    "line",
    "orientation_spline",
    "point_to_point",
    "pose_path",
    "sampled_point_to_point",
    "spline_curve",
    "spline_path",
    "straight_path",
    "track_path",
    "tracking_error",
    "verify",
    "viviani",
]
