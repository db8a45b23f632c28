"""Changes of pace keep to the path and to the acceleration limits."""

import numpy as np
import pytest
from execution_cases import wave

from robomech_ros.execution.client.paced_waypoints import paced_waypoints, slowed_waypoints
from robomech_ros.execution.time_scaling import constant_pace, pace_change
from robomech_ros.trajectory import Waypoints, point_to_point, verify
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.waypoints import discretise

NAMES = ("a", "b")
LIMITS = Limits(NAMES, velocity=2.0, acceleration=8.0, jerk=100.0, lower=-9.0, upper=9.0)


def path_error(positions):
    """How far positions are from the wave, at most."""
    return np.abs(positions[:, 1] - 0.4 * np.sin(2.5 * positions[:, 0])).max()


@pytest.mark.parametrize("target", [0.0, 0.05, 0.3, 0.9])
@pytest.mark.parametrize("place", [0.02, 0.5, 1.0, 1.6, 1.97])
def test_slower_on_the_path_within_the_limits(place, target):
    waypoints = wave()
    curve = waypoints.curve
    scaling = pace_change(curve, 5.0, place, 1.0, target, LIMITS.acceleration)
    rest = paced_waypoints(curve, waypoints, scaling, 0.0)
    assert (np.diff(rest.times) > 0.0).all()
    replayed = rest.curve
    seen = replayed.sample(np.linspace(0.0, rest.times[-1], 3000))
    assert path_error(seen.position) < 2e-5
    full = np.abs(curve.sample(np.linspace(0.0, 2.0, 3000)).acceleration).max(axis=0)
    allowed = np.maximum(LIMITS.acceleration, full)
    assert (np.abs(seen.acceleration).max(axis=0) <= 1.02 * allowed).all()
    np.testing.assert_allclose(rest.velocities[-1], 0.0, atol=1e-12)
    if target and scaling.pace == target:
        np.testing.assert_allclose(rest.positions[-1], waypoints.positions[-1], atol=1e-12)
        left = (2.0 - scaling.places[-1]) / target + scaling.times[-1]
        assert rest.times[-1] == pytest.approx(left, abs=1e-9)


def test_a_stop_and_a_start_come_to_the_end():
    waypoints = wave()
    curve = waypoints.curve
    stop = pace_change(curve, 0.0, 0.6, 1.0, 0.0, LIMITS.acceleration)
    assert stop.pace == 0.0
    assert 0.6 < stop.places[-1] < 1.4
    assert stop.place(100.0) == stop.places[-1]
    start = pace_change(curve, 7.0, stop.places[-1], 0.0, 1.0, LIMITS.acceleration)
    rest = paced_waypoints(curve, waypoints, start, 0.0)
    np.testing.assert_allclose(rest.positions[0], curve.sample(stop.places[-1]).position)
    np.testing.assert_allclose(rest.velocities[0], 0.0, atol=1e-12)
    np.testing.assert_allclose(rest.positions[-1], waypoints.positions[-1], atol=1e-12)
    assert path_error(rest.curve.sample(np.linspace(0.0, rest.times[-1], 999)).position) < 2e-5


def test_pace_may_rise_where_the_plan_takes_all_of_the_limit():
    motion = point_to_point([0.0, 0.0], [2.0, 1.0], limits=LIMITS, profile="ruckig")
    waypoints = discretise(motion, 0.02, 1000)
    for place in np.linspace(0.01, motion.duration - 0.05, 23):
        scaling = pace_change(waypoints.curve, 0.0, place, 0.3, 1.0, LIMITS.acceleration)
        rest = paced_waypoints(waypoints.curve, waypoints, scaling, 0.0)
        peaks = verify(rest.curve, LIMITS, from_zero=False, to_rest=True, rates=("velocity",))
        assert peaks.peak_acceleration_ratio.max() < 1.05
        assert peaks.peak_velocity_ratio.max() < 1.0 + 1e-6


def test_constant_pace():
    waypoints = wave()
    slow = slowed_waypoints(waypoints, 0.25)
    assert slow.times[-1] == pytest.approx(8.0)
    times = np.linspace(0.0, 8.0, 777)
    np.testing.assert_allclose(
        slow.curve.sample(times).position, waypoints.curve.sample(times * 0.25).position, atol=1e-12
    )
    scaling = constant_pace(1.0, 0.0, 0.25)
    assert scaling.place(5.0) == pytest.approx(1.0)


def test_positions_alone_stay_positions_alone():
    waypoints = Waypoints(np.array([0.0, 1.0, 2.0]), np.array([[0.0, 0.0], [0.5, 0.2], [0.6, 0.9]]))
    curve = waypoints.curve
    scaling = pace_change(curve, 0.0, 0.2, 1.0, 0.5, LIMITS.acceleration)
    rest = paced_waypoints(curve, waypoints, scaling, 0.05)
    assert rest.times[0] == pytest.approx(0.05)
    assert np.isnan(rest.velocities[-2:]).all()
    np.testing.assert_allclose(rest.positions[-1], [0.6, 0.9])
    assert rest.times[-1] > 3.5
