"""Streams of the servo: whatever is commanded, no limit is exceeded, and nothing chatters."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from servo_drives import TIMEOUT, Drive, robot_of

from robomech_ros.errors import MissingLimitsError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, load_robot
from robomech_ros.servo.commands import JointCommand, TwistCommand
from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.motion import Motion
from robomech_ros.servo.report import ServoCondition
from robomech_ros.servo.stream import Stream

ROBOTS = ["puma560", "ur5e", "scara", "panda", "iiwa14"]
REGULAR = [0.3, 0.6, -0.7, 0.4, 0.8, 0.2]


def one_joint(lower=-1.0, upper=1.0, velocity=1.0, acceleration=2.0, jerk=np.inf):
    numbers = [np.array([x], dtype=float) for x in (velocity, acceleration, jerk, lower, upper)]
    return ServoLimits(("joint",), *numbers, ("rad",))


@pytest.mark.parametrize("robot", ROBOTS)
def test_random_commands_of_both_kinds_exceed_nothing(robot):
    drive = Drive(robot)
    rng = np.random.default_rng(7)
    for _ in range(8):
        size = 10 ** rng.uniform(-2, 2)
        drive.twist(size * rng.normal(size=6), rng.uniform(0, 0.4))
        drive.joints(size * rng.normal(size=drive.chain.n), rng.uniform(0, 0.3))
        drive.wait(rng.uniform(0, 0.3))
    drive.assert_limits()


rates = st.floats(-1e300, 1e300) | st.floats(-3.0, 3.0) | st.just(0.0)


@pytest.mark.slow
@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    st.lists(st.tuples(rates, rates, st.integers(1, 30)), min_size=1, max_size=6),
    st.sampled_from([np.inf, 40.0, 5.0]),
    st.floats(-1.2, 1.2),
    st.floats(-1.0, 1.0),
)
def test_any_rates_from_anywhere(commands, jerk, position, velocity):
    """Two joints of different limits, begun outside of them and in motion, too."""
    chain = chain_from_dh(
        [0.4, 0.3],
        [0, 0],
        [0, 0],
        limits={
            "lower": [-1, -np.inf],
            "upper": [1, 0.5],
            "velocity": [1.0, 3.0],
            "acceleration": [2.0, 12.0],
            "jerk": [jerk, np.inf],
        },
    )
    start = np.array([position, 0.4 * position])
    drive = Drive("", start, np.array([velocity, velocity]), chain=chain, length=0.3)
    for first, second, count in commands:
        drive.joints([first, second], count * drive.period)
    drive.wait(2.0)
    # A robot in motion brakes before it can turn round: the end of that is a limit of its own.
    drive.start = np.array([drive.path().min(axis=0), drive.path().max(axis=0)])
    begun = np.abs(start[0]) > 1.0 or velocity != 0.0
    drive.assert_limits() if not begun else drive.assert_rates()
    assert not drive.velocities[-1].any()


def test_outside_its_limits_a_joint_moves_inwards_only():
    for start, outwards in ((1.2, 1.0), (-1.3, -1.0)):
        motion = Motion(one_joint(), 0.01, np.array([start]), np.zeros(1))
        for _ in range(50):
            assert motion.advance(np.array([outwards])).bound == ("joint",)
            assert motion.position[0] == start
        for _ in range(40):
            motion.advance(np.array([-outwards]))
        inside = motion.position[0]
        assert abs(inside) < abs(start) - 0.05
        for _ in range(300):
            motion.advance(np.array([outwards]))
            assert abs(motion.position[0]) <= max(1.0, abs(inside) + 0.3)


def test_a_limit_is_approached_without_chatter_and_left_at_once():
    motion = Motion(one_joint(), 0.01, np.zeros(1), np.zeros(1))
    path = []
    for _ in range(300):
        motion.advance(np.array([5.0]))
        path.append(motion.position[0])
    assert 1.0 - 1e-6 < path[-1] <= 1.0
    assert (np.diff(path) >= 0.0).all()
    # It brakes as late as it can: no more than some periods longer than a bang-bang motion.
    assert np.flatnonzero(np.array(path) > 0.999)[0] * 0.01 < 1.0 + 0.5 + 0.1
    before = motion.position[0]
    motion.advance(np.array([-1.0]))
    motion.advance(np.array([-1.0]))
    assert motion.position[0] < before - 1e-4


def test_the_direction_is_kept_while_the_motion_begins_and_ends():
    drive = Drive("puma560", REGULAR)
    drive.joints([1.5, -0.5, 0.25, 0, 0, 0.1], 0.6)
    drive.wait(1.0)
    moved = np.diff(drive.path(), axis=0)
    moved = moved[np.abs(moved).max(axis=1) > 1e-6]
    directions = moved / np.linalg.norm(moved, axis=1)[:, None]
    assert np.ptp(directions, axis=0).max() < 1e-6


@pytest.mark.parametrize("robot", ["puma560", "panda"])
def test_the_tip_keeps_its_direction_though_joint_rates_limit_it(robot):
    q = REGULAR if robot == "puma560" else [0.1, -0.5, 0.2, -1.9, 0.1, 1.5, 0.3]
    drive = Drive(robot, q)
    before = forward_kinematics(drive.chain, drive.q)
    reports = drive.twist([0, 0, 0, 0.0, 40.0, 0.0], 0.4)
    assert reports[-1].condition in (
        ServoCondition.RATE_BOUND,
        ServoCondition.APPROACHING_SINGULARITY,
    )
    assert 0.0 < reports[-1].scale < 0.2
    way = forward_kinematics(drive.chain, drive.q)[:3, 3] - before[:3, 3]
    assert way[1] > 0.02
    assert np.abs(way[[0, 2]]).max() < 0.03 * way[1]
    drive.assert_limits()


def test_axes_of_the_tip_turn_with_it():
    drive = Drive("puma560", REGULAR)
    T = forward_kinematics(drive.chain, drive.q)
    drive.twist(
        [0, 0, 0, 0, 0, 0.1], 0.5, axes=lambda q: forward_kinematics(drive.chain, q)[:3, :3]
    )
    way = T[:3, :3].T @ (forward_kinematics(drive.chain, drive.q)[:3, 3] - T[:3, 3])
    assert way[2] > 0.02 and np.abs(way[:2]).max() < 0.01 * way[2]


def test_slow_joints_move_as_fast_as_commanded():
    drive, rates = Drive("puma560", REGULAR), [0.2, -0.1, 0.05, 0.0, 0.0, 0.0]
    drive.joints(rates, 1.0)
    np.testing.assert_allclose(drive.servo.motion.velocity, rates, atol=1e-9)


@pytest.mark.parametrize("robot", ["puma560", "panda"])
def test_a_stale_command_ends_in_rest(robot):
    q = REGULAR if robot == "puma560" else None
    drive = Drive(robot, q)
    drive.joints(0.4 * drive.servo.limits.velocity, 1.0)
    last = drive.time - drive.period
    reports = drive.wait(2.0)
    stale = next(k for k, r in enumerate(reports) if r.condition is ServoCondition.STALE_COMMAND)
    assert last + stale * drive.period <= last + TIMEOUT + drive.period
    limits = drive.servo.limits
    braking = float(np.max(limits.velocity / limits.acceleration))
    smoothing = float(np.max(2.0 * limits.acceleration / limits.jerk))
    moving = np.flatnonzero(np.abs(np.array(drive.velocities)).max(axis=1) > 0.0)[-1]
    assert moving * drive.period < last + TIMEOUT + braking + smoothing + 3 * drive.period
    assert drive.servo.motion.at_rest
    drive.assert_limits()


def test_a_pause_brakes_and_holds_whatever_is_commanded():
    drive = Drive("puma560", REGULAR)
    drive.joints(np.full(6, 1.0), 0.5)
    drive.servo.paused = True
    reports = drive.joints(np.full(6, 1.0), 1.0)
    assert {report.condition for report in reports} == {ServoCondition.PAUSED}
    assert not drive.velocities[-1].any()
    drive.servo.paused = False
    drive.joints(np.full(6, -0.1), 0.3)
    assert drive.velocities[-1][0] < 0.0
    drive.assert_limits()


def test_every_report_says_what_limits_the_motion():
    drive = Drive("puma560", REGULAR)
    report = drive.joints([0.1, 0, 0, 0, 0, 0], 0.5)[-1]
    assert (report.condition, report.text, report.scale) == (ServoCondition.NO_WARNING, "", 1.0)
    report = drive.joints([20.0, 0, 0, 0, 0, 0], 0.05)[-1]
    assert report.condition is ServoCondition.RATE_BOUND and report.joints == ("waist",)
    assert report.text == "waist would move at 20 rad/s, it can 2 rad/s"
    report = drive.joints([20.0, 0, 0, 0, 0, 0], 3.0)[-1]
    assert report.condition is ServoCondition.JOINT_BOUND and report.joints == ("waist",)
    assert report.text == "waist near the end of the range" and report.scale == 0.0
    scara = Drive("scara", [0.1, 0.5, 0.1, 0.1])
    report = scara.twist([0.5, 0, 0, 0, 0, 0], 0.1)[-1]
    assert report.condition is ServoCondition.IMPOSSIBLE
    assert np.abs(np.diff(scara.path(), axis=0)).max() < 1e-15


def test_a_zero_command_stops_like_none():
    for stop in (
        lambda d: TwistCommand(np.zeros(6), lambda q: None, d.time + 9.0),
        lambda d: JointCommand(np.zeros(6), d.time + 9.0),
    ):
        drive = Drive("puma560", REGULAR)
        drive.twist([0, 0, 0, 0, 0.3, 0], 0.4)
        drive.servo.take(stop(drive))
        reports = drive.wait(1.0)
        assert not drive.velocities[-1].any()
        assert reports[-1].condition is ServoCondition.NO_WARNING and reports[-1].scale == 1.0


def test_a_robot_without_velocity_limits_is_refused():
    chain = chain_from_dh([0.4, 0.3], [0, 0], [0, 0], limits={"acceleration": [1.0, 1.0]})
    with pytest.raises(MissingLimitsError, match="no velocity limit for joints joint_1, joint_2"):
        ServoLimits.of(chain)


def test_the_mean_lasts_no_longer_than_jerks_need():
    limits = ServoLimits.of(load_robot("puma560"))
    assert limits.smoothing(0.01) == 20
    assert ServoLimits.of(load_robot("panda")).smoothing(0.01) == 1
    assert one_joint().smoothing(0.01) == 0


@pytest.mark.parametrize("robot", ["puma560", "ur5e"])
def test_who_gets_a_message_late_has_been_told_the_same_before(robot):
    """With a lead, the first knots of a stream are those that the one before ended with."""
    limits = ServoLimits.of(load_robot(robot))
    position, lead = load_robot(robot).midrange(), 3
    motions = [Stream(limits, 0.01, position, np.zeros(6), lead=k) for k in (1, lead)]
    rng = np.random.default_rng(2)
    before = None
    for k in range(200):
        if k % 20 == 0:
            wanted = rng.normal(size=6) * limits.velocity
        for motion in motions:
            motion.advance(wanted)
        near, far = (motion.samples() for motion in motions)
        late = 0.01 * (lead - 1)
        assert far.times[lead] == pytest.approx(0.01 * lead)
        np.testing.assert_allclose(far.times[lead - 1 :] - late, near.times, atol=1e-12)
        np.testing.assert_allclose(far.positions[lead - 1 :], near.positions, atol=1e-12)
        if before is not None:
            np.testing.assert_allclose(
                far.positions[:lead], before.positions[1 : lead + 1], atol=1e-12
            )
        before = far


@pytest.mark.parametrize("lead", [1, 2, 5])
@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda"])
def test_steps_that_come_late_exceed_nothing(robot, lead):
    """The period jitters, by up to 100 ms, and the commands come when they come."""
    q = robot_of(robot).home()
    for seed in range(2):
        drive = Drive(robot, q, lead=lead)
        rng = np.random.default_rng(seed)
        twist = rng.normal(size=6) * np.repeat((0.5, 0.3), 3)
        for size in (1.0, 0.3, -1.0):
            drive.called_late(partial(TwistCommand, size * twist, lambda q: None), 1.0, rng)
        drive.called_late(partial(JointCommand, rng.normal(size=drive.chain.n)), 0.5, rng)
        assert np.abs(drive.path() - q).max() > 0.02
        drive.assert_limits()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_commands_and_states_that_are_not_finite_are_refused_and_change_nothing(bad):
    drive = Drive("puma560", REGULAR)
    drive.joints([0.2, 0, 0, 0, 0, 0], 0.2)
    rates = np.array([0.1, bad, 0, 0, 0, 0])
    with pytest.raises(NonFiniteError, match="rates of joint 'shoulder'"):
        drive.servo.take(JointCommand(rates, drive.time + 1.0))
    with pytest.raises(NonFiniteError, match="twist"):
        drive.servo.take(TwistCommand(rates, lambda q: None, drive.time + 1.0))
    with pytest.raises(WrongSizeError, match="rates"):
        drive.servo.take(JointCommand(np.zeros(3), drive.time + 1.0))
    assert drive.step().condition is ServoCondition.NO_WARNING
    with pytest.raises(NonFiniteError, match="position of joint 'shoulder'"):
        drive.servo.start(rates, np.zeros(6))
    drive.wait(1.0)
    drive.assert_limits()
