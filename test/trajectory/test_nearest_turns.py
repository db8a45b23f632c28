"""Continuous joints take the short way from point to point."""

import numpy as np

from robomech_ros.trajectory import nearest_turns


def test_continuous_joints_go_at_most_half_a_turn():
    given = np.random.default_rng(3).uniform(-20.0, 20.0, (50, 3))
    points, turns = nearest_turns(given, [True, False, True])
    np.testing.assert_allclose(points, given + 2.0 * np.pi * turns, atol=1e-12)
    np.testing.assert_array_equal(points[0], given[0])
    assert np.abs(np.diff(points[:, [0, 2]], axis=0)).max() <= np.pi + 1e-12
    assert not turns[:, 1].any()


def test_points_without_continuous_joints_are_a_copy():
    given = np.zeros((2, 3))
    points, turns = nearest_turns(given, [False] * 3)
    points += 1.0
    assert not given.any() and not turns.any() and turns.dtype == np.int64
