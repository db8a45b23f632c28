"""The arm that is seen: what it does on every command, without a browser."""

import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import list_robots, load_robot
from robomech_ros.rvs.model.arms.arm import ArmView


def moved(T, *by):
    """A pose moved in the base (m)."""
    there = T.copy()
    there[:3, 3] += by
    return there


@pytest.mark.parametrize("robot", list_robots())
def test_every_robot_stands_at_home_in_a_posture_of_its_own_pose(robot):
    arm = ArmView(load_robot(robot))
    np.testing.assert_array_equal(arm.q, arm.chain.home())
    assert any(posture.is_here for posture in arm.study.postures)
    for posture in arm.study.postures:
        np.testing.assert_allclose(forward_kinematics(arm.chain, posture.q), arm.tip, atol=1e-8)


def test_the_postures_are_those_of_the_solver_in_an_order_that_stays():
    arm = ArmView(load_robot("ur5e"))
    names = [posture.name for posture in arm.study.postures]
    found = inverse_kinematics(arm.chain, arm.tip, seed=arm.q)
    assert sorted(names) == sorted(found.branches) and arm.study.complete and len(names) == 8
    for number in range(len(names)):
        arm.take(number)
        assert [posture.name for posture in arm.study.postures] == names
        assert arm.study.postures[number].is_here


def test_a_joint_moves_inside_its_limits_and_not_beyond():
    arm = ArmView(load_robot("puma560"))
    arm.set_joint(1, 0.5)
    assert arm.q[1] == 0.5
    before = arm.q
    for value, said in (
        (9.0, r"joint 'shoulder' is 9.0, expected -0.785398 to 3.92699 rad"),
        (math.nan, "joint 'shoulder' is nan"),
        ("0.1", "joint 'shoulder' is '0.1'"),
        (None, "joint 'shoulder' is None"),
    ):
        with pytest.raises(BadValueError, match=said):
            arm.set_joint(1, value)
    np.testing.assert_array_equal(arm.q, before)


def test_a_typed_limit_that_was_rounded_is_the_limit():
    arm = ArmView(load_robot("puma560"))
    arm.set_joint(0, float(f"{arm.chain.upper[0]:.6f}"))
    assert arm.q[0] == pytest.approx(arm.chain.upper[0], abs=1e-6)
    assert arm.q[0] <= arm.chain.upper[0]


def test_the_arm_follows_the_gizmo_in_the_nearest_posture():
    arm = ArmView(load_robot("ur5e"))
    T, before = moved(arm.tip, 0.0, 0.0, 0.03), arm.q
    arm.drag(T)
    np.testing.assert_allclose(arm.tip, T, atol=1e-9)
    assert np.abs(arm.q - before).max() < 0.3
    assert arm.study.nearest_posture.distance == min(p.distance for p in arm.study.postures)


def test_out_of_reach_the_arm_stays_the_nearest_posture_is_known_and_the_gizmo_snaps_back():
    arm = ArmView(load_robot("ur5e"))
    before, tip = arm.q, arm.tip
    T = moved(tip, 1.0, 1.0, 0.0)
    arm.drag(T)
    np.testing.assert_array_equal(arm.q, before)
    np.testing.assert_array_equal(arm.target, T)
    assert "out of reach by" in arm.study.sentence and not arm.study.postures
    nearest = arm.study.nearest
    missed = np.linalg.norm(forward_kinematics(arm.chain, nearest)[:3, 3] - T[:3, 3])
    assert missed == pytest.approx(arm.study.position_error, abs=1e-9)
    rng = np.random.default_rng(0)
    others = forward_kinematics(arm.chain, rng.uniform(arm.chain.lower, arm.chain.upper, (500, 6)))
    assert missed < np.linalg.norm(others[:, :3, 3] - T[:3, 3], axis=1).min()
    arm.release()
    np.testing.assert_array_equal(arm.target, tip)
    assert arm.study.postures


def test_limits_that_exclude_everything_name_the_joint_and_the_excess():
    arm = ArmView(load_robot("irb120"))
    q = arm.chain.home()
    q[2] = arm.chain.upper[2] + 0.2
    q[3:] += [0.3, 0.4, 0.5]
    arm.drag(forward_kinematics(arm.chain, q))
    assert not arm.study.postures and arm.study.status.name == "LIMITS_EXCLUDE_ALL"
    found = inverse_kinematics(arm.chain, arm.target)
    for joint, excess in zip(found.blocking_joints, found.blocking_excess, strict=True):
        assert f"'{joint}'" in arm.study.sentence and f"{excess:.4g}"[:5] in arm.study.sentence


