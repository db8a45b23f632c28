"""Trapezoidal and double-S profiles: closed-form durations, limits, and Ruckig as a judge."""

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

from robomech_ros.errors import BadValueError, DurationTooShortError, MissingLimitsError
from robomech_ros.trajectory import Limits, point_to_point, sampled_point_to_point, verify

JOINTS = ("base", "shoulder", "elbow")
PROFILES = ("trapezoidal", "double_s")


def keeps_to(motion, limits, start):
    """Verify what a profile promises; a trapezoidal one steps to rest at its end."""
    smooth = not motion.ACCELERATION_STEPS
    return verify(motion, limits, start=start, rates=motion.REQUIRED, to_rest=smooth)


@pytest.mark.parametrize(
    ("profile", "limits", "shortest", "joint", "limit"),
    [
        # 1 / v + v / a
        ("trapezoidal", {"velocity": [9, 0.5, 9], "acceleration": 2.0}, 2.25, "shoulder",
         "velocity"),
        # 2 sqrt(1 / a)
        ("trapezoidal", {"velocity": 9, "acceleration": [9, 9, 4]}, 1.0, "elbow", "acceleration"),
        # 1 / v + v / a + a / j
        ("double_s", {"velocity": 0.5, "acceleration": 1.0, "jerk": 4.0}, 2.75, "base", "velocity"),
        # 1 / v + 2 sqrt(v / j)
        ("double_s", {"velocity": 0.5, "acceleration": 9.0, "jerk": 8.0}, 2.5, "base", "velocity"),
        # a / j + sqrt((a / j)^2 + 4 / a)
        ("double_s", {"velocity": 9, "acceleration": 1.0, "jerk": 2.0}, 0.5 + 4.25**0.5, "base",
         "acceleration"),
        # 4 (1 / (2 j))^(1/3)
        ("double_s", {"velocity": 9, "acceleration": 99, "jerk": [99, 32.0, 99]}, 1.0, "shoulder",
         "jerk"),
    ],
)  # fmt: skip
def test_the_shortest_duration_and_what_binds(profile, limits, shortest, joint, limit):
    allowed = Limits(JOINTS, **limits)
    start, goal = np.array([0.1, 0.2, 0.3]), np.array([1.1, 1.2, -0.7])
    motion = point_to_point(start, goal, limits=allowed, profile=profile)
    assert motion.duration == pytest.approx(shortest, rel=1e-12)
    assert keeps_to(motion, allowed, start).ok
    slow = point_to_point(start, goal, limits=allowed, profile=profile, duration=9.0)
    assert slow.duration == pytest.approx(9.0, rel=1e-12)
    assert keeps_to(slow, allowed, start).ok
    with pytest.raises(DurationTooShortError) as caught:
        point_to_point(start, goal, limits=allowed, profile=profile, duration=shortest * 0.99)
    assert (caught.value.joint, caught.value.limit) == (joint, limit)


@pytest.mark.parametrize("profile", PROFILES)
@settings(max_examples=80, deadline=None)
@given(
    rise=st.lists(st.floats(-6.0, 6.0), min_size=3, max_size=3),
    velocity=st.floats(0.01, 10.0),
    acceleration=st.floats(0.01, 100.0),
    jerk=st.floats(0.1, 1e4),
)
@example(rise=[0.0, 0.0, 4.0], velocity=0.03125, acceleration=0.015625, jerk=2091.0)
def test_any_motion_is_within_its_limits_and_straight(profile, rise, velocity, acceleration, jerk):
    allowed = Limits(JOINTS, velocity=velocity, acceleration=acceleration, jerk=jerk)
    start, goal = np.array([0.3, -0.2, 0.1]), np.array([0.3, -0.2, 0.1]) + rise
    motion = point_to_point(start, goal, limits=allowed, profile=profile)
    report = keeps_to(motion, allowed, start)
    assert report.ok, report.violation
    peaks = [getattr(report, f"peak_{rate}_ratio").max() for rate in motion.REQUIRED]
    # Instants are told to a rounding, in which the acceleration changes by so much of its limit.
    rounding = 1e-9 + np.spacing(motion.duration) * jerk / acceleration
    assert motion.duration == pytest.approx(1e-3) or max(peaks) == pytest.approx(1.0, rel=rounding)
    inside = motion.sample(np.linspace(0.0, motion.duration, 50)).position - start
    np.testing.assert_allclose(np.cross(inside, np.array(rise)), 0.0, atol=1e-9)


