"""Branches of all limbs put together to postures of a mechanism, within limits."""

import itertools
import math
from collections.abc import Sequence

import numpy as np

from robomech_ros.outcomes import Code
from robomech_ros.parallel.mechanism.limb import Limb, LimbBranches
from robomech_ros.parallel.mechanism.loops import Loops
from robomech_ros.parallel.result import MechanismPostures
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array

# Rounding of positions at limits (rad or m).
_WITHIN = 1e-9
_TURN = 2.0 * math.pi
# Positions of drives (rad, m) that are the same in several branches of a limb.
_SAME = 1e-6
# Postures that are given at most.
_MOST = 4096


def limb_postures(
    limbs: Sequence[Limb], T: Array, near: Array | None, ignore_limits: bool
) -> MechanismPostures:
    """Solve all limbs for a pose (4, 4) of the platform, and sort by distance from ``near``."""
    n = sum(limb.chain.n for limb in limbs)
    found = [limb.branches(T) for limb in limbs]
    excess = np.array([one.excess for one in found])
    blocking = [""] * len(limbs)

    def nothing(code: Code, reason: str) -> MechanismPostures:
        return MechanismPostures(np.empty((0, n)), (), code, reason, excess, tuple(blocking))

    if excess.any():
        worst = int(np.argmax(excess))
        unit = "m" if np.any(limbs[worst].chain.packed[:, 10:]) else "rad"
        why = found[worst].reason
        reason = f": {why}" if why else f" misses the pose by {excess[worst]:.3g} {unit}"
        return nothing(found[worst].code, f"limb {worst + 1}{reason}")
    for i, one in enumerate(found):
        if not len(one.q):
            reason = f"joints of limb {i + 1} can move while the platform stays"
            return nothing(Code.SINGULAR_CONTINUUM, reason)
    start, choices = 0, []
    for i, (limb, one) in enumerate(zip(limbs, found, strict=True)):
        own = None if near is None else near[start : start + limb.chain.n]
        start += limb.chain.n
        q, off = _into_limits(limb, one, own)
        inside = [k for k in range(len(q)) if ignore_limits or not off[k].any()]
        if not inside:
            k = int(np.argmin(off.max(axis=1)))
            joint = int(np.argmax(off[k]))
            excess[i], blocking[i] = off[k, joint], limb.chain.joint_names[joint]
        away = np.zeros(len(q)) if own is None else np.abs(q - own).max(axis=1)
        inside.sort(key=away.__getitem__)
        choices.append([(q[k], one.names[k]) for k in inside])
    if excess.any():
        worst = int(np.argmax(excess))
        chain = limbs[worst].chain
        unit = chain.units[chain.joint_names.index(blocking[worst])]
        reason = (
            f"joint '{blocking[worst]}' of limb {worst + 1} would be {excess[worst]:.3g} {unit} "
            "outside its limits"
        )
        return nothing(Code.LIMITS_EXCLUDE_ALL, reason)
    reason = _fewer(choices)
    rows = list(itertools.product(*choices))
    q = np.array([np.concatenate([joints for joints, _ in row]) for row in rows])
    names = ["".join(name for _, name in row) for row in rows]
    if near is not None:
        order = np.argsort(np.abs(q - near).max(axis=1), kind="stable")
        q, names = q[order], [names[k] for k in order]
    return MechanismPostures(q, tuple(names), Code.NONE, reason, excess, tuple(blocking))


def _fewer(choices: list[list[tuple[Array, str]]]) -> str:
    """Leave out the last branches of limbs with many, and say so."""
    if math.prod(map(len, choices)) <= _MOST:
        return ""
    while math.prod(map(len, choices)) > _MOST:
        max(choices, key=len).pop()
    return f"only the first {math.prod(map(len, choices))} combinations of branches of the limbs"


def _into_limits(limb: Limb, found: LimbBranches, near: Array | None) -> tuple[Array, Array]:
    """Turn joints by whole turns towards ``near`` and into limits; give what is outside, too."""
    chain = limb.chain
    q = found.q.copy()
    turns = chain.types != PRISMATIC
    if near is not None:
        q = np.where(turns, q + _TURN * np.round((near - q) / _TURN), q)
    down = np.where(turns, np.ceil((q - chain.upper - _WITHIN) / _TURN), 0.0)
    q = q - _TURN * np.where(np.isfinite(down), np.maximum(down, 0.0), 0.0)
    up = np.where(turns, np.ceil((chain.lower - _WITHIN - q) / _TURN), 0.0)
    q = q + _TURN * np.where(np.isfinite(up), np.maximum(up, 0.0), 0.0)
    # Outside both ends, the nearer one counts.
    other = np.where(turns & (chain.lower - q + _TURN < q - chain.upper), q - _TURN, q)
    q = np.where(q > chain.upper + _WITHIN, other, q)
    off = limb.limit_excess(q)
    return q, np.where(off <= _WITHIN, 0.0, off)


def joints_of_mode(limbs: Sequence[Limb], loops: Loops, T: Array, drives: Array) -> Array:
    """Return all joints (n,) for a pose (4, 4) and its drives (m,); NaN for no branch."""
    q = np.empty(len(loops.drives))
    for limb, start in zip(limbs, loops.starts, strict=False):
        own = slice(start, start + limb.chain.n)
        index = loops.drives[own]
        known = drives[index[index >= 0]]
        rows = limb.branches(T, known).q
        off = np.abs(rows[:, index >= 0] - known)
        turns = limb.chain.types[index >= 0] != PRISMATIC
        off = np.where(turns, np.abs(np.remainder(off + np.pi, _TURN) - np.pi), off)
        away = off.max(axis=1, initial=0.0)
        same = rows[away <= away.min(initial=np.inf) + _SAME]
        # Among branches with the same drives, the one inside limits or next to them.
        out = limb.limit_excess(same).max(axis=1, initial=0.0)
        q[own] = same[np.argmin(out)] if len(same) else np.nan
    q[loops.drives >= 0] = drives
    return q
