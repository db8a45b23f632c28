"""Motions through via points: passed without a stop, within the limits, sampled as promised."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, DurationTooShortError, WrongSizeError
from robomech_ros.trajectory import (
    PROFILES,
    VIA_PROFILES,
    Limits,
    point_to_point,
    sampled_through_points,
    through_points,
)

JOINTS = tuple(f"joint_{k}" for k in range(6))


def random_case(seed, count):
    rng = np.random.default_rng(seed)
    limits = Limits(
        JOINTS,
        velocity=rng.uniform(0.5, 4.0, 6),
        acceleration=rng.uniform(1.0, 20.0, 6),
        jerk=10.0 ** rng.uniform(1.0, 3.0, 6),
    )
    return rng.uniform(-2.0, 2.0, (count, 6)), limits


@pytest.mark.parametrize("profile", sorted(VIA_PROFILES))
@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("seed", range(5))
def test_samples_pass_the_points_and_keep_to_the_limits(profile, count, seed):
    points, limits = random_case(seed, count)
    plan = sampled_through_points(
        points, limits=limits, profile=profile, period=0.01, max_points=99_999
    )
    assert plan.verification.ok
    knots = plan.trajectory.knots
    np.testing.assert_allclose(plan.trajectory.sample(knots).position, points, atol=1e-9)
    np.testing.assert_allclose(plan.waypoints.curve.sample(knots).position, points, atol=1e-7)
    inner = plan.trajectory.sample(knots[1:-1]).velocity
    assert (np.abs(inner).max(axis=1) > 0.0).all()  # not one of them is stopped at
    np.testing.assert_array_equal(plan.waypoints.velocities[-1], 0.0)
    np.testing.assert_array_equal(plan.waypoints.accelerations[-1], 0.0)
    rates = ("velocity", "acceleration", "jerk")
    peaks = [getattr(plan.verification, f"peak_{rate}_ratio").max() for rate in rates]
    assert 0.999 < max(peaks) <= 1.0


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_two_points_are_a_motion_from_point_to_point(profile):
    points, limits = random_case(1, 2)
    motion = through_points(points, limits=limits, profile=profile)
    assert motion.duration == point_to_point(*points, limits=limits, profile=profile).duration


@pytest.mark.parametrize("profile", sorted(VIA_PROFILES))
def test_instants_of_choice(profile):
    points, limits = random_case(2, 4)
    motion = through_points(points, limits=limits, profile=profile, at=[0.3, 0.7], duration=90.0)
    np.testing.assert_allclose(motion.sample([27.0, 63.0]).position, points[1:3], atol=1e-9)
    with pytest.raises(DurationTooShortError):
        through_points(points, limits=limits, profile=profile, at=[0.3, 0.7], duration=0.5)


def test_many_points_take_no_search():
    points, limits = random_case(3, 40)
    motion = through_points(points, limits=limits, profile="cubic_spline")
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-9)


@pytest.mark.parametrize(
    ("count", "changes", "error", "text"),
    [
        (
            5,
            {"profile": "poly345"},
            BadValueError,
            "via points is 3, .* at most 2 for poly345",
        ),
        (
            3,
            {"profile": "cycloidal"},
            BadValueError,
            "none for cycloidal; poly345, poly4567",
        ),
        (3, {"profile": "ruckig"}, BadValueError, "none for ruckig"),
        (3, {"at": [1.5]}, BadValueError, "between 0 and 1"),
        (3, {"at": [0.2, 0.5]}, WrongSizeError, "at"),
        (1, {}, WrongSizeError, "at least two points"),
    ],
)
def test_bad_requests_are_refused(count, changes, error, text):
    points, limits = random_case(4, count)
    with pytest.raises(error, match=text):
        through_points(points, limits=limits, **changes)
