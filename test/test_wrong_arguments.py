"""Arguments of wrong types raise our errors, and names to choose from can be imported."""

import numpy as np
import pytest

from robomech_ros.dynamics import ALGORITHMS, METHODS, forward_dynamics, operation_counts
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.first_solution import first_solution
from robomech_ros.kinematics.oracles import solve_bivariate, solve_univariate
from robomech_ros.kinetostatics import point_jacobian, singularity_report
from robomech_ros.numerics import newton_gauss, newton_raphson
from robomech_ros.robots import combine_bodies, dh_from_chain, load_robot
from robomech_ros.trajectory import Limits, discretise, point_to_point, verify

LIMITS = Limits(("x", "y"), velocity=1.0, acceleration=2.0, jerk=20.0)
PUMA = load_robot("puma560")
MOTION = point_to_point([0.0, 0.0], [1.0, 0.5], limits=LIMITS, profile="poly345")


@pytest.mark.parametrize("chain", [None, "ur5e", 7])
def test_issue_12_dh_from_what_is_no_chain(chain):
    with pytest.raises(BadValueError, match="chain"):
        dh_from_chain(chain)


@pytest.mark.parametrize("bodies", [None, 3.0, "ab", [None], [1.0, 2.0]])
def test_issue_12_combined_of_what_are_no_bodies(bodies):
    with pytest.raises(BadValueError, match="bodies"):
        combine_bodies(bodies)


@pytest.mark.parametrize("tolerance", [None, "wide", -1.0, float("nan"), [0.1]])
def test_issue_12_start_tolerance_that_is_no_number(tolerance):
    with pytest.raises(BadValueError, match="start_tolerance"):
        verify(MOTION, LIMITS, start=[0.0, 0.0], start_tolerance=tolerance)


def test_issue_12_start_that_is_no_posture():
    with pytest.raises(NonFiniteError, match="start"):
        verify(MOTION, LIMITS, start=[0.0, np.nan])
    with pytest.raises(WrongSizeError, match="start"):
        verify(MOTION, LIMITS, start=[0.0])


@pytest.mark.parametrize("points", [None, "many", 1, 2.5, float("nan"), float("inf")])
def test_issue_12_max_points_that_is_no_number_of_samples(points):
    with pytest.raises(BadValueError, match="max_points"):
        discretise(MOTION, 0.01, points)


@pytest.mark.parametrize("error", [0, 0.0, -1.0, None, float("nan"), 10**400, [1.0, 2.0]])
def test_issue_13_jerk_error_that_is_no_positive_number(error):
    with pytest.raises(BadValueError, match="jerk_error"):
        discretise(MOTION, 0.01, 1000, jerk_error=error)


@pytest.mark.parametrize("tolerance", [10**400, np.array([0.1, 0.2]), [[0.1]]])
def test_issue_13_tolerances_that_are_huge_or_arrays(tolerance):
    with pytest.raises(BadValueError, match="start_tolerance"):
        verify(MOTION, LIMITS, start=[0.0, 0.0], start_tolerance=tolerance)
    with pytest.raises(BadValueError, match="position_tolerance"):
        inverse_kinematics(PUMA, np.eye(4), position_tolerance=tolerance)
    with pytest.raises(BadValueError, match="tolerance"):
        newton_gauss(np.sin, np.cos, [1.0], tolerance=tolerance)


@pytest.mark.parametrize("rates", [None, 7, "velocity", ["speed"], [["jerk"]]])
def test_issue_13_rates_that_are_none(rates):
    with pytest.raises(BadValueError, match="rates"):
        verify(MOTION, LIMITS, rates=rates)


@pytest.mark.parametrize("flag", [None, "yes", np.array([1.0, 2.0]), 2])
def test_issue_13_flags_that_are_none(flag):
    with pytest.raises(BadValueError, match="from_zero"):
        verify(MOTION, LIMITS, from_zero=flag)
    with pytest.raises(BadValueError, match="to_rest"):
        verify(MOTION, LIMITS, to_rest=flag)


@pytest.mark.parametrize("chain", [None, "ur5e", 10**400, [1.0]])
@pytest.mark.parametrize(
    "solve", [inverse_kinematics, first_solution, solve_univariate, solve_bivariate]
)
def test_issue_13_solvers_of_what_is_no_chain(solve, chain):
    with pytest.raises(BadValueError, match="chain"):
        solve(chain, np.eye(4))


@pytest.mark.parametrize("f", [None, 3.0, [1.0]])
@pytest.mark.parametrize("solve", [newton_gauss, newton_raphson])
def test_issue_13_equations_that_are_no_function(solve, f):
    with pytest.raises(BadValueError, match=r"f is .*expected a function"):
        solve(f, np.cos, [1.0])
    with pytest.raises(BadValueError, match=r"jacobian is .*expected a function"):
        solve(np.sin, f, [1.0])


def test_issue_13_a_point_of_which_no_digit_is_left():
    """At 1e155 m the report had an infinite manipulability."""
    for about in (singularity_report, point_jacobian):
        for point in ([1e155, 0.0, 0.0], [0.0, -1.1e6, 0.0]):
            with pytest.raises(BadValueError, match=r"point is .* at most 1e\+06 m"):
                about(PUMA, np.full(6, 0.3), point=point)
    report = singularity_report(PUMA, np.full(6, 0.3), point=[0.0, 1e6, 0.0])
    assert np.isfinite(report.manipulability)


def test_issue_12_names_to_choose_from_can_be_imported():
    chain = load_robot("planar3r")
    still = np.zeros(3)
    accelerations = [
        forward_dynamics(chain, still, still, np.ones(3), method=name) for name in METHODS
    ]
    np.testing.assert_allclose(accelerations[0], accelerations[1], rtol=1e-9)
    assert all(operation_counts(name, 3) for name in ALGORITHMS)
