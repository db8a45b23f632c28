"""Trajectories: profiles, curves through points, paths, and the verification of all of them.

Each part is loaded on first use: a controller, which samples and verifies, never loads the
planning.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.trajectory.curves.interpolation import interpolant as interpolant
    from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial as PiecewisePolynomial
    from robomech_ros.trajectory.joint_points import nearest_turns as nearest_turns
    from robomech_ros.trajectory.limits import JointLimits as JointLimits, Limits as Limits
    from robomech_ros.trajectory.paths.arc_length import (
        ArcLength as ArcLength,
        ArcLengthCurve as ArcLengthCurve,
        arc_length as arc_length,
    )
    from robomech_ros.trajectory.paths.arms import (
        Arm as Arm,
        JoinedArms as JoinedArms,
        SerialArm as SerialArm,
    )
    from robomech_ros.trajectory.paths.blends import blended_polyline as blended_polyline
    from robomech_ros.trajectory.paths.closed_form import (
        arc_about as arc_about,
        arc_through as arc_through,
        cylinder_intersection as cylinder_intersection,
        helix as helix,
        line as line,
        viviani as viviani,
    )
    from robomech_ros.trajectory.paths.curve import (
        Curve as Curve,
        FunctionCurve as FunctionCurve,
        join_curves as join_curves,
    )
    from robomech_ros.trajectory.paths.frenet import (
        FrenetSerret as FrenetSerret,
        frenet_serret as frenet_serret,
    )
    from robomech_ros.trajectory.paths.joint_path import (
        JointMotion as JointMotion,
        JointPath as JointPath,
    )
    from robomech_ros.trajectory.paths.joint_synthesis import (
        joint_spline as joint_spline,
        tracking_error as tracking_error,
    )
    from robomech_ros.trajectory.paths.orientation import (
        Orientation as Orientation,
        OrientationSample as OrientationSample,
        constant_orientation as constant_orientation,
        frenet_orientation as frenet_orientation,
        geodesic_orientation as geodesic_orientation,
    )
    from robomech_ros.trajectory.paths.orientation_spline import (
        orientation_spline as orientation_spline,
    )
    from robomech_ros.trajectory.paths.path_tracking import track_path as track_path
    from robomech_ros.trajectory.paths.pose_lists import (
        arc_path as arc_path,
        spline_path as spline_path,
        straight_path as straight_path,
    )
    from robomech_ros.trajectory.paths.pose_path import (
        PosePath as PosePath,
        PoseSample as PoseSample,
        pose_path as pose_path,
    )
    from robomech_ros.trajectory.paths.spline_curves import spline_curve as spline_curve
    from robomech_ros.trajectory.paths.tracking_result import (
        PathCut as PathCut,
        PathTracking as PathTracking,
        PathTrackingStatus as PathTrackingStatus,
    )
    from robomech_ros.trajectory.plans.path_motions import (
        PATH_PROFILES as PATH_PROFILES,
        PathMotion as PathMotion,
        TipSpeeds as TipSpeeds,
        along_joint_path as along_joint_path,
        along_path as along_path,
    )
    from robomech_ros.trajectory.plans.point_to_point import (
        PROFILES as PROFILES,
        point_to_point as point_to_point,
    )
    from robomech_ros.trajectory.plans.profile_splines import spline_like as spline_like
    from robomech_ros.trajectory.plans.sampled_plan import (
        SampledPlan as SampledPlan,
        sampled_motion as sampled_motion,
        sampled_point_to_point as sampled_point_to_point,
    )
    from robomech_ros.trajectory.plans.spline_motions import (
        Spline as Spline,
        spline_through as spline_through,
    )
    from robomech_ros.trajectory.plans.verification import (
        Verification as Verification,
        verify as verify,
    )
    from robomech_ros.trajectory.plans.via_motions import (
        VIA_PROFILES as VIA_PROFILES,
        sampled_through_points as sampled_through_points,
        through_points as through_points,
    )
    from robomech_ros.trajectory.plans.via_polynomials import (
        ViaPolynomial as ViaPolynomial,
        via_polynomial as via_polynomial,
    )
    from robomech_ros.trajectory.plans.violations import Violation as Violation
    from robomech_ros.trajectory.profiles.jerk_limited import JerkLimited as JerkLimited
    from robomech_ros.trajectory.profiles.rest_to_rest import (
        Cycloidal as Cycloidal,
        Polynomial345 as Polynomial345,
        Polynomial4567 as Polynomial4567,
    )
    from robomech_ros.trajectory.profiles.state_to_state import (
        StateToState as StateToState,
        state_to_state as state_to_state,
    )
    from robomech_ros.trajectory.profiles.velocity_profiles import (
        DoubleS as DoubleS,
        Trapezoidal as Trapezoidal,
    )
    from robomech_ros.trajectory.sample import Sample as Sample, Trajectory as Trajectory
    from robomech_ros.trajectory.timing.path_limits import (
        SpeedLimit as SpeedLimit,
        TorqueLimits as TorqueLimits,
    )
    from robomech_ros.trajectory.timing.path_timing import time_optimal as time_optimal
    from robomech_ros.trajectory.timing.speed_profile import TimeOptimal as TimeOptimal
    from robomech_ros.trajectory.timing.time_optimal_motions import (
        TimeOptimalMotion as TimeOptimalMotion,
        TimeOptimalThrough as TimeOptimalThrough,
    )
    from robomech_ros.trajectory.timing.torque_timing import torque_limited as torque_limited
    from robomech_ros.trajectory.waypoints import Waypoints as Waypoints, discretise as discretise

__getattr__, __all__ = lazy_exports(__name__, globals())
