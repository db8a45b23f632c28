"""Curves through waypoints against scipy, and refusals of waypoints that are none."""

import numpy as np
import pytest
from scipy.interpolate import BPoly, CubicHermiteSpline

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.trajectory import interpolant


@pytest.fixture
def waypoints():
    generator = np.random.default_rng(6)
    times = np.cumsum(generator.uniform(0.05, 0.5, 25))
    return times, *(generator.normal(size=(25, 6)) for _ in range(3))


def rates(sample):
    return sample.position, sample.velocity, sample.acceleration, sample.jerk


def test_cubic_segments_equal_scipy(waypoints):
    times, positions, velocities, _ = waypoints
    curve = interpolant(times, positions, velocities)
    oracle = CubicHermiteSpline(times, positions, velocities)
    instants = np.linspace(times[0], times[-1], 777)
    for order, values in enumerate(rates(curve.sample(instants))):
        np.testing.assert_allclose(values, oracle(instants, order), rtol=1e-10, atol=1e-9)


def test_quintic_segments_equal_scipy(waypoints):
    times, positions, velocities, accelerations = waypoints
    curve = interpolant(times, positions, velocities, accelerations)
    conditions = np.stack([positions, velocities, accelerations], axis=1)
    oracle = BPoly.from_derivatives(times, conditions)
    instants = np.linspace(times[0], times[-1], 777)
    for order, values in enumerate(rates(curve.sample(instants))):
        wanted = oracle.derivative(order)(instants) if order else oracle(instants)
        np.testing.assert_allclose(values, wanted, rtol=1e-9, atol=1e-7)


def test_linear_segments(waypoints):
    times, positions, _, _ = waypoints
    curve = interpolant(times, positions)
    instants = np.linspace(times[0], times[-1], 777)
    sample = curve.sample(instants)
    wanted = np.stack([np.interp(instants, times, column) for column in positions.T], axis=1)
    np.testing.assert_allclose(sample.position, wanted, atol=1e-12)
    assert not sample.acceleration.any()
    assert not sample.jerk.any()


def test_each_segment_takes_the_best_that_its_two_ends_allow(waypoints):
    times, positions, velocities, accelerations = waypoints
    velocities[10] = np.nan
    accelerations[5] = np.nan
    curve = interpolant(times, positions, velocities, accelerations)
    cubic = interpolant(times, positions, np.nan_to_num(velocities))
    linear = interpolant(times, positions)
    middle = (times[:-1] + times[1:]) / 2.0
    sampled, cubics = curve.sample(middle), cubic.sample(middle)
    np.testing.assert_allclose(sampled.position[4:6], cubics.position[4:6], atol=1e-12)
    lines = linear.sample(middle).velocity
    np.testing.assert_allclose(sampled.velocity[9:11], lines[9:11], atol=1e-12)
    exact = curve.sample(times[:4])
    np.testing.assert_allclose(exact.acceleration, accelerations[:4], atol=1e-9)


def test_one_instant_equals_many(waypoints):
    curve = interpolant(*waypoints)
    instants = np.linspace(waypoints[0][0] - 0.1, waypoints[0][-1] + 0.1, 50)
    many = rates(curve.sample(instants))
    for k, instant in enumerate(instants):
        for one, all_ in zip(rates(curve.sample(instant)), many, strict=True):
            assert one.shape == (6,)
            np.testing.assert_allclose(one, all_[k], rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("scalar", [False, True])
def test_outside_the_joints_rest_at_the_nearest_end(waypoints, scalar):
    times, positions, velocities, _ = waypoints
    curve = interpolant(times, positions, velocities)
    for instant, position in ((times[0] - 1.0, positions[0]), (times[-1] + 1.0, positions[-1])):
        sample = curve.sample(instant if scalar else [instant])
        np.testing.assert_allclose(sample.position, position[None] if not scalar else position)
        for rate in rates(sample)[1:]:
            assert not rate.any()


def test_a_single_waypoint_is_held():
    curve = interpolant([2.0], [[1.0, -1.0]], [[5.0, 5.0]])
    assert curve.duration == 0.0
    for instant in (0.0, 2.0, 9.0):
        sample = curve.sample(instant)
        np.testing.assert_array_equal(sample.position, [1.0, -1.0])
        assert not sample.velocity.any()
    np.testing.assert_array_equal(curve.sample([0.0, 9.0]).position, [[1.0, -1.0]] * 2)


def test_the_arrays_of_the_caller_are_not_kept():
    times, positions = np.array([0.0, 1.0]), np.array([[0.0], [1.0]])
    curve = interpolant(times, positions)
    times[:], positions[:] = 7.0, 7.0
    assert curve.sample(0.5).position == 0.5


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        (([], []), WrongSizeError, "times"),
        (([[0.0]], [[0.0]]), WrongSizeError, "times"),
        (([0.0, np.nan], [[0.0], [1.0]]), NonFiniteError, "times"),
        (([0.0, 1.0, 1.0], [[0.0]] * 3), BadValueError, "time of waypoint 2 is 1.0"),
        (([0.0, 1.0], [[0.0]] * 3), WrongSizeError, "positions"),
        (([0.0, 1.0], [0.0, 1.0]), WrongSizeError, "positions"),
        (([0.0, 1.0], [[0.0], [np.nan]]), NonFiniteError, "positions of waypoint 1"),
        (([0.0, 1.0], [[0.0]] * 2, [[0.0, 1.0]] * 2), WrongSizeError, "velocities"),
        (([0.0, 1.0], [[0.0]] * 2, [[np.inf]] * 2), NonFiniteError, "velocities of waypoint 0"),
        (
            ([0.0, 1.0], [[0.0] * 2] * 2, [[0.0] * 2] * 2, [[0.0, 0.0], [0.0, np.nan]]),
            NonFiniteError,
            "accelerations of waypoint 1",
        ),
    ],
)
def test_bad_waypoints_are_refused(arguments, error, text):
    with pytest.raises(error, match=text.replace("[", r"\[")):
        interpolant(*arguments)


@pytest.mark.parametrize("instant", [np.nan, np.inf, [0.0, np.nan]])
def test_an_instant_must_be_finite(instant):
    with pytest.raises(NonFiniteError, match="time"):
        interpolant([0.0, 1.0], [[0.0], [1.0]]).sample(instant)
