"""Searches with loose tolerances, partial tasks, far targets and little time."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros.hands import load_hand
from robomech_ros.kinematics import Status, forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.inverse.result.reach import reach_gap
from robomech_ros.robots import chain_from_dh, load_robot

X_Y_RZ = (True, True, False, False, False, True)


def pose_at(*position):
    T = np.eye(4)
    T[:3, 3] = position
    return T


def random_targets(chain, count, seed):
    rng = np.random.default_rng(seed)
    lower, upper = np.maximum(chain.lower, -3.0), np.minimum(chain.upper, 3.0)
    return forward_kinematics(chain, rng.uniform(lower, upper, (count, chain.n)))


@pytest.mark.parametrize("name", ["planar3r", "scara", "fanuc_arcmate", "general6r"])
def test_a_loose_tolerance_gives_no_near_duplicates(name, apart):
    """Solutions near each other are all exact ones: two, not one and its neighbourhood."""
    chain = load_robot(name)
    for T in random_targets(chain, 30, 1):
        result = inverse_kinematics(chain, T, position_tolerance=1e-2, orientation_tolerance=1e-2)
        assert result.position_error.max() <= 1e-2 and result.orientation_error.max() <= 1e-2
        loose = (result.position_error > 1e-9) | (result.orientation_error > 1e-9)
        distance = apart(chain, result.q[:, None], result.q[None]) + 9.0 * np.eye(len(result))
        assert distance[loose].min(initial=9.0) > 0.1


@pytest.mark.parametrize("name", ["planar3r", "scara", "fanuc_arcmate"])
def test_a_loose_tolerance_loses_no_exact_solution(name, apart):
    chain = load_robot(name)
    lost = total = 0
    for T in random_targets(chain, 30, 2):
        exact = inverse_kinematics(chain, T).q
        loose = inverse_kinematics(chain, T, position_tolerance=1e-3, orientation_tolerance=1e-3).q
        nearest = apart(chain, exact[:, None], loose[None]).min(axis=1)
        total += len(exact)
        lost += (nearest > 0.2).sum()
    assert lost <= 0.05 * total


@pytest.mark.parametrize(
    ("mask", "position", "missing"),
    [
        (X_Y_RZ, (9.0, 0.0, 0.0), 6.7),
        (X_Y_RZ, (0.0, -3.0, 7.0), 0.7),
        ((True, False, False, False, False, False), (9.0, 0.0, 0.0), 6.7),
        ((False, False, True, False, False, False), (1.0, 0.5, 3.0), 3.0),
        ((True, True, False, True, False, False), (4.0, 3.0, 1.0), 2.7),
    ],
)
def test_a_partial_task_out_of_reach_says_by_how_much(mask, position, missing):
    chain = load_robot("planar3r")  # 2.3 m long
    result = inverse_kinematics(chain, pose_at(*position), task_mask=mask)
    assert result.status is Status.OUT_OF_REACH and not len(result)
    assert f"out of reach by {missing:.6g} m" in result.reason


def test_a_partial_task_is_along_the_axes_of_the_target():
    """Turned by a right angle about y, the target's x is the height that the arm has not."""
    chain = load_robot("planar3r")
    T = pose_at(1.0, 0.5, 0.4)
    T[:3, :3] = Rotation.from_rotvec([0.0, np.pi / 2, 0.0]).as_matrix()
    height = inverse_kinematics(chain, T, task_mask=(True, False, False, False, False, False))
    assert height.status is Status.OUT_OF_REACH and "by 0.4 m" in height.reason
    assert len(inverse_kinematics(chain, T, task_mask=(False, True, True, False, False, False)))


def test_a_partial_orientation_that_cannot_be_had():
    chain = load_robot("planar3r")
    T = pose_at(1.0, 0.5, 0.0)
    T[:3, :3] = Rotation.from_rotvec([0.4, 0.0, 0.0]).as_matrix()
    result = inverse_kinematics(chain, T, task_mask=(True, True, False, True, True, False))
    assert result.status is Status.ORIENTATION_UNREACHABLE
    assert "0.4 rad away" in result.reason
    gap = reach_gap(chain, T, (False, False, False, True, True, True))
    assert gap.distance == 0.0 and gap.orientation_error == pytest.approx(0.4, abs=1e-6)


@pytest.mark.parametrize("far", [10.0, 1e3, 1e5])
def test_slides_without_limits_follow_a_far_target(far):
    chain = chain_from_dh(
        [0.2, 0.3, 0.0, 0.1, 0.2],
        [0.1, 0.0, 0.2, 0.1, 0.0],
        [0.5, -1.0, 1.2, 0.3, 0.7],
        types="RPRPR",
    )
    rng = np.random.default_rng(3)
    for q in rng.uniform(-1.0, 1.0, (30, 5)):
        q[[1, 3]] *= far
        result = inverse_kinematics(chain, forward_kinematics(chain, q))
        assert result.status is Status.SUCCESS, (q, result.reason)
        assert result.position_error.max() < 1e-9 and result.orientation_error.max() < 1e-9


