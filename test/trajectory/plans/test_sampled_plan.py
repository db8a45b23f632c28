"""Plans as messages carry them: samples that give the limits back to whoever interpolates them."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, DurationTooShortError
from robomech_ros.trajectory import (
    PROFILES,
    Limits,
    interpolant,
    point_to_point,
    sampled_point_to_point,
    sampled_through_points,
)

SAMPLED = sorted(name for name, method in PROFILES.items() if not method.ACCELERATION_STEPS)


def random_limits(generator, n=6):
    return Limits(
        [f"joint_{k}" for k in range(n)],
        velocity=generator.uniform(0.5, 4.0, n),
        acceleration=generator.uniform(1.0, 20.0, n),
        jerk=10.0 ** generator.uniform(1.0, 3.5, n),
    )


def plan(start, goal, limits, profile, **options):
    arguments = {"period": 0.01, "max_points": 100_000} | options
    return sampled_point_to_point(start, goal, limits=limits, profile=profile, **arguments)


@pytest.mark.parametrize("profile", SAMPLED)
@pytest.mark.parametrize("seed", range(30))
def test_the_interpolated_samples_keep_to_the_limits(seed, profile):
    generator = np.random.default_rng(seed)
    limits = random_limits(generator)
    start, goal = generator.uniform(-3.0, 3.0, (2, 6))
    period = float(generator.choice([0.001, 0.01, 0.05]))
    planned = plan(start, goal, limits, profile, period=period)
    points, report = planned.waypoints, planned.verification
    assert report.ok
    for ratio in ("velocity", "acceleration", "jerk"):
        assert getattr(report, f"peak_{ratio}_ratio").max() <= 1.0
    assert points.times[0] == 0.0
    steps = np.diff(points.times)
    assert (steps > 0.0).all()
    assert steps.max() <= period + 2e-9
    np.testing.assert_array_equal(points.positions[0], start)
    np.testing.assert_array_equal(points.positions[-1], goal)
    for rate in (points.velocities, points.accelerations):
        np.testing.assert_array_equal(rate[-1], 0.0)
    nanoseconds = points.times * 1e9
    np.testing.assert_allclose(nanoseconds, np.round(nanoseconds), rtol=0.0, atol=1e-5)
    dense = interpolant(points.times, points.positions, points.velocities, points.accelerations)
    instants = np.linspace(0.0, points.times[-1], 5000)
    sample, exact = dense.sample(instants), planned.trajectory.sample(instants)
    assert (np.abs(sample.velocity) <= limits.velocity).all()
    assert (np.abs(sample.acceleration) <= limits.acceleration).all()
    assert (np.abs(sample.jerk) <= limits.jerk * 1.02).all()  # samples 1e-4 s apart are rounded
    np.testing.assert_allclose(sample.position, exact.position, atol=1e-6)
    fastest = point_to_point(start, goal, limits=limits, profile=profile).duration
    assert fastest < planned.trajectory.duration < 1.005 * fastest


def peaks(points):
    """Return the largest acceleration and jerk of the quintics, by the textbook."""
    h = np.diff(points.times)[:, None]
    rise = np.diff(points.positions, axis=0)
    v0, v1 = points.velocities[:-1] * h, points.velocities[1:] * h
    a0, a1 = points.accelerations[:-1] * h**2, points.accelerations[1:] * h**2
    cubic = 10.0 * rise - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1
    quartic = -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1
    quintic = 6.0 * rise - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1
    part = np.linspace(0.0, 1.0, 11)[:, None, None]
    acceleration = a0 + part * (6.0 * cubic + part * (12.0 * quartic + part * 20.0 * quintic))
    jerk = 6.0 * cubic + part * (24.0 * quartic + part * 60.0 * quintic)
    return np.abs(acceleration / h**2).max(), np.abs(jerk / h**3).max()


@pytest.mark.parametrize("seed", [0, 3, 34, 38])
def test_jerk_steps_that_nearly_coincide_leave_no_rounding_above_the_limits(seed):
    limits = Limits([f"joint_{k}" for k in range(6)], velocity=3.0, acceleration=3.0, jerk=30.0)
    points = np.random.default_rng(seed).uniform(-1.5, 1.5, (6, 6))
    sampled = sampled_through_points(
        points, limits=limits, profile="ruckig", period=0.01, max_points=10000
    )
    acceleration, jerk = peaks(sampled.waypoints)
    assert acceleration <= 3.0 * (1.0 + 1e-9)
    assert jerk <= 30.0 * (1.0 + 1e-9)


def test_equal_steps_where_nothing_jumps():
    limits = Limits(["slide"], velocity=1.0, acceleration=2.0)
    planned = plan([0.0], [1.0], limits, "poly345", period=0.1)
    steps = np.diff(planned.waypoints.times)
    np.testing.assert_allclose(steps, steps[0], atol=2e-9)
    assert 0.09 < steps[0] <= 0.1


def test_a_wanted_duration_and_the_shortest_of_all():
    limits = Limits(["slide"], velocity=1.0, acceleration=2.0, jerk=20.0)
    for profile in SAMPLED:
        shortest = point_to_point([0.0], [1.0], limits=limits, profile=profile).duration
        exact = plan([0.0], [1.0], limits, profile, duration=shortest)
        assert exact.trajectory.duration == pytest.approx(shortest, abs=1e-8)
        assert exact.waypoints.times[-1] == pytest.approx(shortest, abs=2e-9)
        assert plan([0.0], [1.0], limits, profile, duration=5.0).waypoints.times[-1] == 5.0
        with pytest.raises(DurationTooShortError):
            plan([0.0], [1.0], limits, profile, duration=0.999 * shortest)


@pytest.mark.parametrize("profile", SAMPLED)
def test_a_motion_of_no_length_has_a_start_and_an_end(profile):
    limits = Limits(["slide"], velocity=1.0, acceleration=2.0, jerk=20.0)
    points = plan([0.5], [0.5], limits, profile).waypoints
    np.testing.assert_array_equal(points.times, [0.0, 0.001])
    np.testing.assert_array_equal(points.positions, [[0.5], [0.5]])


def test_too_many_points_are_refused_with_the_period_that_would_do():
    limits = Limits(["slide"], velocity=1.0, acceleration=2.0, jerk=20.0)
    for profile in SAMPLED:
        with pytest.raises(BadValueError, match="may have 100 points") as caught:
            plan([0.0], [1.0], limits, profile, period=1e-4, max_points=100)
        least = float(caught.value.expected.split()[2])
        assert len(plan([0.0], [1.0], limits, profile, period=least).waypoints.times) <= 100
        count = len(plan([0.0], [1.0], limits, profile, period=0.01).waypoints.times)
        exact = plan([0.0], [1.0], limits, profile, period=0.01, max_points=count)
        assert len(exact.waypoints.times) == count
        with pytest.raises(BadValueError, match=f"may have {count - 1} points"):
            plan([0.0], [1.0], limits, profile, period=0.01, max_points=count - 1)


def test_a_moving_start_is_kept():
    limits = Limits(["slide"], velocity=1.0, acceleration=2.0, jerk=20.0)
    points = plan([0.0], [1.0], limits, "ruckig", start_velocity=[0.7]).waypoints
    assert points.velocities[0] == pytest.approx(0.7, abs=1e-15)
    assert points.positions[0] == 0.0
