"""Shoulder, elbow and wrist of arms that only nearly have them.

Descriptions with rounded angles, 1.5708 for a right one, have wrist axes that miss each other by a
little, or axes that are not quite parallel.  Such an arm is solved by a family that assumes
nothing about it, which numbers its postures.  The solver of the family it nearly belongs to knows
their names: polished on the arm as it is, it finds the same postures, all but some beside singular
ones.
"""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels import branch_bits as bit
from robomech_ros._kernels import decoupled_layout, parallel_layout
from robomech_ros._kernels.six_joints import (
    DECOUPLED,
    MAX_SOLUTIONS,
    THREE_PARALLEL,
    six_joint_postures,
)
from robomech_ros._kernels.tolerances import NEARLY_NAMED, SAME_NAMED, SAME_POSTURE
from robomech_ros.kinematics import decoupled, three_parallel
from robomech_ros.robots.chain import REVOLUTE, SerialChain

__all__ = ["distinct", "named_branches"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_NAME = bit.SHOULDER_RIGHT | bit.ELBOW_DOWN | bit.WRIST_FLIP
_NUMBER = bit.ARM_NUMBERED | bit.POSTURE_NUMBERED | bit.ARM_MASK


def named_branches(chain: SerialChain, T: Array, q: Array, branch: Integers) -> Integers:
    """Give numbered postures of an arm of six joints the names they nearly have.

    Parameters
    ----------
    chain : SerialChain
    T : ndarray, shape (4, 4)
        The pose they solve (m).
    q : ndarray, shape (k, 6)
        The postures (rad or m).
    branch : ndarray of int, shape (k,)
        Their bits.

    Returns
    -------
    ndarray of int, shape (k,)
        Bits with names in place of numbers, but for postures beside a singular one that the nearly
        special arm has not, and for arms far from special ones, which keep them.
    """
    family = _namesake(chain)
    if family is None or not len(q):
        return branch
    number, data = family
    others, bits = np.empty((MAX_SOLUTIONS, 6)), np.empty(MAX_SOLUTIONS, np.int64)
    count = six_joint_postures(number, False, data, T, q[0], others, bits)
    named = branch.copy()
    for k in range(len(q) if count else 0):
        away = _apart(chain, others[:count], q[k])
        nearest = int(np.argmin(away))
        if away[nearest] < SAME_NAMED and not bits[nearest] & bit.CONTINUUM:
            named[k] = branch[k] & ~(_NUMBER | _NAME) | bits[nearest] & _NAME
    return named


@lru_cache(maxsize=128)
def _namesake(chain: SerialChain) -> tuple[int, Array] | None:
    """Find the family with named postures that an arm nearly belongs to, and its constants."""
    data = decoupled.match(chain, NEARLY_NAMED)
    if data is not None and data[decoupled_layout.NAMED] != 0.0:
        return DECOUPLED, data
    data = three_parallel.match(chain, NEARLY_NAMED, NEARLY_NAMED)
    if data is not None and data[parallel_layout.NAMED] != 0.0:
        return THREE_PARALLEL, data
    return None


def _apart(chain: SerialChain, postures: Array, q: Array) -> Array:
    """Largest difference of each posture (k, n) from q (n,), angles modulo a turn."""
    difference = postures - q
    turn = np.remainder(difference + math.pi, 2.0 * math.pi) - math.pi
    largest: Array = np.abs(np.where(chain.types == REVOLUTE, turn, difference)).max(axis=1)
    return largest


def distinct(chain: SerialChain, q: Array, names: Sequence[str]) -> tuple[str, ...]:
    """Tell different postures q (k, n) of one name apart by numbers that are theirs, seed or not.

    Windings of one posture keep one name.  Beside a singular posture of an arm that is only nearly
    a special one, two may be on the same side of it.
    """
    unique, several = list(names), set(names) - {""}
    if len(several) == len(names):
        return tuple(names)
    for name in several:
        rows = [k for k, other in enumerate(names) if other == name]
        rows.sort(key=lambda k: np.remainder(q[k], 2.0 * math.pi).tolist())
        found: list[int] = []
        for k in rows:
            away = _apart(chain, q[found], q[k])
            if not (away < SAME_POSTURE).any():
                found.append(k)
        for k in rows if len(found) > 1 else ():
            which = int(np.argmin(_apart(chain, q[found], q[k])))
            unique[k] = f"{name} number-{which + 1}"
    return tuple(unique)
