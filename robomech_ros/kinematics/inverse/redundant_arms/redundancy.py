"""The redundancy of a seven-joint arm at one pose: its postures as functions of one parameter."""

import math

import numpy as np

from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.redundant.arm_angle import arm_angle, arm_angle_postures
from robomech_ros._kernels.inverse.redundant.samples import locked_postures
from robomech_ros._kernels.inverse.six_joints import MAX_SOLUTIONS
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.redundant import locked_anyway
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array

# Postures of neighbouring values belong together where no joint moves farther than this (rad or m)
# and the next nearest pair is so many times farther apart.
SELF_MOTION_NEAR = 0.3
SELF_MOTION_APART = 2.0


class Redundancy:
    """Postures of one pose as functions of the redundancy parameter."""

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
        """Return all postures (k, 7) at a value of the parameter."""
        q, branch = np.empty((MAX_SOLUTIONS, 7)), np.empty(MAX_SOLUTIONS, np.int64)
        if self.data[at.KIND] == at.ARM_ANGLE:
            return q[: arm_angle_postures(self.data, self.T, self._seed, value, q, branch)]
        locked = self._seed.copy()
        locked[0 if self.data[at.FIRST] else 6] = value
        return q[: locked_postures(self.data, self.T, self._seed, locked, q, branch)]

    def parameter(self, q: Array) -> float:
        """Return the parameter of a posture (7,)."""
        if self.data[at.KIND] == at.ARM_ANGLE:
            return float(arm_angle(self.data, q))
        return float(q[6 if self.data[at.FIRST] == 0.0 else 0])

    def range(self) -> tuple[float, float, bool]:
        """Return the range of the parameter, and whether its ends are the same."""
        if self.data[at.KIND] == at.ARM_ANGLE:
            return -math.pi, math.pi, True
        locked = 6 if self.data[at.FIRST] == 0.0 else 0
        if self._turns[locked]:
            return -math.pi, math.pi, True
        # The tip moves along the slide as far as the slide does, to within the arm's length.
        size, transforms = float(self.data[at.SIZE]), self.chain.transforms
        axis = self.T[:3, :3] @ transforms[-1][2, :3] if locked else transforms[0][:3, 2]
        middle = float(axis @ self.T[:3, 3])
        low, high = float(self.chain.lower[locked]), float(self.chain.upper[locked])
        return max(low, middle - size), min(high, middle + size), False

    def difference(self, p: Array, q: Array) -> Array:
        """Subtract postures, angles in (-pi, pi]."""
        raw = p - q
        return np.where(self._turns, np.remainder(raw + math.pi, 2.0 * math.pi) - math.pi, raw)

    def near(self, value: float, guess: Array) -> Array | None:
        """Return the posture at a value that is nearest to a guess, in its winding."""
        q = self.at(value)
        if not len(q):
            return None
        moves = self.difference(q, guess)
        return guess + moves[np.abs(moves).max(axis=1).argmin()]

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


def limit_margins(chain: SerialChain, q: Array) -> Array:
    """Return the distance (rad or m) of the joint nearest to a limit, shape (k,), negative outside.

    Every joint counts in the winding that is farthest inside its limits.
    """
    q = np.atleast_2d(q)
    turns = (chain.types != PRISMATIC) & (chain.lower < chain.upper)
    room = np.minimum(q - chain.lower, chain.upper - q)
    half = 0.5 * (chain.upper - chain.lower)
    away = np.remainder(q - chain.midrange() + math.pi, 2.0 * math.pi) - math.pi
    return np.where(turns, half - np.abs(away), room).min(axis=1, initial=np.inf)
