"""Redundant arms: samples of the self-motion, the nearest posture, any geometry that allows it."""

import numpy as np
import pytest

from robomech_ros._kernels.inverse.decoupled import layout as wrist_at
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.six_joints import DECOUPLED, DOUBT, GENERAL, six_joint_postures
from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.inverse.redundant_arms.redundancy import Redundancy
from robomech_ros.robots import chain_from_dh, load_robot

HALF = np.pi / 2
ARMS = ["panda", "iiwa14", "gen3", "xarm7", "skew", "rail", "rail-and-panda", "general7r"]
ARMS += ["skew-with-slide", "eight-skew"]


def make(name):
    """A robot of ours, or an arm made up here."""
    if name == "xarm7":
        # Spherical shoulder, offset elbow and wrist, as in the description of the UFACTORY xArm 7.
        a, b = [0, 0, 0.0525, 0.0775, 0, 0.076, 0], [0.267, 0, 0.293, 0, 0.3425, 0, 0.097]
        return chain_from_dh(a, b, np.array([-HALF, HALF, HALF, HALF, HALF, -HALF, 0]))
    if name == "skew":
        # Spherical shoulder and wrist whose axes meet at other angles than the right one.
        a, b = [0, 0, 0.05, -0.04, 0, 0, 0], [0.3, 0, 0.4, 0.03, 0.35, 0, 0.1]
        return chain_from_dh(a, b, [1.2, -1.4, 1.5, -1.7, 1.1, -1.3, 0.4])
    if name == "rail":
        a, b = [0, 0, 0.4318, 0.0203, 0, 0, 0], [0, 0, 0, 0.15, 0.4318, 0, 0.1]
        alpha = [HALF, HALF, 0, -HALF, HALF, -HALF, 0]
        limits = np.array([[-1.0, 1.0], *[[-3.1, 3.1]] * 6])
        return chain_from_dh(a, b, alpha, types="PRRRRRR", limits=limits)
    if name == "rail-and-panda":
        a, b = [0, 0, 0, 0.0825, -0.0825, 0, 0.088, 0], [0, 0.333, 0, 0.316, 0, 0.384, 0, 0.107]
        alpha = [HALF, -HALF, HALF, HALF, -HALF, HALF, HALF, 0]
        limits = np.array([[-1.0, 1.0], *[[-2.8, 2.8]] * 7])
        return chain_from_dh(a, b, alpha, types="PRRRRRRR", limits=limits)
    if name in ("skew-with-slide", "eight-skew"):
        # No axes that meet or are parallel.
        types = "RRRPRRR" if name == "skew-with-slide" else "R" * 8
        n = len(types)
        rng = np.random.default_rng(n)
        a, b, alpha = rng.uniform(0.1, 0.4, n), rng.uniform(-0.3, 0.3, n), rng.uniform(0.5, 2.5, n)
        half = np.where([kind == "P" for kind in types], 0.6, 3.0)
        return chain_from_dh(a, b, alpha, types=types, limits=np.column_stack((-half, half)))
    return load_robot(name)


def constant_transforms(packed):
    C = np.tile(np.eye(4), (len(packed), 1, 1))
    C[:, :3, :3] = packed[:, 1:10].reshape(-1, 3, 3)
    C[:, :3, 3] = packed[:, 10:]
    return C


def random_postures(chain, count, seed):
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    return rng.uniform(lower, upper, (count, chain.n))


@pytest.mark.parametrize(
    ("name", "kind", "first"),
    [
        ("panda", at.LOCKED, 0),
        ("iiwa14", at.ARM_ANGLE, 0),
        ("gen3", at.LOCKED, 1),
        ("xarm7", at.LOCKED, 0),
        ("skew", at.ARM_ANGLE, 0),
        ("rail", at.LOCKED, 1),
        ("rail-and-panda", at.LOCKED, 1),
        ("general7r", at.LOCKED, 0),
        ("skew-with-slide", at.LOCKED, 0),
        ("eight-skew", at.LOCKED, 0),
    ],
)
def test_geometry_decides_what_is_locked(name, kind, first):
    family = family_of(make(name))
    assert family.name == "redundant" and family.redundant
    assert family.data[at.KIND] == kind and family.data[at.FIRST] == first


def check_generating_postures(name, count, pose_errors, apart):
    chain = make(name)
    q = random_postures(chain, count, 1)
    for posture, T in zip(q, forward_kinematics(chain, q), strict=True):
        result = inverse_kinematics(chain, T, seed=posture)
        assert result.status is Status.SUCCESS and not result.complete and result.continuum
        assert apart(chain, result.q, posture).min() < 1e-7
        assert pose_errors(chain, T, result.q).max() < 1e-9
        assert (result.q >= chain.lower).all() and (result.q <= chain.upper).all()
        assert (np.diff(result.seed_distance) >= 0).all()


