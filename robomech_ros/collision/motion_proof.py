"""Proof that a motion is free of contact, between its samples too.

While the joints of a chain turn by some angles, no point of a body moves farther than those angles
times its distances from the axes.  A body is free on a part of a motion if in the middle of the
part it is farther from all others than it can move on half of it; else the part is halved.

References
----------
F. Schwarzer, M. Saha, J.-C. Latombe, "Adaptive dynamic collision checking for single and multiple
articulated robots in complex environments", IEEE Trans. Robotics 21, 2005.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from robomech_ros._kernels.collision.bounds import UNCERTAIN
from robomech_ros._kernels.collision.motions import (
    CONTACT,
    DEEPEST,
    FREE,
    OpenParts,
    group_part,
    sweep,
)
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.collision.distances import Distances, room_for_pairs, rotations_and_origins
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import as_finite_values
from robomech_ros.robots.chain import SerialChain
from robomech_ros.trajectory.curves.bounds import hull
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

_sweep, _group_part = direct(sweep), direct(group_part)
# Travel (m) below which hulls decide what spheres do not, and travel below which coal does.
_STEP, _FINE = 0.03, 1e-4
# Travel of bodies (m) between the sampled postures of a motion before its proof.
_LOOK = 0.03
# Travel (m) below which a part is not halved any more, and one that locates a contact well enough.
RESOLUTION = 1e-5
_FIRST = 1e-4
# Shortest part of a piece for the search of a first contact.
_SHORTEST = 1e-6
# Number of open parts that one sweep may leave to coal.
_PLACES = 4096
# Number of unproved parts after which the search for a contact ends.
_MOST_UNPROVED = 100


class MotionCheck(NamedTuple):
    """Result of the check of a motion.

    Attributes
    ----------
    free : bool
        No contact was found.
    certified : bool
        It is proved that there is none.
    parameter : float
        The first contact, or the first place without a proof.  It is an index of waypoints with
        a fraction, the coordinate of a path (m), or the time of a trajectory (s).  NaN if
        certified.
    bodies : tuple of str
        The two bodies there.
    least : float
        The least distance computed during the proof (m).  It does not exceed the distances at
        both ends of each piece.
    """

    free: bool
    certified: bool
    parameter: float
    bodies: tuple[str, str]
    least: float


class Obstruction(NamedTuple):
    """A place on a curve, from 0 to 1, where a pair is in contact or cannot be proved apart."""

    at: float
    pair: int
    contact: bool


class _Middle(NamedTuple):
    """Result of the distances in the middle of a part of a motion.

    A pair in contact, or -1; pairs that may be before or after the middle; how far these (or that)
    can move on half the part (m); and on what share of the half all are surely apart.
    """

    contact: int
    unclear: list[int]
    travel: float
    share: float


def _preferred(one: Obstruction | None, other: Obstruction | None) -> Obstruction | None:
    """Return the contact of two obstructions, or the earlier one."""
    found = [each for each in (one, other) if each is not None]
    return min(found, key=lambda each: (not each.contact, each.at), default=None)


class MotionProof:
    """Proves pieces of motions.

    Parameters
    ----------
    distances : Distances
    clearance : float
        Distance that bodies must exceed (m).
    """

    def __init__(self, distances: Distances, clearance: float) -> None:
        self._distances = distances
        self._clearance = clearance
        self.least = math.inf
        self._tables = distances.tables
        count = len(self._tables.pairs)
        self._all = np.arange(count)
        self._limits = np.array([clearance, _STEP, _FINE, 0.0])
        self._found = np.zeros(4)
        # One part may leave all pairs open.
        places = max(_PLACES, count)
        self._open = OpenParts(np.zeros((places, 2)), np.zeros(places, dtype=np.int64))
        self._unproved = 0
        self._lists = np.zeros((DEEPEST + 2, count), dtype=np.int64)
        self._travel, self._near = np.zeros(count), room_for_pairs(count)
        self._turns, self._origins = rotations_and_origins(self._near)

    def obstruction(self, curve: Array, *, first: bool = True) -> Obstruction | None:
        """Find a place where a curve of Bernstein coefficients (d + 1, n) is not free, or None.

        With ``first`` it is the first such place, to a tenth of a millimetre of travel.
        """
        if not len(self._all):
            return None
        begin, end = 0.0, 1.0
        best: Obstruction | None = None
        self._unproved = 0
        while True:
            part, span = _part(curve, begin, end), end - begin
            status = self._sweep(part)
            found = self._settled(part, int(self._found[0]), first)
            if found is not None:
                best = _preferred(best, found._replace(at=begin + span * found.at))
                if found.contact or not first:
                    return best
            at, proved = float(self._found[1]), float(self._found[3])
            if status == CONTACT:
                self.least = min(self.least, self._clearance)
                contact = Obstruction(begin + span * at, int(self._found[2]), True)
                best = _preferred(best, contact)
                if not first or span * (at - proved) <= _SHORTEST:
                    return best
                # Spheres overlap in the middle of a part whose first half is not proved yet.
                begin, end = begin + span * proved, contact.at
            elif status == FREE or self._unproved >= _MOST_UNPROVED:
                return best
            else:
                begin += span * at

    def seems_free(self, curve: Array) -> bool:
        """Return whether a curve is free at its sampled postures, without a proof in between."""
        if not len(self._all):
            return True
        self._limits[2:] = _LOOK, 1.0
        status = self._sweep(curve)
        self._limits[2:] = _FINE, 0.0
        if status == FREE and not self._found[0]:
            return True
        return status == FREE and self.obstruction(curve, first=False) is None

    def _sweep(self, curve: Array) -> int:
        status: int = _sweep(
            self._tables, self._all, curve, self._limits, self._lists, self._found, self._open
        )
        return status

    def _settled(self, curve: Array, count: int, first: bool) -> Obstruction | None:
        """Prove in their order the parts that spheres have left open, or find an obstruction."""
        best: Obstruction | None = None
        for k in range(count):
            begin, end = self._open.ends[k].tolist()
            if best is not None and (begin >= best.at if best.contact else not first):
                break
            if self._unproved >= _MOST_UNPROVED:
                break
            best = _preferred(best, self._look(curve, begin, end, int(self._open.groups[k]), first))
        return best

    def _look(
        self, curve: Array, begin: float, end: float, group: int, first: bool
    ) -> Obstruction | None:
        """Prove a part for a group by distances in the middle of ever smaller parts."""
        best: Obstruction | None = None
        ends = self._distances.groups[group : group + 2]
        waiting = [(begin, end, self._all[ends[0] : ends[1]])]
        straight = len(curve) == 2
        part = np.empty(2)
        while waiting and self._unproved < _MOST_UNPROVED:
            low, high, tested = waiting.pop()
            part[0], part[1] = low, high
            if best is not None and best.contact and low >= best.at:
                continue
            count = _group_part(
                self._tables, tested, curve, part, self._clearance, self._travel, self._near
            )
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            found = self._middle(count)
            if found.contact >= 0:
                best = _preferred(best, Obstruction(middle, found.contact, True))
                if first and found.travel >= _FIRST:
                    waiting.append((low, middle, tested))
            elif found.unclear and found.travel >= RESOLUTION:
                # On a straight motion the proof extends equally far to both sides.
                proved = half * found.share if straight else 0.0
                left = np.array(found.unclear)
                waiting += [(middle + proved, high, left), (low, middle - proved, left)]
            elif found.unclear:
                self._unproved += 1
                best = _preferred(best, Obstruction(middle, found.unclear[0], False))
            if best is not None and not first:
                break
        return best

    def _middle(self, count: int) -> _Middle:
        """Compute the distances of the pairs that `group_part` has found."""
        distances, unclear, largest, share = self._distances, list[int](), 0.0, 1.0
        for k in range(count):
            pair, travel = int(self._near.pairs[k]), float(self._travel[k])
            needed = travel + self._clearance + UNCERTAIN
            if self._near.low[k] - distances.padding[pair] > needed:
                continue
            place = self._turns, self._origins, 2 * k
            distance = distances.of_hulls(pair, *place)
            contact = distance <= self._clearance
            if distance <= needed and distances.has_surfaces(pair):
                if not distances.surfaces_within(pair, needed, *place):
                    self.least = min(self.least, needed)
                    continue
                contact = distances.surfaces_within(pair, self._clearance, *place)
                distance = self._clearance
            self.least = min(self.least, distance)
            if contact:
                return _Middle(pair, [], travel, 0.0)
            if distance <= needed:
                unclear.append(pair)
                largest = max(largest, travel)
                if travel > 0.0:
                    share = min(share, (distance - self._clearance - UNCERTAIN) / travel)
        return _Middle(-1, unclear, largest, max(share, 0.0))


def check_motion(
    chain: SerialChain, distances: Distances, motion: Any, clearance: float
) -> MotionCheck:
    """Prove a motion; see `PlanningScene.check_motion`."""
    proof = MotionProof(distances, clearance)
    breaks, curves = _pieces(chain, motion)
    largest = np.abs(curves).max(axis=(0, 1))
    # Longer motions would need more halvings than there is room for.
    for i in np.flatnonzero(largest > chain.largest):
        expected = f"at most {chain.largest[i]:g} {chain.units[i]}"
        raise BadValueError(f"motion of joint '{chain.joint_names[i]}'", largest[i], expected)
    ends = curves[:, :1].reshape(-1, chain.n), curves[-1, -1:]
    for q in np.concatenate(ends):
        proof.least = min(proof.least, distances.nearest(q).distance)
    for k, curve in enumerate(curves):
        found = proof.obstruction(np.ascontiguousarray(curve))
        if found is not None:
            parameter = float(breaks[k] + found.at * (breaks[k + 1] - breaks[k]))
            names = distances.names(found.pair)
            return MotionCheck(not found.contact, False, parameter, names, proof.least)
    return MotionCheck(True, True, math.nan, ("", ""), proof.least)


def _pieces(chain: SerialChain, motion: Any) -> tuple[Array, Array]:
    """Return breaks (s + 1,) and Bernstein coefficients (s, d + 1, n) of a motion."""
    for name in ("pieces", "curve"):
        motion = getattr(motion, name, motion)
    if isinstance(motion, PiecewisePolynomial):
        if motion.joints != chain.n:
            raise BadValueError("joints of the motion", motion.joints, f"{chain.n}")
        breaks = motion.breaks
        if len(breaks) == 1:
            breaks = np.array([breaks[0], breaks[0]])
        return breaks, np.ascontiguousarray(hull(motion, 0).transpose(1, 0, 2))
    if hasattr(motion, "sample"):
        expected = "waypoints (m, n), or a path or trajectory of this library, with .pieces"
        raise BadValueError("motion", motion, expected)
    points = as_finite_values(chain, motion, "motion")
    if points.ndim != 2 or not len(points):
        raise BadValueError("motion", points.shape, f"waypoints (m, {chain.n})")
    if len(points) == 1:
        points = np.concatenate([points, points])
    return np.arange(float(len(points))), np.stack([points[:-1], points[1:]], axis=1)


def _part(curve: Array, begin: float, end: float) -> Array:
    """Return a part of a curve (d + 1, n) of Bernstein type."""
    if begin == 0.0 and end == 1.0:
        return curve
    part = curve.copy()
    for first in range(1, len(part)):
        part[first:] += (1.0 - end) * (part[first - 1 : -1] - part[first:])
    for last in range(len(part) - 1, 0, -1):
        part[:last] += (begin / end) * (part[1 : last + 1] - part[:last])
    return part
