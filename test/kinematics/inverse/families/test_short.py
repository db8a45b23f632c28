"""Arms of one to five joints: all their solutions, or how near they come."""

import numpy as np
import pytest

from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.robots import chain_from_dh, load_robot

HALF = np.pi / 2
TYPES = ["R", "P", "RR", "RP", "PR", "RRR", "PRR", "RPR", "RRP", "PPR", "RPP",
         "RRRR", "PRPR", "RRPR", "RPRP", "PRRP", "PRPP"]  # fmt: skip
# Without any special geometry.
SKEW_FIVE = ["RRRRR", "PRRRR", "RRPRR", "RRRRP", "PRRRP", "RPRPR", "PRPRP"]
FIVE = {
    "vx300": None,
    "roll-at-the-end": ([0, 0.4, 0.3, 0, 0], [0.3, 0, 0, 0, 0.2], [HALF, 0, 0, HALF, 0]),
    "offsets": ([0.1, 0.4, 0.3, 0.1, 0.05], [0.3, 0, 0, 0.1, 0.1], [HALF, 0, 0, HALF, 0.4]),
    "meeting-last": ([0.1, 0.4, 0.2, 0, 0.1], [0.3, 0.1, 0.2, 0.3, 0.1], [1.2, 0.7, 1.4, 1.1, 0]),
    "meeting-first": ([0, 0.4, 0.2, 0.3, 0.1], [0.3, 0.1, 0.2, 0.3, 0.1], [1.2, 0.7, 1.4, 1.1, 0]),
}  # fmt: skip


def make(name):
    if name in FIVE and FIVE[name] is not None:
        return chain_from_dh(*FIVE[name])
    if name == "spherical":
        return chain_from_dh([0, 0, 0.2], [0, 0, 0.3], [HALF, -HALF, 0.3])
    if name == "planar-slide":
        return chain_from_dh([0.3, 0, 0.2], [0, 0, 0], [HALF, -HALF, 0], types="RPR")
    if set(name) <= {"R", "P"}:
        n = len(name)
        rng = np.random.default_rng([n, *map(ord, name)])
        a, b, alpha = rng.uniform(0.1, 0.5, n), rng.uniform(-0.3, 0.3, n), rng.uniform(0.4, 2.5, n)
        return chain_from_dh(a, b, alpha, types=name)
    return load_robot(name)


ARMS = [*TYPES, *SKEW_FIVE, *FIVE, "planar3r", "scara", "spherical", "planar-slide"]


def random_postures(chain, count, seed):
    rng = np.random.default_rng(seed)
    half = np.where(chain.types == 1, 0.5, np.pi)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -half)
    upper = np.where(np.isfinite(chain.upper), chain.upper, half)
    return rng.uniform(lower, upper, (count, chain.n))


@pytest.mark.parametrize("name", ARMS)
def test_generating_postures_are_found(name, pose_errors, apart):
    chain = make(name)
    assert family_of(chain).name == "short"
    q = random_postures(chain, 300, 1)
    T = forward_kinematics(chain, q)
    found, count, status = inverse_kinematics_batch(chain, T)
    assert (status == Status.SUCCESS).all()
    for k, posture in enumerate(q):
        assert apart(chain, found[k, : count[k]], posture).min() < 1e-6
        assert pose_errors(chain, T[k], found[k, : count[k]]).max() < 1e-9
    assert inverse_kinematics(chain, T[0]).complete


@pytest.mark.parametrize("name", ARMS)
def test_joints_at_multiples_of_ninety_degrees(name, pose_errors, apart):
    chain = make(name)
    rng = np.random.default_rng(2)
    for _ in range(200):
        q = rng.integers(-1, 3, chain.n) * np.where(chain.types == 1, 0.1, HALF)
        T = forward_kinematics(chain, q)
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.status is Status.SUCCESS
        assert pose_errors(chain, T, result.q).max() < 2e-9
        assert result.continuum or apart(chain, result.q, q).min() < 1e-5


