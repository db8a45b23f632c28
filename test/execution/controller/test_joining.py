import math

import numpy as np
import pytest
from execution_cases import ACCELERATION, VELOCITY, joints, single_point, state, to_rest

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.joining import join
from robomech_ros.execution.joints import State
from robomech_ros.execution.rejections import StartMismatchError, TrajectoryRefusedError
from robomech_ros.trajectory import Waypoints

TOLERANCE = 0.01


def joined(waypoints, present, late=0.0):
    return join(waypoints, present, joints(), TOLERANCE, late)


def assert_smooth(curve, present):
    """No step at the start; limits of speed and, with the planned share, acceleration kept."""
    begin = curve.sample(0.0)
    np.testing.assert_allclose(begin.position, present.position, atol=1e-12)
    np.testing.assert_allclose(begin.velocity, present.velocity, atol=1e-12)
    times = np.linspace(0.0, curve.duration, 4001)
    sample = curve.sample(times)
    step = times[1]
    assert np.abs(np.diff(sample.position, axis=0)).max() <= VELOCITY * step * 1.001
    assert np.abs(sample.velocity).max() <= VELOCITY * (1.0 + 1e-6)
    # The last sample is at the end, where the curve is held.
    assert np.abs(np.diff(sample.velocity, axis=0)).max() <= 2.0 * ACCELERATION * step


def test_a_start_that_fits_leaves_the_trajectory_as_it_is():
    curve = joined(to_rest((0.5, 0.2, -0.1)), state())
    np.testing.assert_array_equal(curve.breaks, [0.0, 1.0])
    np.testing.assert_allclose(curve.sample(0.5).position, [0.25, 0.1, -0.05], atol=1e-15)


def test_a_step_within_tolerance_is_smoothed_out():
    present = state((0.008, -0.005, 0.0))
    curve = joined(to_rest((0.5, 0.2, -0.1)), present)
    assert_smooth(curve, present)
    planned = to_rest((0.5, 0.2, -0.1)).curve
    np.testing.assert_allclose(curve.sample(0.9).position, planned.sample(0.9).position, atol=1e-12)


def test_a_moving_robot_is_taken_over_smoothly():
    present = state((0.05, 0.0, 0.0), (0.8, -0.3, 0.0))
    curve = joined(to_rest((0.5, 0.2, -0.1)), present)
    assert_smooth(curve, present)
    np.testing.assert_allclose(curve.sample(curve.duration).position, [0.5, 0.2, -0.1], atol=1e-12)


def test_a_difference_in_acceleration_alone_is_smoothed_out():
    begin = to_rest((0.5, 0.2, -0.1), 2.0).curve.sample(0.4)
    rest = Waypoints([0.0, 1.6], [begin.position, [0.5, 0.2, -0.1]], [begin.velocity, [0.0] * 3])
    present = State(begin.position, begin.velocity, np.array([0.5, 0.2, -0.1]))
    curve = joined(rest, present)
    assert_smooth(curve, present)
    np.testing.assert_allclose(curve.sample(0.0).acceleration, present.acceleration, atol=1e-12)


def test_a_robot_that_accelerates_at_its_speed_limit_still_follows_the_plan():
    along = np.array([VELOCITY, 0.0, 0.0])
    cruise = Waypoints([0.0, 0.2], [[0.0] * 3, 0.2 * along], [along, along])
    present = State(np.zeros(3), along, np.array([0.5 * ACCELERATION, 0.0, 0.0]))
    curve = joined(cruise, present)
    np.testing.assert_allclose(curve.sample(0.1).position, 0.1 * along, atol=1e-12)
    assert np.abs(curve.sample(np.linspace(0.0, 0.2, 201)).velocity).max() <= VELOCITY + 1e-9