def test_the_nearest_posture_can_be_taken():
    arm = ArmView(load_robot("ur5e"))
    arm.drag(moved(arm.tip, 1.0, 1.0, 0.0))
    nearest = arm.study.nearest
    arm.take(0)
    np.testing.assert_array_equal(arm.q, nearest)


@pytest.mark.parametrize("number", [-1, 8, 0.5, math.inf])
def test_a_posture_that_is_not_there_is_refused(number):
    arm = ArmView(load_robot("ur5e"))
    with pytest.raises(BadValueError, match="posture"):
        arm.take(number)


@pytest.mark.parametrize("T", [np.zeros((4, 4)), np.full((4, 4), np.nan), np.eye(3), "there", None])
def test_what_is_no_pose_is_refused(T):
    arm = ArmView(load_robot("ur5e"))
    before = arm.q
    with pytest.raises(RobomechError):
        arm.drag(T)
    np.testing.assert_array_equal(arm.q, before)


def test_an_arm_with_few_joints_follows_as_near_as_it_can():
    arm = ArmView(load_robot("scara"))
    before = arm.tip
    tilted = moved(before, 0.0, 0.02, 0.0) @ np.diag([1.0, 1.0, 1.0, 1.0])
    tilted[:3, :3] = tilted[:3, :3] @ [[1, 0, 0], [0, 0.995004, -0.099833], [0, 0.099833, 0.995004]]
    arm.drag(tilted)
    assert not arm.study.postures and "nearest" in arm.study.reason
    np.testing.assert_allclose(arm.tip[:3, 3], tilted[:3, 3], atol=0.02)
    assert np.abs(arm.tip - before).max() > 0.005


@pytest.mark.parametrize("robot", ["iiwa14", "panda", "gen3", "general7r"])
def test_the_tip_stays_along_the_self_motion_up_to_a_limit(robot):
    arm = ArmView(load_robot(robot))
    T, begin = arm.tip, arm.q
    curve = arm.self_motion()
    assert curve.low <= -1.0 and curve.high >= 1.0
    for length in np.linspace(curve.low, curve.high, 9):
        arm.slide(float(length))
        np.testing.assert_allclose(arm.tip, T, atol=1e-9)
        assert np.all(arm.q >= arm.chain.lower) and np.all(arm.q <= arm.chain.upper)
    assert arm.self_motion() is curve
    arm.slide(1e9)
    beyond = np.minimum(arm.q - arm.chain.lower, arm.chain.upper - arm.q).min()
    if "limit" in curve.ends[1]:
        assert beyond < 1e-6
    arm.slide(0.0)
    np.testing.assert_allclose(arm.q, begin, atol=1e-9)


@pytest.mark.parametrize("robot", ["iiwa14", "panda"])
def test_no_sample_of_a_self_motion_is_listed_twice(robot):
    postures = ArmView(load_robot(robot)).study.postures
    q = np.array([posture.q for posture in postures])
    assert sum(posture.is_here for posture in postures) == 1
    apart = np.abs(q[:, None] - q).max(axis=-1) + 9.0 * np.eye(len(q))
    assert apart.min() > 1e-6
    assert all(posture.name for posture in postures)


def test_an_arm_of_six_joints_has_no_self_motion():
    arm = ArmView(load_robot("ur5e"))
    assert arm.self_motion() is None
    with pytest.raises(BadValueError, match="more than six joints"):
        arm.slide(0.1)
    with pytest.raises(BadValueError, match="self-motion is nan"):
        ArmView(load_robot("iiwa14")).slide(math.nan)


def test_sliders_of_joints_without_limits_have_ends():
    arm = ArmView(load_robot("jaco2"))
    endless = [j for j in range(arm.chain.n) if np.isinf(arm.chain.upper[j])]
    for joint in range(arm.chain.n):
        low, high = arm.travel(joint)
        assert np.isfinite([low, high]).all() and low < high
    assert endless and arm.travel(endless[0]) == (-2 * np.pi, 2 * np.pi)