@pytest.mark.parametrize("name", ARMS)
def test_what_an_independent_search_finds(name, search_everywhere, apart):
    chain = make(name)
    targets = forward_kinematics(chain, random_postures(chain, 5, 3))
    found = search_everywhere(chain, targets, starts=100, steps=60)
    for T, oracle in zip(targets, found, strict=True):
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert len(result) == len(oracle)
        for one in oracle:
            assert apart(chain, result.q, one).min() < 1e-6


@pytest.mark.parametrize("offset", [0.0, 3e-6, -3e-6])
def test_a_forearm_that_nearly_passes_through_the_elbow(offset, apart):
    """Quanser QArm: an offset of 3e-6 m keeps the roll axis and the elbow from meeting."""
    alpha = [-HALF, 0.0, -HALF, 0.0]
    chain = chain_from_dh([0.0, 0.35, offset, 0.0], [0.14, 0.0, 0.0, 0.24], alpha)
    for q in random_postures(chain, 300, 4):
        result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
        assert result.status is Status.SUCCESS
        assert apart(chain, result.q, q).min() < 1e-6


def test_planar_arm_by_hand():
    """Two circles: elbow up and elbow down, the tool's heading given."""
    chain = load_robot("planar3r")
    q = np.array([0.4, 0.9, -0.3])
    result = inverse_kinematics(chain, forward_kinematics(chain, q), seed=q)
    assert len(result) == 2 and result.complete
    np.testing.assert_allclose(result.q[0], q, atol=1e-9)
    elbow = np.array([1.0 * np.exp(0.4j), 0.8 * np.exp(1.3j)]).sum()
    mirrored = 2 * np.angle(elbow) - 0.4
    np.testing.assert_allclose(result.q[1, :2], [mirrored, -0.9], atol=1e-9)
    np.testing.assert_allclose(result.q[1].sum(), q.sum(), atol=1e-9)


def test_scara_by_hand():
    chain = load_robot("scara")
    q = np.array([0.3, -0.8, 0.05, 0.6])
    result = inverse_kinematics(chain, forward_kinematics(chain, q), seed=q)
    np.testing.assert_allclose(result.q[0], q, atol=1e-9)
    free = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
    assert len(free) == 2
    np.testing.assert_allclose(sorted(free.q[:, 1]), [-0.8, 0.8], atol=1e-9)
    np.testing.assert_allclose(free.q[:, 2], 0.05, atol=1e-12)


@pytest.mark.parametrize("name", ["vx300", "scara", "planar3r", "RRR"])
def test_a_pose_that_cannot_be_taken_is_told_with_the_nearest_posture(name):
    chain = make(name)
    q = random_postures(chain, 10, 4)
    for posture, T in zip(q, forward_kinematics(chain, q), strict=True):
        c, s = np.cos(0.05), np.sin(0.05)
        T[:3, :3] = T[:3, :3] @ [[c, 0, s], [0, 1, 0], [-s, 0, c]]
        T[:3, 3] += [0.01, -0.02, 0.03]
        result = inverse_kinematics(chain, T)
        assert not len(result)
        assert result.status in (Status.OUT_OF_REACH, Status.ORIENTATION_UNREACHABLE)
        assert (result.nearest >= chain.lower).all() and (result.nearest <= chain.upper).all()
        said = result.reason.split("misses by ")[1].split()
        pose = forward_kinematics(chain, result.nearest)
        away = np.linalg.norm(pose[:3, 3] - T[:3, 3])
        angle = np.arccos(np.clip((np.trace(pose[:3, :3].T @ T[:3, :3]) - 1) / 2, -1, 1))
        assert float(said[0]) == pytest.approx(away, rel=1e-4, abs=1e-9)
        assert float(said[3]) == pytest.approx(angle, rel=1e-3, abs=1e-6)
        size = np.linalg.norm(chain.packed[:, 10:], axis=1).sum()
        given = np.hypot(0.05, np.linalg.norm([0.01, -0.02, 0.03]) * 2 / size)
        assert np.hypot(angle, away * 2 / size) <= given * np.sqrt(2) + 1e-9
        assert len(posture) == chain.n


