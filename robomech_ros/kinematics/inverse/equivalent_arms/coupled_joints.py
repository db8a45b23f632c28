"""Solve chains with mimic joints: their solutions are among those of an arm without."""

import itertools
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.inverse.polishing import polish
from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS
from robomech_ros._kernels.tolerances import ACCEPTED, SAME_POSTURE
from robomech_ros.kinematics.inverse.closed_form import all_postures
from robomech_ros.kinematics.inverse.equivalent_arms.offset_hollow_wrist import (
    offset_hollow_wrist,
    offset_wrist_postures,
)
from robomech_ros.kinematics.inverse.equivalent_arms.spherical_hollow_wrist import (
    spherical_hollow_wrist,
    spherical_wrist_postures,
)
from robomech_ros.kinematics.inverse.families.iterative_search import IterativeSearch
from robomech_ros.kinematics.inverse.families.merged_axes import MergedArm, merged_arm
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.request.request import Request
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.branch_names import largest_difference
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

# Joint values of the arm (rad or m) that miss those of followers by less may be those of the chain:
# at a double solution they are off by the root of rounding.  A polish of the chain itself decides.
_SLACK = 1e-3
# Windings of the arm's joints, in turns to either side, and combinations of them, at most.
_MOST_TURNS = 8
_MOST_COMBINATIONS = 4096
_STEPS = 30


class _Inversion(NamedTuple):
    """Relation of drives to the n joints of the arm: joints, matrix and windings."""

    joints: list[int]
    inverse: Array
    turns: Array
    all_listed: bool


def solve_coupled_joints(
    chain: SerialChain, T: Array, request: Request
) -> tuple[IterativeSearch, bool] | None:
    """Find all solutions of a pose, limits aside, if the arm without followers has a closed form.

    Returns solutions as a search gives them, perhaps none, and whether they are provably all; None
    where there is no closed form.
    """
    if request.task != FULL_TASK:
        return None
    arm = merged_arm(chain)
    inversion = _inversion(chain, arm, request.respect_limits)
    found = _postures(arm, T)
    if inversion is None or found is None:
        return None
    postures, complete = found
    solutions: list[Array] = []
    for q in _drive_values(chain, arm, inversion, postures):
        if polish(chain.packed, T, q, _STEPS) <= ACCEPTED and _is_new(chain, q, solutions):
            solutions.append(q)
    complete = complete and inversion.all_listed and len(solutions) <= MAX_SOLUTIONS
    best = solutions[0] if solutions else request.seed
    q = np.array(solutions).reshape(-1, chain.n)
    return IterativeSearch(q, best, 0.0, 0.0, 0, False), complete


def _postures(arm: MergedArm, T: Array) -> tuple[Array, bool] | None:
    """List the arm's postures (k, p), and tell whether they are all that the chain can take."""
    wrist = spherical_hollow_wrist(arm)
    if wrist is not None:
        return spherical_wrist_postures(wrist, T)
    offset_wrist = offset_hollow_wrist(arm)
    if offset_wrist is not None:
        return offset_wrist_postures(offset_wrist, T)
    family = family_of(arm.chain)
    if not family.lists_all:
        return None
    return all_postures(arm.chain, T, family)


@lru_cache(maxsize=64)
def _inversion(chain: SerialChain, arm: MergedArm, limited: bool) -> _Inversion | None:
    """Choose the joints of the arm that give the drives; None where none do."""
    p, n = arm.rows.shape
    choices = map(list, itertools.combinations(range(p), n))
    regular = [joints for joints in choices if abs(np.linalg.det(arm.rows[joints])) >= 1e-6]
    if not regular:
        return None
    inverses = np.linalg.inv(arm.rows[regular]).astype(np.float64)
    best = int(np.abs(inverses - np.round(inverses)).max(axis=(1, 2)).argmin())
    joints, inverse = regular[best], inverses[best]
    bounds = np.where(chain.turns, math.pi, np.maximum(np.abs(chain.lower), np.abs(chain.upper)))
    listed, turnings = True, []
    for column, joint in enumerate(joints):
        feeds = inverse[:, column] != 0.0
        whole = np.abs(inverse[:, column] - np.round(inverse[:, column])) < 1e-9
        most = 0
        if arm.chain.turns[joint] and (feeds & ~(whole & chain.turns)).any():
            reach = float(np.abs(arm.rows[joint])[feeds] @ bounds[feeds])
            listed = listed and limited and math.isfinite(reach)
            most = _MOST_TURNS
            if reach < 2.0 * math.pi * _MOST_TURNS:
                most = math.ceil(reach / (2.0 * math.pi) + 0.5)
        turnings.append(range(-most, most + 1))
    if math.prod(map(len, turnings)) > _MOST_COMBINATIONS:
        return None
    turns = 2.0 * math.pi * np.array(list(itertools.product(*turnings)))
    return _Inversion(joints, inverse, turns, listed)


def _drive_values(
    chain: SerialChain, arm: MergedArm, inversion: _Inversion, postures: Array
) -> Array:
    """List the drive values (k, n) that may give postures (l, p) of the arm, turns aside."""
    wound = postures[:, None, inversion.joints] + inversion.turns
    q = np.where(chain.turns, _wrapped(wound @ inversion.inverse.T), wound @ inversion.inverse.T)
    missed = q @ arm.rows.T - postures[:, None]
    missed = np.where(arm.chain.turns, _wrapped(missed), missed)
    return q[np.abs(missed).max(axis=2) < _SLACK]


def _is_new(chain: SerialChain, q: Array, solutions: list[Array]) -> bool:
    """Bring q (n,) to angles within half a turn; tell whether no solution is the same posture."""
    q[chain.turns] = _wrapped(q[chain.turns])
    known = np.array(solutions).reshape(-1, chain.n)
    return not (largest_difference(chain, known, q) < SAME_POSTURE).any()


def _wrapped(angles: Array) -> Array:
    """Bring angles into [-pi, pi)."""
    return np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi
