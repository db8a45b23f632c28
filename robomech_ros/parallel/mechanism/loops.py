"""The loops of a mechanism as the kernels read them, and calls of the kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros._kernels.loops import loop_closure, rates
from robomech_ros._kernels.loops.factors import FREE, NOT_FINITE
from robomech_ros.errors import NonFiniteError, SingularPostureError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.result import LoopClosure
from robomech_ros.robots import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, IntArray

# Loops that are this far from closed (rad, m over the size) were not closed to begin with.
_OPEN = 1e-6


@dataclass(frozen=True, eq=False)
class Loops:
    """Chains from one base to one platform.

    The chains are packed one after another, (n + limbs, 13), as
    :class:`robomech_ros.robots.SerialChain` packs them.  The starts (limbs + 1,) are the first
    joint of each chain, and the number of all joints; the drives (n,) are of each joint the number
    of its drive, or -1.  The size is the longest constant offset (m), 1 where there is none, and
    the weights (n,) are 1 for joints that turn, 1 / size for those that slide.
    """

    packed: Array
    starts: IntArray
    drives: IntArray
    size: float
    weights: Array

    @classmethod
    def of(cls, chains: Sequence[SerialChain], driven: IntArray) -> Loops:
        """Lay out chains, of which the joints of the given numbers are driven."""
        packed = np.concatenate([chain.packed for chain in chains])
        starts = np.cumsum([0, *(chain.n for chain in chains)])
        drives = np.full(starts[-1], -1)
        drives[driven] = np.arange(len(driven))
        size = float(np.linalg.norm(packed[:, 10:], axis=1).max()) or 1.0
        slides = np.concatenate([chain.types for chain in chains]) == PRISMATIC
        return cls(packed, starts, drives, size, np.where(slides, 1.0 / size, 1.0))

    @cached_property
    def chains(self) -> tuple[Array, IntArray, IntArray, float]:
        """The first arguments of all kernels of loops."""
        return self.packed, self.starts, self.drives, 1.0 / self.size

    def joints_of(self, limb: int) -> slice:
        """Return where the joints of a limb are among all joints."""
        return slice(self.starts[limb], self.starts[limb + 1])

    def limb_poses(self, q: Array) -> Array:
        """Return where each limb of postures (..., n) holds the platform, (..., limbs, 4, 4)."""
        out = np.empty((*q.shape[:-1], len(self.starts) - 1, 4, 4))
        flat = out.reshape(-1, *out.shape[-3:])
        if rates.limb_poses(self.packed, self.starts, _flat(q, q.shape[:-1], q.shape[-1:]), flat):
            raise NonFiniteError("pose of the platform", out)
        return out

    def rates(self, q: Array, given: Array) -> tuple[Array, Array]:
        """Return rates of joints (..., n, c) and twists (..., 6, c) for those of drives."""
        lead = np.broadcast_shapes(q.shape[:-1], given.shape[:-2])
        tail = given.shape[-2:]
        out = np.empty((*lead, q.shape[-1], tail[1]))
        twists = np.empty((*lead, 6, tail[1]))
        rows = _flat(q, lead, q.shape[-1:]), _flat(given, lead, tail)
        found = out.reshape(-1, *out.shape[-2:]), twists.reshape(-1, 6, tail[1])
        refuse_status(rates.rates(*self.chains, *rows, *found), q)
        return out, twists

    def accelerations(self, q: Array, qd: Array, given: Array) -> tuple[Array, Array]:
        """Return accelerations of joints (..., n) and platform (..., 6) for those of drives."""
        lead = np.broadcast_shapes(q.shape[:-1], qd.shape[:-1], given.shape[:-1])
        out, platform = np.empty((*lead, q.shape[-1])), np.empty((*lead, 6))
        joints = (_flat(row, lead, q.shape[-1:]) for row in (q, qd))
        drives = _flat(given, lead, given.shape[-1:])[..., None]
        found = out.reshape(-1, q.shape[-1], 1), platform.reshape(-1, 6, 1)
        refuse_status(rates.accelerations(*self.chains, *joints, drives, *found), q)
        return out, platform

    def close(self, target: Array, near: Array) -> LoopClosure:
        """Move the drives (m,) of a posture (n,) to a target, all joints following."""
        q, report = near.copy(), np.empty(2)
        status = loop_closure.close(*self.chains, self.weights, target, q, report)
        part, error = report.tolist()
        if status == 0:
            return LoopClosure(q, Code.NONE, 1.0, error)
        if part == 0.0 and error > _OPEN:
            reason = f"the loops of the posture given are open by {error:.3g} rad or of the size"
            return LoopClosure(q, Code.NOT_CONVERGED, 0.0, error, reason)
        if status == loop_closure.LONG:
            reason = f"the way is too long for one call: {part:.3g} of it was gone"
            return LoopClosure(q, Code.NOT_CONVERGED, part, error, reason)
        reason = f"a singular posture is in the way, after {part:.3g} of it: assembly modes meet"
        return LoopClosure(q, Code.SINGULAR, part, error, f"{reason} there")


def _flat(array: Array, lead: tuple[int, ...], tail: tuple[int, ...]) -> Array:
    return np.ascontiguousarray(np.broadcast_to(array, (*lead, *tail)).reshape(-1, *tail))


def refuse_status(status: int, q: Array) -> None:
    """Raise the error for a status of a kernel that is not 0."""
    if status == NOT_FINITE:
        if np.isfinite(q).all():
            what = "motion or force that follows from the numbers given, too large ones,"
            raise NonFiniteError(what, np.nan)
        raise NonFiniteError("posture", q)
    if status:
        free = "no limb can move by itself" if status == FREE else "the drives hold the platform"
        raise SingularPostureError("posture", q.tolist(), f"one in which {free}")
