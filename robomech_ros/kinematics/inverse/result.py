"""What inverse kinematics returns."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.one_pose import DISTANCES, MARKED, TARGET
from robomech_ros._kernels.inverse.quality import CONDITION, MARGIN, ORIENTATION, POSITION, measure
from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS
from robomech_ros.kinematics.inverse.branches import branch_name
from robomech_ros.kinematics.inverse.naming import distinct, named_branches
from robomech_ros.kinematics.inverse.status import Status
from robomech_ros.robots.chain import SerialChain

__all__ = [
    "WHOLE_POSE",
    "Draft",
    "InverseKinematicsResult",
    "branches_in",
    "finished",
    "target_in",
]

Array = NDArray[np.float64]

WHOLE_POSE = (True, True, True, True, True, True)
_WHOLE_WEIGHTS = np.ones(6)
# Families that number the postures of arms that nearly are special ones.
_MAY_BE_NAMED = ("three-parallel", "general-6r")
_NUMBERED = bit.ARM_NUMBERED | bit.POSTURE_NUMBERED


@dataclass(frozen=True, eq=False, init=False)
class InverseKinematicsResult:
    """Solutions of inverse kinematics, nearest to the seed first, or why there are none.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    target : ndarray, shape (4, 4)
        ``T_base_tip`` wanted (m).
    q : ndarray, shape (k, n)
        Joint values (rad or m).
    seed_distance : ndarray, shape (k,)
        Distance of each from the seed.
    family : str
        Solver family used.
    complete : bool
        Whether these are provably all solutions within the limits asked for, before any cap.
    status : Status
    reason : str
        In words, with numbers; empty where there is nothing to say.
    blocking_joints : tuple of str
        Where limits exclude everything: the joints outside in the least offending solution.
    blocking_excess : ndarray
        By how much each of them is outside (rad or m).
    branch_bits : ndarray of int, shape (k,)
        Postures as bits; :attr:`branches` has their names.
    task : tuple of six bool
        Which of x, y, z, rx, ry, rz, along and about the axes of the target, count as errors.
    nearest : ndarray, shape (n,), or None
        Of an arm with fewer joints than conditions, where there is no solution: the posture inside
        the limits that misses the pose least in the sense of least squares (rad or m); by how much
        says the reason.
    """

    chain: SerialChain
    target: Array
    q: Array
    seed_distance: Array
    family: str
    complete: bool
    status: Status
    reason: str
    blocking_joints: tuple[str, ...]
    blocking_excess: Array
    branch_bits: NDArray[np.int64]
    task: tuple[bool, ...]
    nearest: Array | None

    def __init__(
        self,
        chain: SerialChain,
        target: Array,
        q: Array,
        seed_distance: Array,
        family: str,
        complete: bool,
        status: Status,
        reason: str,
        blocking_joints: tuple[str, ...],
        blocking_excess: Array,
        branch_bits: NDArray[np.int64],
        task: tuple[bool, ...] = WHOLE_POSE,
        nearest: Array | None = None,
    ) -> None:
        # At once: to write the fields of a frozen dataclass one by one takes thrice as long.
        vars(self).update(
            chain=chain,
            target=target,
            q=q,
            seed_distance=seed_distance,
            family=family,
            complete=complete,
            status=status,
            reason=reason,
            blocking_joints=blocking_joints,
            blocking_excess=blocking_excess,
            branch_bits=branch_bits,
            task=task,
            nearest=nearest,
        )

    if not TYPE_CHECKING:  # or a misspelt name would pass for a field

        def __getattr__(self, name: str) -> Array | NDArray[np.int64]:
            """Take a field out of the kernel's space when it is asked for first."""
            if name not in _LATE:
                kind = type(self).__name__
                raise AttributeError(
                    f"{kind!r} object has no attribute {name!r}", name=name, obj=self
                )
            value = _LATE[name](self._space, len(self.q))
            vars(self)[name] = value
            return value

    def __len__(self) -> int:
        return len(self.q)

    @cached_property
    def continuum(self) -> bool:
        """Whether a solution stands for a continuum: joints can move while the pose stays."""
        return bool((self.branch_bits & bit.CONTINUUM).any())

    @cached_property
    def branches(self) -> tuple[str, ...]:
        """Names of the postures, all different but for windings and samples of a self-motion.

        They are empty strings where the family has none.
        """
        if self.family == "iterative":
            return ("",) * len(self.q)
        bits = self.branch_bits
        if self.family in _MAY_BE_NAMED and (bits & _NUMBERED).any():
            bits = named_branches(self.chain, self.q, bits)
        names = tuple(branch_name(branch) for branch in bits.tolist())
        return names if self.family == "redundant" else distinct(self.chain, self.q, names)

    @cached_property
    def _measured(self) -> Array:
        out = np.empty((4, len(self.q)))
        weights = _WHOLE_WEIGHTS if self.task == WHOLE_POSE else np.roll(self.task, 3) * 1.0
        chain = self.chain
        measure(chain.packed, self.target, weights, chain.lower, chain.upper, self.q, out)
        return out

    def _row(self, number: int) -> Array:
        row: Array = self._measured[number]
        return row

    @property
    def position_error(self) -> Array:
        """Distance (m) between wanted and reached position, shape (k,)."""
        return self._row(POSITION)

    @property
    def orientation_error(self) -> Array:
        """Angle (rad) between wanted and reached orientation, shape (k,)."""
        return self._row(ORIENTATION)

    @property
    def limit_margin(self) -> Array:
        """Distance (rad or m) of the joint nearest to a limit, shape (k,); negative is outside."""
        return self._row(MARGIN)

    @property
    def condition_number(self) -> Array:
        """Condition number of the Jacobian in SI units, shape (k,); infinite where singular."""
        return self._row(CONDITION)


