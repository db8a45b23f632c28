"""Motions through via points: passed without a stop, within the limits, sampled as promised."""

import itertools

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
    verify,
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
    # Along a path in many pieces, thinned out, the points are met less exactly.
    close = 1e-7 if profile == "time_optimal" else 1e-9
    np.testing.assert_allclose(plan.trajectory.sample(knots).position, points, atol=close)
    np.testing.assert_allclose(plan.waypoints.curve.sample(knots).position, points, atol=2e-7)
    if profile != "ruckig":  # which stops where that is faster
        inner = plan.trajectory.sample(knots[1:-1]).velocity
        assert (np.abs(inner).max(axis=1) > 0.0).all()
    np.testing.assert_array_equal(plan.waypoints.velocities[-1], 0.0)
    np.testing.assert_array_equal(plan.waypoints.accelerations[-1], 0.0)
    rates = ("velocity", "acceleration", "jerk")
    peaks = [getattr(plan.verification, f"peak_{rate}_ratio").max() for rate in rates]
    assert 0.995 < max(peaks) <= 1.0


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_two_points_are_a_motion_from_point_to_point(profile):
    points, limits = random_case(1, 2)
    motion = through_points(points, limits=limits, profile=profile)
    assert motion.duration == point_to_point(*points, limits=limits, profile=profile).duration


@pytest.mark.parametrize("count", [10, 40])
def test_ruckig_is_about_as_fast_as_the_time_optimal_motion_through_many_points(count):
    t = np.linspace(0.0, 1.0, count)
    points = np.stack([np.sin(2.0 * np.pi * t * (1.0 + 0.3 * j) + j) for j in range(6)], axis=1)
    limits = Limits(JOINTS, velocity=2.0, acceleration=8.0, jerk=80.0)
    motion = through_points(points, limits=limits, profile="ruckig")
    fastest = through_points(points, limits=limits, profile="time_optimal")
    assert motion.duration <= 1.02 * fastest.duration
    found = verify(motion, limits)
    assert found.ok
    assert found.largest_acceleration_step.max() < 1e-9
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-9)


@pytest.mark.parametrize("profile", sorted(set(VIA_PROFILES) - {"ruckig", "time_optimal"}))
def test_instants_of_choice(profile):
    points, limits = random_case(2, 4)
    motion = through_points(points, limits=limits, profile=profile, at=[0.3, 0.7], duration=90.0)
    np.testing.assert_allclose(motion.sample([27.0, 63.0]).position, points[1:3], atol=1e-9)
    with pytest.raises(DurationTooShortError):
        through_points(points, limits=limits, profile=profile, at=[0.3, 0.7], duration=0.5)


@pytest.mark.parametrize("profile", ["ruckig", "time_optimal"])
def test_via_points_that_are_start_and_goal_make_no_motion(profile):
    points, limits = random_case(6, 1)
    motion = through_points(points[[0, 0, 0, 0]], limits=limits, profile=profile)
    assert motion.duration <= 0.01
    np.testing.assert_array_equal(motion.sample(motion.knots).position, points[[0, 0, 0, 0]])
    assert (
        through_points(points[[0, 0, 0]], limits=limits, profile=profile, duration=3.0).duration
        == 3.0
    )


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["cubic_spline", "ruckig"])
def test_many_points_take_bounded_time(profile):
    points, limits = random_case(3, 120)
    motion = through_points(points, limits=limits, profile=profile)
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_ruckig_is_never_slower_than_stopping_at_every_point(seed):
    """Random points leave little to gain; those of a smooth path are passed in half of the time."""
    rng = np.random.default_rng(seed)
    limits = Limits(JOINTS, velocity=1.5, acceleration=4.0, jerk=40.0)
    phases, turns = rng.uniform(0.0, 6.0, 6), rng.uniform(1.0, 4.0, 6)
    smooth = 2.0 * np.sin(turns * np.linspace(0.0, 1.0, 8)[:, None] + phases)
    for points, most in ((rng.uniform(-2.0, 2.0, (5, 6)), 1.0), (smooth, 0.7)):
        motion = through_points(points, limits=limits, profile="ruckig")
        assert verify(motion, limits, start=points[0]).ok
        stopping = sum(
            point_to_point(*pair, limits=limits, profile="ruckig").duration
            for pair in itertools.pairwise(points)
        )
        assert motion.duration <= most * stopping * (1.0 + 1e-9)
        slow = through_points(points, limits=limits, profile="ruckig", duration=60.0)
        assert slow.duration == pytest.approx(60.0)
        assert verify(slow, limits, start=points[0]).ok


