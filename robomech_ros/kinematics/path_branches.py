"""Joint paths through lists of poses, on one branch of solutions as far as possible."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.branch_selection import fewest_jumps
from robomech_ros.kinematics.inverse.batch import inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.inverse_kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.redundant_arms.redundancy import Redundancy, limit_margins
from robomech_ros.kinematics.inverse.request.request import as_seed, as_tolerance
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.kinematics.joint_jumps import Jump, find_jumps
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, ArrayLike

# Largest move of a joint (rad, m) between two poses that is no jump: paths are sampled finer.
TRACK_JUMP = 0.5
TRACK_JUMP_SLIDE = 0.1
# Values of the redundancy parameter at which a path is looked for, how often the distance to the
# end of a branch is halved, and how often the path is smoothed.
TRACK_PARAMETERS = 64
TRACK_HALVINGS = 6
TRACK_SWEEPS = 8


@dataclass(frozen=True, eq=False)
class BranchPath:
    """A joint path through a list of poses.

    Parameters
    ----------
    q : ndarray, shape (m, n)
        Joint values (rad or m) for the poses up to the first one without a solution.
    jumps : tuple of Jump
        Empty where the path is continuous.
    complete : bool
        Whether all poses have a solution.
    fraction : float
        Part of the poses reached, from the first one on.
    reason : str
        Why the first pose not reached is not; empty where all are.
    """

    q: Array
    jumps: tuple[Jump, ...]
    complete: bool
    fraction: float
    reason: str


def branch_path(
    chain: SerialChain,
    poses: ArrayLike,
    *,
    start: ArrayLike | None = None,
    revolute_jump: float | None = None,
    prismatic_jump: float | None = None,
) -> BranchPath:
    """Choose a joint path through a list of poses, on one branch of solutions as far as possible.

    Where all solutions of every pose are known, the path with the fewest jumps between branches is
    chosen among all, then that with the fewest between windings, then the one whose joints move
    least. A redundant arm goes from each posture to the nearest one of the next pose; where that
    jumps, the path with the fewest jumps among samples of the self-motion of every pose is taken,
    and smoothed. The poses must be so near to each other that a continuous motion keeps every
    joint's move below the threshold of a jump.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    poses : array_like, shape (m, 4, 4)
        ``T_base_tip`` one after another (m).
    start : array_like, shape (n,), optional
        Where the joints are before the first pose (rad or m): the move from there counts like any
        other. Default none: the path begins with the posture that suits it best.
    revolute_jump, prismatic_jump : float, optional
        Largest move of a joint (rad, m) between two poses that is no jump; default 0.5 and 0.1.

    Raises
    ------
    SeedOutsideLimitsError
        A joint of the start is outside its limits.
    """
    check_chain(chain)
    targets = as_targets(poses, "poses", batch=True)
    if not len(targets):
        raise BadValueError("poses", "empty", "at least one pose")
    largest = np.where(
        chain.types == PRISMATIC,
        as_tolerance("prismatic_jump", prismatic_jump, TRACK_JUMP_SLIDE),
        as_tolerance("revolute_jump", revolute_jump, TRACK_JUMP),
    )
    origin = None if start is None else as_seed(chain, start, True)
    if family_of(chain).redundant:
        q = _redundant(chain, targets, origin, largest)
    else:
        solutions, counts, _ = inverse_kinematics_batch(chain, targets)
        lists = [solutions[k, : counts[k]] for k in range(len(targets))]
        q = fewest_jumps(chain, lists, origin, largest)
    reason = ""
    if len(q) < len(targets):
        failed = inverse_kinematics(chain, targets[len(q)])
        reason = f"pose {len(q)}: {failed.reason or 'not reached'}"
    return BranchPath(
        q=q,
        jumps=find_jumps(chain, q, origin, largest),
        complete=len(q) == len(targets),
        fraction=len(q) / len(targets),
        reason=reason,
    )


def _greedy(chain: SerialChain, targets: Array, origin: Array | None) -> Array:
    """Go from each posture to the nearest one of the next pose."""
    path: list[Array] = []
    here = chain.midrange() if origin is None else origin
    for T in targets:
        nearest = inverse_kinematics(chain, T, seed=here, max_solutions=1, metric="l2").q
        if not len(nearest):
            break
        here = nearest[0]
        path.append(here)
    return np.array(path).reshape(-1, chain.n)


def _redundant(chain: SerialChain, targets: Array, origin: Array | None, largest: Array) -> Array:
    """Go on to the nearest posture; where that jumps, look for the best way among many postures."""
    q = _greedy(chain, targets, origin)
    jumps = len(find_jumps(chain, q, origin, largest))
    if chain.n != 7 or (len(q) == len(targets) and not jumps):
        return q
    other = fewest_jumps(chain, _sampled(chain, targets, q, origin), origin, largest)
    other = _relaxed(chain, targets[: len(other)], other, origin, largest)
    worth = len(other), -len(find_jumps(chain, other, origin, largest))
    return other if worth > (len(q), -jumps) else q


def _sampled(chain: SerialChain, targets: Array, q: Array, origin: Array | None) -> list[Array]:
    """List postures inside the limits for every pose: those of many parameters, and of a path."""
    lists = []
    ends: list[float] = []
    for k, T in enumerate(targets):
        redundancy = Redundancy(chain, T)
        low, high, _ = redundancy.range()
        values = np.linspace(low, high, TRACK_PARAMETERS).tolist()
        known = [
            *ends,
            *(redundancy.parameter(p) for p in (origin, *q[k : k + 1]) if p is not None),
        ]
        found, ends = _spread(redundancy, sorted({*values, *known}))
        found = np.concatenate([found, q[k : k + 1]])
        lists.append(found[limit_margins(chain, found) >= 0.0])
    return lists


def _spread(redundancy: Redundancy, values: list[float]) -> tuple[Array, list[float]]:
    """Return the postures at increasing values of the parameter, and at more where a branch ends.

    There the posture changes with the root of the distance from the end, so that halving it again
    and again keeps the postures about as near to each other as elsewhere.  Gives the ends, too.
    """
    found = [redundancy.at(value) for value in values]
    ends = []
    for k in range(len(values) - 1):
        if len(found[k]) == len(found[k + 1]):
            continue
        low, high, at_low = values[k], values[k + 1], len(found[k])
        for _ in range(TRACK_HALVINGS):
            middle = 0.5 * (low + high)
            found.append(redundancy.at(middle))
            low, high = (middle, high) if len(found[-1]) == at_low else (low, middle)
        ends.append(low if at_low > len(found[k + 1]) else high)
    return np.concatenate(found), ends


def _relaxed(
    chain: SerialChain, targets: Array, q: Array, origin: Array | None, largest: Array
) -> Array:
    """Smooth a path of samples: move postures on their self-motion towards their neighbours.

    Each goes to the posture nearest to the mean of its neighbours, unless one of the joints would
    jump; the last one has one neighbour only, as has the first without a start.
    """
    q = q.copy()
    for _ in range(TRACK_SWEEPS):
        for k, T in enumerate(targets):
            before = q[k - 1] if k else origin
            near = [other for other in (before, *q[k + 1 : k + 2]) if other is not None]
            if not near or (np.abs(np.diff([near[0], q[k], *near[1:]], axis=0)) > largest).any():
                continue
            mean = np.mean(near, axis=0)
            moved = inverse_kinematics(chain, T, seed=mean, max_solutions=1, metric="l2").q
            if len(moved) and not (np.abs(moved[0] - near) > largest).any():
                q[k] = moved[0]
    return q