class Draft:
    """A result whose fields are still written.

    What is not frozen is written thrice as fast; the fields of a frozen result, by itself, take a
    fourth of the time in which an arm is solved.  What callers ask for less often stays in the
    ``space`` that ``_kernels.inverse_one`` has filled, until they do.
    """

    def __init__(
        self,
        chain: SerialChain,
        space: Array,
        q: Array,
        family: str,
        complete: bool,
        status: Status,
        reason: str,
        blocking_joints: tuple[str, ...],
        blocking_excess: Array,
        task: tuple[bool, ...],
        nearest: Array | None,
    ) -> None:
        self.chain = chain
        self._space = space
        self.q = q
        self.family = family
        self.complete = complete
        self.status = status
        self.reason = reason
        self.blocking_joints = blocking_joints
        self.blocking_excess = blocking_excess
        self.task = task
        self.nearest = nearest


def finished(draft: Any) -> InverseKinematicsResult:
    """Make a draft the result that it is."""
    draft.__class__ = InverseKinematicsResult
    return cast("InverseKinematicsResult", draft)


def target_in(space: Array) -> Array:
    """Find the pose (4, 4) in what ``_kernels.inverse_one`` has written."""
    return _rest(space)[TARGET:DISTANCES].reshape(4, 4)


def branches_in(space: Array, count: int) -> NDArray[np.int64]:
    """Find the branches of the first ``count`` solutions there."""
    return _rest(space)[MARKED : MARKED + count].astype(np.int64)


def _distances_in(space: Array, count: int) -> Array:
    return _rest(space)[DISTANCES : DISTANCES + count]


def _rest(space: Array) -> Array:
    return space.reshape(-1)[MAX_SOLUTIONS * space.shape[1] :]


# Fields that may stand in the space of the kernel only, and how to find them for so many solutions.
_LATE: dict[str, Callable[[Array, int], Array | NDArray[np.int64]]] = {
    "target": lambda space, _: target_in(space),
    "seed_distance": _distances_in,
    "branch_bits": branches_in,
}
