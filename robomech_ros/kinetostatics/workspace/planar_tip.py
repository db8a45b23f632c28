"""Reach of the tip of a planar arm of three joints with a revolute last joint.

A point inside is reached by a continuum of postures, a curve in the box of the joint values.  It
meets a side of the box, where a joint is at a limit; or it is closed, and then the first joint has
an extreme value on it, at which the other two are singular: the last one has one of two values; or
the first joint turns all the way round, and takes any value.  So what the arm reaches is what its
pairs of joints reach while the third is held at one of these values, and the curves that divide
the plane are those of the pairs.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinetostatics.workspace.curve_pieces import CurvePiece, branches_of, values_in
from robomech_ros.kinetostatics.workspace.cusps_and_nodes import Branch
from robomech_ros.kinetostatics.workspace.nearest import NearestOnCurves
from robomech_ros.kinetostatics.workspace.point_postures import PointPostures
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection, section_of
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, joint_transform
from robomech_ros.typing import Array, BoolArray, IntArray

# How far beside a curve it is looked whether a point is reached, over the arm's size.
_BESIDE = 2e-5
# Bisections that find where a curve begins or ends to divide.
_BISECTIONS = 20
# Curves as near to each other as this, over the arm's size, are the same: where two touch, points
# beside one of them are also beside the other.
_SAME = 3.0 * _BESIDE
# Number of examined vertices of a curve.
_LOOKED_AT = 50


@dataclass(frozen=True, eq=False)
class HeldPair:
    """The section of two joints that move while the third is held at a value (rad or m).

    The cause is its limit, such as ``"joint_3 upper"``, or empty inside its range.
    """

    joint: int
    value: float
    cause: str
    section: WorkspaceSection

    def arm_values(self, q: Array) -> Array:
        """Return the values of all three joints from those of the pair (k, 2)."""
        return np.insert(q, self.joint, self.value, axis=1)

    @cached_property
    def postures(self) -> PointPostures:
        """Solver for the postures of the pair."""
        return PointPostures(self.section, first_free=True)


@dataclass(frozen=True, eq=False)
class PlanarTip:
    """Joint reach of all pairs of joints.

    The pieces of each pair bound the whole, in the coordinates of its section; what is reached is
    on the left.
    """

    pairs: tuple[HeldPair, ...]
    pieces: tuple[tuple[CurvePiece, ...], ...]

    def count(self, points: Array) -> IntArray:
        """Return 1 where points (m, 3) of the base (m) are reached, else 0."""
        return _reached(self.pairs, points).astype(np.int64)

    def distance(self, points: Array) -> Array:
        """Return the distance of points (m, 3) of the base from the nearest boundary (m)."""
        found = [
            search.find(pair.section.coordinates(pair.section.in_frame(points)))[0]
            for pair, search in self._nearest
        ]
        return np.min(found, axis=0)

    @cached_property
    def _nearest(self) -> list[tuple[HeldPair, NearestOnCurves]]:
        return [
            (pair, NearestOnCurves(pair.section, list(pieces)))
            for pair, pieces in zip(self.pairs, self.pieces, strict=True)
            if pieces
        ]


def planar_tip(chain: SerialChain, *, respect_limits: bool) -> PlanarTip:
    """Find what a planar arm of three joints, of which the last turns, reaches with its tip.

    Limits of slides always hold, those of turning joints only if they are respected.
    """
    pairs = []
    for joint in range(3):
        limited = respect_limits or chain.types[joint] == PRISMATIC
        ends = (float(chain.lower[joint]), float(chain.upper[joint]))
        if limited and (chain.types[joint] == PRISMATIC or ends[1] - ends[0] < 2.0 * math.pi):
            for name, value in zip(("lower", "upper"), ends, strict=True):
                cause = f"{chain.joint_names[joint]} {name}"
                pairs.append(_held(chain, joint, value, cause, respect_limits))
        elif joint == 0:
            pairs.append(_held(chain, joint, 0.0, "", respect_limits))
    for value in _singular_values(chain):
        inside = chain.lower[2] <= value <= chain.upper[2]
        if inside or not respect_limits:
            pairs.append(_held(chain, 2, value, "", respect_limits))
    kept = tuple(pair for pair in pairs if pair is not None)
    if not kept:
        expected = "one whose joints move the tip in all directions of its plane"
        raise BadValueError("chain", chain.name, expected)
    return PlanarTip(kept, _dividing(kept))


def _held(
    chain: SerialChain, joint: int, value: float, cause: str, respect_limits: bool
) -> HeldPair | None:
    """Hold a joint; None where the others do not move the tip in all directions."""
    try:
        section = section_of(_without(chain, joint, value), respect_limits=respect_limits)
    except BadValueError:
        return None
    return HeldPair(joint, value, cause, section)


def _without(chain: SerialChain, joint: int, value: float) -> SerialChain:
    """Return the arm of the other two joints, one held at a value (rad or m)."""
    C = list(chain.transforms)
    slides = bool(chain.types[joint] == PRISMATIC)
    C[joint : joint + 2] = [C[joint] @ joint_transform(slides, value) @ C[joint + 1]]
    kept = np.arange(3) != joint
    names = tuple(name for name, one in zip(chain.joint_names, kept, strict=True) if one)
    part = chain_of(np.array(C), chain.types[kept].tolist())
    limits = {"lower": chain.lower[kept], "upper": chain.upper[kept]}
    return replace(part, name=chain.name, joint_names=names, **limits)


def _singular_values(chain: SerialChain) -> tuple[float, ...]:
    """Return the values of joint 3 at which joints 2 and 3 move the tip in one direction only.

    Seen from joint 3 the tip is then on a line with joint 2, or across the slide that this is.
    """
    C = chain.transforms
    seen, tip = np.linalg.inv(C[2]), C[3][:2, 3]
    # Joint 2, or the normal of its slide, in the frame before joint 3 turns, whose axis is z.
    if chain.types[1] == PRISMATIC:
        slide = (seen @ (0.0, 0.0, 1.0, 0.0))[:2]
        towards = np.array((-slide[1], slide[0]))
    else:
        towards = (seen @ (0.0, 0.0, 0.0, 1.0))[:2]
    if not np.linalg.norm(tip) or not np.linalg.norm(towards):
        return ()
    angle = math.atan2(towards[1], towards[0]) - math.atan2(tip[1], tip[0])
    return math.remainder(angle, 2.0 * math.pi), math.remainder(angle + math.pi, 2.0 * math.pi)


def _reached(pairs: tuple[HeldPair, ...], points: Array) -> BoolArray:
    """Tell which of points (m, 3) of the base some pair reaches."""
    reached = np.zeros(len(points), dtype=bool)
    for pair in pairs:
        open_ = np.flatnonzero(~reached)
        if len(open_):
            reached[open_] = pair.postures.count(points[open_]) > 0
    return reached


def _dividing(pairs: tuple[HeldPair, ...]) -> tuple[tuple[CurvePiece, ...], ...]:
    """Return what of the pairs' curves has what is reached on one side only, each curve once."""
    size = max(pair.section.size for pair in pairs)
    found: list[tuple[int, CurvePiece, Array]] = []
    for k, pair in enumerate(pairs):
        section = pair.section
        for branch in branches_of(section.over(section.size))[0]:
            q = values_in(section, branch.q, branch.joint, branch.limit)
            whole = _Branch(Branch.of(section, branch.joint, branch.limit, q), section)
            for piece in whole.dividing(pairs, _BESIDE * size):
                found.append((k, piece, section.on_section(piece.points)))
    # The longest first: others may be parts of them.
    found.sort(key=lambda one: -float(np.linalg.norm(np.diff(one[2], axis=0), axis=1).sum()))
    kept: list[Array] = []
    pieces: list[list[CurvePiece]] = [[] for _ in pairs]
    for k, piece, points in found:
        if not any(_lies_on(points, other, _SAME * size) for other in kept):
            kept.append(points)
            pieces[k].append(piece)
    return tuple(tuple(own) for own in pieces)


