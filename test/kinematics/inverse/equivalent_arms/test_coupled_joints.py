"""Inverse kinematics where joints follow others: complete, or searched and said to be."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.merged_axes import merged_arm
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinetostatics import jacobian, joint_rates
from robomech_ros.robots import load_robot
from test.coupled_robots import DATA, coupled, found_by_newton, lifter

TURNED = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
HOLLOW = (DATA / "hollow_wrist.urdf").read_text(encoding="utf-8")


def spherical_wrist():
    """The hollow wrist with all four axes through one point."""
    text = HOLLOW
    for name in ("j5", "j5b", "j6"):
        offset = HOLLOW.split(f'<joint name="{name}"')[1].split('xyz="')[1].split('"')[0]
        text = text.replace(f'xyz="{offset}"', 'xyz="0 0 0"')
    return load_robot(text)


@pytest.mark.parametrize(
    ("chain", "joints"),
    [(coupled("palletizer"), 5), (coupled("coupled_finger"), 3), (lifter(), 3)],
    ids=["palletizer", "finger", "lifter"],
)
def test_the_arm_without_followers_takes_the_same_poses(chain, joints):
    arm = merged_arm(chain)
    assert arm.rows.shape == (joints, chain.n)
    q = np.random.default_rng(0).uniform(-2.0, 2.0, (50, chain.n))
    poses = forward_kinematics(arm.chain, q @ arm.rows.T)
    np.testing.assert_allclose(poses, forward_kinematics(chain, q), atol=1e-13)


@pytest.mark.parametrize("part", [0.3, pytest.param(1.0, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    ("chain", "poses", "starts"),
    [
        (coupled("palletizer"), 100, 60),
        (coupled("coupled_finger"), 50, 10),
        (lifter(), 50, 30),
        (coupled("hollow_wrist"), 100, 60),
        (spherical_wrist(), 100, 60),
    ],
    ids=["palletizer", "finger", "lifter", "hollow wrist", "spherical wrist"],
)
def test_all_postures_are_found(chain, poses, starts, part):
    count = round(part * poses)
    for q in np.random.default_rng(4).uniform(chain.lower, chain.upper, (count, chain.n)):
        T = forward_kinematics(chain, q)
        found = inverse_kinematics(chain, T)
        assert (found.status, found.family, found.complete) == (Status.SUCCESS, "coupled", True)
        assert found.position_error.max() < 1e-9
        assert found.orientation_error.max() < 1e-9
        assert ((found.q >= chain.lower) & (found.q <= chain.upper)).all()
        for other in [q, *found_by_newton(chain, T, starts)]:
            assert np.abs(found.q - other).max(axis=1).min() < 1e-6
        for k, one in enumerate(found.q):
            assert (np.abs(found.q[:k] - one).max(axis=1) > 1e-6).all()


def test_a_wrist_of_rounded_angles_is_solved_but_nothing_is_claimed():
    chain = load_robot(HOLLOW.replace("0.6108652381980153", "0.6109"))
    for q in np.random.default_rng(5).uniform(chain.lower, chain.upper, (20, chain.n)):
        found = inverse_kinematics(chain, forward_kinematics(chain, q))
        assert not found.complete
        assert np.abs(found.q - q).max(axis=1).min() < 1e-6


def test_what_has_no_closed_form_is_searched():
    chain = load_robot(HOLLOW.replace('multiplier="-1"', 'multiplier="-0.7"'))
    q = np.array([0.3, -0.4, 0.2, 0.5, 0.8, -0.6])
    found = inverse_kinematics(chain, forward_kinematics(chain, q), seed=q)
    assert (found.status, found.family, found.complete) == (Status.SUCCESS, "iterative", False)
    np.testing.assert_allclose(found.q[0], q, atol=1e-6)


def test_without_limits_not_all_windings_are_tried_and_all_are_not_claimed():
    chain = coupled("coupled_finger")
    T = forward_kinematics(chain, chain.midrange())
    found = inverse_kinematics(chain, T, respect_limits=False)
    assert (found.family, found.complete, len(found) > 0) == ("coupled", False, True)


def test_a_hollow_wrist_is_no_plain_one():
    """Its arm has six drives, and the first three of its four axes meet."""
    chain, twist = spherical_wrist(), np.arange(1.0, 7.0)
    q = [0.3, -0.4, 0.2, 0.5, 0.8, -0.6]
    np.testing.assert_allclose(jacobian(chain, q) @ joint_rates(chain, q, twist), twist, atol=1e-9)


def test_reasons_speak_of_drives():
    chain = coupled("palletizer")
    middle = forward_kinematics(chain, chain.midrange())
    far = middle.copy()
    far[0, 3] += 2.0
    found = inverse_kinematics(chain, far)
    assert (found.status, found.complete) == (Status.OUT_OF_REACH, True)
    tilted = inverse_kinematics(chain, middle @ TURNED)
    assert (tilted.status, tilted.complete) == (Status.ORIENTATION_UNREACHABLE, True)
    assert "1.5708 rad away" in tilted.reason
    q = chain.midrange()
    q[1:3] = 0.5, 1.45
    beyond = inverse_kinematics(chain, forward_kinematics(chain, q))
    assert (beyond.status, beyond.complete) == (Status.LIMITS_EXCLUDE_ALL, True)
    assert beyond.blocking_joints == ("fore",)
    np.testing.assert_allclose(beyond.blocking_excess, [0.05], atol=1e-9)


def test_a_batch_gives_what_single_poses_give():
    chain = coupled("palletizer")
    postures = np.random.default_rng(6).uniform(chain.lower, chain.upper, (5, chain.n))
    q, count, status = inverse_kinematics_batch(chain, forward_kinematics(chain, postures))
    assert (status == 0).all()
    for k, one in enumerate(postures):
        assert np.abs(q[k, : count[k]] - one).max(axis=1).min() < 1e-9


def test_a_part_of_the_pose_is_searched():
    chain, q = coupled("palletizer"), [0.4, 0.6, 0.5, 0.2]
    T = forward_kinematics(chain, q)
    found = inverse_kinematics(chain, T @ TURNED, task_mask=[True] * 3 + [False] * 3)
    assert found.status is Status.SUCCESS
    tips = forward_kinematics(chain, found.q)[:, :3, 3]
    np.testing.assert_allclose(tips, np.tile(T[:3, 3], (len(tips), 1)), atol=1e-9)
    whole = inverse_kinematics(chain, T, task_mask=[True] * 3 + [False, False, True])
    assert np.abs(whole.q - q).max(axis=1).min() < 1e-6
