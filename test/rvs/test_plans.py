"""Plans between postures, their curves, and where in them one is."""

import numpy as np
import pytest

from robomech_ros.dynamics import inverse_dynamics
from robomech_ros.errors import BadValueError, MissingLimitsError, RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, load_robot
from robomech_ros.rvs import Motion
from robomech_ros.rvs.model.motions.motion_curves import QUANTITIES, motion_curves
from robomech_ros.rvs.model.motions.planning import JOINTS, LINE, plan_between
from robomech_ros.rvs.model.motions.player import Player
from robomech_ros.rvs.page.curves import ALL, cursor_rule, curves_picture
from robomech_ros.trajectory import PROFILES

ARM = load_robot("ur5e")
HOME = ARM.home()
THERE = HOME + np.array([0.5, -0.3, 0.4, 0.2, -0.4, 0.6])


@pytest.mark.parametrize("profile", PROFILES)
def test_a_plan_of_the_joints_begins_and_ends_at_rest_inside_all_limits(profile):
    made = plan_between(ARM, HOME, THERE, JOINTS, profile)
    motion = made.motion
    np.testing.assert_allclose(motion.q[[0, -1]], [HOME, THERE], atol=1e-9)
    np.testing.assert_allclose(motion.qd[[0, -1]], 0.0, atol=1e-9)
    assert made.complete and profile in made.sentence
    for values, most in ((motion.qd, ARM.velocity), (motion.qdd, ARM.acceleration)):
        assert (np.abs(values) <= most * (1.0 + 1e-6)).all()


def test_a_plan_along_a_line_keeps_the_tip_on_it():
    motion = plan_between(ARM, HOME, THERE, LINE, "poly345").motion
    ends = forward_kinematics(ARM, np.array([HOME, THERE]))[:, :3, 3]
    at = forward_kinematics(ARM, motion.q)[:, :3, 3] - ends[0]
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    np.testing.assert_allclose(at - np.outer(at @ along, along), 0.0, atol=1e-5)
    np.testing.assert_allclose(motion.q[-1], THERE, atol=1e-6)


def test_a_line_that_cannot_be_followed_says_how_far_and_why():
    # Past the axis of the shoulder.
    turned = HOME + [3.0, 0.0, 0.0, 0.0, 0.0, 0.5]
    made = plan_between(ARM, HOME, turned, LINE, "poly345")
    assert not made.complete and "Followed to" in made.sentence
    assert "before the goal" in made.sentence and "shoulder" in made.sentence
    np.testing.assert_allclose(made.motion.q[0], HOME, atol=1e-9)
    np.testing.assert_allclose(made.motion.qd[-1], 0.0, atol=1e-6)


@pytest.mark.parametrize(
    ("goal", "way", "profile", "words"),
    [
        (HOME, JOINTS, "poly345", "another posture"),
        (HOME, LINE, "poly345", "another pose"),
        (HOME + np.eye(6)[0] * np.pi, LINE, "poly345", "from the start to the goal"),
        (THERE, "by train", "poly345", "one of joints"),
        (THERE, JOINTS, "poly3", "one of"),
        (THERE, LINE, "trapezoidal", "one of poly345"),
        (HOME + 100.0, JOINTS, "poly345", "over its limit"),
    ],
)
def test_a_plan_that_cannot_be_is_refused_in_words(goal, way, profile, words):
    with pytest.raises(RobomechError, match=words):
        plan_between(ARM, HOME, goal, way, profile)


def test_an_arm_without_limits_of_its_rates_has_no_plan():
    chain = chain_from_dh([0.5, 0.4], [0.0, 0.0], [0.0, 0.0])
    with pytest.raises(MissingLimitsError):
        plan_between(chain, np.zeros(2), np.ones(2), JOINTS, "poly345")


