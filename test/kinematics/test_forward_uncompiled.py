"""Poses without kernels are the poses with them."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, tip_poses
from robomech_ros.robots import list_robots, load_robot


@pytest.mark.parametrize("name", sorted(list_robots()))
def test_poses_equal_those_of_the_kernel(name):
    chain = load_robot(name)
    q = np.random.default_rng(4).uniform(-2.0, 2.0, (50, chain.n))
    np.testing.assert_allclose(tip_poses(chain, q), forward_kinematics(chain, q), atol=1e-14)


@pytest.mark.parametrize("seed", range(20))
def test_random_chains(random_chain, seed):
    chain = random_chain(seed, n=1 + seed % 9)
    q = np.random.default_rng(seed).uniform(-2.0, 2.0, (7, chain.n))
    np.testing.assert_allclose(tip_poses(chain, q), forward_kinematics(chain, q), atol=1e-13)
