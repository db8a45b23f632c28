"""Result of inverse kinematics."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.one_pose import BRANCHES, DISTANCES, TARGET
from robomech_ros._kernels.inverse.quality import CONDITION, MARGIN, ORIENTATION, POSITION, measure
from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.branch_names import (
    branch_name,
    distinct_names,
    numbered_names,
)
from robomech_ros.kinematics.inverse.result.near_branch_names import named_branches
from robomech_ros.kinematics.inverse.result.singular_marks import singular_marks
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.printing import MOST_LINES, Printed, brief
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, BoolArray, IntArray

NO_EXCESS = np.empty(0)
NO_EXCESS.setflags(write=False)

_measure = direct(measure)
_WHOLE_WEIGHTS = np.ones(6)
# Families that number the postures of arms that nearly are special ones.
_MAY_BE_NAMED = ("three-parallel", "general-6r")
# Those whose postures have nothing but numbers.
_NUMBERED_FAMILIES = ("short", "coupled", "iterative")
_NUMBERED = bit.ARM_NUMBERED | bit.POSTURE_NUMBERED


@dataclass(frozen=True, eq=False)
class Findings:
    """Facts about a list of solutions, which may be empty.

    It is complete if these are provably all solutions within the limits asked for, before any cap.
    The reason is in words, with numbers; empty where there is nothing to say. Where limits exclude
    everything, the blocking joints are outside in the least offending solution, each by its excess
    (rad or m). The task says which of x, y, z, rx, ry, rz, along and about the axes of the target,
    count as errors. Of an arm with fewer joints than conditions, where there is no solution,
    ``nearest`` (n,) is the posture inside the limits that misses the pose least in the sense of
    least squares (rad or m); the reason says by how much. Where a scene was given, ``clearances``
    (k,) are the least distances (m) between bodies at the solutions.
    """

    family: str
    complete: bool
    status: Status
    reason: str = ""
    blocking_joints: tuple[str, ...] = ()
    blocking_excess: Array = field(default_factory=lambda: NO_EXCESS)
    task: tuple[bool, ...] = FULL_TASK
    nearest: Array | None = None
    clearances: Array | None = None


class Listing(NamedTuple):
    """``T_base_tip`` wanted (4, 4), m, and for each of k solutions seed distance and bits."""

    target: Array
    seed_distance: Array
    branch_bits: IntArray


def read_listing(space: Array, count: int) -> Listing:
    """Read what ``_kernels.inverse.one_pose`` has written, of the first ``count`` solutions."""
    rest = space.reshape(-1)[MAX_SOLUTIONS * space.shape[1] :]
    return Listing(
        rest[TARGET:DISTANCES].reshape(4, 4),
        rest[DISTANCES : DISTANCES + count],
        rest[BRANCHES : BRANCHES + count].astype(np.int64),
    )


@dataclass(frozen=True, eq=False, init=False)
class InverseKinematicsResult(Printed):
    """Solutions of inverse kinematics, nearest to the seed first, or why there are none.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : ndarray, shape (k, n)
        Joint values (rad or m).
    findings : Findings
        What is known of them; its fields are attributes of the result, too.
    listing : Listing or ndarray
        Target, distances and branches, whose names are attributes of the result, too; or the space
        in which ``_kernels.inverse.one_pose`` wrote them, which is read when they are asked for.
    """

    chain: SerialChain
    q: Array
    findings: Findings
    listing: Listing | Array = field(repr=False)

    def __init__(
        self, chain: SerialChain, q: Array, findings: Findings, listing: Listing | Array
    ) -> None:
        # As a frozen dataclass writes its fields by itself, they take twice as long.
        fields = self.__dict__
        fields["chain"] = chain
        fields["q"] = q
        fields["findings"] = findings
        fields["listing"] = listing

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        return f"InverseKinematicsResult({self._headline()})"

    def __str__(self) -> str:
        lines = [self._headline()]
        if self.reason:
            lines.append(f"  {self.reason}")
        most = MOST_LINES - len(lines)
        shown = len(self) if len(self) <= most else most - 1
        for q, branch in zip(self.q[:shown], self.branches, strict=False):
            lines.append(f"  {brief(q)} {branch}".rstrip())
        if len(self) > shown:
            lines.append(f"  and {len(self) - shown} more, in q")
        return "\n".join(lines)

    def _headline(self) -> str:
        count = counted(len(self), "solution")
        more = "these are all" if self.complete else "there may be more"
        return f"{count} of {self.chain.name}, {more} ({self.family}, {self.status.name})"

    def within(self, position: float, orientation: float) -> InverseKinematicsResult:
        """Return the solutions with errors of at most ``position`` m and ``orientation`` rad."""
        good = (self.position_error <= position) & (self.orientation_error <= orientation)
        if good.all():
            return self
        findings = self.findings
        if not good.any():
            reason = "no posture of the closed form keeps the tolerances asked for"
            findings = replace(findings, status=Status.NOT_CONVERGED, complete=False, reason=reason)
        return self.keep(good, findings)

    @property
    def family(self) -> str:
        """Solver family used."""
        return self.findings.family

    @property
    def complete(self) -> bool:
        """True if these are provably all solutions within the limits, before any cap."""
        return self.findings.complete

    @property
    def status(self) -> Status:
        """Outcome of the solution."""
        return self.findings.status

    @property
    def reason(self) -> str:
        """Status in words, with numbers; empty where there is nothing to say."""
        return self.findings.reason

    @property
    def blocking_joints(self) -> tuple[str, ...]:
        """Joints outside their limits in the least offending solution, if limits exclude all."""
        return self.findings.blocking_joints

    @property
    def blocking_excess(self) -> Array:
        """By how much each of the blocking joints is outside its limits (rad or m)."""
        return self.findings.blocking_excess

    @property
    def task(self) -> tuple[bool, ...]:
        """Mask of x, y, z, rx, ry, rz, along and about the target's axes, that count as errors."""
        return self.findings.task

    @property
    def nearest(self) -> Array | None:
        """The posture (n,) that misses the pose least; None where it was not searched."""
        return self.findings.nearest

    @property
    def clearances(self) -> Array | None:
        """Least distance (m) between bodies at each solution, shape (k,); None without a scene."""
        return self.findings.clearances

    def keep(self, rows: BoolArray | IntArray, findings: Findings) -> InverseKinematicsResult:
        """Return the result with some of the solutions, by a mask or numbers, and new findings."""
        listing = Listing(self.target, self.seed_distance[rows], self.branch_bits[rows])
        return InverseKinematicsResult(self.chain, self.q[rows], findings, listing)

    @cached_property
    def _listing(self) -> Listing:
        given = self.listing
        return given if isinstance(given, Listing) else read_listing(given, len(self.q))

    @property
    def target(self) -> Array:
        """``T_base_tip`` wanted (m), shape (4, 4)."""
        return self._listing.target

    @property
    def seed_distance(self) -> Array:
        """Distance of each solution from the seed, shape (k,)."""
        return self._listing.seed_distance

    @property
    def branch_bits(self) -> IntArray:
        """Postures as bits, shape (k,); :attr:`branches` has their names."""
        return self._listing.branch_bits

    @cached_property
    def continuum(self) -> bool:
        """True if a solution stands for a continuum: joints can move while the pose stays."""
        return bool((self.branch_bits & bit.CONTINUUM).any())

    @cached_property
    def branches(self) -> tuple[str, ...]:
        """Names of the postures, all different except for windings and samples of a self-motion.

        Where nothing is known of shoulder, elbow and wrist, as of planar arms and partial tasks,
        they are numbers; samples of the self-motion of a redundant arm may have empty names.
        """
        bits = self.branch_bits
        if self.family in _NUMBERED_FAMILIES:
            if self.family == "short":
                bits = bits | singular_marks(self.chain, self.target, self.task, self.q)
            return numbered_names(self.chain, self.q, bits.tolist())
        if self.family in _MAY_BE_NAMED and (bits & _NUMBERED).any():
            bits = named_branches(self.chain, self.q, bits)
        names = tuple(branch_name(branch) for branch in bits.tolist())
        return names if self.family == "redundant" else distinct_names(self.chain, self.q, names)

    @cached_property
    def _measured(self) -> Array:
        out = np.empty((4, len(self.q)))
        weights = _WHOLE_WEIGHTS if self.task == FULL_TASK else np.roll(self.task, 3) * 1.0
        chain, target, q = self.chain, *map(np.ascontiguousarray, (self.target, self.q))
        _measure(chain.packed, target, weights, chain.lower, chain.upper, q, out)
        return out

    @property
    def position_error(self) -> Array:
        """Distance (m) between wanted and reached position, shape (k,)."""
        return self._measured[POSITION]

    @property
    def orientation_error(self) -> Array:
        """Angle (rad) between wanted and reached orientation, shape (k,)."""
        return self._measured[ORIENTATION]

    @property
    def limit_margin(self) -> Array:
        """Distance (rad or m) of the joint nearest to a limit, shape (k,); negative is outside."""
        return self._measured[MARGIN]

    @property
    def condition_number(self) -> Array:
        """Condition number of the Jacobian in SI units, shape (k,); infinite where singular."""
        return self._measured[CONDITION]