def test_the_join_keeps_acceleration_limits_and_is_continuous():
    """Replaced at 100 moments by a plan at the limit, which took it over the limit, with a step."""
    rng, worst, late = np.random.default_rng(3), 0.0, 0
    for _ in range(100):
        # A motion under way, and one that needs all the acceleration that there is.
        under_way = to_rest(rng.uniform(-0.5, 0.5, 3), 2.0).curve.sample(rng.uniform(0.2, 1.8))
        present = State(under_way.position, under_way.velocity, under_way.acceleration)
        duration = rng.uniform(0.5, 0.9)
        way = rng.uniform(-1.0, 1.0, 3)
        way *= 0.999 * ACCELERATION * duration**2 / 5.7736 / np.abs(way).max()
        way *= min(
            1.0, 1.4 / np.abs(way).max(), 0.9 * VELOCITY * duration / 1.875 / np.abs(way).max()
        )
        start = present.position + rng.uniform(-TOLERANCE, TOLERANCE, 3)
        planned = to_rest(start + way, duration, start)
        curve = joined(planned, present)
        begin = curve.sample(0.0)
        np.testing.assert_allclose(begin.position, present.position, atol=1e-12)
        np.testing.assert_allclose(begin.velocity, present.velocity, atol=1e-12)
        np.testing.assert_allclose(begin.acceleration, present.acceleration, atol=1e-9)
        for time in curve.breaks[1:-1]:
            before, after = curve.sample(np.nextafter(time, 0.0)), curve.sample(time)
            np.testing.assert_allclose(before.acceleration, after.acceleration, atol=1e-6)
        sample = curve.sample(np.linspace(0.0, curve.duration, 1001)[:-1])
        worst = max(worst, np.abs(sample.acceleration).max() / ACCELERATION)
        assert np.abs(sample.velocity).max() <= VELOCITY * (1.0 + 1e-6)
        end = curve.sample(curve.duration)
        np.testing.assert_allclose(end.position, start + way, atol=1e-12)
        late += curve.duration > duration + 1e-9
    assert worst <= 1.0 + 1e-6
    assert 0 < late < 100


@pytest.mark.parametrize("points", [2, 3, 5])
def test_a_trajectory_may_be_shorter_than_the_smoothing(points):
    """A robot at full speed that must be here within 20 ms returns later, and smoothly."""
    present = state((0.05, 0.0, 0.0), (1.0, -0.3, 0.0))
    here = np.tile((0.05, 0.0, 0.0), (points, 1))
    still = np.zeros((points, 3))
    curve = joined(Waypoints(np.linspace(0.0, 0.02, points), here, still, still), present)
    assert curve.duration > 0.3
    assert_smooth(curve, present)
    np.testing.assert_allclose(curve.sample(curve.duration).position, here[0], atol=1e-12)
    np.testing.assert_allclose(curve.sample(curve.duration).velocity, 0.0, atol=1e-12)


