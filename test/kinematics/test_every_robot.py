"""Every robot of the library: what was asked is found, and what is found was asked."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
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


def no_two_are_the_same(chain, q):
    for k in range(len(q) - 1):
        apart = np.abs(q[k + 1 :] - q[k])
        turned = np.abs(np.remainder(apart + np.pi, 2.0 * np.pi) - np.pi)
        apart = np.where(chain.types == 0, turned, apart)
        if (apart.max(axis=1) < 1e-6).any():
            return False
    return True


@pytest.mark.parametrize("name", list_robots())
def test_no_two_solutions_are_the_same(name):
    """The Panda at home had one twice, the Gen3 in 23 of 40 poses."""
    chain = load_robot(name)
    middle = [chain.midrange(), chain.home(), np.clip(np.zeros(chain.n), chain.lower, chain.upper)]
    postures = np.vstack((middle, random_postures(chain, 40, 14)))
    targets = forward_kinematics(chain, postures)
    for respect_limits in (True, False):
        solutions, counts, _ = inverse_kinematics_batch(
            chain, targets, respect_limits=respect_limits
        )
        for target, posture, q, count in zip(targets, postures, solutions, counts, strict=True):
            assert no_two_are_the_same(chain, q[:count])
            listed = inverse_kinematics(chain, target, seed=posture, respect_limits=respect_limits)
            assert no_two_are_the_same(chain, listed.q)


@pytest.mark.parametrize("name", ["panda", "gen3", "ur5e"])
def test_windings_are_different_solutions_and_none_is_listed_twice(name):
    chain = load_robot(name)
    target = forward_kinematics(chain, random_postures(chain, 1, 15)[0])
    q = inverse_kinematics(chain, target, include_windings=True).q
    apart = np.abs(q[:, None] - q[None]).max(axis=2)
    assert (apart + np.eye(len(q)) > 1e-6).all()
