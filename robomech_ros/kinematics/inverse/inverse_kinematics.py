"""Inverse kinematics of any serial chain: all solutions, or the reason why there is none."""

from __future__ import annotations

import time
from collections.abc import Sequence

from robomech_ros._kernels.tolerances import ORIENTATION_TOLERANCE, POSITION_TOLERANCE
from robomech_ros.kinematics.inverse.closed_form import solve_closed_form
from robomech_ros.kinematics.inverse.families.selection import Family, family_of
from robomech_ros.kinematics.inverse.nearest_posture import add_nearest
from robomech_ros.kinematics.inverse.redundant_arms.redundant_solutions import solve_by_sampling
from robomech_ros.kinematics.inverse.request.request import (
    Request,
    as_cap,
    as_request,
    is_loose,
    with_task,
)
from robomech_ros.kinematics.inverse.request.target import as_target, as_targets
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.contacts import Scene, without_contacts
from robomech_ros.kinematics.inverse.result.result import InverseKinematicsResult
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinematics.inverse.solve_by_search import solve_by_search
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike

_SUCCESS = Status.SUCCESS  # to look it up takes longer than an argument is checked


def inverse_kinematics(
    chain: SerialChain,
    T: ArrayLike,
    *,
    seed: ArrayLike | None = None,
    respect_limits: bool = True,
    include_windings: bool = False,
    metric: str = "linf",
    max_solutions: int | None = None,
    task_mask: Sequence[bool] | None = None,
    position_tolerance: float | None = None,
    orientation_tolerance: float | None = None,
    timeout: float | None = None,
    scene: Scene | None = None,
) -> InverseKinematicsResult:
    """Find the joint values that bring the tip to a pose, nearest to the seed first.

    An arm with a spherical wrist, whatever its first three joints, and an arm with three parallel
    axes next to each other get all their real solutions in closed form, any other arm of six joints
    from an equation in one of them; ``complete`` is False where a pose is so degenerate that one
    may be missing. Arms of fewer joints, and partial tasks of as many components as there are
    joints, are completed to an arm of six by virtual joints, wherever that has a closed form.
    Where an arm of fewer joints cannot take a pose, as is the rule, ``nearest`` is the posture that
    misses it least.

    Of a chain on which joints follow others, q are the drives. It gets all its solutions where
    parallel axes, or a hollow wrist, leave an arm with a closed form; else they are searched.

    A redundant arm gets samples of its self-motion, in closed form for each value of its redundancy
    parameter. With seven joints and a seed the first is the nearest to it on all branches that
    cross a sample, which are traced; with more, the nearest that steps lead to.

    Redundant partial tasks and chains with very special geometry are searched iteratively, and so
    are poses without a solution if tolerances are looser than the default. ``complete`` is False
    for all of these.

    At a pose where joints can move while the tip stays, each branch is represented by one posture,
    with the free joint at the seed's value where that is possible, and the result is marked as a
    ``continuum``. Of an arm of which that is so in every posture, such as one with two axes on one
    line, the solutions are samples.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    T : array_like, shape (4, 4)
        Wanted ``T_base_tip`` (m); a rotation off by rounding is made orthogonal.
    seed : array_like, shape (n,), optional
        Where distances are measured from and searches begin (rad or m); default mid-range.
    respect_limits : bool, optional
        Whether solutions outside the joint limits are left out.
    include_windings : bool, optional
        Whether a joint whose range exceeds a turn is listed in every winding inside its limits;
        else each solution stands once, in the winding nearest to the seed.
    metric : {"linf", "l2"}, optional
        Distance from the seed: the largest move of a joint, or the root of the sum of squares.
    max_solutions : int, optional
        Keep at most this many, the nearest; 1 is faster for redundant arms and tasks.
    task_mask : sequence of six bool, optional
        Which of x, y, z, rx, ry, rz matter, along and about the axes of the target pose; default
        (and all False) the full pose.
    position_tolerance, orientation_tolerance : float, optional
        Errors (m, rad) that are accepted; default 1e-9, and 1e-5 m and 1e-4 rad of an arm that
        cannot take every pose, such as one of five joints.
    timeout : float, optional
        Time (s) after which an iterative search ends; default none. Closed forms take no notice.
    scene : PlanningScene, optional
        The world around the arm, of the same chain: solutions in contact are left out and counted
        in the reason, and ``clearances`` has the least distances of the others.

    Returns
    -------
    InverseKinematicsResult
        With the status SUCCESS where there is a solution; else with the reason in words:
        OUT_OF_REACH and ORIENTATION_UNREACHABLE, where no posture takes the pose;
        LIMITS_EXCLUDE_ALL, with the joints that are in the way, and SINGULAR_CONTINUUM, the same of
        a continuum; IN_COLLISION, where all solutions are in contact, with the pair of the one that
        is least deep; NOT_CONVERGED and TIMED_OUT, which prove nothing.

    Raises
    ------
    BadValueError, WrongSizeError
        An invalid target or option, or more windings than can be listed.
    SeedOutsideLimitsError
        A joint of the seed is outside its limits, and limits are respected.

    See Also
    --------
    inverse_kinematics_batch : many poses at once.
    self_motion : all postures of an arm of seven joints.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4 and chapter 9; the
    equations are in doc/inverse_kinematics.md.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> posture = [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]
    >>> found = inverse_kinematics(puma, forward_kinematics(puma, posture), seed=posture)
    >>> found.status.name, len(found.q), found.complete
    ('SUCCESS', 2, True)
    >>> np.round(found.q[0], 6)
    array([ 0.3,  0.5, -1.2,  0.4,  0.8,  0.2])
    >>> found.branches[0]
    'shoulder-right elbow-down wrist-noflip'
    """
    cap = max_solutions if scene is None else None
    given = as_target(T)
    request = as_request(chain, seed, respect_limits, include_windings, metric, cap)
    if (
        task_mask is not None
        or position_tolerance is not None
        or orientation_tolerance is not None
        or timeout is not None
    ):
        request = with_task(
            chain, request, task_mask, position_tolerance, orientation_tolerance, timeout
        )
    bounded = position_tolerance is not None or orientation_tolerance is not None
    result = _solved(chain, given, request, bounded)
    if scene is None:
        return result
    return without_contacts(result, scene, as_cap(max_solutions))


def _solved(
    chain: SerialChain, given: Array, request: Request, bounded: bool
) -> InverseKinematicsResult:
    """Solve a request; `bounded` tells whether its tolerances were asked for."""
    started = time.monotonic()
    family = family_of(chain)
    if family.lists_all and request.task == FULL_TASK:
        result = solve_closed_form(chain, given, request, family)
        if bounded:
            # Closed forms are as good as rounding lets them be, and hold these bounds anyway.
            result = result.within(
                max(request.position_tolerance, POSITION_TOLERANCE),
                max(request.orientation_tolerance, ORIENTATION_TOLERANCE),
            )
        if result.status is _SUCCESS:
            return result
        if is_loose(chain, request) or result.status is Status.NOT_CONVERGED:
            near = solve_by_search(chain, result.target, request, started)
            result = near if len(near) else result
    else:
        result = _sampled_or_searched(chain, as_targets(given)[0], request, family, started)
    return add_nearest(chain, result.target, request, result, started)


def _sampled_or_searched(
    chain: SerialChain, T: Array, request: Request, family: Family, started: float
) -> InverseKinematicsResult:
    """Solve a request of which the solutions are a continuum, or cannot be listed."""
    if family.redundant and request.task == FULL_TASK:
        sampled = solve_by_sampling(chain, T, request, family)
        if sampled is not None:
            return sampled
    return solve_by_search(chain, T, request, started)
