"""Time-optimal motions from point to point and through via points, as plans offer them."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.errors import (
    DurationTooShortError,
    LimitExceededError,
    MissingLimitsError,
    SeedOutsideLimitsError,
)
from robomech_ros.trajectory import (
    Limits,
    interpolant,
    point_to_point,
    sampled_through_points,
    through_points,
    time_optimal,
    verify,
)
from robomech_ros.trajectory.curves.cubic_spline import cubic_spline
from robomech_ros.trajectory.curves.fewer_pieces import with_fewer_pieces
from robomech_ros.trajectory.curves.knots import spaced_knots

JOINTS = ("base", "shoulder", "elbow")
LIMITS = Limits(JOINTS, velocity=[1.0, 2.0, 3.0], acceleration=[2.0, 6.0, 9.0], jerk=60.0)
NO_JERK = Limits(JOINTS, velocity=LIMITS.velocity, acceleration=LIMITS.acceleration)
POINTS = np.array([[0.0, 0.5, -1.0], [0.6, 1.0, 0.0], [1.0, -0.5, 0.9], [0.2, -0.4, 1.5]])


def through(points=POINTS, limits=LIMITS, **options):
    return through_points(points, limits=limits, profile="time_optimal", **options)


def test_on_a_straight_line_nothing_is_faster():
    motion = through(POINTS[:2])
    assert (
        motion.duration == point_to_point(*POINTS[:2], limits=LIMITS, profile="double_s").duration
    )
    line = interpolant([0.0, 1.0], POINTS[:2])
    bound = time_optimal(line, LIMITS).duration
    assert bound < motion.duration < 1.1 * bound
    assert verify(motion, LIMITS, start=POINTS[0]).ok


def test_without_jerk_limits_an_acceleration_still_takes_time_to_rise():
    motion = through(POINTS[:2], NO_JERK)
    report = verify(motion, NO_JERK, start=POINTS[0])
    assert report.ok, report.violation
    bound = time_optimal(interpolant([0.0, 1.0], POINTS[:2]), NO_JERK).duration
    assert bound < motion.duration < bound + 0.021
    jerks = np.abs(motion.sample(np.linspace(0.0, motion.duration, 2000)).jerk)
    assert (jerks <= NO_JERK.acceleration / 0.02 * (1.0 + 1e-9)).all()
    curved = through(limits=NO_JERK)
    assert verify(curved, NO_JERK, start=POINTS[0]).ok


@pytest.mark.parametrize("seed", range(4))
def test_via_points_are_passed_on_the_spline_faster_than_by_any_other_profile(seed):
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (6, 3))
    motion = through(points)
    assert verify(motion, LIMITS, start=points[0]).ok
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-7)
    knots = spaced_knots(points, "centripetal", LIMITS.velocity)
    spline = cubic_spline(knots, points, "natural")
    path = spline.sample(np.linspace(0.0, 1.0, 20_000)).position
    for q in motion.sample(np.linspace(0.0, motion.duration, 50)).position:
        assert np.linalg.norm(path - q, axis=1).min() < 1e-3
    assert motion.duration < 1.1 * time_optimal(spline, LIMITS).duration
    slower = through_points(points, limits=LIMITS, profile="cubic_spline").duration
    assert motion.duration < slower


def test_repeated_points_and_no_way_at_all():
    twice = through(POINTS[[0, 0, 1, 1, 2, 2]])
    assert twice.duration == through(POINTS[:3]).duration
    close = twice.sample(twice.knots).position
    np.testing.assert_allclose(close, POINTS[[0, 0, 1, 1, 2, 2]], atol=1e-7)
    still = through(POINTS[[1, 1, 1]])
    assert still.duration == 0.001 and verify(still, LIMITS, start=POINTS[1]).ok


def test_points_that_differ_by_rounding_are_one():
    """Else rounding would be a path with corners, which takes for ever to pass."""
    near = POINTS[[0, 0, 0, 1, 1]] + 1e-9 * np.array([[0], [1], [-1], [1], [0]])
    motion = through(near)
    assert motion.duration == pytest.approx(through(POINTS[[0, 1]]).duration, rel=1e-6)
    assert verify(motion, LIMITS, start=near[0]).ok
    np.testing.assert_array_equal(motion.sample(motion.duration).position, POINTS[1])
    np.testing.assert_allclose(motion.sample(motion.knots).position, near, atol=1e-7)
    still = through(POINTS[[1, 1, 1]] + 1e-9 * np.array([[0], [1], [0]]))
    assert still.duration <= 0.01
    there_and_back = through(POINTS[[0, 1, 0]])
    middle = there_and_back.sample(there_and_back.knots[1])
    np.testing.assert_allclose(middle.position, POINTS[1], atol=1e-7)


def test_one_joint_may_turn_back():
    slide = Limits(["slide"], velocity=1.0, acceleration=2.0, jerk=30.0)
    points = np.array([[0.0], [0.5], [0.1], [0.6]])
    motion = through(points, slide)
    assert verify(motion, slide, start=points[0]).ok
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-7)


def test_wanted_durations_and_scales():
    shortest = through().duration
    slow = through(duration=9.0)
    assert slow.duration == 9.0 and verify(slow, LIMITS, start=POINTS[0]).ok
    np.testing.assert_allclose(slow.sample(slow.knots).position, POINTS, atol=1e-7)
    with pytest.raises(DurationTooShortError):
        through(duration=0.99 * shortest)
    half = through(velocity_scale=0.5, acceleration_scale=0.25, jerk_scale=0.125)
    assert half.duration == pytest.approx(2.0 * shortest, rel=0.02)
    with pytest.raises(MissingLimitsError, match="jerk"):
        through(limits=NO_JERK, jerk_scale=0.5)


def test_a_path_that_swings_out_of_the_limits_is_held_back():
    held = Limits(["slide"], velocity=1.0, acceleration=2.0, jerk=30.0, lower=0.0, upper=0.5)
    points = np.array([[0.0], [0.499], [0.5], [0.1]])
    motion = through(points, held)
    assert verify(motion, held, start=points[0]).ok
    np.testing.assert_allclose(motion.sample(motion.knots).position, points, atol=1e-7)
    with pytest.raises(LimitExceededError, match="position on the way of joint 'slide'"):
        through(np.array([[0.0], [0.499], [0.6], [0.1]]), held)


def test_a_straight_line_out_of_the_limits_is_refused():
    """A straight line is left if a via point is the start or the goal."""
    narrow = replace(LIMITS, lower=np.full(3, -0.5), upper=np.full(3, 0.5))
    start, goal = np.zeros(3), np.array([0.2, 0.9, 0.1])
    for points in ([start, start, goal], [start, goal, goal]):
        with pytest.raises(LimitExceededError, match="0.9, over its limit 0.5"):
            through_points(points, limits=narrow, profile="time_optimal")
    with pytest.raises(SeedOutsideLimitsError):
        through_points([goal, goal, start], limits=narrow, profile="time_optimal")


def test_high_jerk_limits_do_not_make_too_many_samples():
    stiff = Limits(JOINTS, velocity=LIMITS.velocity, acceleration=LIMITS.acceleration, jerk=8e3)
    plan = sampled_through_points(
        POINTS, limits=stiff, profile="time_optimal", period=0.05, max_points=1000
    )
    assert plan.verification.ok
    assert len(plan.waypoints.times) < 200.0 * plan.trajectory.duration


def test_thinning_keeps_the_motion():
    times = np.linspace(0.0, 2.0, 1001)
    states = [np.sin(times + k * np.pi / 2.0)[:, None] for k in range(3)]
    fine = interpolant(times, *states)
    slide = Limits(["slide"], velocity=2.0, acceleration=2.0, jerk=2.0)
    coarse = with_fewer_pieces(fine, slide)
    assert len(coarse.breaks) < 60
    assert coarse.breaks[[0, -1]].tolist() == [0.0, 2.0]
    instants = np.linspace(0.0, 2.0, 777)
    for order, close in enumerate((1e-6, 1e-5, 1e-3)):
        np.testing.assert_allclose(
            coarse.sample(instants)[order], fine.sample(instants)[order], atol=close
        )