@pytest.mark.parametrize("name", ARMS)
def test_generating_postures_are_found(name, pose_errors, apart):
    check_generating_postures(name, 60, pose_errors, apart)


@pytest.mark.long
@pytest.mark.parametrize("name", ARMS)
def test_a_thousand_generating_postures_are_found(name, pose_errors, apart):
    check_generating_postures(name, 1000, pose_errors, apart)


@pytest.mark.parametrize("name", ARMS)
def test_every_pose_in_reach_is_answered_from_any_seed(name, pose_errors):
    chain = make(name)
    T = forward_kinematics(chain, random_postures(chain, 100, 2))
    q, count, status = inverse_kinematics_batch(chain, T)
    assert (status == Status.SUCCESS).all() and (count > 0).all()
    for k in range(100):
        assert pose_errors(chain, T[k], q[k, : count[k]]).max() < 2e-9
        assert np.isnan(q[k, count[k] :]).all()


SEVEN = ("panda", "iiwa14", "gen3", "xarm7", "skew", "general7r")


@pytest.mark.slow
@pytest.mark.parametrize("name", SEVEN)
def test_postures_at_right_angles(name, pose_errors):
    """Joints at multiples of 90 degrees: shoulder, elbow and wrist singular, alone and together."""
    chain = make(name)
    for q in np.random.default_rng(3).integers(-1, 3, (200, 7)) * HALF:
        T = forward_kinematics(chain, q)
        for seed in (q, None):
            result = inverse_kinematics(chain, T, seed=seed, respect_limits=False)
            assert result.status is Status.SUCCESS, q
            assert result.continuum and not result.complete
            assert pose_errors(chain, T, result.q).max() < 2e-9
            if seed is not None:
                assert result.seed_distance[0] < 1e-6, q


@pytest.mark.parametrize("name", SEVEN)
def test_postures_at_right_angles_inside_the_limits(name, pose_errors):
    chain = make(name)
    for q in np.random.default_rng(4).integers(-1, 2, (200, 7)) * HALF:
        q = np.clip(q, chain.lower, chain.upper)
        T = forward_kinematics(chain, q)
        result = inverse_kinematics(chain, T, seed=q)
        assert result.status is Status.SUCCESS, q
        assert result.seed_distance[0] < 1e-6, q
        assert pose_errors(chain, T, result.q).max() < 2e-9


@pytest.mark.parametrize("name", ["gen3", "general7r"])
def test_a_square_posture_is_among_those_at_its_parameter(name, apart):
    """Nothing but the value of the parameter is told, and nothing is lost where postures merge."""
    chain = make(name)
    for q in np.random.default_rng(11).integers(-1, 3, (200, 7)) * HALF:
        redundancy = Redundancy(chain, forward_kinematics(chain, q))
        found = redundancy.at(redundancy.parameter(q))
        assert len(found) and apart(chain, found, q).min() < 2e-2, q


def test_where_the_idealised_wrist_is_not_in_doubt_it_has_what_the_true_one_has():
    """The closed form of three axes that nearly meet against the general equations of the six."""
    data = family_of(make("gen3")).data
    own, whole = at.PARTS + 13 * 8, int(data[at.GENERAL])
    packed = data[own + wrist_at.PACKED : own + wrist_at.HAS_FALLBACK].reshape(7, 13)
    six = chain_of(constant_transforms(packed), [0] * 6)
    q, other, branch = np.empty((16, 6)), np.empty((16, 6)), np.empty(16, np.int64)
    sure = 0
    rng = np.random.default_rng(12)
    for posture in rng.uniform(-np.pi, np.pi, (300, 6)):
        T = forward_kinematics(six, posture)
        ideal = data[own:whole].copy()
        count = six_joint_postures(DECOUPLED, False, ideal, T, np.zeros(6), q, branch)
        if count >= DOUBT:
            continue
        sure += 1
        true = six_joint_postures(
            GENERAL, False, data[whole:].copy(), T, np.zeros(6), other, branch
        )
        assert true == count
        gaps = np.abs((q[:count, None] - other[None, :count] + np.pi) % (2 * np.pi) - np.pi)
        assert gaps.max(axis=2).min(axis=1).max() < 1e-7
    assert sure > 150


