"""What inverse kinematics returns."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels import branch_bits as bit
from robomech_ros._kernels.quality import CONDITION, MARGIN, ORIENTATION, POSITION, measure
from robomech_ros.kinematics.branches import branch_name
from robomech_ros.kinematics.status import Status
from robomech_ros.robots.chain import SerialChain

__all__ = ["WHOLE_POSE", "InverseKinematicsResult", "written"]

Array = NDArray[np.float64]

WHOLE_POSE = (True, True, True, True, True, True)
_WHOLE_WEIGHTS = np.ones(6)


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

    def __len__(self) -> int:
        return len(self.q)

    @cached_property
    def continuum(self) -> bool:
        """Whether a solution stands for a continuum: joints can move while the pose stays."""
        return bool((self.branch_bits & bit.CONTINUUM).any())

    @cached_property
    def branches(self) -> tuple[str, ...]:
        """Names of the postures; empty strings where the family has none."""
        if self.family == "iterative":
            return ("",) * len(self.q)
        return tuple(branch_name(branch) for branch in self.branch_bits.tolist())

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


class _Draft:
    """A result whose fields are still written.

    What is not frozen is written thrice as fast; the fields of a frozen result, by itself, take a
    fourth of the time in which an arm is solved.
    """

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
        task: tuple[bool, ...],
        nearest: Array | None,
    ) -> None:
        self.chain = chain
        self.target = target
        self.q = q
        self.seed_distance = seed_distance
        self.family = family
        self.complete = complete
        self.status = status
        self.reason = reason
        self.blocking_joints = blocking_joints
        self.blocking_excess = blocking_excess
        self.branch_bits = branch_bits
        self.task = task
        self.nearest = nearest


def written(*fields: Any) -> InverseKinematicsResult:
    """Give the result with all these fields, in their order: the same, and faster."""
    result: Any = _Draft(*fields)
    result.__class__ = InverseKinematicsResult
    return cast("InverseKinematicsResult", result)
