"""Reasons for a missing solution or an incomplete list, in words and numbers."""

import math

import numpy as np

from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.ranking import excesses
from robomech_ros.kinematics.inverse.families.selection import Family
from robomech_ros.kinematics.inverse.request.task import FULL_TASK, Task
from robomech_ros.kinematics.inverse.result.reach import ReachGap, distance_inside_limits, reach_gap
from robomech_ros.kinematics.inverse.result.result import (
    NO_EXCESS,
    Findings,
    InverseKinematicsResult,
    Listing,
)
from robomech_ros.kinematics.inverse.result.singular_marks import task_jacobian
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, IntArray

# Part in the motion of a continuum (a unit vector, rad or m) below which a joint stands still.
MOVES_IN_CONTINUUM = 1e-6


# Orientation errors up to this (rad) explain nothing: a search at a singularity leaves as much.
NO_GAP = 1e-6

# Singular values of a Jacobian below this (of the largest) are those of motions that keep the tip
# at rest: the posture that stands for a continuum may be off by the root of its rounding.
STILL = 1e-7


def no_solution(
    chain: SerialChain,
    T: Array,
    family: Family,
    status: Status,
    reason: str,
    blocking: tuple[tuple[str, ...], Array] = ((), NO_EXCESS),
    *,
    complete: bool = False,
) -> InverseKinematicsResult:
    """Return the result without solutions, ``complete`` where it is certain that there are none."""
    findings = Findings(family.name, complete, status, reason, *blocking)
    listing = Listing(T, np.empty(0), np.empty(0, np.int64))
    return InverseKinematicsResult(chain, np.empty((0, chain.n)), findings, listing)


def explain_limits(
    chain: SerialChain, T: Array, q: Array, family: Family, *, continuum: bool, proven: bool
) -> InverseKinematicsResult:
    """Say which joints keep the solutions q (k, n) from being inside the limits, and by how much.

    Of a continuum only representatives were tried, so that limits may still admit another; else it
    is ``proven`` whether q are all.
    """
    excess = np.empty_like(q)
    best = excesses(family.turns, chain.lower, chain.upper, q, excess)
    outside = np.flatnonzero(excess[best]).tolist()
    joints = tuple(chain.joint_names[i] for i in outside)
    amounts = excess[best, outside]
    parts = [
        f"joint '{name}' by {amount:.6g} {chain.units[i]}"
        for name, amount, i in zip(joints, amounts, outside, strict=True)
    ]
    noun = "1 solution exists" if len(q) == 1 else f"{len(q)} solutions exist"
    reason = f"{noun}, none inside the limits; the least offending is outside with {_and(parts)}"
    status = Status.LIMITS_EXCLUDE_ALL
    if continuum:
        status = Status.SINGULAR_CONTINUUM
        reason = f"a continuum of postures exists, none found inside the limits: {reason}"
    complete = proven and not continuum
    return no_solution(chain, T, family, status, reason, (joints, amounts), complete=complete)


def explain_unreachable(
    chain: SerialChain, T: Array, family: Family, *, respect_limits: bool
) -> InverseKinematicsResult:
    """Say how far the target is out of reach, or by how much its orientation is."""
    status, reason = describe_gap(chain, T, reach_gap(chain, T), respect_limits=respect_limits)
    missed = status is Status.ORIENTATION_UNREACHABLE and family.exact
    complete = status is Status.OUT_OF_REACH or missed
    return no_solution(chain, T, family, status, reason, complete=complete)