@settings(max_examples=100, deadline=None)
@given(
    rise=st.floats(1e-3, 6.0),
    velocity=st.floats(0.01, 10.0),
    acceleration=st.floats(0.01, 100.0),
    jerk=st.floats(0.1, 1e4),
)
def test_double_s_is_as_fast_as_ruckig(rise, velocity, acceleration, jerk):
    """For one joint both are time-optimal."""
    allowed = Limits(("slide",), velocity=velocity, acceleration=acceleration, jerk=jerk)
    ours, theirs = (
        point_to_point([0.0], [rise], limits=allowed, profile=profile).duration
        for profile in ("double_s", "ruckig")
    )
    assert ours == pytest.approx(theirs, rel=1e-6, abs=2e-6)


@pytest.mark.parametrize("profile", PROFILES)
def test_ends_are_exact_and_no_motion_stands_still(profile):
    allowed = Limits(JOINTS, velocity=1.3, acceleration=2.7, jerk=31.0)
    start, goal = np.array([0.1, -2.3, 3.0]), np.array([1 / 3, 2.7, -2.9])
    motion = point_to_point(start, goal, limits=allowed, profile=profile)
    for instant, place in ((0.0, start), (motion.duration, goal), (-1.0, start), (99.0, goal)):
        sample = motion.sample(instant)
        np.testing.assert_array_equal(sample.position, place)
        np.testing.assert_array_equal(sample.velocity, 0.0)
    still = point_to_point(start, start, limits=allowed, profile=profile, duration=2.0)
    assert still.duration == 2.0 and (still.sample([0.0, 1.0, 2.0]).position == start).all()


def test_what_cannot_be_planned_or_sampled_is_told():
    free = Limits(JOINTS, velocity=1.0, acceleration=1.0)
    with pytest.raises(MissingLimitsError, match="no jerk limit for joints base, shoulder, elbow"):
        point_to_point(np.zeros(3), np.ones(3), limits=free, profile="double_s")
    with pytest.raises(
        BadValueError, match="continuous acceleration, .*: cubic_spline, cycloidal, double_s, "
    ):
        sampled_point_to_point(
            np.zeros(3), np.ones(3), limits=free, profile="trapezoidal", period=0.01, max_points=999
        )


@pytest.mark.parametrize("profile", ["poly345", "poly4567", "cycloidal", "double_s"])
def test_samples_for_a_controller_keep_to_the_limits(profile):
    rng = np.random.default_rng(3)
    for _ in range(20):
        allowed = Limits(
            JOINTS,
            velocity=rng.uniform(0.5, 3.0, 3),
            acceleration=rng.uniform(1.0, 9.0, 3),
            jerk=rng.uniform(10.0, 90.0, 3),
        )
        start, goal = rng.uniform(-2.0, 2.0, (2, 3))
        plan = sampled_point_to_point(
            start, goal, limits=allowed, profile=profile, period=0.01, max_points=9999
        )
        checked = plan.verification
        assert checked.ok
        peaks = (
            checked.peak_velocity_ratio,
            checked.peak_acceleration_ratio,
            checked.peak_jerk_ratio,
        )
        assert 0.999 < np.max(peaks) <= 1.0 + 1e-9
        np.testing.assert_array_equal(plan.waypoints.velocities[-1], 0.0)
        np.testing.assert_array_equal(plan.waypoints.accelerations[-1], 0.0)
