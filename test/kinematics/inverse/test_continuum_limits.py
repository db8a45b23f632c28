"""Postures that stand for a continuum, where joint limits decide which of them will do."""

import numpy as np
import pytest

from robomech_ros.kinematics import Status, forward_kinematics, inverse_kinematics
from robomech_ros.robots import chain_from_dh

HALF = np.pi / 2
PUMA = {
    "a": [0, 0.4318, 0.0203, 0, 0, 0],
    "b": [0, 0, 0.15005, 0.4318, 0, 0],
    "alpha": [HALF, 0, -HALF, HALF, -HALF, 0],
}
WRIST_LIMITS = np.array(
    [[-2.8, 2.8], [-2.0, 2.0], [-2.5, 2.5], [-1.5, 1.2], [-2.0, 2.0], [-0.8, 0.9]]
)


@pytest.fixture(scope="module")
def narrow_wrist():
    return chain_from_dh(**PUMA, limits=WRIST_LIMITS)


def nearest_allowed(chain, q, seed):
    """Distance from the seed of the nearest q_4 for which q_6 keeps its limits, by trying many."""
    q4 = np.linspace(chain.lower[3], chain.upper[3], 20_001)
    q6 = np.angle(np.exp(1j * (q[3] + q[5] - q4)))
    return np.abs(q4 - seed[3])[(q6 >= chain.lower[5]) & (q6 <= chain.upper[5])].min()


def test_a_singular_wrist_turns_into_the_limits_of_both_its_joints(narrow_wrist):
    rng = np.random.default_rng(0)
    turned = 0
    for _ in range(200):
        q, seed = rng.uniform(WRIST_LIMITS[:, 0], WRIST_LIMITS[:, 1], (2, 6))
        q[4] = 0.0
        result = inverse_kinematics(narrow_wrist, forward_kinematics(narrow_wrist, q), seed=seed)
        assert result.status is Status.SUCCESS and result.continuum and not result.complete
        assert result.limit_margin.min() >= 0.0
        assert max(result.position_error.max(), result.orientation_error.max()) < 1e-9
        same_arm = np.abs(result.q[:, :3] - q[:3]).max(axis=1) < 1e-6
        (found,) = result.q[same_arm]
        away = abs(found[3] - seed[3])
        assert away == pytest.approx(nearest_allowed(narrow_wrist, q, seed), abs=2e-4)
        turned += away > 1e-9
    assert turned > 50


def test_a_free_shoulder_turns_until_the_wrist_is_inside_its_limits():
    limits = np.array([[-2.8, 2.8], [-3, 3], [-6, 6], [-0.6, 0.6], [-2, 2], [-0.8, 0.9]])
    chain = chain_from_dh(
        [0, 0.4, 0, 0, 0, 0],
        [0.5, 0, 0, 0.4, 0, 0.1],
        [HALF, 0, HALF, -HALF, HALF, 0],
        limits=limits,
    )
    rng = np.random.default_rng(1)
    for _ in range(50):
        q, seed = rng.uniform(limits[:, 0], limits[:, 1], (2, 6))
        q[2] = np.angle(np.exp(1j * (3 * HALF - 2 * q[1])))  # the wrist centre on axis 1
        result = inverse_kinematics(chain, forward_kinematics(chain, q), seed=seed)
        assert result.status is Status.SUCCESS and result.continuum
        assert any("shoulder-singular" in branch for branch in result.branches)
        assert result.limit_margin.min() >= 0.0
        assert max(result.position_error.max(), result.orientation_error.max()) < 1e-9


def test_a_continuum_outside_the_limits_is_one(narrow_wrist):
    q = np.array([0.3, -0.4, 0.5, 1.2, 0.0, 0.9])
    T = forward_kinematics(narrow_wrist, q + [0, 0, 0, 0, 0, 0.5])
    result = inverse_kinematics(narrow_wrist, T)
    assert not any(np.abs(found[:3] - q[:3]).max() < 1e-6 for found in result.q)
    assert not result.complete
    if not len(result):
        assert result.status is Status.SINGULAR_CONTINUUM
        assert "a continuum of postures exists" in result.reason
        assert set(result.blocking_joints) <= set(narrow_wrist.joint_names)
