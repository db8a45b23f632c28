"""Arms of six revolute joints without special geometry: every solution."""

import numpy as np
import pytest
from general_arms import NEAR, ROBOTS, TABLES, general_arm, random_postures

from robomech_ros._kernels.inverse.general.solutions import try_forms
from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.inverse.families.general import match
from robomech_ros.robots import chain_from_dh

ARMS = (*ROBOTS, *TABLES)
GOLDEN = (
    "ik6r_diestro_generic",
    "ik6r_fanuc_arcmate_generic",
    "ik6r_manocha_canny_16",
    "ik6r_manocha_code_ex2",
    "ik6r_tsai_morgan_3",
)


def pose_of(case):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = case["R"], case["p"]
    return T


@pytest.mark.parametrize("name", GOLDEN)
def test_published_arms_have_exactly_the_published_solutions(golden, apart, name):
    case = golden(name)
    chain = chain_from_dh(case["a"], case["b"], case["alpha"])
    result = inverse_kinematics(chain, pose_of(case), respect_limits=False)
    assert result.family == "general-6r" and result.complete
    assert len(result) == case["n_real"] == len(case["solutions"])
    for posture in case["solutions"]:
        assert apart(chain, result.q, posture).min() < 1e-9


def test_sixteen_solutions_of_a_second_arm(apart):
    """Sample of D. Manocha's program: pose with six digits, first joint of one printed solution."""
    chain = general_arm("manocha-code")
    T = np.eye(4)
    T[:3, :3] = [
        [-0.357279, -0.85, 0.387106],
        [0.915644, -0.237, 0.324694],
        [-0.184246, 0.470458, 0.862973],
    ]
    u, _, v = np.linalg.svd(T[:3, :3])
    T[:3, :3] = u @ v
    T[:3, 3] = [0.798811, -0.000331, 1.200658]
    result = inverse_kinematics(chain, T, respect_limits=False)
    assert len(result) == 16 and result.complete
    distance = apart(chain, result.q[:, None], result.q[None]) + 9.0 * np.eye(16)
    assert distance.min() > 1e-2
    assert max(result.position_error.max(), result.orientation_error.max()) < 1e-12


@pytest.mark.parametrize("name", ["ik6r_diestro_recalled_pose", "ik6r_fanuc_arcmate_recalled_pose"])
def test_singular_solutions_are_given_once(golden, apart, name):
    case = golden(name)
    chain = chain_from_dh(case["a"], case["b"], case["alpha"])
    result = inverse_kinematics(chain, pose_of(case), respect_limits=False)
    for posture in case["solutions"]:
        assert apart(chain, result.q, posture).min() < 1e-9
    for posture in case["singular_solutions"]:
        assert (apart(chain, result.q, posture) < 1e-2).sum() == 1
    assert len(result) == len(case["solutions"]) + len(case["singular_solutions"])
    assert sum("at-boundary" in branch for branch in result.branches) == len(
        case["singular_solutions"]
    )


def check_generating(chain, postures, apart, pose_errors):
    targets = forward_kinematics(chain, postures)
    solutions, counts, status = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (counts > 0).all() and (status == 0).all()
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < 1e-9 and np.quantile(errors, 0.99) < 1e-12
    distance = apart(chain, np.where(rows[:, :, None], solutions, 9.0), postures[:, None, :])
    worst = np.where(rows, distance, np.inf).min(axis=1)
    assert worst.max() < 1e-6, postures[worst.argmax()]


@pytest.mark.parametrize("name", ARMS)
def test_generating_postures(apart, pose_errors, name):
    check_generating(general_arm(name), random_postures(1000, 1), apart, pose_errors)


@pytest.mark.parametrize("number", range(100))
def test_generating_postures_of_random_tables(apart, pose_errors, number):
    chain = general_arm(f"random-{number}")
    check_generating(chain, random_postures(100, number), apart, pose_errors)


@pytest.mark.long
@pytest.mark.parametrize("number", range(100))
def test_generating_postures_of_random_tables_at_length(apart, pose_errors, number):
    chain = general_arm(f"random-{number}")
    check_generating(chain, random_postures(1000, 100 + number), apart, pose_errors)


@pytest.mark.parametrize("name", NEAR)
def test_nearly_special_arms_lose_nothing(apart, pose_errors, name):
    check_generating(general_arm(name), random_postures(200, 2), apart, pose_errors)


@pytest.mark.long
@pytest.mark.parametrize("name", NEAR)
def test_nearly_special_arms_lose_nothing_at_length(apart, pose_errors, name):
    check_generating(general_arm(name), random_postures(2000, 12), apart, pose_errors)


