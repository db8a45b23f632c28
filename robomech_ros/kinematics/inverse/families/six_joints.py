"""Six-joint arms that are solved completely, alone or inside longer and shorter chains."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.inverse.general import layout as general_layout
from robomech_ros._kernels.inverse.six_joints import DECOUPLED, GENERAL, THREE_PARALLEL
from robomech_ros.kinematics.inverse.families import decoupled, general, three_parallel
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import pack_chain
from robomech_ros.robots.limit_arrays import limit_arrays
from robomech_ros.typing import Array

# Families of six-joint arms, the most special first: name, number in the kernels, recognition.
CLOSED_FORMS: tuple[tuple[str, int, Callable[[SerialChain], Array | None]], ...] = (
    ("decoupled", DECOUPLED, decoupled.match),
    ("three-parallel", THREE_PARALLEL, three_parallel.match),
)


@dataclass(frozen=True, eq=False)
class SixJointArm:
    """Solver of six joints: the family in the kernels, and the constants that it reads.

    These are ``backwards`` if they are those of the inverse motion, from the tip to the base.
    """

    family: int
    backwards: bool
    data: Array


def match_six(transforms: Array, types: Sequence[int]) -> SixJointArm | None:
    """Find the closed form of six joints, from transforms C_0 .. C_6 (7, 4, 4), m, and their types.

    The first family that matches counts, each asked forwards and then backwards: an arm whose first
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


def match_general(
    candidates: Iterable[tuple[Array, Sequence[int]]],
) -> tuple[int, SixJointArm] | None:
    """Find the best of some arms of six joints for elimination, which assumes no special geometry.

    The candidates are as for :func:`match_six`. Returns which one, and how it is solved: the first
    one of which every random pose is solved with nothing in doubt, else the one with most of them.
    """
    best: tuple[float, int, SixJointArm] | None = None
    for number, (transforms, types) in enumerate(candidates):
        data = general.match(chain_of(transforms, types))
        if data is None:
            continue
        clean = float(data[general_layout.CLEAN])
        if best is None or clean > best[0]:
            best = clean, number, SixJointArm(GENERAL, False, data)
        if clean == 1.0:
            break
    return None if best is None else best[1:]


def reversed_transforms(transforms: Array) -> Array:
    """Return the constant transforms of the inverse motion, from the tip to the base."""
    return np.linalg.inv(transforms[::-1]).astype(np.float64)


def chain_of(transforms: Array, types: Sequence[int]) -> SerialChain:
    """Make a chain without names or limits of transforms C_0 .. C_n (n + 1, 4, 4) and types."""
    n = len(types)
    kinds = np.array(types, dtype=np.int64)
    return SerialChain(
        name="part",
        base="base",
        tip="tip",
        joint_names=tuple(f"joint_{i + 1}" for i in range(n)),
        types=kinds,
        packed=pack_chain(transforms, kinds),
        **limit_arrays(None, n),
    )
