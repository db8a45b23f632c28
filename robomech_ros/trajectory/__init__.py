"""Trajectories: profiles, curves through points, paths, and the verification of all of them.

Each part is loaded on first use: a controller, which samples and verifies, never loads the
planning.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.trajectory.curves.interpolation import interpolant
    from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
    from robomech_ros.trajectory.joint_points import nearest_turns
    from robomech_ros.trajectory.limits import JointLimits, Limits
    from robomech_ros.trajectory.paths.arc_length import ArcLength, ArcLengthCurve, arc_length
    from robomech_ros.trajectory.paths.arms import Arm, JoinedArms, SerialArm
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
        OrientationSample,
        constant_orientation,
        frenet_orientation,
        geodesic_orientation,
    )
    from robomech_ros.trajectory.paths.orientation_spline import orientation_spline
    from robomech_ros.trajectory.paths.path_tracking import track_path
    from robomech_ros.trajectory.paths.pose_lists import arc_path, spline_path, straight_path
    from robomech_ros.trajectory.paths.pose_path import PosePath, PoseSample, pose_path
    from robomech_ros.trajectory.paths.spline_curves import spline_curve
    from robomech_ros.trajectory.paths.tracking_result import (
        PathCut,
        PathTracking,
        PathTrackingStatus,
    )
    from robomech_ros.trajectory.plans.path_motions import (
        PATH_PROFILES,
        PathMotion,
        TipSpeeds,
        along_joint_path,
        along_path,
    )
    from robomech_ros.trajectory.plans.point_to_point import PROFILES, point_to_point
    from robomech_ros.trajectory.plans.profile_splines import spline_like
    from robomech_ros.trajectory.plans.sampled_plan import (
        SampledPlan,
        sampled_motion,
        sampled_point_to_point,
    )
    from robomech_ros.trajectory.plans.spline_motions import Spline, spline_through
    from robomech_ros.trajectory.plans.verification import Verification, verify
    from robomech_ros.trajectory.plans.via_motions import (
        VIA_PROFILES,
        sampled_through_points,
        through_points,
    )
    from robomech_ros.trajectory.plans.via_polynomials import ViaPolynomial, via_polynomial
    from robomech_ros.trajectory.plans.violations import Violation
    from robomech_ros.trajectory.profiles.jerk_limited import JerkLimited
    from robomech_ros.trajectory.profiles.rest_to_rest import (
        Cycloidal,
        Polynomial345,
        Polynomial4567,
    )
    from robomech_ros.trajectory.profiles.state_to_state import StateToState, state_to_state
    from robomech_ros.trajectory.profiles.velocity_profiles import DoubleS, Trapezoidal
    from robomech_ros.trajectory.sample import Sample, Trajectory
    from robomech_ros.trajectory.timing.path_limits import SpeedLimit, TorqueLimits
    from robomech_ros.trajectory.timing.path_timing import TimeOptimal, time_optimal
    from robomech_ros.trajectory.timing.time_optimal_motions import (
        TimeOptimalMotion,
        TimeOptimalThrough,
    )
    from robomech_ros.trajectory.timing.torque_timing import torque_limited
    from robomech_ros.trajectory.waypoints import Waypoints, discretise

__all__ = [
    "PATH_PROFILES",
    "PROFILES",
    "VIA_PROFILES",
    "ArcLength",
    "ArcLengthCurve",
    "Arm",
    "Curve",
    "Cycloidal",
    "DoubleS",
    "FrenetSerret",
    "FunctionCurve",
    "JerkLimited",
    "JoinedArms",
    "JointLimits",
    "JointMotion",
    "JointPath",
    "Limits",
    "Orientation",
    "OrientationSample",
    "PathCut",
    "PathMotion",
    "PathTracking",
    "PathTrackingStatus",
    "PiecewisePolynomial",
    "Polynomial345",
    "Polynomial4567",
    "PosePath",
    "PoseSample",
    "Sample",
    "SampledPlan",
    "SerialArm",
    "SpeedLimit",
    "Spline",
    "StateToState",
    "TimeOptimal",
    "TimeOptimalMotion",
    "TimeOptimalThrough",
    "TipSpeeds",
    "TorqueLimits",
    "Trajectory",
    "Trapezoidal",
    "Verification",
    "ViaPolynomial",
    "Violation",
    "Waypoints",
    "along_joint_path",
    "along_path",
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
    "nearest_turns",
    "orientation_spline",
    "point_to_point",
    "pose_path",
    "sampled_motion",
    "sampled_point_to_point",
    "sampled_through_points",
    "spline_curve",
    "spline_like",
    "spline_path",
    "spline_through",
    "state_to_state",
    "straight_path",
    "through_points",
    "time_optimal",
    "torque_limited",
    "track_path",
    "tracking_error",
    "verify",
    "via_polynomial",
    "viviani",
]

_MODULES = {
    "time_optimal": "timing.path_timing",
    "torque_limited": "timing.torque_timing",
    "TimeOptimal": "timing.path_timing",
    "TimeOptimalMotion": "timing.time_optimal_motions",
    "TimeOptimalThrough": "timing.time_optimal_motions",
    "TorqueLimits": "timing.path_limits",
    "SpeedLimit": "timing.path_limits",
    "along_path": "plans.path_motions",
    "along_joint_path": "plans.path_motions",
    "TipSpeeds": "plans.path_motions",
    "PathMotion": "plans.path_motions",
    "PATH_PROFILES": "plans.path_motions",
    "PROFILES": "plans.point_to_point",
    "VIA_PROFILES": "plans.via_motions",
    "ArcLength": "paths.arc_length",
    "Arm": "paths.arms",
    "ArcLengthCurve": "paths.arc_length",
    "Curve": "paths.curve",
    "Cycloidal": "profiles.rest_to_rest",
    "DoubleS": "profiles.velocity_profiles",
    "FrenetSerret": "paths.frenet",
    "FunctionCurve": "paths.curve",
    "JerkLimited": "profiles.jerk_limited",
    "JoinedArms": "paths.arms",
    "JointLimits": "limits",
    "JointMotion": "paths.joint_path",
    "JointPath": "paths.joint_path",
    "Limits": "limits",
    "Orientation": "paths.orientation",
    "PathCut": "paths.tracking_result",
    "PathTracking": "paths.tracking_result",
    "PathTrackingStatus": "paths.tracking_result",
    "PiecewisePolynomial": "curves.piecewise",
    "Polynomial345": "profiles.rest_to_rest",
    "Polynomial4567": "profiles.rest_to_rest",
    "PosePath": "paths.pose_path",
    "PoseSample": "paths.pose_path",
    "Sample": "sample",
    "SampledPlan": "plans.sampled_plan",
    "SerialArm": "paths.arms",
    "Spline": "plans.spline_motions",
    "StateToState": "profiles.state_to_state",
    "Trajectory": "sample",
    "Trapezoidal": "profiles.velocity_profiles",
    "OrientationSample": "paths.orientation",
    "Verification": "plans.verification",
    "ViaPolynomial": "plans.via_polynomials",
    "Violation": "plans.violations",
    "Waypoints": "waypoints",
    "arc_about": "paths.closed_form",
    "arc_length": "paths.arc_length",
    "arc_path": "paths.pose_lists",
    "arc_through": "paths.closed_form",
    "blended_polyline": "paths.blends",
    "constant_orientation": "paths.orientation",
    "cylinder_intersection": "paths.closed_form",
    "discretise": "waypoints",
    "frenet_orientation": "paths.orientation",
    "frenet_serret": "paths.frenet",
    "geodesic_orientation": "paths.orientation",
    "helix": "paths.closed_form",
    "interpolant": "curves.interpolation",
    "join_curves": "paths.curve",
    "joint_spline": "paths.joint_synthesis",
    "line": "paths.closed_form",
    "nearest_turns": "joint_points",
    "orientation_spline": "paths.orientation_spline",
    "point_to_point": "plans.point_to_point",
    "pose_path": "paths.pose_path",
    "sampled_motion": "plans.sampled_plan",
    "sampled_point_to_point": "plans.sampled_plan",
    "sampled_through_points": "plans.via_motions",
    "spline_curve": "paths.spline_curves",
    "spline_like": "plans.profile_splines",
    "spline_path": "paths.pose_lists",
    "spline_through": "plans.spline_motions",
    "state_to_state": "profiles.state_to_state",
    "straight_path": "paths.pose_lists",
    "through_points": "plans.via_motions",
    "track_path": "paths.path_tracking",
    "tracking_error": "paths.joint_synthesis",
    "verify": "plans.verification",
    "via_polynomial": "plans.via_polynomials",
    "viviani": "paths.closed_form",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
