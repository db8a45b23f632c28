"""All poses of platforms on six legs: golden data, an independent search, certificates."""

import numpy as np
import pytest
from platforms import KINDS, independent_poses, on_circles, platform, random_pose, same_poses
from scipy.optimize import brentq

from robomech_ros.outcomes import Code
from robomech_ros.parallel import StewartGough, load_parallel
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector


def golden_poses(data):
    T = np.tile(np.eye(4), (len(data["solutions"]), 1, 1))
    for pose, one in zip(T, data["solutions"], strict=True):
        pose[:3, :3], pose[:3, 3] = one["R"], one["p"]
    return T


@pytest.mark.parametrize(
    ("name", "robot", "tolerance"),
    [("sgp_dietmaier40", "dietmaier", 1e-8), ("sgp_6_3", "sgp_6_3", 1e-10)],
)
def test_golden_modes(golden, name, robot, tolerance):
    data = golden(name)
    for one in (StewartGough(data["A"], data["B"]), load_parallel(robot)):
        found = one.direct(data["L"])
        assert len(found) == data["n_real"]
        assert found.complete and found.status == Code.NONE and found.reason == ""
        assert (found.multiplicity == 1).all()
        assert same_poses(found.poses, golden_poses(data), tolerance)
        assert found.errors.max() < 1e-13


@pytest.mark.parametrize("kind", KINDS)
def test_a_known_pose_is_among_the_answers(kind):
    robot, rng = platform(kind, 3), np.random.default_rng(4)
    for _ in range(40):
        T = random_pose(robot, rng)
        lengths = robot.inverse(T)
        found = robot.direct(lengths, T)
        assert found.complete, found.reason
        assert np.abs(found.poses[0] - T).max() < 1e-7
        assert np.abs(robot.inverse(found.poses) - lengths).max() < 1e-9
        # Complex poses are conjugate in pairs, and all of them are known.
        assert (KINDS[kind] - found.multiplicity.sum()) % 2 == 0


