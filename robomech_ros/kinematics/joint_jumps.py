"""Jumps: where a joint path cannot go on continuously."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class Jump:
    """Discontinuity of a joint path.

    Parameters
    ----------
    index : int
        The pose that is reached by the jump, from pose ``index`` - 1 (or the start, for 0).
    move : ndarray, shape (n,)
        What every joint moves there (rad or m).
    reason : str
        In words: another branch, or another winding of a joint that would leave its limits.
    """

    index: int
    move: Array
    reason: str


def shortest_moves(chain: SerialChain, difference: Array) -> Array:
    """Take the difference of angles modulo a turn, in [-pi, pi)."""
    turned = np.remainder(difference + np.pi, 2.0 * np.pi) - np.pi
    return np.where(chain.turns, turned, difference)


def find_jumps(
    chain: SerialChain, q: Array, origin: Array | None, largest: Array
) -> tuple[Jump, ...]:
    """List the moves that are jumps."""
    if not len(q):
        return ()
    path = q if origin is None else np.vstack((origin, q))
    moves = np.diff(path, axis=0)
    first = 1 if origin is None else 0
    jumps = []
    for k in np.flatnonzero((np.abs(moves) > largest).any(axis=1)).tolist():
        branch = (np.abs(shortest_moves(chain, moves[k])) > largest).any()
        names = [chain.joint_names[i] for i in np.flatnonzero(np.abs(moves[k]) > largest)]
        joints = ", ".join(f"'{name}'" for name in names)
        reason = "to another branch" if branch else "to another winding, at a joint limit"
        jumps.append(Jump(k + first, moves[k], f"joints {joints} jump {reason}"))
    return tuple(jumps)
