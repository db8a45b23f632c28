"""The black-box checks of mobile bases, update by update, for every kind of drive; no clock."""

import math
from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.mobile_base.drives import INTERFACES, chosen_robot
from robomech_ros.nodes.mobile_base.mobile_base import BaseOptions, MobileBase
from robomech_ros.nodes.mobile_base.settings import MobileBaseSettings, check_settings
from robomech_ros.rolling import list_rolling, rolling_description
from robomech_ros.rolling.arcs import moved
from robomech_ros.rolling.tree import BASE_JOINTS

PERIOD = 0.01
MECANUM = {
    f"{corner}_wheel_command_joint_name": corner
    for corner in ("front_left", "front_right", "rear_right", "rear_left")
}
MADE = {
    "diff": {
        "left_wheel_names": ("left",),
        "right_wheel_names": ("right",),
        "wheel_separation": 0.4,
        "wheel_radius": 0.1,
    },
    "omni": {"wheel_names": ("a", "b", "c"), "robot_radius": 0.5, "wheel_radius": 0.1},
    "mecanum": {
        **MECANUM,
        "kinematics__wheels_radius": 0.1,
        "kinematics__sum_of_robot_center_projection_on_X_Y_axis": 0.5,
    },
    "bicycle": {
        "traction_joints_names": ("rear",),
        "steering_joints_names": ("front",),
        "wheelbase": 1.2,
        "traction_wheels_radius": 0.15,
    },
    "tricycle": {
        "traction_joints_names": ("right", "left"),
        "steering_joints_names": ("front",),
        "wheelbase": 1.2,
        "traction_track_width": 0.8,
        "traction_wheels_radius": 0.15,
    },
    "ackermann": {
        "traction_joints_names": ("right", "left"),
        "steering_joints_names": ("front_right", "front_left"),
        "wheelbase": 1.2,
        "traction_track_width": 0.8,
        "steering_track_width": 0.8,
        "traction_wheels_radius": 0.15,
    },
}
LIMITS = {
    f"{axis}__{name}": value
    for axis in ("linear__x", "linear__y", "angular__z")
    for name, value in (("max_velocity", 1.0), ("max_acceleration", 2.0), ("max_jerk", 10.0))
}


def settings_of(drive, **more):
    if drive == "swerve":
        return MobileBaseSettings(robot_description="swerve", **more)
    return MobileBaseSettings(drive=drive, **{**MADE[drive], **more})


def base_of(drive, timeout=None, *, window=1, options=(), **more):
    robot, _ = chosen_robot(settings_of(drive, **more))
    interface = INTERFACES[drive]
    timeout = interface.timeout if timeout is None else timeout
    made = BaseOptions(period=PERIOD, timeout=timeout, window=window, **dict(options))
    return MobileBase(robot, interface, made)


def drive_on(base, command, updates):
    """Command again and again; give the twists, shape (updates, 3)."""
    twists = []
    for _ in range(updates):
        base.take(command, 0.0)
        base.update()
        twists.append(base.motion.twist)
    return np.array(twists)


@pytest.mark.parametrize(
    ("drive", "twist", "rates", "steering"),
    [
        ("diff", (1.0, 0.5, 0.0), (3.0, 7.0), ()),
        ("mecanum", (0.2, 1.0, 0.5), (4.0, 16.0, 6.0, 14.0), ()),
        ("omni", (0.1, 0.1, 0.2), (-2.5, 0.5 * 3**0.5 + 0.5, 0.5 - 0.5 * 3**0.5), ()),
        ("bicycle", (0.5, 1.0, 0.0), (1.0 / 0.15,), (math.atan(0.6),)),
        ("tricycle", (0.5, 1.0, 0.0), (8.0, 16.0 / 3.0), (math.atan(0.6),)),
        ("ackermann", (0.5, 1.0, 0.0), (8.0, 16.0 / 3.0), (math.atan(0.5), math.atan(0.75))),
    ],
)
def test_1_wheels_of_a_twist(drive, twist, rates, steering):
    base = base_of(drive)
    drive_on(base, twist, 5)
    np.testing.assert_allclose(base.wheel_rates, rates, atol=1e-9)
    np.testing.assert_allclose(base.motion.steering, steering, atol=1e-9)