def test_a_reachable_pose_has_no_nearest_posture():
    chain = load_robot("vx300")
    assert inverse_kinematics(chain, forward_kinematics(chain, np.zeros(5))).nearest is None


def test_a_timeout_holds_for_the_nearest_posture_as_well(counted_search):
    chain = load_robot("vx300")
    T = forward_kinematics(chain, np.zeros(5))
    T[0, 3] += 3.0
    whole = inverse_kinematics(chain, T, timeout=1e6)
    looks = counted_search.looks
    assert whole.nearest is not None
    for timeout in range(1, looks, 5):
        counted_search.forget()
        inverse_kinematics(chain, T, timeout=timeout)
        assert counted_search.looks <= timeout + 4


def test_a_joint_on_the_line_of_another_is_a_continuum(pose_errors):
    """Two axes on one line turn against each other while the tip stays."""
    chain = chain_from_dh([0, 0, 0.3], [0.2, 0.1, 0.1], [0, HALF, 0.2])
    T = forward_kinematics(chain, [0.2, 0.4, 0.5])
    result = inverse_kinematics(chain, T)
    assert len(result) and not result.complete
    assert pose_errors(chain, T, result.q).max() < 2e-9


FIVE_AND_FEWER = [*FIVE, *SKEW_FIVE, "RRRR", "RRPR", "scara", "planar3r", "spherical"]


@pytest.mark.parametrize("digits", [6, 8])
@pytest.mark.parametrize("name", FIVE_AND_FEWER)
def test_rounded_poses_have_the_solutions_of_exact_ones(name, digits, apart):
    """The vx300 solved none of 60 rounded poses."""
    chain = make(name)
    targets = forward_kinematics(chain, random_postures(chain, 40, 31))
    rounded = np.round(targets, digits)
    batch, counts, _ = inverse_kinematics_batch(chain, rounded)
    for k, exact in enumerate(targets):
        wanted, found = inverse_kinematics(chain, exact), inverse_kinematics(chain, rounded[k])
        assert found.status is Status.SUCCESS and len(found) == len(wanted) == counts[k]
        assert found.complete == wanted.complete
        assert found.position_error.max() < 1e-5 and found.orientation_error.max() < 1e-4
        for one in wanted.q:
            assert apart(chain, found.q, one).min() < 1e-2
        assert batch[k, : counts[k]].tobytes() == found.q.tobytes()


def test_a_pose_typed_with_six_digits_is_solved_and_its_errors_are_told():
    chain = load_robot("vx300")
    T = np.round(forward_kinematics(chain, [0.3, -0.4, 0.7, 0.2, 0.6]), 6)
    found = inverse_kinematics(chain, T)
    assert found.complete and 1e-9 < found.orientation_error.max() < 1e-5
    strict = {"position_tolerance": 1e-9, "orientation_tolerance": 1e-9}
    assert not len(inverse_kinematics(chain, T, **strict))


@pytest.mark.parametrize("name", ["vx300", "scara", "planar3r"])
def test_poses_that_are_missed_by_more_than_the_tolerances_have_no_solution(name):
    chain = make(name)
    for T in forward_kinematics(chain, random_postures(chain, 10, 32)):
        c, s = np.cos(3e-3), np.sin(3e-3)
        T[:3, :3] = [[c, 0.6 * s, 0.8 * s], [-0.6 * s, 0.36 * c + 0.64, 0.48 * (c - 1.0)],
                     [-0.8 * s, 0.48 * (c - 1.0), 0.64 * c + 0.36]] @ T[:3, :3]  # fmt: skip
        found = inverse_kinematics(chain, T)
        assert (found.position_error < 1e-5).all() and (found.orientation_error < 1e-4).all()
        if not len(found):
            assert "misses by" in found.reason
