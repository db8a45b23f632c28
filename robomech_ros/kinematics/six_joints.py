"""Six-joint arms with a closed form, forwards or backwards, alone or inside longer chains."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.six_joints import DECOUPLED, THREE_PARALLEL
from robomech_ros.kinematics import decoupled, three_parallel
from robomech_ros.robots.chain import SerialChain, pack_chain

__all__ = ["CLOSED_FORMS", "SixJointArm", "chain_of", "match_six", "reversed_transforms"]

Array = NDArray[np.float64]

# Families of six-joint arms, the most special first: name, number in the kernels, recognition.
CLOSED_FORMS: tuple[tuple[str, int, Callable[[SerialChain], Array | None]], ...] = (
    ("decoupled", DECOUPLED, decoupled.match),
    ("three-parallel", THREE_PARALLEL, three_parallel.match),
)


@dataclass(frozen=True, eq=False)
class SixJointArm:
    """A closed form for six joints.

    Parameters
    ----------
    family : int
        The family in the kernels.
    backwards : bool
        Whether the constants are those of the inverse motion, from the tip to the base.
    data : ndarray
        The constants, as the family's kernel reads them.
    """

    family: int
    backwards: bool
    data: Array


def match_six(transforms: Array, types: Sequence[int]) -> SixJointArm | None:
    """Find the closed form of six joints.

    Parameters
    ----------
    transforms : ndarray, shape (7, 4, 4)
        C_0 .. C_6 of :class:`SerialChain` (m).
    types : sequence of 6 int
        0 revolute, 1 prismatic.

    Returns
    -------
    SixJointArm or None
        The first family that matches, each asked forwards and then backwards: an arm whose first
        three axes meet is decoupled when it is read from its tip.
    """
    forwards = chain_of(transforms, types)
    backwards = chain_of(reversed_transforms(transforms), types[::-1])
    for _, number, match in CLOSED_FORMS:
        for reverse, chain in ((False, forwards), (True, backwards)):
            data = match(chain)
            if data is not None:
                return SixJointArm(number, reverse, data)
    return None


def reversed_transforms(transforms: Array) -> Array:
    """Give the constant transforms of the inverse motion, from the tip to the base."""
    inverse: Array = np.linalg.inv(transforms[::-1]).astype(np.float64)
    return inverse


def chain_of(transforms: Array, types: Sequence[int]) -> SerialChain:
    """Make a chain without names and limits.

    Parameters
    ----------
    transforms : ndarray, shape (n + 1, 4, 4)
        C_0 .. C_n (m).
    types : sequence of n int
        0 revolute, 1 prismatic.
    """
    n = len(types)
    kinds = np.array(types, dtype=np.int64)
    missing = np.full(n, np.nan)
    return SerialChain(
        name="part",
        base="base",
        tip="tip",
        joint_names=tuple(f"joint_{i + 1}" for i in range(n)),
        types=kinds,
        packed=pack_chain(transforms, kinds),
        lower=np.full(n, -np.inf),
        upper=np.full(n, np.inf),
        velocity=missing,
        acceleration=missing,
        jerk=missing,
        effort=missing,
    )