@pytest.mark.parametrize("drive", INTERFACES)
def test_2_odometry_is_exact_on_arcs_and_its_covariance_grows(drive):
    # Each of the three ways is that of some drives.
    ways = ((), (("by_position", False),), (("open_loop", True),))
    options = ways[sorted(INTERFACES).index(drive) % 3]
    limits = {} if drive != "swerve" else {"max_steering_rate": 1e6}
    base = base_of(drive, options=options, **limits)
    command = np.array([0.5, 0.4, 0.0 if base.robot.base.axle is not None else 0.2])
    drive_on(base, command, 100)
    begin, spread = base.odometry.pose, np.trace(base.odometry.covariance)
    np.testing.assert_allclose(base.motion.twist, command, atol=1e-9)
    drive_on(base, command, 50)
    after = moved(begin, 0.5 * command)
    np.testing.assert_allclose(base.odometry.pose, after, atol=1e-9)
    np.testing.assert_allclose(base.odometry.pose, base.simulated.pose, atol=1e-9)
    assert np.trace(base.odometry.covariance) > spread > 0.0
    assert base.odometry.slip < 1e-9


@pytest.mark.parametrize("drive", INTERFACES)
def test_3_silence_brakes_within_limits_and_the_next_command_counts(drive):
    base = base_of(drive, 0.1, **LIMITS)
    drive_on(base, (0.3, 0.5, 0.0), 200)
    moving = base.motion.twist
    assert moving[1] > 0.4
    turn = moving[0] / moving[1]
    for _ in range(200):
        base.update()
        if base.motion.twist[1] > 1e-6:
            assert abs(base.motion.twist[0] / base.motion.twist[1] - turn) < 1e-9
    assert base.timed_out and not base.motion.twist.any() and not base.wheel_rates.any()
    pose = base.odometry.pose
    base.update()
    np.testing.assert_array_equal(base.odometry.pose, pose)
    drive_on(base, (0.0, 0.5, 0.0), 50)
    assert base.motion.twist[1] > 0.1 and not base.timed_out


@pytest.mark.parametrize("drive", INTERFACES)
def test_4_a_stale_command_is_ignored(drive):
    base = base_of(drive, 0.5)
    with pytest.raises(BadValueError, match=r"age of the command is 0.6, expected up to 0.5 s"):
        base.take((0.0, 0.5, 0.0), 0.6)
    base.update()
    assert not base.motion.twist.any()
    # From the future: as if it were now.
    base.take((0.0, 0.5, 0.0), -1000.0)
    for _ in range(60):
        base.update()
    assert base.timed_out


def test_4_a_stale_command_also_ends_the_one_before_on_mecanum_wheels_only():
    for drive, ends in (("mecanum", True), ("diff", False)):
        base = base_of(drive, 0.5)
        drive_on(base, (0.0, 0.5, 0.0), 3)
        with pytest.raises(BadValueError, match="age"):
            base.take((0.0, 0.2, 0.0), 0.6)
        base.update()
        assert base.timed_out is ends


@pytest.mark.parametrize(
    ("drive", "updates"),
    [("diff", 200), ("swerve", 200), ("omni", 0), ("mecanum", 1), ("ackermann", 1)],
)
def test_5_a_time_out_of_0(drive, updates):
    base = base_of(drive, 0.0)
    base.take((0.0, 0.5, 0.0), 0.0)
    counted = 0
    for _ in range(200):
        base.update()
        counted += not base.timed_out
    assert counted == updates


@pytest.mark.parametrize("drive", INTERFACES)
@pytest.mark.parametrize("spoilt", [math.nan, math.inf, 1e300])
def test_6_numbers_that_are_none_change_nothing(drive, spoilt):
    base, other = base_of(drive, 0.5), base_of(drive, 0.5)
    for one in (base, other):
        drive_on(one, (0.3, 0.5, 0.0), 5)
    with pytest.raises((NonFiniteError, BadValueError)):
        base.take((0.0, spoilt, 0.0), 0.0)
    for one in (base, other):
        one.update()
    np.testing.assert_array_equal(base.motion.twist, other.motion.twist)


@pytest.mark.parametrize("drive", INTERFACES)
def test_7_nothing_moves_before_the_first_command(drive):
    base = base_of(drive)
    for _ in range(100):
        base.update()
    assert base.timed_out and not base.wheel_rates.any() and not base.odometry.pose.any()


