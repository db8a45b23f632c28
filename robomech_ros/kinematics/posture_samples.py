"""Postures spread evenly over all that an arm can take, and how far it reaches in them."""

import numpy as np

from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, IntArray


def low_discrepancy_strides(n: int) -> Array:
    """Return the strides of an n-dimensional sequence that fills the unit cube evenly.

    They are the powers of the inverse of the root of x^(n + 1) = x + 1.

    Returns
    -------
    ndarray, shape (n,)
        Each in (0, 1).

    References
    ----------
    M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
    """
    root = 1.5
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (n + 1))
    return (root ** -np.arange(1.0, n + 1)) % 1.0


def sample_postures(chain: SerialChain, count: int) -> Array:
    """Spread postures evenly over what the joints can take: :func:`spread_values`.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.

    Returns
    -------
    ndarray, shape (count, n)
        Joint values (rad or m).
    """
    return spread_values(chain.types, chain.lower, chain.upper, count)


def spread_values(types: IntArray, lower: Array, upper: Array, count: int) -> Array:
    """Spread values evenly over what joints can take, the one in the middle first.

    Joints that can turn around are spread over a whole turn, slides with an open end over 2 m at
    least.

    Parameters
    ----------
    types : ndarray of int, shape (n,)
        PRISMATIC, or another type.
    lower, upper : ndarray, shape (n,)
        Limits (rad or m), infinite where there is none.

    Returns
    -------
    ndarray, shape (count, n)
        Joint values (rad or m).
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
