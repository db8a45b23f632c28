"""Size of an arm, and check of its six degrees of freedom."""

import math

import numpy as np

from robomech_ros._kernels.chain.serial import jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array

# Least ratio of singular values, at the best of some postures, of an arm with six of freedom.
ARM_MOBILITY = 1e-7


def arm_size(chain: SerialChain) -> float:
    """Measure an arm (m): the sum of the distances between the frames of neighbouring joints.

    It is 1e-3 at least, and no less than the distance that can be between the first and the last
    of these frames while prismatic joints stay at zero.
    """
    return max(float(np.linalg.norm(chain.packed[1:-1, 10:13], axis=1).sum()), 1e-3)


def mobility(chain: SerialChain, size: float) -> float:
    """Measure how far an arm of one to six joints is from having lost a degree of freedom.

    That is the least singular value of the Jacobian over the largest, lengths over the size (m), at
    the best of some postures.
    """
    values = np.linalg.svd(sampled_jacobians(chain, size), compute_uv=False)
    return float(np.max(values[:, -1] / values[:, 0]))


def sampled_jacobians(chain: SerialChain, size: float) -> Array:
    """Return the Jacobians (16, 6, n) of some postures, linear rows over a size (m)."""
    q = np.random.default_rng(0).uniform(-math.pi, math.pi, (16, chain.n))
    q[:, chain.types == PRISMATIC] *= size
    return scaled_jacobians(chain.packed, q, size)


def scaled_jacobians(packed: Array, q: Array, size: float) -> Array:
    """Return the Jacobians (m, 6, n) of a packed chain at q (m, n), linear rows over a size (m)."""
    J = np.empty((len(q), 6, q.shape[1]))
    jacobian(packed, q, J, np.empty((4, 4)))
    J[:, 3:] /= size
    return J


def moves_in_all_directions(chain: SerialChain, size: float) -> bool:
    """Return whether a six-joint arm of a size (m) has six degrees of freedom."""
    return mobility(chain, size) > ARM_MOBILITY
