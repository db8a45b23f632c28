"""The self-motion of a seven-joint arm: how it can move while its tip stays where it is."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.kinematics.inverse.redundant_arms.redundancy import Redundancy, limit_margins
from robomech_ros.kinematics.inverse.redundant_arms.redundant_solutions import parameter_name
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike

# Step of the redundancy parameter (rad or m) at most, and below which a branch that cannot be
# followed has ended.
SELF_MOTION_STEP = 0.05
SELF_MOTION_LEAST = 1e-7


@dataclass(frozen=True, eq=False)
class SelfMotionBranch:
    """A piece of a self-motion along which the posture is a continuous function of the parameter.

    Parameters
    ----------
    parameter : ndarray, shape (m,)
        Increasing values of the redundancy parameter (rad, or m for a slide).
    q : ndarray, shape (m, n)
        The postures (rad or m), angles without jumps of a turn.
    closed : bool
        Whether the piece returns to its first posture after a turn of the parameter.
    intervals : ndarray, shape (k, 2)
        Where on it all joints are inside their limits, in some winding.
    """

    parameter: Array
    q: Array
    closed: bool
    intervals: Array


@dataclass(frozen=True, eq=False)
class SelfMotion:
    """All of a self-motion.

    Parameters
    ----------
    chain : SerialChain
    target : ndarray, shape (4, 4)
        ``T_base_tip`` that is kept (m).
    parameter_name : str
        What the parameter is: the arm angle, or the joint that is locked.
    branches : tuple of SelfMotionBranch
        They end where the parameter turns back, in a fold that two of them share, and at the end
        of its range.
    """

    chain: SerialChain
    target: Array
    parameter_name: str
    branches: tuple[SelfMotionBranch, ...]

    @property
    def feasible(self) -> float:
        """Length of all intervals inside the limits together (rad or m)."""
        return float(sum((b.intervals[:, 1] - b.intervals[:, 0]).sum() for b in self.branches))


def self_motion(chain: SerialChain, T: ArrayLike) -> SelfMotion:
    """Trace the self-motion of a seven-joint arm at a pose, and where it keeps the joint limits.

    The parameter goes through its whole range in steps that become shorter where branches come
    near each other or end; ends of intervals and of branches are located to about 1e-6.

    Parameters
    ----------
    chain : SerialChain
        Of seven joints, of which the first or the last six move in all directions. Where no six
        of them are solved completely, the last one (else the first) is locked and the others are
        searched for iteratively, which takes long and proves nothing complete.
    T : array_like, shape (4, 4)
        ``T_base_tip`` (m).

    Returns
    -------
    SelfMotion
        Without branches where the pose is out of reach.

    Raises
    ------
    BadValueError, WrongSizeError
        A chain with another number of joints or without such six, or an invalid target.

    See Also
    --------
    inverse_kinematics : samples of it.
    optimal_posture : the best posture on it.
    """
    check_chain(chain)
    target = as_targets(T)[0]
    redundancy = Redundancy(chain, target)
    pieces = _pieces(redundancy)
    low, high, ring = redundancy.range()
    branches = []
    for values, postures in pieces:
        parameter, q = np.array(values), np.array(postures)
        whole = ring and values[0] == low and values[-1] == high
        closed = whole and bool(np.abs(redundancy.difference(q[0], q[-1])).max() < 1e-6)
        intervals = _intervals(redundancy, parameter, q)
        branches.append(SelfMotionBranch(parameter, q, closed, intervals))
    return SelfMotion(chain, target, parameter_name(chain, redundancy.data), tuple(branches))


def _pieces(redundancy: Redundancy) -> list[tuple[list[float], list[Array]]]:
    """Follow every posture from one value of the parameter to the next."""
    low, high, _ = redundancy.range()
    steps = max(math.ceil((high - low) / SELF_MOTION_STEP), 1)
    values = [low + (high - low) * k / steps for k in range(steps)] + [high]
    done: list[tuple[list[float], list[Array]]] = []
    postures = redundancy.at(low)
    active = [([low], [posture]) for posture in postures]
    for start, end in itertools.pairwise(values):
        # Parts of this step that are still to be done, the next one last.
        ahead = [(end, redundancy.at(end))]
        value = start
        while ahead:
            goal, found = ahead[-1]
            least = 0.0 if goal - value < SELF_MOTION_LEAST else SELF_MOTION_LEAST
            pairs = redundancy.matched(postures, found, least)
            if pairs is None:
                middle = 0.5 * (value + goal)
                ahead.append((middle, redundancy.at(middle)))
                continue
            ahead.pop()
            active = _extended(redundancy, active, goal, found, pairs, done)
            value, postures = goal, found
    return done + [piece for piece in active if len(piece[0]) > 1]


def _extended(
    redundancy: Redundancy,
    active: list[tuple[list[float], list[Array]]],
    value: float,
    found: Array,
    pairs: list[tuple[int, int]],
    done: list[tuple[list[float], list[Array]]],
) -> list[tuple[list[float], list[Array]]]:
    """Add the postures found at a value to the pieces they belong to; those that end are done."""
    following: list[tuple[list[float], list[Array]]] = [([value], [q]) for q in found]
    taken = set()
    for i, j in pairs:
        values, postures = active[i]
        taken.add(i)
        last = postures[-1]
        postures.append(last + redundancy.difference(found[j], last))
        values.append(value)
        following[j] = active[i]
    done.extend(p for i, p in enumerate(active) if i not in taken and len(p[0]) > 1)
    return following


def _intervals(redundancy: Redundancy, parameter: Array, q: Array) -> Array:
    """Find where a piece is inside the limits, shape (k, 2)."""
    inside = limit_margins(redundancy.chain, q) >= 0.0
    edges = []
    if inside[0]:
        edges.append(float(parameter[0]))
    for k in np.flatnonzero(inside[1:] != inside[:-1]).tolist():
        edges.append(_crossing(redundancy, parameter[k : k + 2], q[k : k + 2], bool(inside[k])))
    if inside[-1]:
        edges.append(float(parameter[-1]))
    return np.array(edges).reshape(-1, 2)


def _crossing(redundancy: Redundancy, parameter: Array, q: Array, first_inside: bool) -> float:
    """Locate the limit between two postures of a piece, on its inner side."""
    a, b = float(parameter[0]), float(parameter[1])
    p, r = q
    for _ in range(40):
        middle = 0.5 * (a + b)
        posture = redundancy.near(middle, 0.5 * (p + r))
        if posture is None or not a < middle < b:
            break
        if (limit_margins(redundancy.chain, posture)[0] >= 0.0) == first_inside:
            a, p = middle, posture
        else:
            b, r = middle, posture
    return a if first_inside else b
