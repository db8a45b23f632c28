"""Odometry: exact arcs, and a covariance that grows with distance and slip."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from robomech_ros.rolling import (
    Odometry,
    OdometryNoise,
    advance_odometry,
    differential_drive,
    list_rolling,
    load_rolling,
    mecanum,
)
from robomech_ros.rolling.arcs import moved


def exponential(pose, step):
    """The same by the exponential of a matrix."""
    w, x, y = step
    after = expm(np.array([[0.0, -w, x], [w, 0.0, y], [0.0, 0.0, 0.0]]))
    c, s = math.cos(pose[2]), math.sin(pose[2])
    place = np.array([[c, -s], [s, c]]) @ after[:2, 2] + pose[:2]
    return np.array([*place, pose[2] + w])


@pytest.mark.parametrize("turn", [0.0, 1e-12, 1e-5, 0.00999, 0.01001, 1.0, -3.0, 7.0])
def test_arcs_are_those_of_the_exponential(turn):
    pose, step = np.array([0.4, -0.2, 2.1]), np.array([turn, 0.7, -0.3])
    assert np.abs(moved(pose, step) - exponential(pose, step)).max() < 1e-14


def test_black_box_2_odometry_of_the_controllers():
    base = differential_drive(0.1, 0.4)
    rates = base.wheel_rates([1.0, 0.5, 0.0])
    pose = base.integrate([0.0, 0.0, 0.0], rates, 1.0)
    assert pose == pytest.approx([0.5 * math.sin(1.0), 0.5 * (1.0 - math.cos(1.0)), 1.0], abs=1e-12)
    for _ in range(50):
        pose = base.integrate(pose, rates, 0.02)
    assert pose == pytest.approx([0.5 * math.sin(2.0), 0.5 * (1.0 - math.cos(2.0)), 2.0], abs=1e-12)


def test_a_quarter_turn_of_a_mecanum_base_ends_where_it_should():
    """With the new heading and straight steps it would be 7.1 mm beside."""
    base, pose = mecanum(0.1, 0.6, 0.4), np.zeros(3)
    count = 157
    time = 0.5 * math.pi / 0.5 / count
    rates = base.wheel_rates([0.5, 0.5, 0.0])
    for _ in range(count):
        pose = base.integrate(pose, rates, time)
    assert pose == pytest.approx([1.0, 1.0, 0.5 * math.pi], abs=1e-12)


@pytest.mark.parametrize("name", list_rolling())
def test_poses_are_moved_many_at_once(name):
    base, rng = load_rolling(name), np.random.default_rng(1)
    twists = base.feasible(rng.normal(size=(20, 3)))
    angles = base.steering_angles(twists) if base.steered else None
    poses = rng.normal(size=(20, 3))
    moving = base.integrate(poses, base.wheel_rates(twists), 0.3, angles)
    expected = [exponential(pose, 0.3 * twist) for pose, twist in zip(poses, twists, strict=True)]
    assert np.abs(moving - expected).max() < 1e-12


def test_the_covariance_of_a_straight_way_does_not_depend_on_the_steps():
    base, noise = differential_drive(0.1, 0.4), OdometryNoise(travel=1e-4)
    found = []
    for count in (1, 7, 100):
        odometry = Odometry.at([0.0, 0.0, 0.3])
        for _ in range(count):
            odometry = advance_odometry(base, odometry, [5.0, 5.0], 4.0 / count, noise=noise)
        found.append(odometry.covariance)
    assert np.abs(found[1] - found[0]).max() < 1e-15
    assert np.abs(found[2] - found[0]).max() < 1e-15
    # The heading as the difference of both ways over the track.
    assert found[0][2, 2] == pytest.approx(2.0 * 1e-4 * 2.0 / 0.4**2)


def test_black_box_covariance_grows_with_distance_and_with_slip_and_not_at_rest():
    base = mecanum(0.1, 0.6, 0.4)
    rates = base.wheel_rates([0.3, 0.5, 0.1])
    odometry, sizes = Odometry.at(), []
    for _ in range(20):
        odometry = advance_odometry(base, odometry, rates, 0.1)
        assert np.linalg.eigvalsh(odometry.covariance).min() > 0.0
        sizes.append(np.trace(odometry.covariance))
    assert (np.diff(sizes) > 0.0).all()
    resting = advance_odometry(base, odometry, np.zeros(4), 5.0)
    assert np.abs(resting.covariance - odometry.covariance).max() < 1e-18
    slipping = advance_odometry(base, odometry, rates + [1.0, 0.0, 0.0, 0.0], 0.1)
    rolling = advance_odometry(base, odometry, rates, 0.1)
    assert slipping.slip > 0.01
    assert np.trace(slipping.covariance) > 1.5 * np.trace(rolling.covariance)


def test_the_covariance_is_that_of_many_noisy_ways():
    """Wheels whose ways vary as the noise says scatter the poses as the covariance says."""
    base, noise, rng = mecanum(0.1, 0.6, 0.4), OdometryNoise(travel=1e-4), np.random.default_rng(2)
    rates, count, dt = base.wheel_rates([0.8, 0.5, 0.2]), 100, 0.02
    odometry, poses = Odometry.at(), np.zeros((4000, 3))
    for _ in range(count):
        odometry = advance_odometry(base, odometry, rates, dt, noise=noise)
        spread = np.sqrt(1e-4 * np.abs(rates) * 0.1 * dt)
        ways = rates * 0.1 * dt + rng.normal(size=(len(poses), 4)) * spread
        poses = base.integrate(poses, ways / 0.1 / dt, dt)
    found = np.cov(poses.T)
    size = np.sqrt(np.outer(np.diag(found), np.diag(found)))
    assert np.abs((found - odometry.covariance) / size).max() < 0.1
