"""Arms with a spherical wrist: golden solutions, random poses, singular poses, completeness."""

import functools
import itertools

import numpy as np
import pytest
from scipy.optimize import minimize

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.robots import chain_from_dh, load_robot

POSES = 10_000
SINGULAR_POSES = 300
ROBOTS = ("puma560", "irb120", "stanford")
GOLDEN = ("decoupled_puma560", "decoupled_irb2000", "decoupled_general_8", "ik6r_tsai_morgan_1")
SKEW = tuple(
    f"{''.join(kinds)}-{number}"
    for kinds in itertools.product("RP", repeat=3)
    for number in range(2)
)
SPECIAL = ("orthogonal", "general8", "first-parallel", "last-parallel")


def make_arm(name):
    """A robot, a skew arm such as "RPR-0", or an arm of special geometry."""
    half = np.pi / 2
    if name in ROBOTS:
        return load_robot(name)
    if name == "orthogonal":
        b = [0, 1, 1, 1, 0, 0.2]
        return chain_from_dh([1, 1, 1, 0, 0, 0], b, [half, -half, half, -half, half, 0])
    if name == "general8":
        alpha = np.radians([70, -30, 80, 75, -85, 20])
        return chain_from_dh([0.3, 0.5, 0.25, 0, 0, 0], [0.2, 0.1, 0.15, 0.6, 0, 0.1], alpha)
    if name == "first-parallel":
        b = [0.3, 0.1, 0, 0.5, 0, 0.1]
        return chain_from_dh([0.4, 0.3, 0.1, 0, 0, 0], b, [0, half, half, -half, half, 0])
    if name == "last-parallel":
        b = [0.3, 0.1, 0.1, 0.5, 0, 0.1]
        return chain_from_dh([0.1, 0.4, 0.3, 0, 0, 0], b, [1.1, np.pi, 0.9, -half, half, 0])
    kinds, number = name.split("-")
    rng = np.random.default_rng([int(number), *(ord(kind) for kind in kinds)])
    a, b = rng.uniform(-0.5, 0.5, (2, 6))
    a[3] = a[4] = b[4] = 0.0
    alpha = rng.uniform(0.4, 2.7, 6) * rng.choice([-1, 1], 6)
    types = [int(kind == "P") for kind in kinds] + [0, 0, 0]
    return chain_from_dh(a, b, alpha, rng.uniform(-3, 3, 6), types=types)


@pytest.fixture(scope="module")
def arm():
    """Make an arm by name, once."""
    return functools.lru_cache(make_arm)


def random_postures(chain, count, seed):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6))


@pytest.mark.parametrize("name", GOLDEN)
def test_golden_solutions(golden, apart, pose_errors, name):
    data = golden(name)
    chain = chain_from_dh(data["a"], data["b"], data["alpha"])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = data["R"], data["p"]
    result = inverse_kinematics(chain, T, respect_limits=False)
    expected = np.array(data["solutions"])
    assert result.family == "decoupled" and result.complete
    assert len(result) == len(expected) == data["n_real"]
    distance = apart(chain, result.q[:, None], expected[None])
    assert distance.min(axis=0).max() < 1e-7 and distance.min(axis=1).max() < 1e-7
    assert pose_errors(chain, T, result.q).max() < 1e-7  # the pose is printed to 1e-8


def test_golden_orthogonal_arm(golden, apart):
    data = golden("decoupled_orthogonal_arm")
    half = np.pi / 2
    chain = chain_from_dh(
        [*data["a"], 0, 0, 0], [*data["b"], data["b4"], 0, 0], [*data["alpha"], half, half, 0]
    )
    T = forward_kinematics(chain, [*data["solutions"][0], 0.4, 0.5, 0.6])
    np.testing.assert_allclose(T[:3, 3], data["C"], atol=1e-9)
    result = inverse_kinematics(chain, T, respect_limits=False)
    expected = np.array(data["solutions"])
    first_three = np.abs(np.angle(np.exp(1j * (result.q[:, None, :3] - expected[None])))).max(
        axis=-1
    )
    assert first_three.min(axis=0).max() < 1e-9 and first_three.min(axis=1).max() < 1e-9
    assert len(result) == 8


