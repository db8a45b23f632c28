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
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    assert pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows]).max() < 1e-9
    if chain.n <= 6:
        distance = apart(chain, np.where(rows[:, :, None], solutions, 9.0), postures[:, None])
        assert np.where(rows, distance, np.inf).min(axis=1).max() < 1e-6
    else:
        for posture, target in zip(postures, targets, strict=True):
            nearest = inverse_kinematics(chain, target, seed=posture, max_solutions=1).q
            assert apart(chain, nearest, posture).min() < 1e-6


@pytest.mark.parametrize("name", ["puma560", "stanford", "ur5e", "xarm6", "crx10ia", "vx300"])
def test_an_independent_search_agrees(apart, search_everywhere, name):
    """From 300 random starts at each of 50 poses: nothing missing, nothing spurious."""
    chain = load_robot(name)
    targets = forward_kinematics(chain, random_postures(chain, 50, 12))
    for target, postures in zip(targets, search_everywhere(chain, targets), strict=True):
        result = inverse_kinematics(chain, target, respect_limits=False)
        assert result.complete
        assert apart(chain, result.q, postures[:, None]).min(axis=1).max() < 1e-6
