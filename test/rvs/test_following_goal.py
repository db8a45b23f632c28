"""A goal stays with the robot until it is put elsewhere."""

import numpy as np
import pytest

from robomech_ros.rvs.model.running.following_goal import REST, FollowingGoal

HERE, THERE = np.zeros(3), np.full(3, 0.5)


@pytest.fixture
def goal():
    """A goal of a robot that rests where it is."""
    found = FollowingGoal(HERE)
    found.robot_is_at(HERE, 0.0)
    assert found.robot_is_at(HERE, 2.0 * REST)
    return found


def test_it_is_brought_once_when_the_robot_rests(goal):
    assert not goal.robot_is_at(THERE, 10.0)
    assert not goal.robot_is_at(THERE, 10.0 + 0.5 * REST)
    assert goal.robot_is_at(THERE, 10.0 + 1.5 * REST)
    np.testing.assert_array_equal(goal.followed(), THERE)
    goal.put(THERE, followed=True)
    assert not goal.robot_is_at(THERE, 20.0)
    assert not goal.is_apart


def test_it_stays_where_it_was_put(goal):
    goal.put(THERE)
    assert goal.is_apart and goal.followed() is None
    goal.robot_is_at(-THERE, 10.0)
    assert not goal.robot_is_at(-THERE, 20.0)
    assert goal.is_apart


def test_a_small_step_away_from_the_robot_is_kept(goal):
    goal.put(HERE + 1e-3)
    assert not goal.robot_is_at(HERE, 10.0) and goal.followed() is None


def test_it_follows_again_once_the_robot_has_come(goal):
    goal.put(THERE)
    assert not goal.robot_is_at(THERE, 10.0)
    assert goal.robot_is_at(THERE, 20.0)
    assert not goal.is_apart


def test_it_can_be_called_back(goal):
    goal.put(THERE)
    goal.follow()
    np.testing.assert_array_equal(goal.followed(), HERE)


def test_it_is_behind_while_the_robot_moves_on_without_it(goal):
    assert not goal.is_behind
    goal.robot_is_at(HERE + 1e-3, 10.0)
    assert not goal.is_behind
    goal.robot_is_at(THERE, 11.0)
    assert goal.is_behind
    assert goal.robot_is_at(THERE, 20.0)
    assert not goal.is_behind


def test_it_is_not_behind_where_it_was_put_or_called_to(goal):
    goal.put(-THERE)
    goal.robot_is_at(THERE, 10.0)
    assert not goal.is_behind
    goal.follow()
    goal.followed()
    assert not goal.is_behind
    goal.robot_is_at(HERE, 11.0)
    assert goal.is_behind