def test_the_curves_are_those_that_the_motion_brings_and_the_torques_of_its_bodies():
    motion = plan_between(ARM, HOME, THERE, JOINTS, "double_s").motion
    known = {one.name: one for one in motion_curves(motion).quantities}
    assert tuple(known) == QUANTITIES
    assert [one.unit for one in known.values()] == ["rad", "rad/s", "rad/s²", "rad/s³", "N m"]
    np.testing.assert_array_equal(known["jerk"].values, motion.qddd)
    tau = inverse_dynamics(ARM, motion.q, motion.qd, motion.qdd)
    np.testing.assert_allclose(known["torque"].values, tau)
    np.testing.assert_array_equal(known["torque"].upper, ARM.effort)


def test_rates_that_are_not_known_are_differences():
    full = plan_between(ARM, HOME, THERE, JOINTS, "poly4567").motion
    times = np.linspace(0.0, full.duration, 2001)
    bare = Motion(ARM, times, full.at(times))
    known = {one.name: one.values for one in motion_curves(bare).quantities}
    for name, given in (("velocity", full.qd), ("acceleration", full.qdd)):
        exact = np.column_stack([np.interp(times, full.times, column) for column in given.T])
        assert np.abs(known[name] - exact)[5:-5].max() < 0.01 * np.abs(exact).max()
    one = motion_curves(Motion(ARM, [0.0], [HOME]))
    assert all(not q.values.any() for q in one.quantities if q.name == "velocity")


def test_joints_that_slide_are_drawn_apart_and_missing_torques_are_named():
    chain = load_robot("scara")
    q = chain.home() + np.linspace(0.0, 0.05, 11)[:, None]
    times = np.linspace(0.0, 1.0, 11)
    curves = motion_curves(Motion(chain, times, q))
    assert [one.unit for one in curves.quantities[:4]] == ["rad", "m", "rad/s", "m/s"]
    assert curves.missing == ("No torques: the robot's description has no masses.",)
    driven = motion_curves(Motion(chain, times, q, tau=np.zeros_like(q))).quantities
    assert [one.unit for one in driven if one.name == "torque"] == ["N m", "N"]
    assert curves.missing[0].replace("'", "&#x27;") in curves_picture(
        chain.joint_names, curves, ALL
    )


def test_the_picture_draws_every_joint_with_its_limits_and_a_cursor():
    curves = motion_curves(plan_between(ARM, HOME, THERE, JOINTS, "poly345").motion)
    text = curves_picture(ARM.joint_names, curves, "acceleration")
    assert text.count("<polyline") == 6 and text.count("data-cursor") == 1
    assert "stroke-dasharray" in text and "limits dashed" in text and "shoulder pan" in text
    assert curves_picture(ARM.joint_names, curves, ALL).count("data-cursor") == len(QUANTITIES)
    assert "nan" not in curves_picture(ARM.joint_names, curves, ALL)
    assert cursor_rule(0.25) == "<style>[data-cursor]{left:25.000%}</style>"


def test_a_player_goes_on_stops_at_the_end_and_begins_again():
    player = Player()
    player.play()
    assert not player.playing
    player.load(2.0)
    player.play()
    player.set_speed(0.5)
    player.advance(1.0)
    assert player.time == 0.5 and player.playing
    player.advance(100.0)
    assert player.time == 2.0 and not player.playing
    player.play()
    player.advance(4.0)
    assert player.time == 2.0 and not player.playing
    player.play()
    assert player.time == 0.0
    player.loop = True
    player.advance(5.0)
    assert player.time == pytest.approx(0.5) and player.playing
    player.pause()
    player.advance(1.0)
    assert player.time == pytest.approx(0.5)
    player.seek(100.0)
    assert player.time == 2.0


@pytest.mark.parametrize("wrong", [np.nan, np.inf, "fast", None, 0.0, 11.0])
def test_a_player_refuses_other_speeds(wrong):
    player = Player()
    with pytest.raises(BadValueError):
        player.set_speed(wrong)
    assert player.speed == 1.0


@pytest.mark.parametrize("wrong", [np.nan, -np.inf, "later", [1.0]])
def test_a_player_refuses_other_times(wrong):
    with pytest.raises(BadValueError):
        Player().seek(wrong)