@pytest.mark.slow
@pytest.mark.parametrize("count", [3, pytest.param(100, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", KINDS)
def test_many_known_poses_are_among_the_answers(kind, count):
    missed = []
    for seed in range(10):
        robot, rng = platform(kind, 100 + seed), np.random.default_rng(seed)
        for _ in range(count):
            T = random_pose(robot, rng)
            found = robot.direct(robot.inverse(T), T)
            if not found.complete or np.abs(found.poses[0] - T).max() > 1e-6:
                missed.append((seed, T.tolist(), found.reason))
    assert missed == []


@pytest.mark.parametrize("kind", ["general", "hexapod", "6-3"])
def test_a_search_of_its_own_finds_the_same(kind):
    robot, rng = platform(kind, 5), np.random.default_rng(6)
    lengths = robot.inverse(random_pose(robot, rng))
    found = robot.direct(lengths)
    assert found.complete
    assert same_poses(found.poses, independent_poses(robot, lengths), 1e-8)


def test_no_real_pose_is_answered_as_such_with_how_near_it_comes():
    robot = platform("hexapod")
    found = robot.direct([0.2, 3.0, 0.2, 3.0, 0.2, 3.0])
    assert len(found) == 0 and found.complete and found.status == Code.OUT_OF_REACH
    assert "no real pose: the nearest one found misses the lengths by up to" in found.reason
    assert len(independent_poses(robot, np.array([0.2, 3.0, 0.2, 3.0, 0.2, 3.0]), 300)) == 0


def singular_poses(robot):
    """Poses along a line of turns in which the determinant of the Jacobian changes sign."""
    from scipy.spatial.transform import Rotation

    def pose(angle):
        T = np.eye(4)
        T[:3, :3] = Rotation.from_rotvec([0.2, 0.1, angle]).as_matrix()
        T[:3, 3] = 0.1, 0.05, 0.8
        return T

    def determinant(angle):
        return np.linalg.det(robot.jacobian(pose(angle)))

    angles = np.linspace(0.0, 3.0, 40)
    signs = np.sign([determinant(angle) for angle in angles])
    for k in np.flatnonzero(signs[1:] != signs[:-1]):
        yield pose(brentq(determinant, angles[k], angles[k + 1], xtol=1e-15))


@pytest.mark.parametrize("kind", ["general", "hexapod", "planar platform"])
def test_modes_that_meet_are_one_pose_counted_twice(kind):
    robot = platform(kind, 8)
    poses = list(singular_poses(robot))
    assert poses
    for T in poses:
        found = robot.direct(robot.inverse(T), T)
        assert found.complete, found.reason
        assert found.multiplicity[0] == 2 and "singular" in found.reason
        assert np.abs(found.poses[0] - T).max() < 4e-7


@pytest.mark.parametrize(("nearness", "modes"), [(1e-10, 2), (-1e-10, 0)])
def test_near_a_singular_pose_two_modes_are_two_or_none(nearness, modes):
    robot = platform("general", 8)
    T = next(singular_poses(robot))
    values, rows = np.linalg.svd(robot.jacobian(T).T)[1:]
    assert values[5] < 1e-10 * values[0]
    # Lengths changed in the direction that no twist makes: modes part, or become complex.
    lengths = robot.inverse(T)
    counts = []
    for sign in (1.0, -1.0):
        found = robot.direct(lengths + sign * nearness * rows[5], T)
        assert found.complete, found.reason
        near = np.abs(found.poses - T).max(axis=(1, 2)) < 0.01
        counts.append(int(found.multiplicity[near].sum()))
    assert sorted(counts) == [0, 2] and modes in counts


def test_the_nearest_pose_comes_first():
    robot = load_parallel("dietmaier")
    lengths = [1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071]
    every = robot.direct(lengths).poses
    for seed in every[::7]:
        assert np.abs(robot.direct(lengths, seed).poses[0] - seed).max() < 1e-12


def test_the_same_request_gives_the_same_bytes():
    robot, other = platform("general", 2), platform("general", 2)
    lengths = robot.inverse(random_pose(robot, np.random.default_rng(1)))
    found = [one.direct(lengths).poses.tobytes() for one in (robot, robot, other)]
    assert found[0] == found[1] == found[2]


def test_units_do_not_matter():
    robot = platform("general", 2)
    T = random_pose(robot, np.random.default_rng(1))
    shift = np.array([3.0, -2.0, 1.0])
    far = StewartGough(1e3 * (robot.base_points + shift), 1e3 * robot.platform_points)
    found, same = robot.direct(robot.inverse(T)), far.direct(1e3 * robot.inverse(T))
    expected = found.poses.copy()
    expected[:, :3, 3] = 1e3 * (expected[:, :3, 3] + shift)
    assert same.complete and same_poses(same.poses, expected, 1e-8)


@pytest.mark.parametrize(
    ("robot", "family"),
    [
        (platform("general"), "6-6 general"),
        (platform("planar"), "6-6 planar"),
        (platform("planar platform"), "6-6 planar platform"),
        (platform("6-3"), "6-3 planar"),
        (platform("3-3"), "3-3 planar"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_families(robot, family):
    assert robot.family == family and not robot.always_singular


@pytest.mark.parametrize("azimuths", [[0, 60, 120, 180, 240, 300], [-10, 10, 110, 130, 230, 250]])
def test_an_architecturally_singular_platform_is_told_at_load(azimuths):
    robot = StewartGough(*on_circles(azimuths, azimuths))
    assert robot.always_singular
    assert robot.family == "6-6 planar, architecturally singular"
    found = robot.direct(robot.inverse(np.eye(4)) + 1.0)
    assert not found.complete and found.status == Code.SINGULAR_CONTINUUM
    assert "architecturally singular" in found.reason


@pytest.mark.parametrize(("base", "top"), [(1.0, 0.003), (0.003, 1.0)])
def test_a_small_platform_is_regular(base, top):
    a = base * on_circles([-15, 15, 105, 135, 225, 255], [0] * 6)[0]
    b = top * on_circles([-45, 45, 75, 165, 195, 285], [0] * 6)[0]
    robot = StewartGough(a, b)
    assert robot.family == "6-6 planar" and robot.conditioning > 0.1
    assert_found(robot, complete=True)


def test_a_platform_near_an_architecturally_singular_one_is_solved():
    a, b = on_circles(*[[-15, 15, 105, 135, 225, 255]] * 2, ratio=0.6)
    b[:, :2] += 1e-3 * np.random.default_rng(0).normal(size=(6, 2))
    robot = StewartGough(a, b)
    assert robot.family == "6-6 planar" and robot.conditioning < 1e-3
    assert_found(robot)


def assert_found(robot, complete=False):
    """The pose is found whose lengths are given."""
    T = np.eye(4)
    T[:3, :3], T[2, 3] = matrix_from_rotation_vector([0.1, -0.05, 0.2]), 1.0
    found = robot.direct(robot.inverse(T), seed=T)
    assert np.abs(found.poses[0] - T).max() < 1e-9
    assert found.complete or not complete


def test_a_platform_that_can_move_with_locked_legs_is_told():
    # Legs of one length between congruent hexagons: the platform shifts along a sphere.
    a, b = on_circles(*[[0, 60, 120, 180, 240, 300]] * 2, ratio=1.0)
    a[:, 2] = b[:, 2] = [0.0, 0.1, 0.3, -0.2, 0.15, -0.1]
    robot = StewartGough(a, b)
    assert not robot.always_singular
    found = robot.direct(np.full(6, 0.8))
    assert not found.complete and found.status == Code.SINGULAR_CONTINUUM
    assert "can move while its legs are locked" in found.reason
    assert np.abs(robot.inverse(found.poses) - 0.8).max() < 1e-9