@pytest.mark.parametrize("drive", INTERFACES)
def test_10_limits_hold_in_every_update(drive):
    rng = np.random.default_rng(7)
    base = base_of(drive, 0.2, **LIMITS)
    begin = base.motion.steering
    twists = [np.zeros((1, 3))]
    for _ in range(12):
        command = rng.uniform(-2.0, 2.0, 3)
        twists.append(drive_on(base, command, int(rng.integers(1, 60))))
        silent = int(rng.integers(0, 60))
        for _ in range(silent):
            base.update()
            twists.append(base.motion.twist[None])
    velocity = np.concatenate(twists)
    # What the feasible twist adds sideways follows from the turn: the axes that are commanded.
    velocity = velocity[:, :2] if base.robot.base.axle is not None else velocity
    acceleration = np.diff(velocity, axis=0, prepend=0.0) / PERIOD
    jerk = np.diff(acceleration, axis=0, prepend=0.0) / PERIOD
    assert np.abs(velocity).max() > 0.1 and len(begin) == len(base.motion.steering)
    for values, most in ((velocity, 1.0), (acceleration, 2.0), (jerk, 10.0)):
        assert np.abs(values).max() / most <= 1.0 + 1e-9


@pytest.mark.parametrize("drive", ["diff", "omni", "mecanum", "ackermann"])
def test_curvature_is_kept_where_a_wheel_saturates(drive):
    base = base_of(drive, 0.5, max_wheel_rate=3.0)
    drive_on(base, (0.5, 1.0, 0.0), 5)
    w, vx, _ = base.motion.twist
    assert abs(w / vx - 0.5) < 1e-9 and vx < 1.0 and base.motion.saturated
    assert np.abs(base.wheel_rates).max() <= 3.0 * (1.0 + 1e-9)


@pytest.mark.parametrize("drive", INTERFACES)
def test_12_open_loop_follows_the_limited_command(drive):
    base = base_of(drive, 0.5, options=(("open_loop", True),), **LIMITS)
    twists = drive_on(base, (0.0, 5.0, 0.0), 30)
    assert abs(base.odometry.pose[0] - PERIOD * twists[:, 1].sum()) < 1e-9


@pytest.mark.parametrize("drive", INTERFACES)
def test_13_odometry_jumps_where_it_is_placed_and_the_base_moves_on(drive):
    base, other = base_of(drive, 0.5), base_of(drive, 0.5)
    for one in (base, other):
        drive_on(one, (0.0, 0.5, 0.0), 50)
    base.place((3.0, 4.0, 0.5))
    np.testing.assert_array_equal(base.odometry.pose, (3.0, 4.0, 0.5))
    assert not base.odometry.covariance.any()
    np.testing.assert_array_equal(base.motion.twist, other.motion.twist)
    np.testing.assert_array_equal(base.mean_twist, other.mean_twist)
    with pytest.raises(NonFiniteError):
        base.place((math.nan, 0.0, 0.0))


@pytest.mark.parametrize("drive", INTERFACES)
def test_14_wheels_that_begin_anywhere_do_not_move_odometry(drive):
    base = base_of(drive, options=(("wheel_position", 5.0),))
    base.update()
    assert not base.odometry.pose.any() and (base.simulated.positions == 5.0).all()


@pytest.mark.parametrize("drive", ["diff", "bicycle", "tricycle", "ackermann"])
def test_15_what_the_drive_cannot_give_is_left_out(drive):
    base, other = base_of(drive), base_of(drive)
    drive_on(base, (0.3, 0.5, 0.7), 20)
    drive_on(other, (0.3, 0.5, 0.0), 20)
    np.testing.assert_array_equal(base.motion.twist, other.motion.twist)


@pytest.mark.parametrize(
    "name", ["differential", "omni", "mecanum", "tricycle", "ackermann", "swerve"]
)
def test_motors_move_the_base_to_its_command_and_to_rest(name):
    robot, _ = chosen_robot(MobileBaseSettings(robot_description=name))
    options = BaseOptions(period=PERIOD, timeout=0.5, dynamic=True)
    base = MobileBase(robot, INTERFACES[robot.drive], options)
    drive_on(base, (0.2, 0.3, 0.0), 200)
    np.testing.assert_allclose(base.simulated.twist, (0.2, 0.3, 0.0), atol=1e-6)
    # Odometry is that of the simulated wheels, not of commands.
    np.testing.assert_allclose(base.odometry.pose, base.simulated.pose, atol=1e-9)
    for _ in range(200):
        base.update()
    assert np.abs(base.simulated.twist).max() < 1e-6


