"""Trajectories: profiles from point to point, curves through waypoints, and their verification."""

from robomech_ros.trajectory.interpolation import interpolant
from robomech_ros.trajectory.jerk_limited import JerkLimited
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.path_limits import SpeedLimit, TorqueLimits
from robomech_ros.trajectory.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.polynomial import Polynomial345
from robomech_ros.trajectory.profiles import PROFILES, point_to_point
from robomech_ros.trajectory.sample import Sample, Trajectory
from robomech_ros.trajectory.sampled_plan import SampledPlan, sampled_point_to_point
from robomech_ros.trajectory.time_optimal import TimeOptimal, time_optimal
from robomech_ros.trajectory.verification import Verification, Violation, verify
from robomech_ros.trajectory.waypoints import Waypoints, discretise

__all__ = [
    "PROFILES",
    "JerkLimited",
    "JointLimits",
    "Limits",
    "PiecewisePolynomial",
    "Polynomial345",
    "Sample",
    "SampledPlan",
    "SpeedLimit",
    "TimeOptimal",
    "TorqueLimits",
    "Trajectory",
    "Verification",
    "Violation",
    "Waypoints",
    "discretise",
    "interpolant",
    "point_to_point",
    "sampled_point_to_point",
    "time_optimal",
    "verify",
]
