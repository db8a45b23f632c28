"""Random plans of every profile over many magnitudes; `make plans` makes a million of each."""

import warnings

import numpy as np
import pytest
from many_plans.campaign import run
from many_plans.cases import CASES

from robomech_ros.errors import BadValueError
from robomech_ros.trajectory import (
    Limits,
    discretise,
    point_to_point,
    sampled_motion,
    through_points,
    verify,
)

# Those that take more than a hundredth of a second each, and how many of them are made.
SLOWER = {
    "poly345_through": 40,
    "poly4567_through": 40,
    "cubic_spline_through": 40,
    "ruckig_through": 100,
    "time_optimal_through": 8,
    "path": 60,
    "path_smoothed": 6,
    "path_torques": 60,
}


def of(profile, count, **marks):
    return pytest.param(profile, count, id=f"{profile}-{count}", **marks)


@pytest.mark.parametrize(
    ("profile", "count"),
    [
        *(of(profile, SLOWER.get(profile, 300)) for profile in CASES),
        *(of(profile, 4 * count, marks=pytest.mark.long) for profile, count in SLOWER.items()),
    ],
)
def test_plans_over_many_magnitudes(profile, count):
    outcome = run(profile, count, seed=13)
    assert not outcome.faults, outcome.faults[:5]
    assert outcome.plans >= 0.97 * count, outcome.reasons


def test_issue_13_breaks_of_plans_with_random_limits_increase():
    rng = np.random.default_rng(13)
    names = [f"joint {k}" for k in range(6)]
    for _ in range(2050):
        rates = 10.0 ** rng.uniform(-1.0, 2.0, (3, 6))
        limits = Limits(names, *rates)
        start, goal = rng.uniform(-3.0, 3.0, (2, 6))
        motion = point_to_point(start, goal, limits=limits, profile="double_s")
        assert verify(motion.pieces, limits, start=start).ok


@pytest.mark.parametrize("apart", [1e-6, 3e-7, 1e-8])
@pytest.mark.parametrize("profile", ["time_optimal", "ruckig", "cubic_spline"])
def test_issue_13_points_microradians_apart_are_passed(profile, apart):
    limits = Limits(["base", "elbow"], velocity=[1.0, 2.0], acceleration=6.0, jerk=60.0)
    start = np.array([0.3, -2.5])
    steps = np.array([[0.0, 0.0], [1.0, 0.5], [-0.5, 1.0], [2.0, -1.0], [0.4 / apart, 0.0]])
    points = start + apart * np.cumsum(steps, axis=0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motion = through_points(points, limits=limits, profile=profile)
    passed = motion.sample(motion.knots).position
    np.testing.assert_allclose(passed, points, rtol=0.0, atol=1e-12)
    assert verify(motion, limits, start=start).ok


@pytest.mark.parametrize("profile", ["time_optimal", "ruckig", "cubic_spline", "poly345"])
def test_issue_13_no_warnings_for_points_that_are_nearly_equal(profile):
    limits = Limits(["base"], velocity=0.05, acceleration=0.03, jerk=0.4)
    for apart in 10.0 ** np.arange(-17.0, -6.0):
        points = np.array([[0.7], [0.7 + apart], [0.7 + 2.5 * apart], [0.7 + 3.0 * apart]])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            motion = through_points(points, limits=limits, profile=profile)
        assert np.isfinite(motion.pieces.coefficients).all()
        np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=2e-9)


@pytest.mark.parametrize("planner", [None, 0, "ruckig", Limits])
def test_issue_13_a_planner_that_is_no_function_is_refused(planner):
    limits = Limits(["lift"], velocity=1.0, acceleration=4.0, jerk=40.0)
    with pytest.raises(BadValueError, match="planner"):
        sampled_motion(planner, [0.0], limits, period=0.1, max_points=1000)


def test_issue_13_samples_at_breaks_nearer_than_a_nanosecond_have_times_of_their_own():
    limits = Limits(["lift"], velocity=1.0, acceleration=4.0, jerk=1e11)
    motion = point_to_point([0.0], [1.0], limits=limits, profile="double_s")
    assert np.diff(motion.pieces.breaks).min() < 1e-10
    waypoints = discretise(motion, 0.1, 1000, jerk_error=1e300)
    assert (np.diff(waypoints.times) > 0.0).all()
    assert waypoints.curve.duration == waypoints.times[-1]
