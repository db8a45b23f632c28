"""What is no argument at all raises our errors, and names to choose from can be imported."""

import numpy as np
import pytest

from robomech_ros.dynamics import ALGORITHMS, METHODS, forward_dynamics, operation_counts
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots import combined, dh_from_chain, load_robot
from robomech_ros.trajectory import Limits, discretise, point_to_point, verify

LIMITS = Limits(("x", "y"), velocity=1.0, acceleration=2.0, jerk=20.0)
MOTION = point_to_point([0.0, 0.0], [1.0, 0.5], limits=LIMITS, profile="poly345")


@pytest.mark.parametrize("chain", [None, "ur5e", 7])
def test_issue_12_dh_from_what_is_no_chain(chain):
    with pytest.raises(BadValueError, match="chain"):
        dh_from_chain(chain)


@pytest.mark.parametrize("bodies", [None, 3.0, "ab", [None], [1.0, 2.0]])
def test_issue_12_combined_of_what_are_no_bodies(bodies):
    with pytest.raises(BadValueError, match="bodies"):
        combined(bodies)


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


def test_issue_12_names_to_choose_from_can_be_imported():
    chain = load_robot("planar3r")
    still = np.zeros(3)
    accelerations = [
        forward_dynamics(chain, still, still, np.ones(3), method=name) for name in METHODS
    ]
    np.testing.assert_allclose(accelerations[0], accelerations[1], rtol=1e-9)
    assert all(operation_counts(name, 3) for name in ALGORITHMS)