def test_a_motion_that_would_swing_out_of_the_limits_is_slower_instead():
    points = np.array([[0.0], [0.5], [1.0], [0.2], [0.0]])
    free = Limits(["slide"], velocity=2.0, acceleration=3.0, jerk=30.0)
    held = Limits(["slide"], velocity=2.0, acceleration=3.0, jerk=30.0, lower=0.0, upper=1.0)
    motion = through_points(points, limits=held, profile="ruckig")
    assert verify(motion, held, start=points[0]).ok
    assert motion.duration >= through_points(points, limits=free, profile="ruckig").duration
    twice = through_points(points[[0, 1, 1, 2]], limits=held, profile="ruckig")
    np.testing.assert_allclose(twice.sample(twice.knots).position, points[[0, 1, 1, 2]], atol=1e-9)


@pytest.mark.parametrize(
    ("count", "changes", "error", "text"),
    [
        (5, {"profile": "poly345"}, BadValueError, "via points is 3, .* at most 2 for poly345"),
        (3, {"profile": "cycloidal"}, BadValueError, "none for cycloidal; poly345, poly4567"),
        (3, {"profile": "ruckig", "at": [0.5]}, BadValueError, "at is .*none for ruckig"),
        (3, {"profile": "time_optimal", "at": [0.5]}, BadValueError, "none for time_optimal"),
        (3, {"profile": "double_s"}, BadValueError, "none for double_s"),
        (3, {"at": [1.5]}, BadValueError, "between 0 and 1"),
        (3, {"at": [0.2, 0.5]}, WrongSizeError, "at"),
        (1, {}, WrongSizeError, "at least two points"),
    ],
)
def test_bad_requests_are_refused(count, changes, error, text):
    points, limits = random_case(4, count)
    with pytest.raises(error, match=text):
        through_points(points, limits=limits, **changes)


ON_THE_LIMIT = {
    "stays, then leaves": [[0, 0], [1, 0], [2, 1]],
    "leaves slowly": [[0, 0], [1, 0.01], [2, 1]],
    "comes back": [[0, 0], [1, 1], [2, 0], [2.5, 1]],
    "stays twice": [[0, 0], [0.3, 0], [0.6, 0], [1, 0.5], [2, 1]],
    "arrives early": [[0, 1], [1, 0], [2, 0]],
}


@pytest.mark.parametrize("profile", ["cubic_spline", "time_optimal"])
@pytest.mark.parametrize("name", ON_THE_LIMIT)
def test_issue_12_a_joint_may_start_or_stop_on_its_position_limit(name, profile):
    """Splines swung out of the limit, by 0.0766 rad in the first case, and were refused."""
    limits = Limits(
        ("a", "b"), velocity=1.0, acceleration=2.0, jerk=20.0, lower=[-3, 0], upper=[3, 3]
    )
    points = np.array(ON_THE_LIMIT[name], dtype=float)
    motion = through_points(points, limits=limits, profile=profile)
    assert verify(motion, limits, start=points[0]).ok
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-6)
    unbounded = Limits(("a", "b"), velocity=1.0, acceleration=2.0, jerk=20.0)
    free = through_points(points, limits=unbounded, profile=profile)
    assert motion.duration < 1.25 * free.duration
    plan = sampled_through_points(
        points, limits=limits, profile=profile, period=0.01, max_points=99_999
    )
    assert plan.verification.ok
