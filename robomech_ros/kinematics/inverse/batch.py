"""Inverse kinematics of many poses in one compiled loop."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.inverse.solutions import MAX_SOLUTIONS
from robomech_ros.kinematics.inverse.closed_form import solve_many
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, iterative_data
from robomech_ros.kinematics.inverse.families.selection import Family, family_of, iterative_family
from robomech_ros.kinematics.inverse.inverse_kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.redundant_arms.redundant_solutions import sample_self_motions
from robomech_ros.kinematics.inverse.request.request import Request, as_request, default_tolerances
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.reach import out_of_reach
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinematics.tolerances import MOST_SAMPLED
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike, IntArray


def inverse_kinematics_batch(
    chain: SerialChain,
    T: ArrayLike,
    *,
    seed: ArrayLike | None = None,
    respect_limits: bool = True,
    metric: str = "linf",
    max_solutions: int | None = None,
) -> tuple[Array, IntArray, IntArray]:
    """Solve many poses in one compiled loop.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    T : array_like, shape (m, 4, 4)
        Wanted ``T_base_tip`` (m).
    seed, respect_limits, metric, max_solutions
        As for :func:`inverse_kinematics`; the seed (n,) serves every pose.

    Returns
    -------
    q : ndarray, shape (m, 16, n)
        Solutions (rad or m), nearest to the seed first, NaN after the last. The second axis is
        ``max_solutions`` long where that is less than 16; for a redundant arm 64 takes the place
        of 16.
    count : ndarray of int, shape (m,)
        How many each pose has.
    status : ndarray of int, shape (m,)
        :class:`Status` of each. A pose without a solution takes some milliseconds, to tell
        whether its position or its orientation is out of reach.

    Raises
    ------
    SeedOutsideLimitsError
        As for :func:`inverse_kinematics`; of a target at fault the message names the index.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics, inverse_kinematics_batch
    >>> from robomech_ros.robots import load_robot
    >>> ur5e = load_robot("ur5e")
    >>> postures = [[0.1, -1.0, 1.2, -0.5, 0.6, 0.0], [0.4, -1.2, 0.9, 0.3, 1.0, 0.2]]
    >>> targets = forward_kinematics(ur5e, postures)
    >>> q, count, status = inverse_kinematics_batch(ur5e, targets, max_solutions=1)
    >>> q.shape, count.tolist(), status.tolist()
    ((2, 1, 6), [1, 1], [0, 0])
    """
    targets = as_targets(T, batch=True)
    request = as_request(chain, seed, respect_limits, False, metric, max_solutions)
    cap, family = request.max_solutions, family_of(chain)
    if family.redundant:
        room = min(cap or MOST_SAMPLED, MOST_SAMPLED)
        traced = request.seeded or room == 1
        q, count, *_ = sample_self_motions(chain, targets, family, request, room, traced=traced)
    elif chain.coupling is not None:
        room = min(cap or MAX_SOLUTIONS, MAX_SOLUTIONS)
        q, count = np.full((len(targets), room, chain.n), np.nan), np.zeros(len(targets), np.int64)
    else:
        family = family_within(chain, request.respect_limits)
        room = min(cap or MAX_SOLUTIONS, MAX_SOLUTIONS)
        q, count, _ = solve_many(chain, targets, family, request, room)
    status = np.zeros(len(targets), np.int64)
    for index in np.flatnonzero(count <= 0):
        one = targets[index]
        outcome = _outcome_of_none(chain, one, family, request)
        if outcome is None:
            found = inverse_kinematics(
                chain,
                one,
                seed=request.seed,
                respect_limits=request.respect_limits,
                metric=metric,
                max_solutions=room,
            )
            outcome = found.status
            count[index] = len(found)
            q[index, : len(found)] = found.q
        status[index] = outcome
    np.maximum(count, 0, out=count)
    return q, count, status


def family_within(chain: SerialChain, respect_limits: bool) -> Family:
    """Return the family of a chain; an iterative one searches with limits or without."""
    family = family_of(chain)
    if family.closed_form:
        return family
    goal = SearchGoal(respect_limits, FULL_TASK, *default_tolerances(chain, FULL_TASK))
    data = iterative_data(chain, goal)
    return iterative_family(chain, data)


def _outcome_of_none(
    chain: SerialChain, T: Array, family: Family, request: Request
) -> Status | None:
    """Tell why a closed form gave nothing for a pose of a batch; None where a search has to."""
    if family.redundant or not family.closed_form:
        return None
    _, _, state = solve_many(chain, T[None], family, request, 1)
    bare, _, _, singular, unproven = state
    if bare:
        return Status.SINGULAR_CONTINUUM if singular else Status.LIMITS_EXCLUDE_ALL
    if unproven:
        return None
    reachable = out_of_reach(chain, T) == 0.0
    return Status.ORIENTATION_UNREACHABLE if reachable else Status.OUT_OF_REACH
