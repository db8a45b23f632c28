"""Commands within limits: at starts, ends, reversals, saturation and time-outs; curvature kept."""

import math

import numpy as np
import pytest
import ruckig
from limiter_oracle import limited

from robomech_ros.errors import LimitExceededError, NonFiniteError
from robomech_ros.rolling import (
    CommandLimiter,
    MotionLimits,
    ackermann,
    differential_drive,
    list_rolling,
    mecanum,
    rolling_robot,
    swerve,
    tricycle,
)

PERIOD = 0.01
MOST = 1.0 + 1e-9
# Of one kind of drive; ten times as many where there is time.
STREAMS = 1000
UNEVEN = MotionLimits(
    velocity=[2.0, 1.0, 0.8],
    backward_velocity=[2.0, 0.4, 0.8],
    acceleration=[3.0, 0.5, 1.0],
    deceleration=[3.0, 1.5, 1.0],
    backward_acceleration=[3.0, 0.3, 1.0],
    backward_deceleration=[3.0, 0.9, 1.0],
    jerk=[20.0, 5.0, 5.0],
)


def limiter_of(name):
    robot = rolling_robot(name)
    return CommandLimiter(robot.base, robot.limits, PERIOD)


def ratios(limiter, twists, angles):
    """Largest velocity, acceleration, jerk, wheel rate and steering rate, in their limits."""
    limits, dt = limiter.limits, limiter.period
    v = np.concatenate([np.zeros((2, 3)), twists])
    a = np.diff(v, axis=0) / dt
    jerk = np.diff(a, axis=0) / dt
    forth = np.where(v[:-1] == 0.0, v[1:] > 0.0, v[:-1] > 0.0)
    most = np.where(
        forth,
        np.where(a > 0.0, limits.acceleration, limits.deceleration),
        np.where(a < 0.0, limits.backward_acceleration, limits.backward_deceleration),
    )
    speed = np.where(twists > 0.0, limits.velocity, limits.backward_velocity)
    with np.errstate(invalid="ignore"):
        found = [np.nanmax(np.abs(twists) / speed)]
    found += [np.max(np.abs(a) / most), np.max(np.abs(jerk) / limits.jerk)]
    base = limiter.base
    rates = base.wheel_rates(twists, angles if base.steered else None)
    bounds = [w.max_rate for w in base.wheels if w.driven]
    found.append(np.max(np.abs(rates) / bounds))
    if base.steered:
        bounds = [w.max_steering_rate for w in base.wheels if w.kind == "steered"]
        turned = np.diff(np.concatenate([np.zeros((1, angles.shape[1])), angles]), axis=0) / dt
        found.append(np.max(np.abs(turned) / bounds))
        # Wheels roll at the angles that they have.
        off = base.steering_angles(twists, angles) - angles
        found.append(1.0 + np.abs(off).max() - 1e-12)
    return np.array(found)


