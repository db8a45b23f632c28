"""Proofs that joint intervals hold no singular posture, by bounds of the Jacobian's minors.

The Jacobian keeps its rank where one of its largest minors is not zero.  As seen from the tip, each
of these minors is a polynomial of degree two in the cosine and sine of every angle and in every
displacement, and it depends neither on the first joint nor, at a point of its axis, on the last.
With ``t = tan((q - m) / 2)`` about the middle m of an interval it becomes a polynomial of degree
four in t, over (1 + t^2)^2, and its Bernstein coefficients bound it.

For an arm with a spherical wrist the one minor is the product of the factors of arm and wrist, and
the coefficients are products of theirs: the bounds are those of the factors.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.special import comb

from robomech_ros.errors import BadValueError, MissingLimitsError, WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, check_chain, raise_not_finite
from robomech_ros.kinetostatics.singularities.distance import singular_posture_from
from robomech_ros.kinetostatics.singularities.minors import Minors, minors_of
from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, ArrayLike

_WHOLE_TURN = 2.0 * math.pi
# Boxes that searches for a singular posture start from, and the widest that do (rad, of the size).
_SEARCHES = 24
_SEARCHED = 0.3
# A singular posture this far (rad or m) out of the intervals is on their ends, as found.
_SLACK = 1e-9
# Halvings of a segment whose ends have minors of different signs.
_HALVINGS = 60


@dataclass(frozen=True, eq=False)
class SingularityFree:
    """Result of a search for singular postures within joint intervals.

    Attributes
    ----------
    proven : bool
        There is none, for certain.
    posture : ndarray, shape (n,), or None
        A singular one (rad or m), where one was found.
    boxes : int
        Parts of the intervals that were examined.
    """

    proven: bool
    posture: Array | None
    boxes: int

    @property
    def undecided(self) -> bool:
        """Neither is proved that there is none, nor was one found."""
        return not self.proven and self.posture is None


def singularity_free(
    chain: SerialChain,
    lower: ArrayLike | None = None,
    upper: ArrayLike | None = None,
    *,
    most_boxes: int = 20_000,
) -> SingularityFree:
    """Prove that joint intervals hold no singular posture, or find one.

    Singular is a posture in which the tip has lost a motion that the arm has elsewhere.  The
    intervals are halved until bounds prove that some minor of the Jacobian is not zero in any
    part; beside a singular posture just out of them this takes many parts.

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint to eight.
    lower, upper : array_like, shape (n,), optional
        Ends of the intervals (rad or m), slides' finite; default the position limits.  Angles
        without a limit are all examined.
    most_boxes : int, optional
        Parts that are examined before it is left undecided, at least one.

    Returns
    -------
    SingularityFree
        With ``proven`` True, or a singular ``posture`` within the intervals, or neither.

    Raises
    ------
    BadValueError, WrongSizeError
        The ends are not n numbers, or a lower one is above the upper; the chain has no joint or
        more than eight; ``most_boxes`` is no number of parts.
    MissingLimitsError
        A slide without an end.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.4.  Farouki, The
    Bernstein polynomial basis: a centennial retrospective, Computer Aided Geometric Design 29(6),
    2012.
    """
    check_chain(chain)
    if not isinstance(most_boxes, int | np.integer) or most_boxes is True or most_boxes < 1:
        raise BadValueError("most_boxes", most_boxes, "a number of parts, 1 or more")
    low, high = _ends(chain, lower, upper)
    return _Search(chain, low, high, int(most_boxes)).result()


def _ends(
    chain: SerialChain, lower: ArrayLike | None, upper: ArrayLike | None
) -> tuple[Array, Array]:
    """Check the ends, and cut angles to one turn."""
    low = chain.lower if lower is None else as_joint_values(chain, lower, "lower")
    high = chain.upper if upper is None else as_joint_values(chain, upper, "upper")
    for what, ends in (("lower", low), ("upper", high)):
        if ends.ndim != 1:
            raise WrongSizeError(what, ends.shape, (chain.n,))
        if np.isnan(ends).any():
            raise_not_finite(chain, ends, what)
    above = np.flatnonzero(low > high)
    if len(above):
        i = above[0]
        expected = f"at most its upper end {high[i]:g}"
        raise BadValueError(f"lower end of joint '{chain.joint_names[i]}'", float(low[i]), expected)
    slides = chain.types == PRISMATIC
    endless = slides & ~(np.isfinite(low) & np.isfinite(high))
    if endless.any():
        raise MissingLimitsError(
            "position", [chain.joint_names[i] for i in np.flatnonzero(endless)]
        )
    # A turn that begins at the one end there is.
    begin = np.where(
        np.isfinite(low), low, np.where(np.isfinite(high), high - _WHOLE_TURN, -math.pi)
    )
    wide = ~slides & ~(high - begin < _WHOLE_TURN)
    return begin, np.where(wide, begin + _WHOLE_TURN, high)


@dataclass(frozen=True, eq=False)
class _Box:
    """A part of the intervals: ends in t (k,), and the middle (k,) where t is zero (rad or m).

    The tensor (m, ...) has the Bernstein coefficients of the minors.
    """

    tensor: Array
    middle: Array
    low: Array
    high: Array


class _Search:
    """Boxes that are still to be proved regular, and what has been found."""

    def __init__(self, chain: SerialChain, low: Array, high: Array, most: int) -> None:
        self.chain, self.low, self.high, self.most = chain, low, high, most
        self.minors: Minors = minors_of(chain)
        self.turns = chain.types[list(self.minors.joints)] != PRISMATIC
        self.searches = 0
        # A posture with a positive minor and one with a negative one, where there is but one.
        self.signs: dict[bool, Array] = {}

    def result(self) -> SingularityFree:
        found = self._searched(0.5 * (self.low + self.high))
        boxes = 0
        waiting = [] if found is not None else self._first()
        while waiting and boxes < self.most and found is None:
            box = waiting.pop()
            boxes += 1
            centre = self._posture(box, 0.5 * (box.low + box.high))
            found = self._changed(centre)
            if found is None and not self._regular(box, centre):
                if self._width(box) < _SEARCHED and self.searches < _SEARCHES:
                    self.searches += 1
                    found = self._searched(centre)
                waiting += self._halves(box)
        return SingularityFree(found is None and not waiting, found, boxes)

    def _first(self) -> list[_Box]:
        """Cut the intervals into boxes of at most half a turn."""
        joints = list(self.minors.joints)
        parts = []
        for low, high, turns in zip(self.low[joints], self.high[joints], self.turns, strict=True):
            count = max(1, math.ceil((high - low) / math.pi)) if turns else 1
            ends = np.linspace(low, high, count + 1)
            parts.append(list(itertools.pairwise(ends.tolist())))
        return [self._box(np.array(ends).reshape(-1, 2)) for ends in itertools.product(*parts)]

    def _box(self, ends: Array) -> _Box:
        middle, half = ends.mean(axis=1), 0.5 * (ends[:, 1] - ends[:, 0])
        reach = np.where(self.turns, np.tan(0.5 * half), half)
        return _Box(self.minors.bernstein(middle, reach), middle, -reach, reach)

    def _posture(self, box: _Box, t: Array) -> Array:
        """Return joint values, those that do not count in the middle of their intervals."""
        q = 0.5 * (self.low + self.high)
        joints = list(self.minors.joints)
        q[joints] = box.middle + np.where(self.turns, 2.0 * np.arctan(t), t)
        return np.clip(q, self.low, self.high)

    def _width(self, box: _Box) -> float:
        spans = box.high - box.low
        size = np.where(self.turns, 0.5, self.minors.size)
        return float((spans / size).max(initial=0.0))

    def _regular(self, box: _Box, centre: Array) -> bool:
        """Return whether the combination of minors that is largest in the middle has one sign."""
        here = self.minors.at(centre)
        norm = float(np.linalg.norm(here))
        if norm == 0.0:
            return False
        bound = np.tensordot(here / norm, box.tensor, axes=1)
        return bool(bound.min() > self.minors.margin)

    def _changed(self, q: Array) -> Array | None:
        """Look for a zero between postures where the only minor has different signs."""
        if self.minors.count != 1:
            return None
        value = float(self.minors.at(q)[0])
        self.signs.setdefault(value > 0.0, q)
        if len(self.signs) < 2:
            return None
        ends = self.signs[True], self.signs[False]
        return bisected(*ends, lambda q: self.minors.at(q)[0] > 0.0, _HALVINGS)[1]

    def _searched(self, q: Array) -> Array | None:
        """Look for the nearest singular posture, and take it if it is within the intervals."""
        end = singular_posture_from(self.chain, q, self.minors.size)
        if end is None:
            return None
        # The first joint and the last may be anywhere.
        free = np.ones(self.chain.n, dtype=bool)
        free[list(self.minors.joints)] = False
        end = np.where(free, q, end)
        turn = np.where(self.chain.types == PRISMATIC, 0.0, _WHOLE_TURN)
        end = end - turn * np.floor((end - self.low + _SLACK) / np.where(turn > 0.0, turn, 1.0))
        inside = np.clip(end, self.low, self.high)
        return inside if np.abs(inside - end).max() <= _SLACK else None

    def _halves(self, box: _Box) -> list[_Box]:
        """Halve a box where its coefficients change most."""
        changes = [
            np.abs(np.diff(box.tensor, axis=axis + 1)).max(initial=0.0)
            for axis in range(len(box.middle))
        ]
        axis = int(np.argmax(changes))
        t = 0.5 * (box.low[axis] + box.high[axis])
        halves = []
        for tensor, side in zip(_cut(box.tensor, axis + 1), ("high", "low"), strict=True):
            ends = {"low": box.low.copy(), "high": box.high.copy()}
            ends[side][axis] = t
            halves.append(_Box(tensor, box.middle, **ends))
        return halves


def _cut(tensor: Array, axis: int) -> tuple[Array, Array]:
    """Return the Bernstein coefficients of the two halves along an axis, after de Casteljau."""
    left = _left_half(tensor.shape[axis])
    moved = np.moveaxis(tensor, axis, -1)
    first, second = (np.moveaxis(moved @ half.T, -1, axis) for half in (left, left[::-1, ::-1]))
    return first, second


@functools.lru_cache(maxsize=8)
def _left_half(count: int) -> Array:
    i = np.arange(count)[:, None]
    return np.asarray(comb(i, i.T) / 2.0**i)
