"""Postures spread evenly over all that an arm can take, and how far it reaches in them."""

import numpy as np

from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, IntArray


def low_discrepancy_strides(n: int) -> Array:
    """Return the strides (n,) in (0, 1) of a sequence that fills the unit cube evenly.

    They are the powers of the inverse of the root of x^(n + 1) = x + 1 (M. Roberts, The
    unreasonable effectiveness of quasirandom sequences, 2018).
    """
    root = 1.5
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (n + 1))
    return (root ** -np.arange(1.0, n + 1)) % 1.0


def sample_postures(chain: SerialChain, count: int) -> Array:
    """Spread postures (count, n), rad or m, evenly over what the joints can take."""
    return spread_values(chain.types, chain.lower, chain.upper, count)


def spread_values(types: IntArray, lower: Array, upper: Array, count: int) -> Array:
    """Spread values (count, n) evenly over what joints can take, the one in the middle first.

    Joints that can turn around are spread over a whole turn, slides with an open end over 2 m at
    least. The types (n,) are PRISMATIC, or another; the limits (n,) infinite where there is none
    (rad or m).
    """
    whole = (types != PRISMATIC) & ~(upper - lower < 2.0 * np.pi)
    open_below = np.minimum(-1.0, upper - 2.0)
    least = np.where(whole, -np.pi, np.where(np.isfinite(lower), lower, open_below))
    most = np.where(whole, np.pi, np.where(np.isfinite(upper), upper, least + 2.0))
    share = (0.5 + np.arange(count)[:, None] * low_discrepancy_strides(len(types))) % 1.0
    return least + share * (most - least)


def reach_bound(chain: SerialChain) -> float:
    """Return an upper bound on the distance (m) between base and tip, prismatic travel included."""
    fixed = float(np.linalg.norm(chain.packed[:, 10:13], axis=1).sum())
    sliding = chain.types == PRISMATIC
    travel = np.maximum(np.abs(chain.lower), np.abs(chain.upper))[sliding]
    return fixed + float(travel[np.isfinite(travel)].sum())
