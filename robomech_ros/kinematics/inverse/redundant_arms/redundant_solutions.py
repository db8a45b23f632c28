"""Solutions of redundant arms: samples of the self-motion, nearest to the seed first."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros.kinematics.inverse.closed_form import rank_solutions
from robomech_ros.kinematics.inverse.families.selection import Family
from robomech_ros.kinematics.inverse.request.request import Request
from robomech_ros.kinematics.inverse.result.result import Findings, InverseKinematicsResult, Listing
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinematics.tolerances import MOST_SAMPLED
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, IntArray


@lru_cache(maxsize=1)
def _solver() -> Callable[..., Any]:
    """Load the kernel when it is needed: it takes half a minute to compile."""
    from robomech_ros._kernels.inverse.redundant.solutions import solve_redundant

    return direct(solve_redundant)


def solve_by_sampling(
    chain: SerialChain, T: Array, request: Request, family: Family
) -> InverseKinematicsResult | None:
    """Sample the self-motion at the pose T (4, 4); None where no sample is inside the limits."""
    room = min(request.max_solutions or MOST_SAMPLED, MOST_SAMPLED)
    traced = request.seeded or room == 1
    ranked, counts, names, distances = sample_self_motions(
        chain, T[None], family, request, room, traced=traced
    )
    count = int(counts[0])
    if count <= 0:
        return None
    q, names, distances = ranked[0, :count], names[:count], distances[:count]
    if request.include_windings:
        q, names, distances = rank_solutions(chain, family.turns, request, q, names)
    kept = slice(request.max_solutions)
    findings = _sampled(chain, family)
    listing = Listing(T, distances[kept], names[kept])
    return InverseKinematicsResult(chain, q[kept], findings, listing)


@lru_cache(maxsize=64)
def _sampled(chain: SerialChain, family: Family) -> Findings:
    """Return what is found of solutions, which is the same for all poses."""
    reason = (
        f"{chain.n} joints for 6 conditions: the solutions form a continuum, of which these are "
        f"samples, along {parameter_name(chain, family.data)}"
    )
    return Findings(family.name, False, Status.SUCCESS, reason)


def sample_self_motions(
    chain: SerialChain, T: Array, family: Family, request: Request, room: int, *, traced: bool
) -> tuple[Array, IntArray, IntArray, Array]:
    """Sample the self-motion at the poses T (m, 4, 4).

    Where ``traced``, the first solution of arms of seven joints is the nearest of all self-motions
    to the seed, which takes several times longer for seeds far away.

    Returns the ranked solutions (m, room, n), their numbers (m,) as :func:`solve_redundant` gives
    them, and of the last pose the branches and distances (room,).
    """
    ranked = np.empty((len(T), room, chain.n))
    names, distances = np.empty(room, np.int64), np.empty(room)
    counts = np.empty(len(T), np.int64)
    asked = request.metric, request.respect_limits, room == 1, traced
    _solver()(family.arm, T, request.seed, asked, ranked, names, distances, counts)
    return ranked, counts, names, distances


def parameter_name(chain: SerialChain, data: Array) -> str:
    """Name what is sampled: the arm angle, or the joints that are locked."""
    if data[at.KIND] == at.ARM_ANGLE:
        return "the arm angle"
    first = int(data[at.FIRST])
    locked = chain.joint_names[:first] + chain.joint_names[first + 6 :]
    return " and ".join(f"joint '{name}'" for name in locked)