def test_golden_spherical_wrist(golden):
    data = golden("spherical_wrist")
    alpha = [np.pi / 2, 0.3, -np.pi / 2, *data["alpha456"]]
    chain = chain_from_dh([0.1, 0.4, 0.1, 0, 0, 0], [0.3, 0, 0, 0.5, 0, 0], alpha)
    arm_angles = [0.2, -0.4, 0.7]
    T = forward_kinematics(chain, [*arm_angles, 0, 0, 0])
    wrist = forward_kinematics(chain.with_tip(chain.links[3]), arm_angles)
    T[:3, :3] = wrist[:3, :3] @ np.array(data["R"])
    result = inverse_kinematics(chain, T, respect_limits=False)
    same_arm = np.abs(result.q[:, :3] - arm_angles).max(axis=1) < 1e-8
    found = result.q[same_arm][:, 3:]
    expected = np.array(data["solutions"])
    distance = np.abs(np.angle(np.exp(1j * (found[:, None] - expected[None])))).max(axis=-1)
    assert found.shape == (2, 3) and distance.min(axis=0).max() < 1e-9


@pytest.mark.parametrize("name", ROBOTS + SPECIAL + SKEW)
def test_residuals_and_generating_postures(arm, apart, pose_errors, name):
    chain = arm(name)
    q = random_postures(chain, POSES, 1)
    targets = forward_kinematics(chain, q)
    solutions, counts, status = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (counts > 0).all() and (status == 0).all() and counts.max() <= 8
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < 1e-9
    distance = apart(chain, np.where(rows[:, :, None], solutions, 9.0), q[:, None, :])
    assert np.where(rows, distance, np.inf).min(axis=1).max() < 1e-6


def wrist_singular(chain, q):
    q[:, 4] = np.where(np.arange(len(q)) % 2, 0.0, np.pi)
    return q


def right_angles(chain, q):
    rng = np.random.default_rng(3)
    return rng.integers(-2, 3, q.shape) * np.pi / 2


@pytest.mark.parametrize("make", [wrist_singular, right_angles])
@pytest.mark.parametrize("name", (*ROBOTS, "orthogonal", "general8", "RRR-0", "RPR-1", "PRR-0"))
def test_singular_postures(arm, pose_errors, name, make):
    chain = arm(name)
    q = make(chain, random_postures(chain, SINGULAR_POSES, 5))
    check_answered(chain, q, pose_errors)


def check_answered(chain, q, pose_errors):
    targets = forward_kinematics(chain, q)
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (counts > 0).all(), q[counts == 0][:3]
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < 1e-9


def test_wrist_centre_on_the_first_axis(pose_errors):
    # Without an offset at the shoulder, the wrist centre can be put on axis 1.
    half = np.pi / 2
    chain = chain_from_dh(
        [0, 0.4, 0, 0, 0, 0], [0.5, 0, 0, 0.4, 0, 0.1], [half, 0, half, -half, half, 0]
    )
    q = random_postures(chain, SINGULAR_POSES, 6)
    # Two equal links make an isosceles triangle with the axis.
    q[:, 2] = 3.0 * half - 2.0 * q[:, 1]
    targets = forward_kinematics(chain, q)
    centre = targets[:, :3, 3] - 0.1 * targets[:, :3, 2]
    on_axis = np.hypot(centre[:, 0], centre[:, 1]) < 1e-12
    check_answered(chain, q, pose_errors)
    assert on_axis.all()
    for T in targets[:20]:
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.continuum and "joint_1" in result.reason