def test_weak_motors_are_named_and_do_not_give_more():
    robot, _ = chosen_robot(MobileBaseSettings(robot_description="mecanum"))
    options = BaseOptions(period=PERIOD, timeout=0.5, dynamic=True)
    weak = np.full(4, 0.05)
    robot.dynamics.max_torques[:] = weak
    base = MobileBase(robot, INTERFACES["mecanum"], options)
    drive_on(base, (0.0, 0.8, 0.0), 50)
    assert set(base.simulated.saturated) <= set(robot.base.driven) and base.simulated.saturated
    assert np.abs(base.simulated.torques).max() <= 0.05 * (1.0 + 1e-9)
    assert base.simulated.twist[1] < 0.5 * base.motion.twist[1]


def test_motors_need_bodies():
    robot, _ = chosen_robot(MobileBaseSettings(robot_description="swerve"))
    options = BaseOptions(period=PERIOD, timeout=0.5, dynamic=True)
    with pytest.raises(BadValueError, match="'dynamic', expected kinematic: this robot's"):
        MobileBase(replace(robot, dynamics=None), INTERFACES["swerve"], options)


def test_several_wheels_of_a_side_are_one():
    settings = settings_of("diff", left_wheel_names=("a", "b"), right_wheel_names=("c", "d"))
    robot, joints = chosen_robot(settings)
    assert joints.rolling == (("a", 0), ("b", 0), ("c", 1), ("d", 1))
    assert robot.base.driven == ("left", "right")


def test_the_frame_of_a_mecanum_base_may_be_beside_its_wheels():
    moved_by = {"kinematics__base_frame_offset__x": 0.3, "kinematics__base_frame_offset__y": -0.1}
    robot, _ = chosen_robot(settings_of("mecanum", **moved_by))
    centred, _ = chosen_robot(settings_of("mecanum"))
    # The centre of the wheels moves by the turn about the frame.
    rates = robot.base.wheel_rates([1.0, 0.2, 0.3])
    np.testing.assert_allclose(rates, centred.base.wheel_rates([1.0, 0.3, 0.6]), atol=1e-9)


def test_limits_that_are_given_replace_those_of_the_robot_and_follow_one_another():
    given = {"linear__x__max_velocity": 0.4, "linear__x__max_deceleration": -0.7}
    robot, _ = chosen_robot(MobileBaseSettings(robot_description="mecanum", **given))
    known, _ = chosen_robot(MobileBaseSettings(robot_description="mecanum"))
    limits = robot.limits
    assert limits.velocity.tolist() == [1.23, 0.4, 0.8] and limits.backward_velocity[1] == 0.4
    assert limits.deceleration[1] == 0.7 and limits.acceleration[1] == known.limits.acceleration[1]
    assert limits.jerk.tolist() == known.limits.jerk.tolist()


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        (MobileBaseSettings(), "parameter 'drive' is ''; allowed is one of diff, omni"),
        (MobileBaseSettings(drive="swerve"), "'swerve'; allowed is one of diff"),
        (MobileBaseSettings(robot_description="mecanum", drive="diff"), "allowed is 'mecanum'"),
        (replace(settings_of("diff"), right_wheel_names=()), r"'right_wheel_names'.* 1 name\b"),
        (replace(settings_of("tricycle"), steering_joints_names=()), "'steering_joints_names'"),
        (replace(settings_of("diff"), left_wheel_names=("right",)), "each joint once"),
        (replace(settings_of("mecanum"), rear_left_wheel_command_joint_name=""), "rear_left"),
        (replace(settings_of("diff"), wheel_radius=0.0), "'wheel_radius' is 0.0; .* above 0 m"),
        (settings_of("diff", wheel_separation=0.0), "'wheel_separation' is 0.0; .* above 0 m"),
        (settings_of("omni", robot_radius=0.0), "'robot_radius' is 0.0"),
        (settings_of("mecanum", kinematics__wheels_radius=0.0), "'kinematics.wheels_radius'"),
        (settings_of("omni", wheel_names=("a", "b")), "2, expected a number of wheels from 3"),
        (settings_of("bicycle", wheelbase=0.0), "'wheelbase' is 0.0"),
        (settings_of("bicycle", traction_wheels_radius=0.0), "'traction_wheels_radius' is 0.0"),
        (settings_of("tricycle", traction_track_width=0.0), "'traction_track_width' is 0.0"),
    ],
)
def test_what_makes_no_robot_is_refused(settings, text):
    with pytest.raises(ValueError, match=text):
        chosen_robot(settings)