def stream(limiter, rng):
    """A random stream: steps, ramps and noise, up to twice the limits, silence at its end."""
    size = np.minimum(limiter.limits.velocity, 10.0) * rng.choice([0.1, 1.0, 2.0])
    held = [1, 5, 30][rng.integers(3)]
    commands = np.repeat(rng.normal(size=(60 // held + 1, 3)) * size, held, axis=0)
    if rng.random() < 0.3:
        commands = np.cumsum(commands, axis=0) / 10.0
    return np.concatenate([commands[:60], np.zeros((30, 3))])


def run_streams(limiter, count, seed):
    rng = np.random.default_rng(seed)
    worst = np.zeros(1)
    for number in range(count):
        twists, angles, _ = limiter.run(limiter.at_rest(), stream(limiter, rng))
        found = ratios(limiter, twists, angles)
        assert found.max() <= MOST, (number, seed, found)
        worst = np.maximum(worst, found)
    # The limits are used.
    assert worst[1] > 0.99
    assert worst[2] > 0.99


@pytest.mark.parametrize("name", list_rolling())
def test_black_box_10_random_streams_stay_within_all_limits(name):
    run_streams(limiter_of(name), STREAMS, 1)


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("name", list_rolling())
def test_ten_thousand_random_streams_stay_within_all_limits(name):
    run_streams(limiter_of(name), 10 * STREAMS, 2)


@pytest.mark.parametrize("name", list_rolling())
def test_a_command_that_is_allowed_once_moves_the_base_as_one_in_every_period(name):
    limiter = limiter_of(name)
    one = other = limiter.at_rest()
    for command in ([0.3, 0.2, 0.1], [9.0, 9.0, -9.0], [0.0, 0.0, 0.0]):
        allowed = limiter.allowed(command)
        for _ in range(30):
            one = limiter.step(one, command)
            other = limiter.approach(other, *allowed)
            np.testing.assert_array_equal(other.twist, one.twist)
            np.testing.assert_array_equal(other.steering, one.steering)
            assert other.saturated == one.saturated


def test_limits_that_are_not_given_are_those_they_follow():
    forward, slowing, backward = [3.0, 2.0, 1.0], [6.0, 5.0, 4.0], [9.0, 8.0, 7.0]
    limits = MotionLimits(acceleration=forward)
    for name in ("deceleration", "backward_acceleration", "backward_deceleration"):
        assert getattr(limits, name).tolist() == forward
    limits = MotionLimits(velocity=backward, acceleration=forward, deceleration=slowing)
    assert limits.backward_velocity.tolist() == backward
    assert limits.backward_acceleration.tolist() == forward
    assert limits.backward_deceleration.tolist() == slowing


@pytest.mark.parametrize("base", [differential_drive(0.1, 0.4), mecanum(0.1, 0.6, 0.4)])
def test_uneven_limits_hold_where_a_velocity_changes_its_sign(base):
    limiter = CommandLimiter(base, UNEVEN, PERIOD)
    rng = np.random.default_rng(3)
    for _ in range(200):
        twists, angles, _ = limiter.run(limiter.at_rest(), stream(limiter, rng))
        assert ratios(limiter, twists, angles)[:3].max() <= MOST


@pytest.mark.parametrize("name", list_rolling())
def test_every_command_is_reached_exactly_and_every_stop(name):
    limiter, rng = limiter_of(name), np.random.default_rng(4)
    motion = limiter.at_rest()
    for _ in range(50):
        command = limiter.base.feasible(rng.normal(size=3) * limiter.limits.velocity)
        for wanted in (command, np.zeros(3)):
            if rng.random() < 0.5:
                continue
            motion = limiter.run(motion, np.tile(wanted, (2000, 1)))[2]
            assert motion.twist.tolist() == limiter.allowed(wanted)[0].tolist()
            assert not motion.acceleration.any()


@pytest.mark.parametrize("name", list_rolling())
def test_the_curvature_is_kept_from_rest_under_saturation_and_while_braking(name):
    limiter, rng = limiter_of(name), np.random.default_rng(6)
    for _ in range(30):
        command = limiter.base.feasible(3.0 * rng.normal(size=3) * limiter.limits.velocity)
        commands = np.concatenate([np.tile(command, (300, 1)), np.zeros((300, 3))])
        twists, _, motion = limiter.run(limiter.at_rest(), commands)
        ray = command / np.linalg.norm(command)
        off = twists - (twists @ ray)[:, None] * ray
        assert np.abs(off).max() <= 1e-9 * np.abs(twists).max()
        assert (twists @ ray >= 0.0).all()
        assert motion.saturated == limiter.allowed(command)[1]


def test_a_commanded_circle_of_one_metre_is_kept():
    """Limited axis by axis, it would be left by 0.20 m."""
    limits = MotionLimits(acceleration=[3.0, 0.5, 1.0], jerk=[30.0, 5.0, 5.0])
    limiter = CommandLimiter(differential_drive(0.1, 0.4), limits, 0.02)
    twists, _, _ = limiter.run(limiter.at_rest(), np.tile([0.5, 0.5, 0.0], (500, 1)))
    pose, farthest = np.zeros(3), 0.0
    for twist in twists:
        pose = limiter.base.integrate(pose, limiter.base.wheel_rates(twist), 0.02)
        farthest = max(farthest, abs(math.hypot(pose[0], pose[1] - 1.0) - 1.0))
    assert farthest < 1e-12


def test_a_step_is_as_fast_as_the_limits_allow():
    """From 0 to 1 m/s with 2 m/s^2 and 5 m/s^3: 0.4 s of jerk twice, and 0.1 s between."""
    limits = MotionLimits(acceleration=[3.0, 2.0, 1.0], jerk=[9.0, 5.0, 5.0])
    limiter = CommandLimiter(differential_drive(0.1, 0.4), limits, PERIOD)
    twists, _, _ = limiter.run(limiter.at_rest(), np.tile([0.0, 1.0, 0.0], (200, 1)))
    assert int(np.argmax(twists[:, 1] == 1.0)) + 1 <= 91
    assert ratios(limiter, twists, np.zeros((200, 0)))[2] <= MOST


def test_a_wheel_that_saturates_shortens_the_whole_twist_and_is_named():
    base = differential_drive(0.1, 0.4, max_rate=5.0)
    limiter = CommandLimiter(base, MotionLimits(acceleration=[9.0] * 3, jerk=[90.0] * 3), PERIOD)
    twist, saturated = limiter.allowed([1.0, 0.5, 0.0])
    assert twist == pytest.approx([5.0 / 7.0, 2.5 / 7.0, 0.0], rel=1e-12)
    assert saturated == ("right",)
    assert base.wheel_rates(twist).max() == pytest.approx(5.0, rel=1e-12)


def test_an_axis_without_velocity_is_left_out_and_the_others_go_on():
    limiter = limiter_of("differential")
    twist, _ = limiter.allowed([0.1, 0.2, 0.7])
    assert twist == pytest.approx([0.1, 0.2, 0.0])


def test_wheels_turn_before_a_swerve_base_starts():
    base = swerve(0.05, [[0.2, 0.2], [-0.2, -0.2]], max_steering_rate=2.0)
    limiter = CommandLimiter(base, MotionLimits(acceleration=[5.0] * 3, jerk=[50.0] * 3), PERIOD)
    twists, angles, _ = limiter.run(limiter.at_rest(), np.tile([0.0, 0.0, 0.5], (200, 1)))
    turning = math.ceil(0.5 * math.pi / 2.0 / PERIOD)
    assert not twists[:turning].any()
    assert twists[turning + 1 :].any(axis=1).all()
    assert np.abs(angles[turning:]) == pytest.approx(0.5 * math.pi, abs=1e-12)


def test_a_car_stops_before_it_drives_the_other_way():
    limiter = CommandLimiter(
        ackermann(0.15, 1.2, 0.8), MotionLimits(acceleration=[3.0] * 3, jerk=[9.0] * 3), PERIOD
    )
    motion = limiter.run(limiter.at_rest(), np.tile([0.3, 1.0, 0.0], (300, 1)))[2]
    twists, _, _ = limiter.run(motion, np.tile([0.3, -1.0, 0.0], (500, 1)))
    assert (twists == 0.0).all(axis=1).any()
    assert twists[-1] == pytest.approx([0.3, -1.0, 0.0])


@pytest.mark.parametrize("name", ["ackermann", "swerve", "tricycle"])
def test_a_command_that_eases_off_and_comes_back_does_not_stop_a_steered_base(name):
    """Jerk forbids for some periods to go on; once that was taken for steering, and braked for."""
    limiter = limiter_of(name)
    fast = 0.4 * limiter.limits.velocity[1]
    # Quicker than the acceleration lets the base follow.
    quick = 2.0 * limiter.limits.acceleration[1] / (0.3 * fast) * PERIOD
    swing = 0.3 * np.sin(quick * np.arange(2000))
    commands = np.array([0.1 * fast, fast, 0.0]) * (1.0 + swing[:, None] * [1.5, 1.0, 1.0])
    motion = limiter.run(limiter.at_rest(), np.tile(commands[0], (400, 1)))[2]
    assert motion.twist.tolist() == commands[0].tolist()
    twists, _, _ = limiter.run(motion, commands)
    assert twists[:, 1].min() > 0.6 * fast


def test_a_tricycle_that_turns_a_little_as_it_reverses_does_not_creep():
    """Its wheel would have to turn round; it once did so at rest, as far as its limits."""
    limiter = limiter_of("tricycle")
    motion = limiter.run(limiter.at_rest([-1e-4]), np.tile([1e-7, -4e-4, 0.0], (20, 1)))[2]
    assert motion.twist[1] == -4e-4
    speeds = 0.002 * np.arange(1, 120)
    twists, angles, _ = limiter.run(motion, speeds[:, None] * [1.3e-3, 1.0, 0.0])
    assert np.abs(angles).max() < 0.02
    assert twists[-1, 1] > 0.8 * speeds[-1]


def test_without_limits_a_command_is_followed_at_once():
    limiter = CommandLimiter(mecanum(0.1, 0.6, 0.4), MotionLimits(), PERIOD)
    motion = limiter.step(limiter.at_rest(), [0.3, -0.2, 0.9])
    assert motion.twist.tolist() == [0.3, -0.2, 0.9]


def test_black_box_6_what_is_not_finite_moves_nothing():
    limiter = limiter_of("mecanum")
    motion = limiter.step(limiter.at_rest(), [0.1, 0.2, 0.3])
    before = motion.twist.tolist()
    with pytest.raises(NonFiniteError, match=r"command\[1\] is nan"):
        limiter.step(motion, [0.0, math.nan, 0.0])
    assert motion.twist.tolist() == before
    with pytest.raises(LimitExceededError, match="steering angle of joint 'front' is 2 rad"):
        CommandLimiter(tricycle(0.1, 1.0, 0.6), MotionLimits(), PERIOD).at_rest([2.0])


def test_steps_one_by_one_are_those_of_a_run():
    limiter, rng = limiter_of("swerve"), np.random.default_rng(8)
    commands = np.repeat(rng.normal(size=(5, 3)), 20, axis=0)
    twists, angles, _ = limiter.run(limiter.at_rest(), commands)
    motion = limiter.at_rest()
    for i, command in enumerate(commands):
        motion = limiter.step(motion, command)
        assert motion.twist.tolist() == twists[i].tolist()
        assert motion.steering.tolist() == angles[i].tolist()


def test_the_kernel_does_what_its_rule_in_numpy_does():
    limiter, rng = limiter_of("mecanum"), np.random.default_rng(12)
    for _ in range(5):
        commands = limiter.allowed(stream(limiter, rng))[0]
        twists = limiter.run(limiter.at_rest(), commands)[0]
        assert np.abs(twists - limited(commands, limiter.limits, PERIOD)).max() < 1e-9


def test_steps_from_rest_take_as_long_as_those_of_ruckig():
    """Ruckig is optimal in continuous time; ours may be later by what whole periods cost."""
    rng, base = np.random.default_rng(13), mecanum(0.1, 0.6, 0.4)
    for _ in range(50):
        acceleration, jerk = rng.uniform(0.5, 4.0, 3), rng.uniform(2.0, 40.0, 3)
        limiter = CommandLimiter(base, MotionLimits(acceleration=acceleration, jerk=jerk), PERIOD)
        command = rng.normal(size=3)
        wanted = ruckig.InputParameter(3)
        wanted.control_interface = ruckig.ControlInterface.Velocity
        wanted.synchronization = ruckig.Synchronization.Phase
        wanted.current_position = wanted.target_position = [0.0] * 3
        wanted.current_velocity = wanted.current_acceleration = [0.0] * 3
        wanted.target_velocity, wanted.target_acceleration = command.tolist(), [0.0] * 3
        wanted.max_acceleration, wanted.max_jerk = acceleration.tolist(), jerk.tolist()
        found = ruckig.Trajectory(3)
        ruckig.Ruckig(3).calculate(wanted, found)
        twists, _, _ = limiter.run(limiter.at_rest(), np.tile(command, (3000, 1)))
        ours = (int(np.argmax((twists == command).all(axis=1))) + 1) * PERIOD
        # Phases along one ray take as long as the axis that needs most of each limit.
        share = np.abs(command)
        most, harshest = (acceleration / share).min(), (jerk / share).min()
        ray = 1.0 / most + most / harshest
        if most * most > harshest:
            ray = 2.0 / math.sqrt(harshest)
        assert found.duration - PERIOD <= ours <= ray + 2.0 * PERIOD


def test_a_turn_sharper_than_the_steering_allows_is_said():
    limiter = limiter_of("ackermann")
    twist, saturated = limiter.allowed([9.0, 1.0, 0.0])
    assert saturated == ("curvature",)
    assert twist == pytest.approx([limiter.base.curvatures[1], 1.0, 0.0])
