"""Trajectories: profiles from point to point, curves through waypoints, and their verification."""

from robomech_ros.trajectory.interpolation import interpolant
from robomech_ros.trajectory.jerk_limited import JerkLimited
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.profiles import PROFILES, point_to_point
from robomech_ros.trajectory.rest_to_rest import Cycloidal, Polynomial345, Polynomial4567
from robomech_ros.trajectory.sample import Sample, Trajectory
from robomech_ros.trajectory.sampled_plan import SampledPlan, sampled_point_to_point
from robomech_ros.trajectory.splines import Spline, spline_through
from robomech_ros.trajectory.through_points import (
    VIA_PROFILES,
    sampled_through_points,
    through_points,
)
from robomech_ros.trajectory.velocity_profiles import DoubleS, Trapezoidal
from robomech_ros.trajectory.verification import Verification, Violation, verify
from robomech_ros.trajectory.via_polynomial import ViaPolynomial, via_polynomial
from robomech_ros.trajectory.waypoints import Waypoints, discretise

__all__ = [
    "PROFILES",
    "VIA_PROFILES",
    "Cycloidal",
    "DoubleS",
    "JerkLimited",
    "JointLimits",
    "Limits",
    "PiecewisePolynomial",
    "Polynomial345",
    "Polynomial4567",
    "Sample",
    "SampledPlan",
    "Spline",
    "Trajectory",
    "Trapezoidal",
    "Verification",
    "ViaPolynomial",
    "Violation",
    "Waypoints",
    "discretise",
    "interpolant",
    "point_to_point",
    "sampled_point_to_point",
    "sampled_through_points",
    "spline_through",
    "through_points",
    "verify",
    "via_polynomial",
]