@pytest.mark.parametrize("name", ("orthogonal", "general8", "RRR-0", "RRR-1"))
def test_workspace_boundary(arm, pose_errors, name):
    chain = arm(name)
    centre_chain = chain.with_tip(chain.links[4])
    rng = np.random.default_rng(8)
    targets = []
    for _ in range(SINGULAR_POSES // 10):
        q = rng.uniform(-np.pi, np.pi, 6)
        q[1:3] = farthest(centre_chain, q, rng)
        targets.append(forward_kinematics(chain, q))
    solutions, counts, _ = inverse_kinematics_batch(chain, np.array(targets), respect_limits=False)
    assert (counts > 0).all()
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    repeated = np.repeat(np.array(targets), counts, axis=0)
    assert pose_errors(chain, repeated, solutions[rows]).max() < 1e-9


def farthest(chain, q, rng):
    """Joints 2 and 3 at which the wrist centre is locally farthest in a random direction."""
    direction = rng.normal(size=2)

    def distance(angles):
        p = forward_kinematics(chain, [q[0], *angles, q[3]])[:3, 3]
        return -(direction[0] * np.hypot(p[0], p[1]) + direction[1] * p[2])

    return minimize(distance, rng.uniform(-3, 3, 2), method="Nelder-Mead", tol=1e-14).x


@pytest.mark.parametrize("count", [12, pytest.param(50, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ("puma560", "stanford", "orthogonal", "general8", *SKEW[::3]))
def test_nothing_missing(arm, apart, search_everywhere, name, count):
    chain = arm(name)
    targets = forward_kinematics(chain, random_postures(chain, count, 2))
    solutions, counts, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    for k, postures in enumerate(search_everywhere(chain, targets)):
        ours = solutions[k, : counts[k]]
        nearest = apart(chain, ours, postures[:, None]).min(axis=1)
        assert nearest.max(initial=0.0) < 1e-6, (name, k, postures[nearest.argmax()])


@pytest.mark.parametrize(
    ("change", "family"),
    [
        ({}, "decoupled"),
        ({"a": [0, 0.4318, 0.0203, 0.01, 0, 0]}, "general-6r"),
        ({"b": [0, 0, 0.15005, 0.4318, 0.01, 0]}, "general-6r"),
    ],
)
def test_geometry_decides_the_family(change, family):
    half = np.pi / 2
    table = {
        "a": [0, 0.4318, 0.0203, 0, 0, 0],
        "b": [0, 0, 0.15005, 0.4318, 0, 0],
        "alpha": [half, 0.1, -half, half, -half, 0],
    }
    chain = chain_from_dh(**(table | change))
    T = forward_kinematics(chain, np.full(6, 0.3))
    assert inverse_kinematics(chain, T).family == family


@pytest.mark.parametrize("offset", [0.0, 0.0203])
def test_wrist_centre_on_the_first_axis_inside_limits(pose_errors, offset):
    half = np.pi / 2
    lower = [-np.pi, -3.1, -3.1, -np.pi, -3.1, -np.pi]
    chain = chain_from_dh(
        [0, 0.4318, offset, 0, 0, 0],
        [0.2, 0, 0, 0.4318, 0, 0.05],
        [half, 0, -half, half, -half, 0],
        limits=np.stack([lower, np.negative(lower)], axis=1),
    )
    rng = np.random.default_rng(9)
    answered = 0
    for q in rng.uniform(-3.0, 3.0, (SINGULAR_POSES, 6)):
        # The angle of axis 2 that puts the wrist centre on axis 1, for this angle of axis 3.
        q[1] = 0.0
        centre = forward_kinematics(chain.with_tip(chain.links[4]), [0.0, 0.0, q[2], 0.0])[:3, 3]
        q[1] = half - np.arctan2(centre[2] - 0.2, centre[0])
        q[1] = np.angle(np.exp(1j * q[1]))
        if abs(q[1]) > 3.1:
            continue
        T = forward_kinematics(chain, q)
        result = inverse_kinematics(chain, T, seed=q)
        assert len(result), q
        assert pose_errors(chain, T, result.q).max() < 1e-9
        assert result.continuum and len(result) <= 8
        assert result.seed_distance[0] < 1e-6, q
        answered += 1
    assert answered > 200
