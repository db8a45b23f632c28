"""The twist of a walker's odometry."""

import numpy as np

from robomech_ros.nodes.walker.publication import mean_twist
from robomech_ros.spatial import pose_exponential


def test_the_twist_of_a_trunk_that_has_not_moved_is_exactly_zero():
    rng = np.random.default_rng(0)
    poses = pose_exponential(rng.uniform(-3.0, 3.0, (200, 6)))
    rounding = [np.linalg.inv(T) @ T - np.eye(4) for T in poses]
    assert np.abs(rounding).max() > 0.0
    assert not any(mean_twist(T, T.copy(), 0.02).any() for T in poses)


def test_the_twist_of_a_trunk_that_moves_is_that_of_its_own_axes():
    rng = np.random.default_rng(1)
    T, twist = pose_exponential(rng.uniform(-1.0, 1.0, 6)), rng.uniform(-1.0, 1.0, 6)
    moved = T @ pose_exponential(0.02 * twist)
    assert np.abs(mean_twist(T, moved, 0.02) - twist).max() < 1e-12
    assert not mean_twist(T, moved, 0.0).any()
