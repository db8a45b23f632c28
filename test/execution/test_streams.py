"""Streams of short trajectories, each replacing the one before, that come early and late."""

import numpy as np
import pytest
from execution_cases import ACCELERATION, VELOCITY, follower, joints, state, tolerances

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.joining import join, join_in_steps
from robomech_ros.execution.refusals import StartMismatchError
from robomech_ros.trajectory import Waypoints

STEP = 0.01
FULL = VELOCITY * (1.0 - 1e-9)
WAY = np.array([1.0, -0.5, 0.2])
TOLERANCE = 0.01


def place(time):
    """Where a stream has the joints: from rest to full speed, and on."""
    rise = FULL / ACCELERATION
    slow = 0.5 * ACCELERATION * np.square(time)
    return -1.9 + np.where(time < rise, slow, FULL * (time - 0.5 * rise))


def speed(time):
    return np.minimum(ACCELERATION * np.asarray(time), FULL)


def message(time, known=3):
    """The knots of the stream from `time` on, and a plan to stop from the last of them."""
    times = time + STEP * np.arange(known)
    stop = speed(times[-1]) / ACCELERATION
    positions = np.append(place(times), place(times[-1]) + 0.5 * speed(times[-1]) * stop)
    velocities = np.append(speed(times), 0.0)
    instants = np.append(times, times[-1] + stop) - times[0]
    return Waypoints(instants, positions[:, None] * WAY, velocities[:, None] * WAY)


def moved(waypoints, ahead):
    return Waypoints(waypoints.times + ahead, waypoints.positions, waypoints.velocities)


def at_full_speed(time=0.5, off=0.0):
    return state(place(time) * WAY + off, speed(time) * WAY)


def fastest(curve):
    sample = curve.sample(np.linspace(0.0, curve.duration, 2001)[:-1])
    return np.abs(sample.velocity).max(), np.abs(sample.acceleration).max()


@pytest.mark.parametrize("ahead", [1e-9, 6.93711e-6, 1e-4, 0.004, 0.00999])
@pytest.mark.parametrize("off", [0.0, 1e-6, -6.63e-5, 1e-3])
def test_a_first_point_within_a_cycle_is_as_good_as_passed(ahead, off):
    """The way to it would be infinitely steep; the stream goes on instead."""
    waypoints = moved(message(0.5 + ahead), 0.02 + ahead)
    present = at_full_speed(off=off * WAY)
    curve = join(waypoints, present, joints(), TOLERANCE, late=0.02, cycle=0.01).curve
    begin = curve.sample(0.0)
    np.testing.assert_allclose(begin.position, present.position, atol=1e-12)
    np.testing.assert_allclose(begin.velocity, present.velocity, atol=1e-12)
    velocity, acceleration = fastest(curve)
    assert velocity <= VELOCITY * (1.0 + 1e-6) and acceleration <= 1.5 * ACCELERATION + 1e-6
    # It is followed at its time, or as much later as the robot is behind at full speed.
    behind = max(-off / FULL, 0.0)
    end = curve.sample(curve.duration).position
    np.testing.assert_allclose(end, waypoints.positions[-1], atol=1e-9)
    assert curve.duration == pytest.approx(ahead + 0.02 + 0.2 + behind, abs=1e-6)


@pytest.mark.parametrize("late", [0.0, 0.005, 0.013, 0.02, 0.024])
def test_a_message_of_a_stream_is_taken_up_where_it_should_be(late):
    curve = join(message(0.5), at_full_speed(0.5 + late), joints(), TOLERANCE, late).curve
    assert curve.duration == pytest.approx(0.22 - late, abs=1e-9)
    for time in (0.0, 0.02 - late if late < 0.02 else 0.0):
        there = place(min(0.5 + late + time, 0.52))
        if late <= 0.02:
            np.testing.assert_allclose(curve.sample(time).position, there * WAY, atol=1e-9)


