"""Names of postures, from the bits that the solvers give them."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.tolerances import SAME_POSTURE
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

_SINGULAR = (
    (bit.SHOULDER_SINGULAR, "shoulder-singular"),
    (bit.ELBOW_SINGULAR, "elbow-singular"),
    (bit.WRIST_SINGULAR, "wrist-singular"),
    (bit.SELF_MOTION, "self-motion"),
    (bit.BOUNDARY, "at-boundary"),
)


@lru_cache(maxsize=1024)
def branch_name(branch: int) -> str:
    """Name a posture by its bits, as ``"shoulder-left elbow-up wrist-flip"``; "" without a name."""
    if branch & bit.UNNAMED:
        return ""
    number = ((branch & bit.ARM_MASK) >> bit.ARM_SHIFT) + 1
    if branch & bit.POSTURE_NUMBERED:
        words = [f"posture-{number}"]
    elif branch & bit.ARM_NUMBERED:
        words = [f"arm-{number}"]
    else:
        words = [
            "shoulder-right" if branch & bit.SHOULDER_RIGHT else "shoulder-left",
            "elbow-down" if branch & bit.ELBOW_DOWN else "elbow-up",
        ]
    if not branch & bit.POSTURE_NUMBERED:
        words.append("wrist-flip" if branch & bit.WRIST_FLIP else "wrist-noflip")
    words += [word for mark, word in _SINGULAR if branch & mark]
    return " ".join(words)


def largest_difference(chain: SerialChain, postures: Array, q: Array) -> Array:
    """Largest difference of each posture (k, n) from q (n,), angles modulo a turn."""
    difference = postures - q
    turn = np.remainder(difference + math.pi, 2.0 * math.pi) - math.pi
    return np.abs(np.where(chain.turns, turn, difference)).max(axis=1)


def distinct_names(chain: SerialChain, q: Array, names: Sequence[str]) -> tuple[str, ...]:
    """Tell different postures q (k, n) of one name apart by numbers that are theirs, seed or not.

    Windings of one posture keep one name.  Beside a singular posture of an arm that is only nearly
    a special one, two may be on the same side of it.
    """
    unique, several = list(names), set(names) - {""}
    if len(several) == len(names):
        return tuple(names)
    for name in several:
        rows = [k for k, other in enumerate(names) if other == name]
        numbers = _numbers(chain, q[rows])
        for k, number in zip(rows, numbers if max(numbers) > 1 else (), strict=False):
            unique[k] = f"{name} number-{number}"
    return tuple(unique)


def numbered_names(chain: SerialChain, q: Array, branches: Sequence[int]) -> tuple[str, ...]:
    """Name postures q (k, n) that have no other names by numbers, and say what is singular.

    The numbers follow their joint values, so that the seed changes nothing.
    """
    names = []
    for number, branch in zip(_numbers(chain, q), branches, strict=True):
        words = [f"posture-{number}", *(word for mark, word in _SINGULAR if branch & mark)]
        names.append(" ".join(words))
    return tuple(names)


def _numbers(chain: SerialChain, q: Array) -> list[int]:
    """Assign numbers from 1 on to postures q (k, n) by joint values; windings share one."""
    turned = np.where(chain.turns, np.remainder(q, 2.0 * math.pi), q)
    found: list[int] = []
    for k in sorted(range(len(q)), key=lambda k: turned[k].tolist()):
        if not (largest_difference(chain, q[found], q[k]) < SAME_POSTURE).any():
            found.append(k)
    return [int(np.argmin(largest_difference(chain, q[found], one))) + 1 for one in q]
