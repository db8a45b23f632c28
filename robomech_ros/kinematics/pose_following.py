"""Joint paths along pose paths: branch by branch, and where they have to jump."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.tolerances import (
    AT_LIMIT,
    TRACK_HALVINGS,
    TRACK_JUMP,
    TRACK_JUMP_SLIDE,
    TRACK_PARAMETERS,
    TRACK_SWEEPS,
)
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.inverse_kinematics import (
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.inverse.request import as_seed, as_tolerance
from robomech_ros.kinematics.inverse.self_motion import Tracer, margins
from robomech_ros.kinematics.inverse.target import as_targets
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC

__all__ = ["Jump", "TrackResult", "track"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Jump:
    """Where a joint path cannot go on continuously.

    Parameters
    ----------
    index : int
        The pose that is reached by the jump, from pose ``index`` - 1 (or the start, for 0).
    move : ndarray, shape (n,)
        What every joint moves there (rad or m).
    reason : str
        In words: another branch, or another winding of a joint that would leave its limits.
    """

    index: int
    move: Array
    reason: str


@dataclass(frozen=True, eq=False)
class TrackResult:
    """A joint path along a path of poses.

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


def track(
    chain: SerialChain,
    poses: ArrayLike,
    *,
    start: ArrayLike | None = None,
    revolute_jump: float | None = None,
    prismatic_jump: float | None = None,
) -> TrackResult:
    """Follow a path of poses with the joints, on one branch of solutions as long as that goes.

    Where all solutions of every pose are known, the path with the fewest jumps between branches is
    chosen among all, then that with the fewest between windings, then the one whose joints move
    least. A redundant arm goes from each posture to the nearest one of the next pose; where that
    jumps, the path with the fewest jumps among samples of the self-motion of every pose is taken,
    and smoothed. The poses must be so near to each other
    that a continuous motion keeps every joint's move below the threshold of a jump.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    poses : array_like, shape (m, 4, 4)
        ``T_base_tip`` one after another (m).
    start : array_like, shape (n,), optional
        Where the joints are before the first pose (rad or m): the move from there counts like any
        other. Default none: the path begins with the posture that suits it best.
    revolute_jump, prismatic_jump : float, optional
        Largest move of a joint (rad, m) between two poses that is no jump; default 0.5 and 0.1.

    Returns
    -------
    TrackResult

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        Poses, a start or thresholds that are none.
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
        q = _fewest_jumps(chain, lists, origin, largest)
    reason = ""
    if len(q) < len(targets):
        failed = inverse_kinematics(chain, targets[len(q)])
        reason = f"pose {len(q)}: {failed.reason or 'not reached'}"
    return TrackResult(
        q=q,
        jumps=_jumps(chain, q, origin, largest),
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
    jumps = len(_jumps(chain, q, origin, largest))
    if chain.n != 7 or (len(q) == len(targets) and not jumps):
        return q
    other = _fewest_jumps(chain, _sampled(chain, targets, q, origin), origin, largest)
    other = _relaxed(chain, targets[: len(other)], other, origin, largest)
    worth = len(other), -len(_jumps(chain, other, origin, largest))
    return other if worth > (len(q), -jumps) else q


def _sampled(chain: SerialChain, targets: Array, q: Array, origin: Array | None) -> list[Array]:
    """List postures inside the limits for every pose: those of many parameters, and of a path."""
    lists = []
    ends: list[float] = []
    for k, T in enumerate(targets):
        tracer = Tracer(chain, T)
        low, high, _ = tracer.range()
        values = np.linspace(low, high, TRACK_PARAMETERS).tolist()
        known = [*ends, *(tracer.parameter(p) for p in (origin, *q[k : k + 1]) if p is not None)]
        found, ends = _spread(tracer, sorted({*values, *known}))
        found = np.concatenate([found, q[k : k + 1]])
        lists.append(found[margins(chain, found) >= 0.0])
    return lists


def _spread(tracer: Tracer, values: list[float]) -> tuple[Array, list[float]]:
    """Give the postures at increasing values of the parameter, and at more where a branch ends.

    There the posture changes with the root of the distance from the end, so that halving it again
    and again keeps the postures about as near to each other as elsewhere.  Gives the ends, too.
    """
    found = [tracer.at(value) for value in values]
    ends = []
    for k in range(len(values) - 1):
        if len(found[k]) == len(found[k + 1]):
            continue
        low, high, at_low = values[k], values[k + 1], len(found[k])
        for _ in range(TRACK_HALVINGS):
            middle = 0.5 * (low + high)
            found.append(tracer.at(middle))
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


def _fewest_jumps(
    chain: SerialChain, solutions: list[Array], origin: Array | None, largest: Array
) -> Array:
    """Choose a solution for every pose: fewest jumps first, then least squares of the moves.

    Solutions stand for all their windings at first.  Of the best path to each solution of the last
    pose the windings are chosen, and then the best of these paths.  It ends before the first pose
    without a solution.
    """
    reached = next((k for k, found in enumerate(solutions) if not len(found)), len(solutions))
    if not reached:
        return np.empty((0, chain.n))
    first = solutions[0]
    cost = np.zeros(len(first))
    if origin is not None:
        cost = _edges(chain, origin[None], first, largest)[0]
    came: list[Integers] = []
    for k in range(1, reached):
        total = cost[:, None] + _edges(chain, solutions[k - 1], solutions[k], largest)
        came.append(total.argmin(axis=0))
        cost = total.min(axis=0)
    paths = []
    for last in range(len(cost)):
        chosen = [last]
        for back in reversed(came):
            chosen.append(int(back[chosen[-1]]))
        path = np.array([solutions[k][i] for k, i in enumerate(reversed(chosen))])
        path = _wound(chain, path, origin)
        paths.append((len(_jumps(chain, path, origin, largest)), float(cost[last]), path))
    return min(paths, key=lambda one: one[:2])[2]


def _edges(chain: SerialChain, before: Array, after: Array, largest: Array) -> Array:
    """Cost of every move, shape (k, l): a jump costs more than any moves can."""
    moves = _moves(chain, after[None] - before[:, None])
    jumps = (np.abs(moves) > largest).any(axis=2)
    cost: Array = np.where(jumps, 1e6, 0.0) + (moves**2).sum(axis=2)
    return cost


def _moves(chain: SerialChain, difference: Array) -> Array:
    """Take the difference of angles modulo a turn, in [-pi, pi)."""
    turned = np.remainder(difference + np.pi, 2.0 * np.pi) - np.pi
    moves: Array = np.where(chain.types == PRISMATIC, difference, turned)
    return moves


def _wound(chain: SerialChain, path: Array, origin: Array | None) -> Array:
    """Choose windings: each joint goes on continuously as far as its limits allow."""
    result = path.copy()
    steps = _moves(chain, np.diff(path, axis=0))
    for i in np.flatnonzero(chain.types != PRISMATIC).tolist():
        k = 0
        here = path[0, i] if origin is None else origin[i]
        free = origin is None
        while k < len(path):
            run = np.concatenate(([0.0], np.cumsum(steps[k:, i])))
            value, length = _longest(chain, i, path[k, i], run, None if free else here)
            result[k : k + length, i] = np.clip(
                value + run[:length], chain.lower[i], chain.upper[i]
            )
            here, free = result[k + length - 1, i], True
            k += length
    return result


def _longest(
    chain: SerialChain, i: int, value: float, run: Array, near: float | None
) -> tuple[float, int]:
    """Find the winding of joint i from which a run stays inside the limits longest.

    Of equals it is the one nearest to the middle of the limits; where there is a place to start
    from, only the winding nearest to that is looked at, if it is inside.
    """
    lower, upper = chain.lower[i] - AT_LIMIT, chain.upper[i] + AT_LIMIT
    turn = 2.0 * np.pi
    middle = float(chain.midrange()[i]) if near is None else near
    centre = value + turn * np.round((middle - value) / turn)
    best = (0, -np.inf, value)
    for k in (0,) if near is not None and lower <= centre <= upper else range(-8, 9):
        wound = centre + turn * k
        outside = (wound + run < lower) | (wound + run > upper)
        length = int(outside.argmax()) if outside.any() else len(run)
        best = max(best, (length, -abs(wound - middle), wound))
    # The solver gave the value inside the limits, so that at least the first one stays.
    return best[2], max(best[0], 1)


def _jumps(chain: SerialChain, q: Array, origin: Array | None, largest: Array) -> tuple[Jump, ...]:
    """List the moves that are jumps."""
    if not len(q):
        return ()
    path = q if origin is None else np.vstack((origin, q))
    moves = np.diff(path, axis=0)
    first = 1 if origin is None else 0
    jumps = []
    for k in np.flatnonzero((np.abs(moves) > largest).any(axis=1)).tolist():
        branch = (np.abs(_moves(chain, moves[k])) > largest).any()
        names = [chain.joint_names[i] for i in np.flatnonzero(np.abs(moves[k]) > largest)]
        joints = ", ".join(f"'{name}'" for name in names)
        reason = "to another branch" if branch else "to another winding, at a joint limit"
        jumps.append(Jump(k + first, moves[k], f"joints {joints} jump {reason}"))
    return tuple(jumps)