def test_a_slide_with_one_limit_follows_a_far_target():
    limits = [(-3, 3), (0.1, None), (-3, 3)]
    chain = chain_from_dh([0.3, 0, 0.2], [0, 0, 0], [1.2, -1.2, 0], types="RPR", limits=limits)
    for way in (5.0, 500.0, 5e4):
        T = forward_kinematics(chain, [0.7, way, -0.4])
        result = inverse_kinematics(chain, T)
        assert result.status is Status.SUCCESS and (result.q[:, 1] >= 0.1).all()
        assert result.position_error.max() < 1e-9


def test_a_far_point_is_not_out_of_reach_of_slides():
    chain = chain_from_dh([0.1] * 3, [0.0] * 3, [1.0, -1.3, 0.2], types="RPP")
    assert reach_gap(chain, pose_at(3e3, -2e3, 0.3)).distance == 0.0
    turned = load_robot("planar3r")
    assert reach_gap(turned, pose_at(1e6, 0.0, 0.0)).distance == pytest.approx(1e6 - 2.3)


def test_an_answer_cut_short_says_so():
    """Four conditions for four joints: without a closed form, but with finitely many solutions."""
    chain = chain_from_dh([0.3, 0.2, 0.4, 0.1], [0.1] * 4, [1.2, -0.9, 0.7, 1.1])
    T = forward_kinematics(chain, np.full(4, 0.3))
    task = {"task_mask": [True] * 4 + [False] * 2}
    whole = inverse_kinematics(chain, T, **task)
    hurried = inverse_kinematics(chain, T, seed=np.full(4, 0.3), timeout=1e-9, **task)
    assert hurried.status is Status.SUCCESS and len(hurried) and not hurried.complete
    assert "cut short after 1e-09 s" in hurried.reason and "more solutions" in hurried.reason
    assert whole.reason == "" and len(whole) >= len(hurried)


def test_a_redundant_answer_cut_short_says_both():
    chain = load_robot("panda")
    q = chain.midrange() + 0.2
    T = forward_kinematics(chain, q)
    reasons = {inverse_kinematics(chain, T, seed=q, timeout=1e-9).reason for _ in range(3)}
    # Eight samples may be found before the first look at the clock.
    assert all("form a continuum" in reason for reason in reasons)


COINCIDENT = {
    "two of three": chain_from_dh([0.3, 0.0, 0.2], [0.0, 0.1, 0.0], [0.0] * 3),
    "two of six": chain_from_dh(
        [0.0, 0.0, 0.3, 0.0, 0.0, 0.0],
        [0.3, 0.1, 0.0, 0.3, 0.0, 0.2],
        [0.0, np.pi / 2, 0.0, np.pi / 2, -np.pi / 2, 0.0],
    ),
}


@pytest.mark.parametrize(("name", "moving"), [("two of three", (1, 2)), ("two of six", (0, 1))])
def test_issue_12_arms_with_two_axes_on_one_line_have_a_continuum_everywhere(name, moving):
    """Sixteen of infinitely many postures were listed as if they were all there is to say."""
    chain = COINCIDENT[name]
    q = np.linspace(0.2, 0.9, chain.n)
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, seed=q, respect_limits=False)
    assert result.status is Status.SUCCESS and result.continuum and not result.complete
    first, second = (f"'{chain.joint_names[k]}'" for k in moving)
    assert f"joints {first} and {second} can move while the tip stays" in result.reason
    assert result.reason.endswith("of this continuum these are samples")
    assert all(name.endswith(" self-motion") for name in result.branches)
    assert len(set(result.branches)) == len(result)
    along = np.zeros(chain.n)
    along[list(moving)] = 0.3, -0.3
    np.testing.assert_allclose(forward_kinematics(chain, result.q[0] + along), T, atol=1e-9)


def test_issue_12_a_regular_arm_that_is_searched_has_no_continuum():
    chain = load_robot("planar3r")
    for T in random_targets(chain, 20, 5):
        result = inverse_kinematics(chain, T, task_mask=X_Y_RZ)
        assert len(result) and not result.continuum and not result.reason


def test_a_continuum_of_a_partial_task_is_that_of_the_components_that_count():
    """A finger whose tip is on its first axis was said to move all joints but the first."""
    finger = load_hand("three_fingered").fingers[0]
    T = np.eye(4)
    T[:3, 3] = 0.05, 0.0, 0.08
    result = inverse_kinematics(finger, T, task_mask=[True] * 3 + [False] * 3)
    assert len(result) == 2 and result.continuum
    assert f"'{finger.joint_names[0]}' can move while the tip stays" in result.reason
    assert "in the direction (1, 0, 0)" in result.reason
    for turn in (-0.7, 0.4):
        moved = forward_kinematics(finger, result.q + [turn, 0.0, 0.0])
        assert np.allclose(moved[:, :3, 3], T[:3, 3], rtol=0.0, atol=1e-12)
