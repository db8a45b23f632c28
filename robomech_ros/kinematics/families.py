"""Which solver an arm gets: decided once for a chain, by its geometry."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels import decoupled_layout, short_layout
from robomech_ros._kernels.inverse import SHORT
from robomech_ros._kernels.six_joints import DECOUPLED, GENERAL, ITERATIVE
from robomech_ros.kinematics import decoupled, general_6r, iterative, redundant, short
from robomech_ros.kinematics.six_joints import CLOSED_FORMS
from robomech_ros.robots.chain import REVOLUTE, SerialChain

__all__ = ["REDUNDANT", "Family", "family_of", "iterative_family"]

Array = NDArray[np.float64]

# Number of the family that has a kernel of its own.
REDUNDANT = 3


@dataclass(frozen=True, eq=False)
class Family:
    """A solver family with the constants it needs of one chain.

    Parameters
    ----------
    name : str
        ``"decoupled"``, ``"three-parallel"``, ``"general-6r"``, ``"redundant"``, ``"short"`` or
        ``"iterative"``.
    number : int
        The family in the kernels.
    data : ndarray
        The constants, as the family's kernel reads them.
    turns : ndarray of int, shape (n,)
        1 for revolute joints.
    """

    name: str
    number: int
    data: Array
    turns: NDArray[np.int64]

    @property
    def closed_form(self) -> bool:
        """Whether the family finds all solutions, of a redundant arm in all samples."""
        return self.number != ITERATIVE

    @property
    def redundant(self) -> bool:
        """Whether solutions are samples of a self-motion."""
        return self.number == REDUNDANT

    @property
    def exact(self) -> bool:
        """Whether that is certain: no wrist whose axes meet but for some micrometres."""
        if self.number == SHORT:
            return bool(self.data[short_layout.EXACT])
        return self.number != DECOUPLED or bool(self.data[decoupled_layout.EXACT])


_FAMILIES = (
    *CLOSED_FORMS,
    ("general-6r", GENERAL, general_6r.match),
    ("redundant", REDUNDANT, redundant.match),
    ("short", SHORT, short.match),
)


@lru_cache(maxsize=128)
def family_of(chain: SerialChain) -> Family:
    """Find the first family whose geometry a chain has; the iterative one takes what is left.

    An arm whose wrist axes meet but for some micrometres is a general one, where it can be.

    Parameters
    ----------
    chain : SerialChain
    """
    for name, number, match in _FAMILIES:
        data = match(chain)
        if data is None:
            continue
        if number == DECOUPLED and not decoupled.polishes_well(chain):
            general = general_6r.match(chain)
            if general is not None:
                return Family("general-6r", GENERAL, general, _turns(chain))
        return Family(name, number, data, _turns(chain))
    return iterative_family(chain, iterative.iterative_data(chain))


def iterative_family(chain: SerialChain, data: Array) -> Family:
    """Give the iterative family with constants made for a request of its own."""
    return Family("iterative", ITERATIVE, data, _turns(chain))


def _turns(chain: SerialChain) -> NDArray[np.int64]:
    turns: NDArray[np.int64] = (chain.types == REVOLUTE).astype(np.int64)
    return turns
