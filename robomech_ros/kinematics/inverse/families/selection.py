"""Selection of the solver of an arm, once per chain, by its geometry."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from robomech_ros._kernels.inverse import short_layout
from robomech_ros._kernels.inverse.decoupled import layout as decoupled_layout
from robomech_ros._kernels.inverse.six_joints import BACKWARDS, DECOUPLED, GENERAL, ITERATIVE
from robomech_ros._kernels.inverse.solutions import SHORT
from robomech_ros.kinematics.inverse.families import decoupled, general, iterative, redundant, short
from robomech_ros.kinematics.inverse.families.six_joints import (
    CLOSED_FORMS,
    chain_of,
    reversed_transforms,
)
from robomech_ros.kinematics.mobility import arm_size, mobility
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import unpack_chain
from robomech_ros.typing import Array, IntArray

# Least ratio of singular values, at the best of some postures, of an arm of which a list is called
# complete: with less, solutions are lost in rounding.
CERTAIN_MOBILITY = 1e-6


# Number of the family that has a kernel of its own.
REDUNDANT = 3


@dataclass(frozen=True, eq=False)
class Family:
    """A solver family with the constants it needs of one chain.

    The number is that of the family in the kernels, BACKWARDS added where the data is that of the
    inverse motion. ``turns`` (n,) is 1 for revolute joints; the limits (2, n) are those of the
    joints (rad or m), lower in front. The arm is ``certain`` if it is so far from having lost a
    degree of freedom that rounding hides nothing.
    """

    name: str
    number: int
    data: Array
    turns: IntArray
    limits: Array
    certain: bool

    @cached_property
    def arm(self) -> Array:
        """The arm as ``_kernels.inverse.solutions.solve`` reads it."""
        return np.concatenate(([self.number], self.turns, self.limits.ravel(), self.data))

    @property
    def closed_form(self) -> bool:
        """True if the family finds all solutions, of a redundant arm in all samples."""
        return self.number != ITERATIVE

    @cached_property
    def lists_all(self) -> bool:
        """True if the family finds all solutions of a pose at once, which are finitely many."""
        return self.closed_form and not self.redundant

    @property
    def redundant(self) -> bool:
        """True if solutions are samples of a self-motion."""
        return self.number == REDUNDANT

    @cached_property
    def exact(self) -> bool:
        """True if that is certain: not so for a wrist whose axes miss each other by micrometres."""
        if not self.certain:
            return False
        if self.number == SHORT:
            return bool(self.data[short_layout.EXACT])
        return self.number % BACKWARDS != DECOUPLED or bool(self.data[decoupled_layout.EXACT])


def _match_backwards(chain: SerialChain) -> Array | None:
    """Recognise an arm whose first three axes meet: read from its tip it has a spherical wrist."""
    if chain.n != 6:
        return None
    links = reversed_transforms(unpack_chain(chain.packed))
    return decoupled.match(chain_of(links, chain.types[::-1].tolist()))


_FAMILIES = (
    *CLOSED_FORMS,
    ("decoupled", BACKWARDS + DECOUPLED, _match_backwards),
    ("general-6r", GENERAL, lambda arm: None if arm.types.any() else general.match(arm)),
    ("general-6", GENERAL, general.match),
    ("redundant", REDUNDANT, redundant.match),
    ("short", SHORT, short.match),
)


@lru_cache(maxsize=128)
def family_of(chain: SerialChain) -> Family:
    """Find the first family whose geometry a chain has; the iterative one takes what is left.

    An arm whose wrist axes miss each other by micrometres is a general one, where it can be.
    """
    for name, number, match in () if chain.coupling else _FAMILIES:
        data = match(chain)
        if data is None:
            continue
        if number % BACKWARDS == DECOUPLED and not data[decoupled_layout.EXACT]:
            whole = general.match(chain)
            if whole is not None:
                name = "general-6" if chain.types.any() else "general-6r"
                return _family(chain, name, GENERAL, whole)
        return _family(chain, name, number, data)
    return iterative_family(chain, iterative.iterative_data(chain))


def iterative_family(chain: SerialChain, data: Array) -> Family:
    """Return the iterative family with constants made for a request of its own."""
    turns = chain.turns.astype(np.int64)
    limits = np.stack((chain.lower, chain.upper))
    return Family("iterative", ITERATIVE, data, turns, limits, certain=False)


def _family(chain: SerialChain, name: str, number: int, data: Array) -> Family:
    certain = number != REDUNDANT and mobility(chain, arm_size(chain)) > CERTAIN_MOBILITY
    return replace(iterative_family(chain, data), name=name, number=number, certain=certain)
