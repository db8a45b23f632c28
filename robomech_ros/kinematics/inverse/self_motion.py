"""The self-motion of a seven-joint arm: how it can move while its tip stays where it is."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arm_angle import arm_angle, arm_angle_postures
from robomech_ros._kernels.inverse.redundant.solutions import locked_postures
from robomech_ros._kernels.inverse.six_joints import MAX_SOLUTIONS
from robomech_ros._kernels.tolerances import (
    SELF_MOTION_APART,
    SELF_MOTION_LEAST,
    SELF_MOTION_NEAR,
    SELF_MOTION_STEP,
)
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.redundant import locked_anyway
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.redundant_solutions import parameter_name
from robomech_ros.kinematics.inverse.target import as_targets
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC

__all__ = ["SelfMotion", "SelfMotionBranch", "margins", "self_motion"]

Array = NDArray[np.float64]


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


class Tracer:
    """Postures of one pose as a function of the redundancy parameter."""

    def __init__(self, chain: SerialChain, T: Array) -> None:
        if chain.n != 7:
            raise BadValueError("number of joints", chain.n, "7, one more than conditions")
        family = family_of(chain)
        self.chain, self.T = chain, T
        data = family.data if family.redundant else locked_anyway(chain)
        if data is None:
            expected = "an arm of which the first or the last six joints move in all directions"
            raise BadValueError("chain", chain.name, expected)
        self.data = data
        self._seed = chain.midrange()
        self._turns = chain.types != PRISMATIC

    def at(self, value: float) -> Array:
        """Give all postures (k, 7) at a value of the parameter."""
        q, branch = np.empty((MAX_SOLUTIONS, 7)), np.empty(MAX_SOLUTIONS, np.int64)
        if self.data[at.KIND] == at.ARM_ANGLE:
            count = arm_angle_postures(self.data, self.T, self._seed, value, q, branch)
            return q[:count]
        locked = self._seed.copy()
        locked[0 if self.data[at.FIRST] else 6] = value
        count = locked_postures(self.data, self.T, self._seed, locked, q, branch)
        return q[:count]

    def parameter(self, q: Array) -> float:
        """Give the parameter of a posture (7,)."""
        if self.data[at.KIND] == at.ARM_ANGLE:
            return float(arm_angle(self.data, q))
        return float(q[6 if self.data[at.FIRST] == 0.0 else 0])

    def range(self) -> tuple[float, float, bool]:
        """Give the range of the parameter, and whether its ends are the same."""
        if self.data[at.KIND] == at.ARM_ANGLE:
            return -math.pi, math.pi, True
        locked = 6 if self.data[at.FIRST] == 0.0 else 0
        if self._turns[locked]:
            return -math.pi, math.pi, True
        size = float(self.data[at.SIZE])
        low, high = float(self.chain.lower[locked]), float(self.chain.upper[locked])
        return max(low, -size), min(high, size), False

    def difference(self, p: Array, q: Array) -> Array:
        """Subtract postures, angles in (-pi, pi]."""
        raw = p - q
        return np.where(self._turns, np.remainder(raw + math.pi, 2.0 * math.pi) - math.pi, raw)

    def near(self, value: float, guess: Array) -> Array | None:
        """Give the posture at a value that is nearest to a guess, in its winding."""
        q = self.at(value)
        if not len(q):
            return None
        moves = self.difference(q, guess)
        k = int(np.abs(moves).max(axis=1).argmin())
        nearest: Array = guess + moves[k]
        return nearest

    def matched(self, p: Array, q: Array, least: float) -> list[tuple[int, int]] | None:
        """Pair the postures of two neighbouring values; None where that is not clear.

        Below the least step what is clear is paired, and the rest are ends of branches.
        """
        if not len(p) or not len(q):
            return [] if len(p) == len(q) or least == 0.0 else None
        away = np.abs(self.difference(p[:, None], q[None])).max(axis=2)
        to, back = away.argmin(axis=1), away.argmin(axis=0)
        pairs = [(i, int(j)) for i, j in enumerate(to) if back[j] == i]
        if least == 0.0:
            return [(i, j) for i, j in pairs if away[i, j] < SELF_MOTION_NEAR]
        if len(p) != len(q) or len(pairs) < len(p):
            return None
        for i, j in pairs:
            others = np.concatenate((np.delete(away[i], j), np.delete(away[:, j], i)))
            if away[i, j] > SELF_MOTION_NEAR or (others < SELF_MOTION_APART * away[i, j]).any():
                return None
        return pairs


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
    BadValueError, WrongSizeError, NonFiniteError
        A chain with another number of joints or without such six, or a target that is none.

    See Also
    --------
    inverse_kinematics : samples of it.
    optimal_posture : the best posture on it.
    """
    check_chain(chain)
    target = as_targets(T)[0]
    tracer = Tracer(chain, target)
    pieces = _pieces(tracer)
    low, high, ring = tracer.range()
    branches = []
    for values, postures in pieces:
        parameter, q = np.array(values), np.array(postures)
        whole = ring and values[0] == low and values[-1] == high
        closed = whole and bool(np.abs(tracer.difference(q[0], q[-1])).max() < 1e-6)
        intervals = _intervals(tracer, parameter, q)
        branches.append(SelfMotionBranch(parameter, q, closed, intervals))
    name = parameter_name(chain, tracer.data)
    return SelfMotion(chain, target, name, tuple(branches))


