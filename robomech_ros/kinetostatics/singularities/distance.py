"""Distance of the joints from the nearest singular posture."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.kinematics.joint_values import as_posture
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.kinetostatics.singularities.generic_rank import generic_rank, scaling_length
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, ArrayLike

# Least singular value (lengths over the characteristic length) of a posture found to be singular.
ON_SINGULARITY = 1e-8


# Searches, the first from the posture itself, the others from about it; how far about (rad); steps
# of each, and the longest of them (rad).
_STARTS = 12
_ABOUT = 1.5
_STEPS = 60
_LONGEST = 0.3
# A step shorter than this (rad) is none.
_ARRIVED = 1e-10


class NearestSingularity(NamedTuple):
    """A singular posture near a given one.

    Attributes
    ----------
    distance : float
        Norm of the difference of the joint values, those of slides divided by the length (rad);
        infinite where no singular posture was found.
    q : ndarray, shape (n,)
        The singular posture (rad or m); NaN where none was found.
    """

    distance: float
    q: Array


def nearest_singular_posture(
    chain: SerialChain, q: ArrayLike, *, length: float | None = None
) -> NearestSingularity:
    """Search for the singular posture that is nearest in the space of the joints.

    Twelve searches end on the surface of singular postures, each where it is nearest locally; the
    nearest of their ends is the answer, and no singular posture nearer than that is known.

    Parameters
    ----------
    chain, q, length
        As for :func:`singularity_report`.
    """
    home = as_posture(chain, q)
    metres = scaling_length(chain, length)
    unit = np.where(chain.types == PRISMATIC, metres, 1.0)
    about = np.arange(_STARTS)[:, None] * low_discrepancy_strides(chain.n)
    starts = home + unit * _ABOUT * (2.0 * ((about + 0.5) % 1.0) - 1.0)
    ends = _ended(chain, home, starts, unit, metres)
    if not len(ends):
        return NearestSingularity(math.inf, np.full(chain.n, math.nan))
    away = np.linalg.norm((ends - home) / unit, axis=1)
    return NearestSingularity(float(away.min()), ends[away.argmin()])


def singular_posture_from(chain: SerialChain, q: Array, length: float) -> Array | None:
    """Search for the singular posture (n,) that is nearest to q (n,), from q; None if that fails.

    Linear motions and slides are divided by the length (m).
    """
    unit = np.where(chain.types == PRISMATIC, length, 1.0)
    ends = _ended(chain, q, q[None], unit, length)
    return ends[0] if len(ends) else None


def _ended(chain: SerialChain, home: Array, q: Array, unit: Array, length: float) -> Array:
    """Go from q (m, n) to where the Jacobian loses rank, as near home as there is.

    There the block of the Jacobian between the singular vectors that are to be free vanishes.
    Every step goes to the point nearest home at which the block, were it linear, would be zero.
    Returns the ends (k, n) of those that arrive.
    """
    scale = np.repeat((1.0, 1.0 / length), 3)[:, None]
    free = generic_rank(chain) - 1
    ends = []
    for _ in range(_STEPS):
        J = scale * jacobian(chain, q)
        left, values, right = np.linalg.svd(J)
        left, right = np.swapaxes(left[:, :, free:], 1, 2), np.swapaxes(right[:, free:], 1, 2)
        # (m, a, 6) (m, k, 6, n) (m, n, b), with joint k last.
        bent = left[:, None] @ _derivatives(chain, q, scale) @ right[:, None]
        G = np.swapaxes(bent.reshape(len(q), chain.n, -1), 1, 2) * unit
        block = (left @ J @ right).reshape(len(q), -1)
        way = (home - q) / unit
        off = (G @ way[:, :, None])[:, :, 0] + block
        step = way - (np.linalg.pinv(G, rcond=RANK) @ off[:, :, None])[:, :, 0]
        size = np.linalg.norm(step, axis=1)
        arrived = size < _ARRIVED
        ends.append(q[arrived & (values[:, free] < ON_SINGULARITY)])
        shorter = np.minimum(1.0, _LONGEST / np.maximum(size, _ARRIVED))[:, None]
        q = (q + unit * step * shorter)[~arrived]
        if not len(q):
            break
    return np.concatenate(ends)


def _derivatives(chain: SerialChain, q: Array, scale: Array) -> Array:
    """Return the derivatives (m, n, 6, n) of scaled Jacobians (m, 6, n) by the joints.

    Linear rows carry the scale, and so does what is made of them.
    """
    J = scale * jacobian(chain.uncoupled, chain.joint_values(q))
    a, p = np.swapaxes(J[:, :3], 1, 2), np.swapaxes(J[:, 3:], 1, 2)
    own = np.tri(a.shape[1], dtype=bool).T[:, :, None]
    first = np.cross(a[:, :, None], a[:, None])
    angular = np.where(own, first, 0.0)
    linear = np.where(own, np.cross(a[:, :, None], p[:, None]), np.cross(a[:, None], p[:, :, None]))
    # The joint that moves comes first here, and the components last.
    derivatives: Array = np.swapaxes(np.concatenate((angular, linear), axis=3), 2, 3)
    if chain.coupling is not None:
        A = chain.coupling.matrix
        derivatives = np.einsum("ka,mkrc,cb->marb", A, derivatives, A)
    return derivatives