def describe_gap(
    chain: SerialChain,
    T: Array,
    gap: ReachGap,
    task: Task = FULL_TASK,
    *,
    respect_limits: bool,
    deadline: float = math.inf,
) -> tuple[Status, str]:
    """Put a gap of reach into a status and words; where limits count, the amount respects them."""
    # Less than a nanometre is rounding; adding 0 makes -0 a plain 0.
    position = ", ".join(f"{value:.6g}" for value in T[:3, 3].round(9) + 0.0)
    part = "" if all(task) else f"; only {_components(task)} of the target count"
    if gap.distance > 0.0:
        amount = f"{gap.distance:.6g} m"
        if respect_limits:
            amount = _inside_limits(chain, T, gap, task, deadline)
        return Status.OUT_OF_REACH, (
            f"the position ({position}) m of '{chain.tip}' in '{chain.base}' is out of reach "
            f"by {amount}{part}"
        )
    if gap.orientation_error <= NO_GAP:
        return Status.NOT_CONVERGED, (
            f"the pose at ({position}) m of '{chain.tip}' in '{chain.base}' is in reach to "
            f"{gap.orientation_error:.3g} rad, but no posture was found"
        )
    away = f"{gap.orientation_error:.6g} rad away" + ", joint limits aside" * respect_limits
    if part:
        return Status.ORIENTATION_UNREACHABLE, (
            f"the orientation of '{chain.tip}' in '{chain.base}' at ({position}) m is out of "
            f"reach: the nearest attainable one is {away}{part}"
        )
    return Status.ORIENTATION_UNREACHABLE, (
        f"the position ({position}) m of '{chain.tip}' in '{chain.base}' is in reach, but not in "
        f"this orientation: the nearest attainable one there is {away}"
    )


def _inside_limits(chain: SerialChain, T: Array, gap: ReachGap, task: Task, deadline: float) -> str:
    """Say how far a target is out of reach inside the limits, and without them if that differs."""
    inside = distance_inside_limits(chain, T, task, gap.distance, deadline)
    found, aside = f"{inside:.6g} m", f"{gap.distance:.6g} m"
    if math.isnan(inside):
        return f"{aside}, joint limits aside"
    return found if found == aside else f"{found} inside the joint limits, {aside} without them"


def describe_continuum(
    chain: SerialChain,
    T: Array,
    q: Array,
    branch: IntArray,
    task: Task = FULL_TASK,
    sampled: bool = False,
) -> str:
    """Say which joints of the solutions q (k, n) move while the tip stays, and in what ratio.

    Of the tip at T only what the task counts has to stay.

    The direction is that of the first solution that stands for a continuum, of which the others
    are samples, or one for each branch.
    """
    ways = [_still_motions(chain, T, q[k], task) for k in np.flatnonzero(branch & bit.CONTINUUM)]
    moving = np.flatnonzero(np.concatenate(ways).any(axis=0)).tolist()
    joints = [f"'{chain.joint_names[i]}'" for i in moving]
    directions = _and([f"({', '.join(f'{x:.6g}' for x in one)})" for one in ways[0]])
    listed = "of this continuum these are samples"
    if not sampled:
        listed = "every branch of this continuum is represented by one posture"
    # A redundant arm can move in other postures, too.
    elsewhere = _still_motions(chain, T, q[0] + np.linspace(0.3, 0.7, chain.n), task, least=0)
    word = "redundant" if len(elsewhere) >= len(ways[0]) else "singular"
    return (
        f"{word}: joint{'s' * (len(joints) > 1)} {_and(joints)} can move while the tip stays, "
        f"at the nearest such solution in the direction {directions}; {listed}"
    )


def _still_motions(chain: SerialChain, T: Array, q: Array, task: Task, least: int = 1) -> Array:
    """Return unit vectors, shape (k, n), that span the joint motions that keep the task at rest.

    At least so many of the least moving ones; what is rounding is zero, the largest entry of each
    positive.
    """
    _, values, rows = np.linalg.svd(task_jacobian(chain, T, task, q)[0])
    lost = values < STILL * values[0]
    lost[len(lost) - least :] = True
    still = rows[: len(values)][lost]
    still[np.abs(still) < MOVES_IN_CONTINUUM] = 0.0
    largest = np.abs(still).argmax(axis=1)
    ways: Array = still * np.sign(np.take_along_axis(still, largest[:, None], axis=1))
    return ways + 0.0  # no zeros with a sign


def _components(task: Task) -> str:
    names = ("x", "y", "z", "rx", "ry", "rz")
    return _and([name for name, counts in zip(names, task, strict=True) if counts])


def _and(parts: list[str]) -> str:
    if len(parts) < 2:
        return "".join(parts)
    return f"{', '.join(parts[:-1])} and {parts[-1]}"
