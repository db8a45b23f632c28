"""How far the joints are from the nearest singular posture."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.kinetostatics.singularities.generic_rank import generic_rank, scaling_length
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC

__all__ = ["NearestSingularity", "nearest_singular_posture", "singular_posture_from"]

# Least singular value (lengths over the characteristic length) of a posture found to be singular.
ON_SINGULARITY = 1e-8

Array = NDArray[np.float64]

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

    Returns
    -------
    NearestSingularity

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`singularity_report`.
    """
    if jacobian(chain, q).ndim != 2:
        raise WrongSizeError("q", np.shape(q), (chain.n,))
    metres = scaling_length(chain, length)
    unit = np.where(chain.types == PRISMATIC, metres, 1.0)
    home = np.asarray(q, dtype=np.float64)
    about = np.arange(_STARTS)[:, None] * low_discrepancy_strides(chain.n)
    starts = home + unit * _ABOUT * (2.0 * ((about + 0.5) % 1.0) - 1.0)
    nearest = NearestSingularity(math.inf, np.full(chain.n, math.nan))
    for start in starts:
        end = _ended(chain, home, start, unit, metres)
        if end is not None and (away := float(np.linalg.norm((end - home) / unit))) < nearest[0]:
            nearest = NearestSingularity(away, end)
    return nearest


def singular_posture_from(chain: SerialChain, q: Array, length: float) -> Array | None:
    """Search for the singular posture (n,) that is nearest to q (n,), from q; None if that fails.

    Parameters
    ----------
    chain : SerialChain
    q : ndarray, shape (n,)
        Joint values (rad or m).
    length : float
        What linear motions and slides are divided by (m).
    """
    return _ended(chain, q, q, np.where(chain.types == PRISMATIC, length, 1.0), length)


def _ended(chain: SerialChain, home: Array, q: Array, unit: Array, length: float) -> Array | None:
    """Go from q to where the Jacobian loses rank, as near home as there is; None if that fails.

    There the block of the Jacobian between the singular vectors that are to be free vanishes.
    Every step goes to the point nearest home at which the block, were it linear, would be zero.
    """
    scale = np.repeat((1.0, 1.0 / length), 3)[:, None]
    free = generic_rank(chain) - 1
    for _ in range(_STEPS):
        J = scale * jacobian(chain, q)
        left, values, right = np.linalg.svd(J)
        bent = np.einsum(
            "ra,krc,bc->abk", left[:, free:], _derivatives(chain, q, scale), right[free:]
        )
        G = bent.reshape(-1, chain.n) * unit
        block = (left[:, free:].T @ J @ right[free:].T).ravel()
        way = (home - q) / unit
        step = way - np.linalg.lstsq(G, G @ way + block, rcond=RANK)[0]
        size = float(np.linalg.norm(step))
        if size < _ARRIVED:
            return q if values[free] < ON_SINGULARITY else None
        q = q + unit * step * min(1.0, _LONGEST / size)
    return None


def _derivatives(chain: SerialChain, q: Array, scale: Array) -> Array:
    """Give the derivatives (n, 6, n) of a scaled Jacobian by the joints, as its kernels have them.

    Linear rows carry the scale, and so does what is made of them.
    """
    J = scale * jacobian(chain.uncoupled, chain.joint_values(q))
    a, m = J[:3].T, J[3:].T
    n = len(a)
    own = np.tri(n, dtype=bool).T[:, :, None]
    angular = np.where(own, np.cross(a[:, None], a[None]), 0.0)
    linear = np.where(own, np.cross(a[:, None], m[None]), np.cross(a[None], m[:, None]))
    derivatives = np.concatenate((angular, linear), axis=2).swapaxes(1, 2)
    if chain.coupling is None:
        return derivatives
    A = chain.coupling.matrix
    return np.einsum("ka,krc,cb->arb", A, derivatives, A)
