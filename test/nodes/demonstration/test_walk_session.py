"""The eight that walking machines are shown on: it closes, suits the robot, and is followed."""

import numpy as np
import pytest

from robomech_ros.nodes.demonstration.path_follower import PathFollower
from robomech_ros.nodes.demonstration.walk_session import eight_for, quickest
from robomech_ros.robots.robot_kinds import kind_of
from robomech_ros.walking import load_legged

ROBOTS = {"phantomx": "tripod", "go1": "trot"}


def test_the_words_of_the_demonstration_name_a_robot():
    assert kind_of("hexapod_walker") == "walking"
    assert load_legged("hexapod_walker").name == "phantomx"


@pytest.mark.parametrize("name", ROBOTS)
def test_the_eight_closes_and_leaves_the_walker_some_speed(name):
    walker = quickest(load_legged(name))
    assert walker.gait == ROBOTS[name]
    path, _, speed = eight_for(walker)
    assert np.abs(path.places[-1] - path.places[0]).max() < 1e-3 * path.length
    assert path.headings[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12)
    # Of both parts together, so that there is some left to come back to the path.
    parts = np.abs(speed * path.twists()[:, :2]) / walker.fastest[:2]
    assert 0.4 < parts.sum(axis=1).max() < 0.8


@pytest.mark.parametrize("name", ROBOTS)
def test_a_walker_follows_the_eight_and_arrives(name):
    walker = quickest(load_legged(name))
    path, radius, speed = eight_for(walker)
    follower, base, off, least = PathFollower(None, path, speed, 0.2, radius), np.zeros(3), 0.0, 1.0
    for k in range(round(4.0 * path.length / speed / walker.period)):
        if k % 10 == 0:
            walker.command(follower.command(k * walker.period, base))
        if follower.arrived:
            break
        update = walker.update()
        base, least = update.base, min(least, update.margin)
        off = max(off, np.hypot(*(path.places - base[:2]).T).min())
    assert follower.arrived and off < 0.1 * radius
    assert np.abs(base).max() < 3e-3 and least >= walker.bound
