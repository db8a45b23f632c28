"""Every robot of the library: what was asked is found, and what is found was asked."""

import numpy as np
import pytest

from robomech_ros.kinematics import (
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.robots import list_robots, load_robot


def random_postures(chain, count, seed):
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(chain.lower), np.maximum(chain.lower, -np.pi), -np.pi)
    upper = np.where(np.isfinite(chain.upper), np.minimum(chain.upper, np.pi), np.pi)
    return rng.uniform(lower, upper, (count, chain.n))


@pytest.mark.parametrize("name", list_robots())
def test_a_thousand_poses(apart, pose_errors, name):
    """Without redundancy the generating postures are found; with it they are, from a seed there."""
    chain = load_robot(name)
    postures = random_postures(chain, 1000, 11)
    targets = forward_kinematics(chain, postures)
    solutions, counts, codes = inverse_kinematics_batch(chain, targets)
    assert (codes == 0).all() and (counts > 0).all()
    for posture, target, found, count in zip(postures, targets, solutions, counts, strict=True):
        assert pose_errors(chain, target, found[:count]).max() < 1e-9
        if chain.n <= 6:
            assert apart(chain, found[:count], posture).min() < 1e-6
        else:
            nearest = inverse_kinematics(chain, target, seed=posture, max_solutions=1).q
            assert apart(chain, nearest, posture).min() < 1e-6


@pytest.mark.parametrize("name", ["puma560", "stanford", "ur5e", "xarm6", "crx10ia", "vx300"])
def test_an_independent_search_agrees(apart, search_everywhere, name):
    """From 300 random starts at each of 50 poses: nothing missing, nothing spurious."""
    chain = load_robot(name)
    for k, target in enumerate(forward_kinematics(chain, random_postures(chain, 50, 12))):
        result = inverse_kinematics(chain, target, respect_limits=False)
        assert result.complete
        for posture in search_everywhere(chain, target, seed=k):
            assert apart(chain, result.q, posture).min() < 1e-6