@dataclass(frozen=True, eq=False)
class _Branch:
    """A curve with its reached side; a number k + x is between its vertices k and k + 1."""

    branch: Branch
    section: WorkspaceSection

    def values(self, at: Array) -> Array:
        """Return the joint values (m, 2) of places (m,)."""
        q = self.branch.q
        k = np.clip(at.astype(np.int64), 0, len(q) - 2)
        return q[k] + (at - k)[:, None] * (q[k + 1] - q[k])

    def sides(self, pairs: tuple[HeldPair, ...], at: Array, step: float) -> IntArray:
        """Return 1 where only the left of places (m,) is reached, -1 only the right, else 0."""
        section, q = self.section, self.values(at)
        points = section.image(q[:, 0], q[:, 1])
        chords = np.diff(self.branch.points, axis=0)
        tangent = chords[np.clip(at.astype(np.int64), 0, len(chords) - 1)]
        tangent = tangent / np.maximum(np.linalg.norm(tangent, axis=1), 1e-300)[:, None]
        normal = step * np.stack((-tangent[:, 1], tangent[:, 0]), axis=1)
        left, right = (
            _reached(pairs, section.on_section(points + sign * normal)) for sign in (1, -1)
        )
        return left.astype(np.int64) - right.astype(np.int64)

    def dividing(self, pairs: tuple[HeldPair, ...], step: float) -> list[CurvePiece]:
        """Cut out what has one side reached only, with that side on the left."""
        count = len(self.branch.q) - 1
        side = self.sides(pairs, np.arange(count, dtype=np.float64) + 0.5, step)
        change = np.flatnonzero(np.diff(side)) + 1
        low, high = (np.asarray(change + half, dtype=np.float64) for half in (-0.5, 0.5))
        for _ in range(_BISECTIONS if len(change) else 0):
            middle = np.asarray(0.5 * (low + high), dtype=np.float64)
            before = self.sides(pairs, middle, step) == side[change - 1]
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        ends = [0.0, *(0.5 * (low + high)).tolist(), float(count)]
        found = zip(ends[:-1], ends[1:], side[[0, *change]].tolist(), strict=True)
        return [self._piece(first, last, one) for first, last, one in found if one]

    def _piece(self, first: float, last: float, side: int) -> CurvePiece:
        """Return what is between two places, the side that is reached on the left."""
        between = np.arange(math.floor(first) + 1.0, math.ceil(last))
        q = self.values(np.concatenate(([first], between, [last])))[::side]
        points = self.section.image(q[:, 0], q[:, 1])
        return CurvePiece(self.branch.joint, self.branch.limit, q, points, 1, 0)


def _lies_on(points: Array, line: Array, near: float) -> bool:
    """Return whether points (k, 3) are on a polyline (m, 3)."""
    start, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    for point in points[:: max(1, len(points) // _LOOKED_AT)]:
        share = np.clip(((point - start) * along).sum(axis=1) / square, 0.0, 1.0)
        if np.linalg.norm(point - start - share[:, None] * along, axis=1).min() > near:
            return False
    return True