def test_a_start_at_an_impossible_speed_is_refused():
    still = np.zeros((2, 3))
    fast = np.array([[1e5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    with pytest.raises(
        LimitExceededError, match="at t = 0 s the velocity of joint 'shoulder' is 1"
    ):
        joined(Waypoints(np.array([0.0, 1.0]), still, fast, still), state())


@pytest.mark.parametrize("velocities", [True, False])
def test_a_later_first_point_is_reached_from_the_present_state(velocities):
    present = state((0.3, 0.2, 0.1), (0.5, 0.0, 0.0))
    curve = joined(single_point((0.5, 0.0, 0.0), 1.0, velocities), present)
    assert_smooth(curve, present)
    np.testing.assert_allclose(curve.sample(1.0).position, [0.5, 0.0, 0.0], atol=1e-12)


def test_from_rest_positions_alone_are_joined_linearly():
    curve = joined(single_point((0.5, 0.0, 0.0), 1.0, velocities=False), state())
    np.testing.assert_allclose(curve.sample(0.25).position, [0.125, 0.0, 0.0], atol=1e-15)


def test_from_rest_a_velocity_at_the_start_is_reached_smoothly():
    velocities = np.array([[0.4, 0.0, 0.0], [0.0, 0.0, 0.0]])
    positions = np.array([[0.0, 0.0, 0.0], [0.5, 0.2, 0.0]])
    curve = joined(Waypoints(np.array([0.0, 1.5]), positions, velocities), state())
    assert_smooth(curve, state())


def test_a_whole_turn_of_a_continuous_joint_does_not_matter():
    present = state((0.0, 0.0, 0.2 + 4.0 * math.pi))
    curve = joined(to_rest((0.5, 0.0, 0.6), start=(0.0, 0.0, 0.2)), present)
    assert curve.sample(0.0).position[2] == pytest.approx(0.2 + 4.0 * math.pi, abs=1e-12)
    assert curve.sample(1.0).position[2] == pytest.approx(0.6 + 4.0 * math.pi, abs=1e-12)


def test_a_start_far_away_names_joint_and_amount():
    with pytest.raises(
        StartMismatchError, match=r"'elbow' at 0\.3 rad, but .* at 0 rad: 0\.3 rad apart.*0\.01 rad"
    ):
        joined(to_rest((0.5, 0.0, 0.0), start=(0.0, 0.3, 0.0)), state())


def test_a_whole_turn_of_a_limited_joint_is_said():
    with pytest.raises(StartMismatchError, match=r"1 whole turn"):
        joined(to_rest((0.5, 0.0, 0.0), start=(math.tau, 0.0, 0.0)), state())


def test_a_moving_joint_may_have_moved_on():
    waypoints = to_rest((0.5, 0.0, 0.0))
    joined(waypoints, state((0.09, 0.0, 0.0), (0.9, 0.0, 0.0)))
    with pytest.raises(StartMismatchError):
        joined(waypoints, state((0.09, 0.0, 0.0)))


def test_speed_between_the_points_counts():
    # The mean speed is 1.5, below the limit of 2, but a quintic from rest to rest peaks at 1.875
    # times the mean.
    with pytest.raises(
        LimitExceededError, match=r"velocity of joint 'shoulder' is 2\.8125.* by 0\.81"
    ):
        joined(to_rest((1.5, 0.0, 0.0)), state())


def test_speed_on_the_way_to_the_first_point_counts():
    with pytest.raises(LimitExceededError, match=r"way from the present state.*'elbow' is 4"):
        joined(single_point((0.0, 0.4, 0.0), 0.1, velocities=False), state())


def test_positions_between_the_points_count():
    waypoints = to_rest((2.5, 0.0, 0.0), duration=3.0)
    with pytest.raises(LimitExceededError, match=r"position of joint 'shoulder' is 2\.5"):
        joined(waypoints, state())


def test_what_is_past_is_dropped():
    waypoints = Waypoints(
        np.array([0.0, 0.5, 1.0]), np.array([[0.0] * 3, [0.2, 0, 0], [0.5, 0, 0]], dtype=float)
    )
    curve = joined(waypoints, state((0.25, 0.0, 0.0)), late=0.6)
    np.testing.assert_allclose(curve.breaks, [0.0, 0.4])
    np.testing.assert_allclose(curve.sample(0.4).position, [0.5, 0.0, 0.0])


@pytest.mark.parametrize("ahead", [7e-6, 0.05])
def test_points_that_cannot_be_reached_in_time_are_passed_over_in_a_late_trajectory(ahead):
    places = np.outer([0.0, 0.2, 0.23, 0.24, 0.5], [1.0, 0.0, 0.0])
    waypoints = Waypoints(np.array([0.0, 0.5, 0.51, 0.54, 1.0]), places)
    late = 0.5 - ahead
    curve = joined(waypoints, state((0.2 - 2.4 * ahead, 0.0, 0.0)), late)
    np.testing.assert_allclose(curve.breaks, [0.0, 0.54 - late, 1.0 - late])
    np.testing.assert_allclose(curve.sample(1.0 - late).position, places[-1])
    # In time the trajectory is refused, as it is where no point can be reached: the first is named.
    for here, lateness in ((-3.0, 0.0), (-3.0, late), (0.199, 1.0 - 7e-6)):
        with pytest.raises(LimitExceededError, match="on the way from the present state"):
            joined(Waypoints(waypoints.times + 1e-3, places), state((here, 0.0, 0.0)), lateness)


def test_no_more_than_a_tenth_of_a_second_is_passed_over():
    places = np.outer([0.0, 1.0, 1.2], [1.0, 0.0, 0.0])
    waypoints = Waypoints(np.array([0.0, 0.5, 1.5]), places)
    with pytest.raises(LimitExceededError, match="on the way from the present state"):
        joined(waypoints, state(), late=0.45)


def test_a_point_outside_the_limits_is_not_passed_over():
    places = np.outer([0.0, 2.5, 0.3], [1.0, 0.0, 0.0])
    waypoints = Waypoints(np.array([0.0, 0.5, 0.54]), places)
    with pytest.raises(LimitExceededError):
        joined(waypoints, state((0.25, 0.0, 0.0)), late=0.45)
    fitting = Waypoints(waypoints.times, np.minimum(places, 1.0))
    assert joined(fitting, state((0.25, 0.0, 0.0)), late=0.45).duration == pytest.approx(0.09)


def test_what_has_ended_is_refused():
    with pytest.raises(TrajectoryRefusedError, match=r"ended 0\.5 s ago.*1\.5 s old.*lasts 1 s"):
        joined(to_rest((0.5, 0.0, 0.0)), state(), late=1.5)


def test_a_single_point_at_once_within_tolerance():
    present = state((0.005, 0.0, 0.0))
    curve = joined(single_point((0.0, 0.0, 0.0), 0.0), present)
    assert_smooth(curve, present)
    np.testing.assert_allclose(curve.sample(curve.duration).position, 0.0, atol=1e-12)