@pytest.mark.parametrize("name", (*ARMS, "random-3", "near-wrist-1e-04", "near-parallel-1e-04"))
def test_random_poses_are_proved_complete(name):
    chain = general_arm(name)
    for T in forward_kinematics(chain, random_postures(50, 3)):
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.complete and result.family == "general-6r"
        assert len(result) % 2 == 0  # as real zeros of a trigonometric polynomial are


@pytest.mark.slow
@pytest.mark.parametrize("count", [12, pytest.param(50, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", (*ARMS, "random-0", "random-1", *NEAR[::4]))
def test_nothing_missing_and_nothing_spurious(search_everywhere, apart, name, count):
    chain = general_arm(name)
    targets = forward_kinematics(chain, random_postures(count, 4))
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    for k, postures in enumerate(search_everywhere(chain, targets)):
        ours = solutions[k, : counts[k]]
        nearest = apart(chain, ours, postures[:, None]).min(axis=1)
        assert nearest.max(initial=0.0) < 1e-6, (name, k, postures[nearest.argmax()])
        distance = apart(chain, ours[:, None], ours[None]) + 9.0 * np.eye(len(ours))
        assert distance.min() > 1e-6


def test_out_of_reach():
    chain = general_arm("general6r")
    T = np.eye(4)
    T[:3, 3] = [9.0, 0.0, 0.0]
    result = inverse_kinematics(chain, T)
    assert result.status is Status.OUT_OF_REACH and result.complete


def test_limits_select():
    chain = general_arm("fanuc_arcmate")
    T = forward_kinematics(chain, [0.4, 0.9, -0.6, 0.5, 1.1, -0.8])
    everything = inverse_kinematics(chain, T, respect_limits=False)
    inside = inverse_kinematics(chain, T, seed=everything.q[0], max_solutions=1)
    assert len(everything) == 8 and len(inside) == 1
    np.testing.assert_allclose(inside.q[0], everything.q[0], atol=1e-12)
    assert len(set(everything.branches)) == 8


def test_same_request_same_bytes():
    chain = general_arm("random-5")
    targets = forward_kinematics(chain, random_postures(50, 7))
    one = inverse_kinematics_batch(chain, targets, respect_limits=False)
    other = inverse_kinematics_batch(chain, targets.copy(), respect_limits=False)
    for a, b in zip(one, other, strict=True):
        assert a.tobytes() == b.tobytes()


def test_size_does_not_matter():
    """The same arm a thousand times smaller and larger."""
    small, large = (
        chain_from_dh(np.array([0.3, 0.5, 0.2, 0.4, 0.1, 0.2]) * s,
                      np.array([0.1, 0.2, -0.3, 0.2, 0.4, 0.1]) * s,
                      [1.0, -0.7, 1.9, 0.6, -1.2, 0.3])
        for s in (1e-3, 1e3)
    )  # fmt: skip
    for q in random_postures(30, 8):
        one = inverse_kinematics(small, forward_kinematics(small, q), seed=q, respect_limits=False)
        other = inverse_kinematics(
            large, forward_kinematics(large, q), seed=q, respect_limits=False
        )
        assert len(one) == len(other) and one.complete and other.complete
        np.testing.assert_allclose(one.q[0], q, atol=1e-8)
        np.testing.assert_allclose(other.q[0], q, atol=1e-8)


def test_an_arm_that_hardly_moves_in_all_directions_claims_nothing():
    """Two links of a few micrometres: solutions that exist are lost in rounding."""
    a = [-2.02e-06, 8.83e-05, 0.0, 0.0, 0.3, 0.0]
    b = [-0.2, 0.48, 0.3, -0.417, -0.209, 0.0]
    chain = chain_from_dh(a, b, [np.pi, 0.0, -5.37e-4, 1.5708073637, np.pi, -0.764])
    rng = np.random.default_rng(0)
    for q in rng.uniform(-3.0, 3.0, (20, 6)):
        result = inverse_kinematics(chain, forward_kinematics(chain, q))
        assert not result.complete


@pytest.mark.parametrize("name", [*ROBOTS, "random-0"])
def test_hardly_a_pose_needs_a_second_sampling(name):
    """The first form is the one with the least effort; this keeps the slowest poses fast."""
    chain = general_arm(name)
    data = match(chain)
    spent = []
    for q in random_postures(200, 21):
        clean, effort = try_forms(data, forward_kinematics(chain, q), np.zeros(6))
        assert clean
        spent.append(effort)
    assert np.mean(spent) < 3.0 and np.quantile(spent, 0.98) < 20
