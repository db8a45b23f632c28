"""A controller that gets the stream of a servo late catches up within all limits.

Before, a message 100 ms late made joints accelerate at 6 to 8 times their limits, messages late by
0 to 80 ms at 20 to 100 times, and jerks were up to 9,000 times their limits.
"""

import numpy as np
import pytest
from approaches import random_start
from late_streams import LateStream
from servo_drives import TIMEOUT, robot_of

from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.joints import Joints
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.servo.commands import JointCommand, TwistCommand
from robomech_ros.trajectory import Waypoints

POSTURES = {
    "puma560": [0.3, 0.6, -0.7, 0.4, 0.8, 0.2],
    "ur5e": [0.0, -1.2, 1.5, -1.57, -1.57, 0.0],
    "panda": [0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.7],
}
DIRECTIONS = {"up": [0.0, 0.0, 1.0], "across": [0.6, 0.8, 0.0]}


def twist(direction, speed):
    rates = np.concatenate((np.zeros(3), speed * np.array(direction)))
    return lambda now: TwistCommand(rates, lambda q: None, now + TIMEOUT)


def jog(*rates):
    return lambda now: JointCommand(np.array(rates), now + TIMEOUT)


def one_late(count):
    return 0.1 if count == 80 else 0.001


def in_time(count):
    return 0.001


def random_delays(seed):
    rng = np.random.default_rng(seed)
    delays = 0.001 + 0.08 * rng.random(400) ** 4
    return lambda count: delays[count]


@pytest.mark.parametrize(
    ("direction", "speed"),
    [
        ("up", 0.4),
        ("across", 1.0),
        pytest.param("across", 0.05, marks=pytest.mark.long),
        pytest.param("up", 0.05, marks=pytest.mark.long),
        pytest.param("across", 0.4, marks=pytest.mark.long),
        pytest.param("up", 1.0, marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize("robot", POSTURES)
def test_twists_at_any_speed_that_come_late(robot, direction, speed):
    command = twist(DIRECTIONS[direction], speed)
    delays = random_delays(int(1000 * speed))
    late = LateStream(robot, POSTURES[robot], command, delays, seconds=0.8)
    late.assert_within()
    assert late.off_line() < 5e-4


@pytest.mark.slow
@pytest.mark.parametrize("rates", [(1.5, 0.0, -1.0, 0, 0, 0), (0, 0, 0, 0, 0, 4.0)])
def test_joints_at_and_below_their_largest_speed_that_come_late(rates):
    for delay in (one_late, random_delays(5)):
        LateStream("puma560", POSTURES["puma560"], jog(*rates), delay).assert_within()


def random_stream(robot, number, speed, delay):
    """One of the drives of the benchmark that measures all robots at the controller."""
    rng = np.random.default_rng(1)
    for _ in range(number + 1):
        q, direction = random_start(robot, rng)
    return LateStream(robot, q, twist(direction, speed), delay, seconds=2.0)


@pytest.mark.parametrize(
    ("robot", "number"), [("gen3", 0), ("iiwa14", 1), ("general7r", 2), ("vx300", 2)]
)
def test_accelerations_do_not_step_where_a_way_bends(robot, number):
    """From cycle to cycle the jerk was 4.3, 3.1, 3.8 and 1.3 times its limit, in time."""
    seen = random_stream(robot, number, 1.0, in_time)
    seen.assert_within()
    assert seen.off_line() < 5e-4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "number", "speed", "delay"),
    [
        ("gen3", 1, 0.4, one_late),
        ("gen3", 1, 1.0, random_delays(0)),
        ("crx10ia", 0, 0.2, random_delays(0)),
    ],
)
def test_what_comes_late_is_neither_refused_nor_too_hard(robot, number, speed, delay):
    """The first two were refused, and the jerk of the third was 2.1 times its limit."""
    late = random_stream(robot, number, speed, delay)
    late.assert_within()
    assert late.off_line() < 5e-4


@pytest.mark.parametrize("stopped", [0.1, 0.3])
def test_a_controller_that_is_held_up(stopped):
    late = LateStream(
        "ur5e",
        POSTURES["ur5e"],
        twist(DIRECTIONS["across"], 0.4),
        in_time,
        stopped=(1.0, 1.0 + stopped),
    )
    late.assert_within()
    assert late.off_line() < 5e-4


@pytest.mark.slow
def test_a_robot_that_fell_behind_gets_nearer_again():
    late = LateStream(
        "puma560", POSTURES["puma560"], jog(0.6, 0, 0, 0, 0, 0), one_late, seconds=2.5
    )
    late.assert_within()
    assert max(late.lags) >= 0.04
    assert 0.0 < late.lags[240] < late.lags[120] - 0.005


def test_at_the_largest_speed_it_stays_behind():
    late = LateStream("puma560", POSTURES["puma560"], jog(9.0, 0, 0, 0, 0, 0), one_late)
    late.assert_within()
    assert min(late.lags[100:140]) >= 0.015


def test_what_comes_in_time_is_followed_as_ever():
    """A message that is one period old tells what the one before it told."""
    seen = LateStream("puma560", POSTURES["puma560"], twist([0, 1, 0], 0.2), in_time)
    assert not any(seen.lags)
    # Its knots are a period apart, beginning two periods after the first message at 0.01 s.
    told = np.searchsorted(seen.times, 0.02 + 0.01 * np.arange(1, 120) - 1e-6)
    knots = np.array(seen.drive.positions)[2:121]
    np.testing.assert_allclose(seen.positions[told], knots, atol=1e-12)


@pytest.mark.parametrize("over", [0.05, 0.3])
def test_the_end_of_a_stream_is_reached_that_comes_when_it_is_over(over):
    """The robot rests just before it, as the message before had it."""
    chain = Joints.of(robot_of("puma560"))
    arm = TrajectoryFollower(chain, SimulatedJoints(np.zeros(6)))
    free = Tolerances(*[np.full(6, np.inf)] * 3, np.inf)
    times = np.array([0.0, 0.02, 0.1])
    steps = np.outer([-0.004, -0.001, 0.003], [1.0, -0.5, 0.0, 0.0, 0.0, 0.0])
    rates = np.outer([0.1, 0.1, 0.0], [1.0, -0.5, 0.0, 0.0, 0.0, 0.0])
    arm.start(Waypoints(times, steps, rates), free, 1.0, -0.1 - over)
    for cycle in range(600):
        arm.advance(1.0 + cycle * 0.002)
    np.testing.assert_allclose(arm.actual.position, steps[-1], atol=1e-9)
    with pytest.raises(TrajectoryRefusedError, match=r"ended 0\.6 s ago"):
        arm.start(Waypoints(times, steps, rates), free, 3.0, -0.7)
    with pytest.raises(TrajectoryRefusedError, match=r"ended 0\.05 s ago"):
        arm.start(Waypoints(times, steps + 0.1, rates), free, 4.0, -0.15)
