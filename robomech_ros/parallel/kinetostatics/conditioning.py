"""Conditioning of platforms: distances from singularities, dexterity, and the length."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.kinetostatics.indices import as_length
from robomech_ros.parallel.kinetostatics.limb_geometry import limbs_at, limbs_holding, motions_of
from robomech_ros.parallel.kinetostatics.limb_wrenches import Wrenches, limb_wrenches
from robomech_ros.parallel.kinetostatics.pose_samples import held_poses, size_of
from robomech_ros.parallel.kinetostatics.square_systems import are_regular
from robomech_ros.parallel.library import AnyParallelRobot, ParallelRobot
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, ArrayLike

_ANGULAR = 3
# Parts of unit twists below which they are zero.
_ROUNDING = 1e-9
# Number of postures of a mechanism that are compared.
_POSTURES = 256
# Powers of ten of the size between which lengths are looked for, how many at a time, how often.
_RANGE, _LENGTHS, _ROUNDS = 4.0, 65, 9


class ScaledMatrices(NamedTuple):
    """K and J without units, for poses (...).

    K (..., m, m) has the columns of the motions that the platform has, angular ones divided by the
    length (m), and J (..., m) the entries over the greatest that they can be: from -1 to 1, of
    legs 1.  These motions (..., 6, m) are orthonormal, with angular parts multiplied by the
    length.  The scale is the length, 1 where the platform only turns, and the rows (..., m, 6) are
    those of K for all twists, angular columns divided by the scale.
    """

    K: Array
    J: Array
    length: float
    motions: Array
    scale: float
    rows: Array


def scaled_matrices(
    robot: AnyParallelRobot, T: ArrayLike, q: ArrayLike | None, length: float | None
) -> ScaledMatrices:
    """Find K and J without units; arguments as for :func:`singularity_distances`."""
    limbs = limbs_holding(robot, T, q)
    length = platform_length(robot) if length is None else as_length(length)
    if isinstance(limbs, Wrenches):
        K, J, motions = limbs.borne, limbs.work, limbs.motions(length)
    else:
        (K, J), motions = limbs.rows(), np.eye(6)[:, list(motions_of(robot))]
    scale = length if np.abs(motions[..., _ANGULAR:, :]).max() > _ROUNDING else 1.0
    rows = K / np.repeat([scale, 1.0], _ANGULAR)
    return ScaledMatrices(rows @ motions, J / limbs.lever, length, motions, scale, rows)


def platform_length(robot: AnyParallelRobot) -> float:
    r"""Find the characteristic length: with it the best conditioned pose is nearest to isotropic.

    It makes the condition number by the Frobenius norm of K, angular columns divided by it, least
    over 2,048 poses all over the workspace and over all lengths; at a pose the best one is known
    in closed form.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR, Spherical3RRR or Mechanism
        Of a mechanism of one of these classes the length is that of the class; poses of others are
        those near home, in its assembly mode, within the limits of their joints.

    Returns
    -------
    float
        In m; 1 where the platform only translates or only turns and no length is needed, and the
        size of a platform that is singular in every pose.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel, platform_length
    >>> round(platform_length(load_parallel("hexapod")), 2)
    0.27
    """
    if isinstance(robot, Mechanism):
        return platform_length(robot.robot) if robot.robot is not None else _mechanism_length(robot)
    motions_of(robot)
    return _length_of(robot)


@functools.lru_cache(maxsize=64)
def _length_of(robot: ParallelRobot) -> float:
    motions = motions_of(robot)
    if min(motions) >= _ANGULAR or max(motions) < _ANGULAR:
        return 1.0
    poses, q = held_poses(robot)
    K = limbs_at(robot, poses, q).rows()[0][..., list(motions)]
    turning = np.array([k < _ANGULAR for k in motions])
    regular = are_regular(K)
    singular_always = isinstance(robot, StewartGough) and robot.always_singular
    if singular_always or not regular.any():
        return size_of(robot)
    K, inverse = K[regular], np.linalg.inv(K[regular])
    # |K|^2 = a / L^2 + b and |K^-1|^2 = c L^2 + d.
    a, b = ((K[..., which] ** 2).sum(axis=(1, 2)) for which in (turning, ~turning))
    c, d = ((inverse[:, which] ** 2).sum(axis=(1, 2)) for which in (turning, ~turning))
    best = int(np.argmin(np.sqrt(a * c) + np.sqrt(b * d)))
    return float((a * d / (b * c))[best] ** 0.25)


@functools.lru_cache(maxsize=64)
def _mechanism_length(mechanism: Mechanism) -> float:
    """Find the characteristic length (m) of a mechanism, as :func:`platform_length` describes it.

    The size where no posture is regular.
    """
    q = _held_postures(mechanism)
    limbs = limb_wrenches(mechanism, mechanism.pose(q), q)
    S = limbs.motions(limbs.size)
    if not all((np.abs(part) > _ROUNDING).any() for part in (S[:, :_ANGULAR], S[:, _ANGULAR:])):
        return 1.0
    return _best_length(limbs, S) or mechanism.size


def _best_length(limbs: Wrenches, S: Array) -> float:
    """Return the length with the least condition number of any posture, 0 if none is regular."""
    # Unit twists in S, those that rotate most first: rotations and translations stay orthogonal.
    S = S @ np.swapaxes(np.linalg.svd(S[:, :_ANGULAR], full_matrices=True)[2], -1, -2)
    K = limbs.borne / np.repeat([limbs.size, 1.0], _ANGULAR) @ S
    kept = are_regular(K)
    if not kept.any():
        return 0.0
    K, turns = K[kept], (S[kept, :_ANGULAR] ** 2).sum(axis=1)
    moves = (S[kept, _ANGULAR:] ** 2).sum(axis=1)
    forward, back = (K**2).sum(axis=1), (np.linalg.inv(K) ** 2).sum(axis=2)
    middle, reach = 0.0, _RANGE
    for _ in range(_ROUNDS):
        powers = middle + np.linspace(-reach, reach, _LENGTHS)
        # Squared norms of the columns of S with the length over the size.
        stretched = turns[..., None] * 100.0**powers + moves[..., None]
        squares = (forward[..., None] / stretched).sum(axis=1) * (back[..., None] * stretched).sum(
            axis=1
        )
        middle = float(powers[int(np.argmin(squares.min(axis=0)))])
        reach *= 2.0 / (_LENGTHS - 1)
    return float(limbs.size * 10.0**middle)


def _held_postures(mechanism: Mechanism) -> Array:
    """Spread postures (k, n) over the mode of home, the same every time, within limits."""
    home, driven = mechanism.home(), mechanism.drive_index
    slides = mechanism.types[driven] == PRISMATIC
    free = np.where(slides, mechanism.size, np.pi)
    low, high = mechanism.lower[driven], mechanism.upper[driven]
    low = np.where(np.isfinite(low), low, home[driven] - free)
    high = np.where(np.isfinite(high), high, home[driven] + free)
    parts = (0.5 + np.arange(_POSTURES)[:, None] * low_discrepancy_strides(len(driven))) % 1.0
    q = np.vstack([home, mechanism.midway_postures(low + parts * (high - low))])
    inside = ~(mechanism.limit_excess(q) > 0.0).any(axis=1)
    return q[inside] if inside.any() else q


def singularity_distances(
    robot: AnyParallelRobot,
    T: ArrayLike,
    q: ArrayLike | None = None,
    *,
    length: float | None = None,
) -> Array:
    """Measure how far poses are from the singularities of both types.

    Parameters
    ----------
    robot, T, q
        As for :func:`velocity_matrices`.
    length : float, optional
        What makes linear and angular motions comparable (m); default :func:`platform_length`,
        which takes about a second to find and is kept.

    Returns
    -------
    ndarray, shape (..., 2)
        From type 1: the least entry of J over the greatest that it can be, 1 for legs, and for
        other limbs as they bend at the joint next to the drive; from
        type 2: the least singular value of K, angular columns divided by the length.  Both are
        without unit, and 0 where singular.
    """
    found = scaled_matrices(robot, T, q, length)
    second = np.linalg.svd(found.K, compute_uv=False)[..., -1]
    return np.stack((np.abs(found.J).min(axis=-1), second), axis=-1)


def dexterity(
    robot: AnyParallelRobot,
    T: ArrayLike,
    q: ArrayLike | None = None,
    *,
    length: float | None = None,
) -> Array | float:
    """Compute how evenly the drives move the platform: 1 where isotropic, 0 where singular.

    Parameters
    ----------
    robot, T, q, length
        As for :func:`singularity_distances`.

    Returns
    -------
    float or ndarray, shape (...)
        The reciprocal of the condition number of the map from drive rates to twists, both without
        units.

    References
    ----------
    Gosselin, Kinematic analysis, optimization and programming of parallel robotic manipulators,
    thesis, McGill University 1988.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import dexterity, load_parallel
    >>> eye = load_parallel("agile_eye")
    >>> round(dexterity(eye, np.eye(4), eye.inverse(np.eye(4)).q[0]), 6)
    1.0
    """
    found = inverse_condition(scaled_matrices(robot, T, q, length))
    return float(found) if found.ndim == 0 else found


def inverse_condition(found: ScaledMatrices) -> Array:
    """Return the reciprocal condition number (...) of the map between drives and twists."""
    values = np.linalg.svd(found.K, compute_uv=False)
    regular = (np.abs(found.J) > RANK).all(axis=-1) & (values[..., -1] > RANK * values[..., 0])
    entries = np.where(regular[..., None], found.J, 1.0)
    values = np.linalg.svd(found.K / entries[..., None], compute_uv=False)
    return np.where(regular, values[..., -1] / values[..., 0], 0.0)
