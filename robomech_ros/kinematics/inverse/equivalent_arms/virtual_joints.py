"""Partial tasks of arms with just as many joints: all solutions, by virtual joints at the tip.

What the task leaves free is given to joints behind the tip: turns about the target's axes, then
slides along them.  The arm has six joints then and reaches the whole pose, and every one of its
postures is, without the virtual joints, one of the arm itself.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from robomech_ros._kernels.tolerances import SAME_POSTURE
from robomech_ros.kinematics.inverse.closed_form import solve_closed_form
from robomech_ros.kinematics.inverse.families.iterative_search import IterativeSearch
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.inverse.request.request import Request
from robomech_ros.kinematics.inverse.request.task import FULL_TASK, Task
from robomech_ros.numerics.arrays import distinct
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE, unpack_chain
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

# Turns that bring z onto x, y and z.
_ONTO = (
    np.array([[0.0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]),
    np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]),
    np.eye(4),
)
# Axes of the turns that together leave the orientation free.
_ALL_TURNS = (2, 0, 2)


def solve_with_virtual_joints(
    chain: SerialChain, T: Array, request: Request
) -> tuple[IterativeSearch, bool] | None:
    """Find all solutions of a task that asks for as many components as there are joints.

    Returns solutions as a search gives them, and whether they are provably all; None where virtual
    joints do not make it an arm of six, or no solution was found.
    """
    extended = _with_virtual_joints(chain, request.task)
    if extended is None:
        return None
    family = family_of(extended)
    if not family.lists_all:
        return None
    whole = request._replace(
        seed=np.concatenate((request.seed, np.zeros(6 - chain.n))),
        include_windings=False,
        max_solutions=None,
        task=FULL_TASK,
    )
    result = solve_closed_form(extended, T, whole, family)
    if not len(result):
        return None
    q = np.array(distinct(result.q[:, : chain.n], SAME_POSTURE))
    return IterativeSearch(q, q[0], 0.0, 0.0, 0, False), result.complete


@lru_cache(maxsize=64)
def _with_virtual_joints(chain: SerialChain, task: Task) -> SerialChain | None:
    """Add a joint for every component that a task leaves free, if that makes six."""
    free = [axis for axis in range(6) if not task[axis]]
    slides, turns = [i for i in free if i < 3], [i - 3 for i in free if i >= 3]
    if chain.n + len(free) != 6 or len(turns) == 2:
        # The free orientations about two axes are no product of two turns.
        return None
    axes = [*(_ALL_TURNS if len(turns) == 3 else turns), *slides]
    C = list(unpack_chain(chain.packed))
    for axis in axes:
        C[-1] = C[-1] @ _ONTO[axis]
        C.append(rigid_inverse(_ONTO[axis]))
    types = [*chain.types.tolist(), *[REVOLUTE] * len(turns), *[PRISMATIC] * len(slides)]
    endless = np.full(len(free), np.inf)
    return replace(
        chain_of(np.array(C), types),
        lower=np.concatenate((chain.lower, -endless)),
        upper=np.concatenate((chain.upper, endless)),
    )