@pytest.mark.parametrize(("name", "least"), [("panda", 24), ("iiwa14", 48)])
def test_the_family_is_large(name, least):
    chain = load_robot(name)
    T = forward_kinematics(chain, random_postures(chain, 200, 4))
    _, count, _ = inverse_kinematics_batch(chain, T, respect_limits=False)
    assert np.mean(count) > least


@pytest.mark.parametrize("metric", ["linf", "l2"])
@pytest.mark.parametrize("name", ["panda", "iiwa14", "general7r"])
def test_the_nearest_is_as_near_as_its_self_motion_goes(name, metric):
    """No posture of a fine self-motion of the same branch is nearer to the seed."""
    chain = load_robot(name)
    order = np.inf if metric == "linf" else 2
    rng = np.random.default_rng(5)
    for posture in random_postures(chain, 20, 6):
        T = forward_kinematics(chain, posture)
        seed = np.clip(posture + rng.uniform(-0.2, 0.2, 7), chain.lower, chain.upper)
        best = inverse_kinematics(chain, T, seed=seed, metric=metric, max_solutions=1)
        assert len(best) == 1
        assert best.seed_distance[0] <= np.linalg.norm(posture - seed, ord=order) + 1e-6
        for step in rng.uniform(-0.1, 0.1, (20, 7)):
            other = np.clip(best.q[0] + step, chain.lower, chain.upper)
            near = inverse_kinematics(chain, T, seed=other, max_solutions=1, metric="l2").q[0]
            assert best.seed_distance[0] <= np.linalg.norm(near - seed, ord=order) + 2e-3


@pytest.mark.parametrize("name", ["panda", "general7r"])
def test_postures_with_the_joint_locked_are_all_there_are(search_everywhere, apart, name):
    """The last joint held: what an independent search finds, no more and no fewer."""
    chain = load_robot(name)
    C = constant_transforms(chain.packed)
    for k, posture in enumerate(random_postures(chain, 15, 7)):
        c, s = np.cos(posture[6]), np.sin(posture[6])
        turn = np.eye(4)
        turn[:2, :2] = [[c, -s], [s, c]]
        held = chain_of(np.concatenate((C[:6], [C[6] @ turn @ C[7]])), [0] * 6)
        T = forward_kinematics(chain, posture)
        (oracle,) = search_everywhere(held, T[None], seed=k)
        found = Redundancy(chain, T).at(posture[6])
        assert len(found) == len(oracle)
        for one in oracle:
            assert apart(held, found[:, :6], one).min() < 1e-6


def test_batch_agrees_with_single_calls():
    chain = load_robot("panda")
    T = forward_kinematics(chain, random_postures(chain, 20, 8))
    T[3, :3, 3] += 5.0
    q, count, status = inverse_kinematics_batch(chain, T)
    assert q.shape == (20, 64, 7)
    for k in range(20):
        single = inverse_kinematics(chain, T[k])
        assert count[k] == len(single) and status[k] == single.status
        assert q[k, : count[k]].tobytes() == single.q.tobytes()
    assert status[3] == Status.OUT_OF_REACH
    nearest, one, _ = inverse_kinematics_batch(chain, T, max_solutions=1)
    assert nearest.shape == (20, 1, 7) and one.max() == 1


def test_limits_that_exclude_all_are_told():
    chain = make("rail")
    T = forward_kinematics(chain, [1.0, 0.3, 0.5, -1.2, 0.4, 0.8, 0.2])
    T[2, 3] += 1.5
    free = inverse_kinematics(chain, T, respect_limits=False)
    held = inverse_kinematics(chain, T)
    assert len(free) and not len(held)
    assert held.status is Status.LIMITS_EXCLUDE_ALL and not held.complete


@pytest.mark.parametrize(
    ("name", "most"), [("panda", 0), ("iiwa14", 0), ("gen3", 0), ("general7r", 0)]
)
def test_issue_12_hardly_ever_is_a_known_posture_nearer_than_the_first(name, most):
    """Every posture is within 0.5 rad of the seed; of 400 seeds 8 to 22 had a farther answer."""
    chain = load_robot(name)
    rng = np.random.default_rng(12)
    low, high = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)
    farther = 0
    for posture in rng.uniform(low, high, (400, 7)):
        seed = np.clip(posture + rng.uniform(-0.5, 0.5, 7), chain.lower, chain.upper)
        T = forward_kinematics(chain, posture)
        best = inverse_kinematics(chain, T, seed=seed, max_solutions=1)
        assert best.position_error[0] < 1e-9 and best.orientation_error[0] < 1e-9
        assert best.limit_margin[0] >= 0.0
        farther += best.seed_distance[0] > np.abs(posture - seed).max() + 1e-6
    assert farther <= most