@pytest.mark.parametrize(
    ("drive", "left_out", "instead"),
    [
        ("ackermann", "steering_track_width", {}),
        ("bicycle", "traction_wheels_radius", {"traction_wheel_radius": 0.15}),
        ("tricycle", "traction_track_width", {"wheel_track": 0.8}),
    ],
)
def test_files_of_ros2_controllers_may_name_or_leave_out_measures_otherwise(
    drive, left_out, instead
):
    plain, _ = chosen_robot(settings_of(drive))
    robot, _ = chosen_robot(settings_of(drive, **{left_out: 0.0}, **instead))
    for wheel, known in zip(robot.base.wheels, plain.base.wheels, strict=True):
        assert wheel.position.tolist() == known.position.tolist()
        assert (wheel.radius, wheel.name, wheel.driven) == (known.radius, known.name, known.driven)


def test_limits_that_a_file_of_older_ros2_controllers_switches_off_do_not_count():
    """Their own example has zeros beside, which would be no limits."""
    names = ("max_velocity", "min_velocity", "max_acceleration", "max_jerk", "min_jerk")
    zeros = {f"linear__x__{name}": 0.0 for name in names}
    kinds = ("velocity", "acceleration", "jerk")
    off = {f"linear__x__has_{kind}_limits": False for kind in kinds}
    robot, _ = chosen_robot(settings_of("diff", **zeros, **off, angular__z__max_velocity=2.0))
    for kind in kinds:
        assert getattr(robot.limits, kind)[1] == math.inf
    assert robot.limits.deceleration[1] == robot.limits.backward_velocity[1] == math.inf
    assert robot.limits.velocity[0] == 2.0
    with pytest.raises(ValueError, match="acceleration"):
        chosen_robot(settings_of("diff", **zeros))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("linear__x__max_deceleration", 1.0),
        ("angular__z__max_velocity", -1.0),
        ("pose_covariance_diagonal", (1.0,)),
        ("diagonal_covariance__twist", (1.0, 2.0)),
    ],
)
def test_parameters_of_the_wrong_sign_or_number_are_refused(name, value):
    with pytest.raises(ParameterError, match=name.replace("__", ".")):
        check_settings(MobileBaseSettings(**{name: value}))


@pytest.mark.parametrize("name", list_rolling())
def test_the_joints_that_are_told_are_those_of_the_description(name):
    robot, joints = chosen_robot(MobileBaseSettings(robot_description=name))
    moved = set(rolling_description(robot.base).joint_names) - set(BASE_JOINTS)
    assert set(joints.names) == moved and len(joints.names) == len(moved)


def test_names_of_joints_that_come_twice_in_a_document_are_refused():
    """joint_states could not tell them apart."""
    wheels = [
        f"- {{name: {name}, kind: steered, position: {[x, 0.0]}, radius: 0.1}}"
        for name, x in (("a", 0.3), ("a_steering", -0.3))
    ]
    head = ["kind: rolling", "name: twice", "source: this test", "drive: swerve", "wheels:"]
    text = "\n".join([*head, *wheels, ""])
    with pytest.raises(ParameterError, match="'names of joints' is 'a_steering'.* each joint once"):
        chosen_robot(MobileBaseSettings(robot_description=text))


def test_rates_of_brackets_are_those_of_the_period():
    robot, _ = chosen_robot(MobileBaseSettings(robot_description="differential"))
    base = MobileBase(robot, INTERFACES["diff"], BaseOptions(period=PERIOD, timeout=0.5))
    for command in ([0.5, 0.3, 0.0], [-0.5, -0.3, 0.0]):
        base.take(command, 0.0)
        for _ in range(20):
            before = base.simulated.brackets
            base.update()
            told = base.simulated.bracket_rates * base.options.period
            assert told == pytest.approx(base.simulated.brackets - before, abs=1e-15)
    assert base.simulated.brackets[0] != 0.0


def test_every_robot_has_a_drive_with_an_interface():
    for name in list_rolling():
        robot, joints = chosen_robot(MobileBaseSettings(robot_description=name))
        assert robot.drive in INTERFACES
        assert len(joints.steering) == len(robot.base.steered)
