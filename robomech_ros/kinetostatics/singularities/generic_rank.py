"""The Jacobian of an arm in nearly all postures: its rank, and its scale."""

import functools

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.mobility import arm_size, sampled_jacobians
from robomech_ros.kinetostatics.conditioning import characteristic_length, length_scale
from robomech_ros.kinetostatics.indices import as_length
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array


@functools.lru_cache(maxsize=64)
def _length(chain: SerialChain) -> float:
    try:
        return float(characteristic_length(chain))
    except BadValueError:
        return length_scale(chain)


def scaling_length(chain: SerialChain, length: float | None) -> float:
    """Return the length (m) that a caller wants, or the characteristic length.

    The size of the arm takes the place of the latter where there is none, since more joints move
    the tip than it has degrees of freedom in any posture.
    """
    if not chain.n:
        raise BadValueError("chain", chain.name, "one with a joint")
    return _length(chain) if length is None else as_length(length)


def generic_rank(chain: SerialChain) -> int:
    """Return the rank that the Jacobian has in nearly all postures."""
    return generic_motions(chain)[0]


@functools.lru_cache(maxsize=64)
def generic_motions(chain: SerialChain) -> tuple[int, Array]:
    """Find the rank that the Jacobian has in nearly all postures, and what it spans in all.

    The rank is from 1 to 6; twists (r, 6), in 1 and m, span what it has in any posture.
    """
    size = arm_size(chain)
    J = sampled_jacobians(chain, size)
    values = np.linalg.svd(J, compute_uv=False)
    left, all_values, _ = np.linalg.svd(np.concatenate(list(J), axis=1))
    rank = int((values > RANK * values[:, :1]).sum(axis=1).max())
    span: Array = left[:, : int((all_values > RANK * all_values[0]).sum())]
    span[3:] *= size
    return rank, np.ascontiguousarray(span.T)
