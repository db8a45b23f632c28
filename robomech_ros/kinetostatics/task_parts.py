"""Rows of the Jacobian of a part of a task."""

import functools
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.kinematics.mobility import arm_size, sampled_jacobians
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, IntArray

# Rows of the Jacobian that a part of the task means.
PARTS = {"pose": np.arange(6), "orientation": np.arange(3), "position": np.arange(3, 6)}
# Entries of projections onto axes, 0 or 1, are as exact as this.
_ROUNDING = 1e-6


class TaskPart(NamedTuple):
    """A chain packed (n + 1, 13) for kernels, and the rows (r,) of its Jacobian that count.

    Its base may be turned so that what it never does are rows of zeros.
    """

    packed: Array
    rows: IntArray


@functools.lru_cache(maxsize=64)
def task_part(chain: SerialChain, part: str) -> TaskPart:
    """Find the rows of one of PARTS, less the directions that the arm has in no posture.

    A planar arm of three joints is asked for velocities in its plane only, a SCARA for angular
    velocities about the vertical only; where the arm has no more joints than rows are left out of,
    or where the directions of turning and moving do not go with each other, all rows count.
    """
    rows = PARTS[part]
    if chain.n:
        turning, moving = _projections(chain)
        axes = np.linalg.eigh(turning + 2.0 * moving)[1]
        axes[:, 0] *= np.sign(np.linalg.det(axes))
        seen = [axes.T @ one @ axes for one in (turning, moving)]
        done = np.concatenate([np.diag(one) for one in seen])
        exact = max(float(np.abs(one - np.diag(np.round(np.diag(one)))).max()) for one in seen)
        kept = rows[done[rows] > 0.5]
        if exact < _ROUNDING and 0 < len(kept) < min(chain.n, len(rows)):
            packed = chain.packed.copy()
            packed[0, 1:10] = (axes.T @ packed[0, 1:10].reshape(3, 3)).ravel()
            packed[0, 10:13] = axes.T @ packed[0, 10:13]
            return TaskPart(packed, kept)
    return TaskPart(chain.packed, rows)


def _projections(chain: SerialChain) -> tuple[Array, Array]:
    """Return the projections (3, 3) onto the spans of turning and moving in all postures."""
    J = sampled_jacobians(chain, arm_size(chain))
    spans = [np.concatenate(list(J[:, k : k + 3]), axis=1) for k in (0, 3)]
    (left, values), (right, more) = (np.linalg.svd(span)[:2] for span in spans)
    least = RANK * max(values[0], more[0])
    turning, moving = left[:, values > least], right[:, more > least]
    return turning @ turning.T, moving @ moving.T
