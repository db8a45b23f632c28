"""The characteristic length of limbs of any kind."""

from __future__ import annotations

import functools

import numpy as np

from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.parallel.kinetostatics.limb_wrenches import Wrenches, limb_wrenches
from robomech_ros.parallel.kinetostatics.square_systems import are_regular
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array

_ANGULAR = 3
_POSTURES = 256
# Parts of unit twists below which they are zero.
_ROUNDING = 1e-9
# Powers of ten of the size between which lengths are looked for, how many at a time, how often.
_RANGE, _LENGTHS, _ROUNDS = 4.0, 65, 9


@functools.lru_cache(maxsize=64)
def mechanism_length(mechanism: Mechanism) -> float:
    """Find the characteristic length (m) of a mechanism, as :func:`platform_length` describes it.

    The size where no posture is regular.
    """
    q = _held_postures(mechanism)
    limbs = limb_wrenches(mechanism, mechanism.pose(q), q)
    S = limbs.motions(limbs.size)
    if not all((np.abs(part) > _ROUNDING).any() for part in (S[:, :_ANGULAR], S[:, _ANGULAR:])):
        return 1.0
    return _best(limbs, S) or mechanism.size


def _best(limbs: Wrenches, S: Array) -> float:
    """Return the length with the least condition number of any posture, 0 if none is regular."""
    # Of unit twists in S those that turn most first: turns and displacements stay orthogonal.
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
        # Of columns of S the squares of the norms with the length over the size.
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