def margins(chain: SerialChain, q: Array) -> Array:
    """Give the distance (rad or m) of the joint nearest to a limit, shape (k,), negative outside.

    Every joint counts in the winding that is farthest inside its limits.
    """
    q = np.atleast_2d(q)
    turns = (chain.types != PRISMATIC) & (chain.lower < chain.upper)
    room = np.minimum(q - chain.lower, chain.upper - q)
    half = 0.5 * (chain.upper - chain.lower)
    away = np.remainder(q - chain.midrange() + math.pi, 2.0 * math.pi) - math.pi
    least: Array = np.where(turns, half - np.abs(away), room).min(axis=1, initial=np.inf)
    return least


def _pieces(tracer: Tracer) -> list[tuple[list[float], list[Array]]]:
    """Follow every posture from one value of the parameter to the next."""
    low, high, _ = tracer.range()
    steps = max(math.ceil((high - low) / SELF_MOTION_STEP), 1)
    values = [low + (high - low) * k / steps for k in range(steps)] + [high]
    done: list[tuple[list[float], list[Array]]] = []
    postures = tracer.at(low)
    active = [([low], [posture]) for posture in postures]
    for start, end in itertools.pairwise(values):
        # Parts of this step that are still to be done, the next one last.
        ahead = [(end, tracer.at(end))]
        value = start
        while ahead:
            goal, found = ahead[-1]
            least = 0.0 if goal - value < SELF_MOTION_LEAST else SELF_MOTION_LEAST
            pairs = tracer.matched(postures, found, least)
            if pairs is None:
                middle = 0.5 * (value + goal)
                ahead.append((middle, tracer.at(middle)))
                continue
            ahead.pop()
            active = _extended(tracer, active, goal, found, pairs, done)
            value, postures = goal, found
    return done + [piece for piece in active if len(piece[0]) > 1]


def _extended(
    tracer: Tracer,
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
        postures.append(last + tracer.difference(found[j], last))
        values.append(value)
        following[j] = active[i]
    done.extend(p for i, p in enumerate(active) if i not in taken and len(p[0]) > 1)
    return following


def _intervals(tracer: Tracer, parameter: Array, q: Array) -> Array:
    """Find where a piece is inside the limits, shape (k, 2)."""
    inside = margins(tracer.chain, q) >= 0.0
    edges = []
    if inside[0]:
        edges.append(float(parameter[0]))
    for k in np.flatnonzero(inside[1:] != inside[:-1]).tolist():
        edges.append(_crossing(tracer, parameter[k : k + 2], q[k : k + 2], bool(inside[k])))
    if inside[-1]:
        edges.append(float(parameter[-1]))
    return np.array(edges).reshape(-1, 2)


def _crossing(tracer: Tracer, parameter: Array, q: Array, first_inside: bool) -> float:
    """Locate the limit between two postures of a piece, on its inner side."""
    a, b = float(parameter[0]), float(parameter[1])
    p, r = q
    for _ in range(40):
        middle = 0.5 * (a + b)
        posture = tracer.near(middle, 0.5 * (p + r))
        if posture is None or not a < middle < b:
            break
        if (margins(tracer.chain, posture)[0] >= 0.0) == first_inside:
            a, p = middle, posture
        else:
            b, r = middle, posture
    return a if first_inside else b