def test_a_robot_that_has_begun_to_brake_follows_the_stream_later_at_its_own_pace():
    """At full speed it cannot catch up; its speed is regained without passing the limit."""
    braked = 0.03
    slower = FULL - ACCELERATION * braked
    behind = 0.5 * ACCELERATION * braked**2 / FULL
    there = place(0.5 + braked - behind)
    joined = join(
        message(0.5 + braked, known=60), state(there * WAY, slower * WAY), joints(), TOLERANCE
    )
    assert joined.pace == pytest.approx(slower / FULL)
    assert joined.curve.duration == pytest.approx(0.59 + 0.2 + behind)
    velocity, _ = fastest(joined.curve)
    assert velocity <= VELOCITY * (1.0 + 1e-6)
    np.testing.assert_allclose(joined.curve.sample(0.0).position, there * WAY, atol=1e-12)
    np.testing.assert_allclose(joined.curve.sample(0.0).velocity, FULL * WAY, rtol=1e-9)


def test_a_single_point_that_cannot_be_reached_by_a_little_is_reached_later():
    waypoints = Waypoints(np.array([0.01]), place(0.512) * WAY[None], np.zeros((1, 3)))
    curve = join(waypoints, at_full_speed(), joints(), TOLERANCE, cycle=0.01).curve
    velocity, _ = fastest(curve)
    assert velocity <= VELOCITY * (1.0 + 1e-6)
    np.testing.assert_allclose(curve.sample(curve.duration).position, place(0.512) * WAY)


@pytest.mark.parametrize("ahead", [1e-6, 0.005])
def test_a_first_point_far_away_is_refused_however_near_its_time(ahead):
    waypoints = moved(message(0.5), ahead)
    with pytest.raises(LimitExceededError, match="on the way from the present state"):
        join(waypoints, at_full_speed(0.2), joints(), TOLERANCE, cycle=0.01)
    with pytest.raises(StartMismatchError):
        join(message(0.5), at_full_speed(0.2), joints(), TOLERANCE, cycle=0.01)


def test_a_stream_over_a_limit_is_refused_wherever_the_robot_is():
    fast = message(0.5)
    fast = Waypoints(0.5 * fast.times, fast.positions, 2.0 * fast.velocities)
    for ahead in (0.0, 1e-5, 0.02):
        with pytest.raises(LimitExceededError, match="velocity of joint 'shoulder' is 4"):
            join(moved(fast, ahead), at_full_speed(), joints(), TOLERANCE, cycle=0.01)


def test_points_that_are_not_interpolated_may_be_that_near_too():
    waypoints = moved(message(0.5 + 7e-6), 7e-6)
    present = at_full_speed(off=-6.6e-5 * WAY)
    curve = join_in_steps(waypoints, present, joints(), TOLERANCE, cycle=0.01).curve
    np.testing.assert_array_equal(curve.sample(1e-5).position, waypoints.positions[1])
    with pytest.raises(LimitExceededError):
        join_in_steps(waypoints, at_full_speed(0.2), joints(), TOLERANCE, cycle=0.01)


@pytest.mark.parametrize("clock", [1e-6, 1e-4, 1e-3])
def test_a_stream_at_full_speed_is_followed_whatever_its_messages_do(clock):
    """They come up to two periods late, some not at all, and stamps are off by `clock`."""
    random = np.random.default_rng(4)
    arm = follower(np.full(3, -1.9) * WAY, cycle=0.01)
    sent = STEP * np.arange(180.0)
    given = [(t + random.uniform(0.0, 0.019), t) for t in sent if random.random() > 0.05]
    seen, cycle = [], 0.0
    for now, time in sorted(given):
        while cycle < now:
            arm.advance(cycle)
            seen.append((cycle, arm.wanted))
            cycle += 0.01
        error = random.uniform(-clock, clock)
        arm.start(message(time + STEP), tolerances(), now, time + STEP - now + error)
    velocities = np.array([state.velocity for _, state in seen])
    assert np.abs(velocities).max() <= VELOCITY * (1.0 + 1e-6)
    assert np.abs(np.diff(velocities, axis=0)).max() <= 1.5 * ACCELERATION * 0.01
    wanted = np.array([place(time) * WAY for time, _ in seen])
    off = np.abs(wanted - np.array([state.position for _, state in seen]))
    # Two lost messages in a row let it brake for up to 20 ms; it is that much later from then on.
    assert off.max() <= 0.02 * FULL + 4.0 * FULL * clock
    assert velocities[-1, 0] == pytest.approx(FULL)
