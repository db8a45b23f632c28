"""Arms of six joints, one to three of them prismatic anywhere, without special geometry."""

import itertools

import numpy as np
import pytest

from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh

TYPES = [
    "".join("P" if joint in slides else "R" for joint in range(6))
    for count in (1, 2, 3)
    for slides in itertools.combinations(range(6), count)
]
MOST = {1: 16, 2: 8, 3: 2}
FEW = ["PRRRRR", "RPRRRR", "RRPRRR", "RRRRRP", "PRRRRP", "RPPRRR", "RRPRPR", "PRPRPR", "RRRPPP"]


def arm(types, number=0):
    """A chain with links turned and shifted at random."""
    rng = np.random.default_rng([number, *map(ord, types)])
    links = np.tile(np.eye(4), (7, 1, 1))
    for link in links:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        link[:3, :3] = turn * np.linalg.det(turn)
        link[:3, 3] = rng.uniform(-0.4, 0.4, 3)
    return chain_of(links, [int(kind == "P") for kind in types])


def random_postures(chain, count, seed):
    half = np.where(chain.types == 1, 0.5, np.pi)
    return np.random.default_rng(seed).uniform(-half, half, (count, 6))


def check_generating(chain, postures, apart, pose_errors):
    targets = forward_kinematics(chain, postures)
    solutions, counts, status = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (counts > 0).all() and (status == 0).all()
    assert counts.max() <= MOST[int(chain.types.sum())]
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < 1e-9
    distance = apart(chain, np.where(rows[:, :, None], solutions, 9.0), postures[:, None, :])
    worst = np.where(rows, distance, np.inf).min(axis=1)
    assert worst.max() < 1e-6, postures[worst.argmax()]
    for k, count in enumerate(counts):
        q = solutions[k, :count]
        assert (apart(chain, q[:, None], q[None]) + 9.0 * np.eye(count)).min() > 1e-6


@pytest.mark.parametrize("types", TYPES)
def test_generating_postures(apart, pose_errors, types):
    check_generating(arm(types), random_postures(arm(types), 100, 1), apart, pose_errors)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(100))
def test_generating_postures_of_a_hundred_arms(apart, pose_errors, number):
    types = TYPES[number % len(TYPES)]
    chain = arm(types, 1 + number)
    check_generating(chain, random_postures(chain, 200, number), apart, pose_errors)


@pytest.mark.parametrize("types", FEW)
def test_random_poses_are_proved_complete(types):
    chain = arm(types)
    for T in forward_kinematics(chain, random_postures(chain, 50, 2)):
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.complete and result.family == "general-6"
        assert len(result) % 2 == 0  # as real zeros of a trigonometric polynomial are


def check_nothing_missing(chain, count, search_everywhere, apart, starts):
    targets = forward_kinematics(chain, random_postures(chain, count, 3))
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    oracle = search_everywhere(chain, targets, starts=starts, steps=60)
    for k, postures in enumerate(oracle):
        nearest = apart(chain, solutions[k, : counts[k]], postures[:, None]).min(axis=1)
        assert nearest.max(initial=0.0) < 1e-6, (k, postures[nearest.argmax()])


@pytest.mark.parametrize("types", ["RPRRRR", "PRRPRR", "RPRPRP"])
def test_nothing_is_missing(search_everywhere, apart, types):
    check_nothing_missing(arm(types), 3, search_everywhere, apart, 200)


@pytest.mark.slow
@pytest.mark.parametrize("count", [3, pytest.param(10, marks=pytest.mark.long)])
@pytest.mark.parametrize("types", TYPES)
def test_nothing_is_missing_at_length(search_everywhere, apart, types, count):
    check_nothing_missing(arm(types, 7), count, search_everywhere, apart, 400)


@pytest.mark.parametrize("types", FEW)
def test_right_angles(apart, types):
    """Poses with joints at multiples of 90 degrees: nothing spurious, every regular posture."""
    rng = np.random.default_rng(4)
    a, b = rng.uniform(0.1, 0.5, 6), rng.uniform(-0.3, 0.3, 6)
    chain = chain_from_dh(a, b, rng.choice([-0.5, 0.5], 6) * np.pi, types=types)
    postures = rng.integers(-1, 3, (60, 6)) * np.where(chain.types == 1, 0.1, np.pi / 2)
    values = np.linalg.svd(jacobian(chain, postures), compute_uv=False)
    for q, regular in zip(postures, values[:, -1] > 1e-3 * values[:, 0], strict=True):
        result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
        assert result.position_error.max(initial=0.0) < 1e-9
        assert not regular or apart(chain, result.q, q).min() < 1e-6, q


def test_size_does_not_matter():
    rng = np.random.default_rng(5)
    a, b, alpha = rng.uniform(0.1, 0.5, 6), rng.uniform(-0.3, 0.3, 6), rng.uniform(0.4, 2.5, 6)
    for types in ("RRPRRR", "PRRRPR"):
        unit = chain_from_dh(a, b, alpha, types=types)
        for scale in (1e-2, 1e2):
            chain = chain_from_dh(scale * a, scale * b, alpha, types=types)
            for q in random_postures(unit, 20, 6):
                scaled = q * np.where(chain.types == 1, scale, 1.0)
                one = inverse_kinematics(unit, forward_kinematics(unit, q), respect_limits=False)
                T = forward_kinematics(chain, scaled)
                other = inverse_kinematics(chain, T, seed=scaled, respect_limits=False)
                assert len(one) == len(other) and other.complete
                np.testing.assert_allclose(other.q[0], scaled, atol=1e-8 * max(scale, 1.0))


def test_a_pose_that_cannot_be_taken():
    """Three slides and three skew axes reach every position, but not in every orientation."""
    chain = arm("PRPRPR")
    far = forward_kinematics(chain, np.array([5.0, 0.3, -7.0, 0.5, 6.0, -0.4]))
    assert len(inverse_kinematics(chain, far, respect_limits=False)) == 2
    missed = 0
    for T in forward_kinematics(chain, random_postures(chain, 30, 7)):
        T[:3, :3] = T[:3, :3][:, [1, 2, 0]]
        result = inverse_kinematics(chain, T, respect_limits=False)
        missed += not len(result)
        if not len(result):
            assert result.status is Status.ORIENTATION_UNREACHABLE and result.complete
    assert missed


def test_two_postures_that_are_nearly_one(apart):
    """Near a fold of an arm with three slides both are given, down to 1e-4 rad of each other."""
    chain = arm("RPPRRP", 1)
    q = random_postures(chain, 200, 1)[166]
    result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
    assert len(result) == 2 and result.complete
    assert apart(chain, result.q, q).min() < 1e-7
    assert 1e-5 < apart(chain, *result.q) < 1e-2


def test_same_request_same_bytes():
    chain = arm("RRPRRR")
    T = forward_kinematics(chain, random_postures(chain, 30, 8))
    one = inverse_kinematics_batch(chain, T, respect_limits=False)
    other = inverse_kinematics_batch(chain, T.copy(), respect_limits=False)
    for a, b in zip(one, other, strict=True):
        assert a.tobytes() == b.tobytes()
