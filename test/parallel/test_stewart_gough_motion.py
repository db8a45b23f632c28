"""Lengths, Jacobian and following of platforms on six legs."""

import numpy as np
import pytest
from platforms import platform, random_pose, traced

from robomech_ros.outcomes import Code
from robomech_ros.parallel import load_parallel
from robomech_ros.spatial import pose_exponential


def moved(T, xi):
    """A pose after a small motion: rotation and translation in the base, about its own origin."""
    step = pose_exponential(np.concatenate((xi[:3], np.zeros(3))))
    new = T.copy()
    new[:3, :3] = step[:3, :3] @ T[:3, :3]
    new[:3, 3] += xi[3:]
    return new


def test_lengths_of_batches_are_those_of_single_poses():
    robot, rng = platform("general"), np.random.default_rng(0)
    poses = np.array([random_pose(robot, rng) for _ in range(6)]).reshape(2, 3, 4, 4)
    lengths = robot.inverse(poses)
    assert lengths.shape == (2, 3, 6)
    for i in range(2):
        for j in range(3):
            R, p = poses[i, j, :3, :3], poses[i, j, :3, 3]
            direct = np.linalg.norm(p + robot.platform_points @ R.T - robot.base_points, axis=1)
            assert np.abs(lengths[i, j] - direct).max() < 1e-14


@pytest.mark.parametrize("kind", ["general", "hexapod"])
def test_the_jacobian_is_the_derivative_of_the_lengths(kind):
    robot, rng = platform(kind), np.random.default_rng(1)
    T = random_pose(robot, rng)
    K, h = robot.jacobian(T), 1e-6
    for k in range(6):
        xi = np.zeros(6)
        xi[k] = h
        rate = (robot.inverse(moved(T, xi)) - robot.inverse(moved(T, -xi))) / (2.0 * h)
        assert np.abs(K[:, k] - rate).max() < 1e-8
    assert robot.jacobian(np.array([T, T])).shape == (2, 6, 6)


def test_power_of_twist_and_wrench_is_that_of_the_legs():
    robot, rng = platform("general"), np.random.default_rng(2)
    K = robot.jacobian(random_pose(robot, rng))
    twist, forces = rng.normal(size=(2, 6))
    assert forces @ (K @ twist) == pytest.approx((K.T @ forces) @ twist, rel=1e-13)


@pytest.mark.parametrize("kind", ["general", "hexapod", "6-3"])
def test_following_small_steps_is_certified_and_right(kind):
    robot, rng = platform(kind, 7), np.random.default_rng(3)
    certified = 0
    for _ in range(200):
        T = random_pose(robot, rng)
        new = moved(T, 1e-3 * rng.normal(size=6))
        lengths = robot.inverse(new)
        found = robot.follow(lengths, T)
        if found.certified:
            certified += 1
            assert np.abs(robot.inverse(found.pose) - lengths).max() < 1e-12
            if found.steps == 1:
                assert np.abs(found.pose - new).max() < 1e-9
        else:
            assert found.status in (Code.SINGULAR, Code.NOT_CONVERGED) and 0.0 <= found.part < 1.0
    assert certified >= 190


def test_following_a_path_of_large_steps_ends_where_small_ones_do():
    robot = load_parallel("hexapod")
    T = np.eye(4)
    T[2, 3] = 0.508
    start = robot.inverse(T)
    goal = start + np.array([0.05, -0.04, 0.03, 0.06, -0.05, 0.02])
    at_once = robot.follow(goal, T)
    pose = T
    for part in np.linspace(0.0, 1.0, 51)[1:]:
        step = robot.follow(np.sqrt(start**2 + part * (goal**2 - start**2)), pose)
        assert step.certified
        pose = step.pose
    assert at_once.certified and np.abs(at_once.pose - pose).max() < 1e-9


DIETMAIER = np.array([1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071])


def test_a_pose_is_followed_close_by_a_singular_one():
    robot = load_parallel("dietmaier")
    lengths, T = np.array([0.96, 0.65, 1.01, 1.51, 1.26, 0.83]), robot.direct(DIETMAIER).poses[10]
    found = robot.follow(lengths, T)
    part, pose = traced(robot, T, lengths)
    assert found.certified and part == 1.0
    np.testing.assert_allclose(found.pose, pose, atol=1e-6)


def random_follows(count):
    """Yield platforms, poses and lengths: in turn the modes of Dietmaier's, and other kinds."""
    rng, dietmaier = np.random.default_rng(1), load_parallel("dietmaier")
    modes = dietmaier.direct(DIETMAIER).poses
    others = [platform(kind, 7) for kind in ("general", "planar platform", "hexapod", "6-3")]
    for k in range(count):
        robot = [dietmaier, *others][k % 5]
        T = random_pose(robot, rng) if k % 5 else modes[rng.integers(len(modes))]
        start = robot.inverse(T) if k % 5 else DIETMAIER
        yield robot, T, start * (1.0 + 0.08 * rng.normal(size=6))


@pytest.mark.slow
@pytest.mark.parametrize("count", [30, pytest.param(500, marks=pytest.mark.long)])
def test_certified_and_singular_ends_are_those_of_the_traced_curve(count):
    counts = dict.fromkeys(Code, 0)
    for robot, T, lengths in random_follows(count):
        found = robot.follow(lengths, T)
        counts[found.status] += 1
        if found.status == Code.NOT_CONVERGED:
            assert "cannot be certified" in found.reason
            continue
        part, pose = traced(robot, T, lengths)
        if found.certified:
            assert part == 1.0
            np.testing.assert_allclose(found.pose, pose, atol=1e-6)
        else:
            values = np.linalg.svd(robot.jacobian(found.pose), compute_uv=False)
            assert found.part == pytest.approx(part, abs=1e-6) and part < 1.0
            assert values[5] < 1e-5 * values[0]
    assert counts[Code.NONE] >= count // 4 and counts[Code.SINGULAR] >= count // 4
    assert counts[Code.NOT_CONVERGED] <= count // 10


def test_a_change_of_assembly_mode_is_noticed():
    robot, lengths = load_parallel("dietmaier"), DIETMAIER
    modes = robot.direct(lengths).poses
    for T in modes[:10]:
        assert robot.follow(lengths, T).certified
    # No pose is near for the new lengths: the motion ends in a singular one.
    lost = robot.follow(3.0 * lengths * [1, 0.3, 1, 0.3, 1, 0.3], modes[0])
    assert not lost.certified and lost.status == Code.SINGULAR
    assert "assembly modes meet there in a singular pose" in lost.reason
    rows = np.linalg.svd(robot.jacobian(lost.pose), compute_uv=False)
    assert rows[5] < 0.01 * rows[0]
