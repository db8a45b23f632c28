"""Best posture of a redundant arm by a criterion, among all that reach a pose."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.kinetostatics.indices import COUNT, MANIPULABILITY, indices
from robomech_ros._kernels.tolerances import SAME_POSTURE
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.inverse_kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.redundant_arms.redundancy import Redundancy, limit_margins
from robomech_ros.kinematics.inverse.redundant_arms.self_motion import SelfMotionBranch, self_motion
from robomech_ros.kinematics.inverse.result.result import Findings, InverseKinematicsResult, Listing
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array, ArrayLike, IntArray

# Peaks of a criterion that are refined, and golden sections for each: 1e-7 of a step.
BEST_STARTS = 4
BEST_SECTIONS = 32

Criterion = Callable[[SerialChain, Array], Array]

_GOLDEN = 0.6180339887498949


def _manipulability(chain: SerialChain, q: Array) -> Array:
    """Product of the singular values of the Jacobian in SI units, shape (k,)."""
    out = np.empty((len(q), COUNT))
    indices(chain.packed, np.ascontiguousarray(q), np.ones(6), np.arange(6), 2.0, out)
    return out[:, MANIPULABILITY]


CRITERIA: dict[str, Criterion] = {"limit_margin": limit_margins, "manipulability": _manipulability}


def optimal_posture(
    chain: SerialChain, T: ArrayLike, *, criterion: str = "limit_margin"
) -> InverseKinematicsResult:
    """Find the posture of a seven-joint arm that reaches a pose and is best by a criterion.

    The whole self-motion inside the joint limits is searched, and its best places are refined.

    Parameters
    ----------
    chain : SerialChain
        Chain of seven joints.
    T : array_like, shape (4, 4)
        ``T_base_tip`` (m).
    criterion : {"limit_margin", "manipulability"}, optional
        What is made as large as possible: the distance (rad or m) of the joint nearest to a limit,
        or the root of the determinant of J J^T in SI units.

    Returns
    -------
    InverseKinematicsResult
        With that one posture; where there is none, that of :func:`inverse_kinematics`.

    Raises
    ------
    BadValueError, WrongSizeError
        An unknown criterion, a limit margin of a chain without limits, a chain with another number
        of joints, or an invalid target.

    See Also
    --------
    self_motion : all postures.
    """
    criterion = as_choice("criterion", criterion, tuple(CRITERIA))
    if criterion == "limit_margin" and np.isinf(chain.upper - chain.lower).all():
        raise BadValueError("criterion", criterion, "a chain with a joint that has two limits")
    motion = self_motion(chain, T)
    redundancy = Redundancy(chain, motion.target)
    value = CRITERIA[criterion]
    starts = [start for branch in motion.branches for start in _starts(branch, chain, value)]
    starts.sort(key=lambda start: -start[0])
    found = [_refined(redundancy, value, *start) for start in starts[:BEST_STARTS]]
    if not found:
        return inverse_kinematics(chain, T)
    worth, posture = max(found, key=lambda one: one[0])
    q = _placed(chain, posture)
    distance = np.array([np.abs(q - chain.midrange()).max()])
    listing = Listing(motion.target, distance, _branch(chain, motion.target, q))
    findings = Findings(
        family_of(chain).name, False, Status.SUCCESS, f"best by {criterion}: {worth:.6g}"
    )
    return InverseKinematicsResult(chain, q[None], findings, listing)


def _branch(chain: SerialChain, T: Array, q: Array) -> IntArray:
    """Return the bits that the solver of the chain's family gives a posture (n,), shape (1,)."""
    nearest = inverse_kinematics(chain, T, seed=q, max_solutions=1)
    if len(nearest) and nearest.seed_distance[0] < SAME_POSTURE:
        return nearest.branch_bits
    return np.array([bit.SELF_MOTION | bit.UNNAMED])


def _starts(
    branch: SelfMotionBranch, chain: SerialChain, value: Criterion
) -> list[tuple[float, float, float, Array]]:
    """Return the peaks among a branch's samples: worth, neighbouring parameters, posture."""
    inside = limit_margins(chain, branch.q) >= 0.0
    if not inside.any():
        return []
    worth = np.where(inside, value(chain, branch.q), -np.inf)
    last = len(worth) - 1
    peaks = []
    for k in np.flatnonzero(inside).tolist():
        before, after = max(k - 1, 0), min(k + 1, last)
        if worth[k] >= max(worth[before], worth[after]):
            low, high = float(branch.parameter[before]), float(branch.parameter[after])
            peaks.append((float(worth[k]), low, high, branch.q[k]))
    return peaks


def _refined(
    redundancy: Redundancy, value: Criterion, worth: float, low: float, high: float, posture: Array
) -> tuple[float, Array]:
    """Climb to the top of a peak by golden sections, inside the limits."""
    best = (worth, posture)

    def climb(parameter: float) -> float:
        nonlocal best
        q = redundancy.near(parameter, best[1])
        if q is None or limit_margins(redundancy.chain, q)[0] < 0.0:
            return -np.inf
        height = float(value(redundancy.chain, q[None])[0])
        if height > best[0]:
            best = (height, q)
        return height

    x, y = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    fx, fy = climb(x), climb(y)
    for _ in range(BEST_SECTIONS):
        if fx > fy:
            high, y, fy = y, x, fx
            x = high - _GOLDEN * (high - low)
            fx = climb(x)
        else:
            low, x, fx = x, y, fy
            y = low + _GOLDEN * (high - low)
            fy = climb(y)
    return best


def _placed(chain: SerialChain, q: Array) -> Array:
    """Put every joint into the winding that is farthest inside its limits."""
    middle = chain.midrange()
    turned = middle + np.remainder(q - middle + np.pi, 2.0 * np.pi) - np.pi
    return np.where(chain.types == PRISMATIC, q, turned)
