"""The way of the joints while the tip follows one twist, laid node by node as far as needed.

It is parametrised by its length in joint space, each joint over its acceleration limit, for this
is smooth where the way of the tip ends: before a singularity joints turn by more and more for the
same way of the tip.  Each node is corrected until the tip is where the twist, held since the first
node, leads.  The way ends at the hard stop.  Beyond it leads only where the tip loses so little
meanwhile that it remains on its line, as when a wrist passes its singularity.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.servo.look_ahead import postures_on_way
from robomech_ros.servo.resolution import Heading, TwistResolver

__all__ = ["LinePath"]

Array = NDArray[np.float64]

_postures_on_way = direct(postures_on_way)
_ONE = np.ones(1)

# The most by which a joint moves from node to node (rad or m), far from and near a singularity.
_STEP, _SHORT_STEP = 0.04, 0.01
# Corrections smaller than this (rad or m) leave the square of it.
_CONVERGED = 3e-5
_CORRECTIONS = 6
# Of a step at the end of the way, the shortest (part of a step).
_SHORTEST = 1e-3
# How near to the hard stop the way ends, as part of its condition number.
_NEAR = 0.98
# The cosine between two directions that follow each other at least has.
_STRAIGHT = 0.9
# What the tip may lose beyond the hard stop: m across its line, and rad of a twist that turns it
# or does not.
_LOST_WAY, _LOST_TURN, _TURNED = 8e-4, 0.1, 5e-3
# Nodes that the way beyond the hard stop has at most.  Its steps are shortened, from the short
# step above to this (rad or m), where it bends by more than the first cosine, and lengthened where
# it bends by less than the second.
_BEYOND, _SHORTEST_STEP, _BENT, _EVEN = 80, 1e-3, 0.97, 0.995
# So many nodes are kept behind.
_KEPT = 64


class _Node:
    """A posture on the way, its direction there, and where the tip should be."""

    def __init__(self, place: float, q: Array, heading: Heading, weights: Array) -> None:
        self.place, self.q, self.heading = place, q, heading
        self.rate = _norm(heading.rates * weights)
        self.direction: Array = heading.rates / max(self.rate, 1e-300)


class LinePath:
    """The way of n joints for a twist that is held.

    Parameters
    ----------
    resolver : TwistResolver
        Of the chain.
    weights : ndarray, shape (n,)
        By which joints count for the length of the way (s^2/rad or s^2/m).
    q : ndarray, shape (n,)
        Where it begins (rad or m), nearer to a regular posture than the hard stop.
    twist : callable
        Gives the twist for q in base axes, angular first (rad/s and m/s).

    Attributes
    ----------
    ended : bool
        Whether it leads no farther than it has been laid.
    singular : bool
        Whether it ends before a singularity.
    """

    def __init__(
        self,
        resolver: TwistResolver,
        weights: Array,
        q: Array,
        twist: Callable[[Array], Array],
    ) -> None:
        self._resolver, self._weights, self.twist = resolver, weights, twist
        heading = resolver.heading(q, twist(q))
        self._nodes = [_Node(0.0, q, heading, weights)]
        self._pose = heading.pose
        self._lost = np.zeros(6)
        self._bend = np.zeros_like(q)
        self._tables: tuple[Array, Array, Array, Array] | None = None
        usable = heading.possible and heading.condition < resolver.stop_at
        self.ended = not usable or self._nodes[0].rate == 0.0
        self.singular = False

    @property
    def hopeless(self) -> bool:
        """Whether it leads nowhere at all, for a reason other than a singularity ahead."""
        return self.ended and len(self._nodes) == 1

    def reach(self, place: float) -> bool:
        """Lay it as far as a place; False where it ends before."""
        while self._nodes[-1].place < place and not self.ended:
            self._lay()
        return self._nodes[-1].place >= place

    def forget_before(self, place: float) -> None:
        """Keep no more than some nodes behind a place."""
        behind = sum(node.place < place for node in self._nodes[:-2])
        if behind > 2 * _KEPT:
            del self._nodes[: behind - _KEPT]
            self._tables = None

    def at(self, places: Array, rates: Array) -> tuple[Array, Array]:
        """Give postures at places (k,), which do not decrease, and velocities.

        Both have the shape (k, n); rates (k,) are those with which the places change (1/s).
        """
        nodes, postures, slopes, _ = self._table()
        q, v = np.empty((2, len(places), postures.shape[1]))
        _postures_on_way(nodes, postures, slopes, places, rates, q, v)
        return q, v

    def slope(self, place: float) -> Array:
        """Give by how much the joints turn there by place."""
        slope: Array = self.at(np.array([place]), _ONE)[1][0]
        return slope

    def rate(self, place: float) -> float:
        """Give how fast the place changes with the whole twist (1/s)."""
        at, _, _, rates = self._table()
        return float(np.interp(place, at, rates))

    def _table(self) -> tuple[Array, Array, Array, Array]:
        if self._tables is None:
            nodes = self._nodes
            self._tables = (
                np.array([node.place for node in nodes]),
                np.array([node.q for node in nodes]),
                np.array([node.direction for node in nodes]),
                np.array([node.rate for node in nodes]),
            )
        return self._tables

    def _lay(self) -> None:
        """Add a node, or end the way."""
        last = self._nodes[-1]
        near = last.heading.condition > self._resolver.slow_from
        step = (_SHORT_STEP if near else _STEP) / float(np.abs(last.direction).max())
        shortest = _SHORTEST * step
        low, found = 0.0, self._stepped(step)
        if found is not None and found[0].heading.condition < self._resolver.stop_at:
            self._add(*found)
            return
        high, best = step, None
        while high - low > shortest:
            middle = 0.5 * (low + high)
            found = self._stepped(middle)
            if found is None or found[0].heading.condition >= self._resolver.stop_at:
                high = middle
                continue
            low, best = middle, found
            if found[0].heading.condition > _NEAR * self._resolver.stop_at:
                break
        if best is not None:
            self._add(*best)
        if not self._passed():
            self.ended = True
            self.singular = self._nodes[-1].heading.condition > self._resolver.slow_from

    def _add(self, node: _Node, pose: Array) -> None:
        last = self._nodes[-1]
        self._bend = (node.direction - last.direction) / (node.place - last.place)
        self._nodes.append(node)
        self._pose, self._tables = pose, None

    def _stepped(self, step: float) -> tuple[_Node, Array] | None:
        """Find the node so much farther on, and the pose of the tip; None if there is none."""
        last, weights = self._nodes[-1], self._weights**2
        along = weights * last.direction
        time = step / last.rate
        q = last.q + step * (last.direction + 0.5 * step * self._bend)
        held = self.twist(last.q)
        for _ in range(_CORRECTIONS):
            twist = self.twist(q)
            heading = self._resolver.heading(q, twist)
            if not heading.possible or float(along @ heading.rates) <= 0.0:
                return None
            pose = _moved(self._pose, 0.5 * time * (held + twist))
            change = heading.gain @ _error(pose, heading.pose)
            more = -float(along @ change) / float(along @ heading.rates)
            change = change + more * heading.rates
            time += more
            q = q + change
            if np.abs(change).max() < _CONVERGED:
                break
        else:
            return None
        length = _norm((q - last.q) * self._weights)
        node = _Node(0.0, q, heading, self._weights)
        turn = (node.direction - last.direction) * self._weights
        if time <= 0.0 or float(along @ node.direction) < _STRAIGHT:
            return None
        node.place = last.place + length * (1.0 + float(turn @ turn) / 24.0)
        return node, _moved(self._pose, 0.5 * time * (held + twist))

    def _passed(self) -> bool:
        """Lay the way through a singularity, if the tip loses next to nothing there."""
        kept = len(self._nodes), self._pose, self._lost.copy(), self._bend
        step = _SHORT_STEP
        for _ in range(_BEYOND):
            bend = self._step_beyond(step)
            if not self._on_its_line() or (bend < _BENT and step < _SHORTEST_STEP):
                break
            if bend < _BENT:
                step *= 0.5
            elif self._nodes[-1].heading.condition < _NEAR * self._resolver.stop_at:
                return True
            elif bend > _EVEN:
                step = min(2.0 * step, _SHORT_STEP)
        del self._nodes[kept[0] :]
        _, self._pose, self._lost, self._bend = kept
        self._tables = None
        return False

    def _on_its_line(self) -> bool:
        turns = self.twist(self._nodes[-1].q)[:3].any()
        most = _LOST_TURN if turns else _TURNED
        return _norm(self._lost[3:]) <= _LOST_WAY and _norm(self._lost[:3]) <= most

    def _step_beyond(self, step: float) -> float:
        """Add a node where what is about to be lost lags behind, by a step of a joint (rad or m).

        Returns the cosine between the directions before and after it; 0 where it bends too much,
        and nothing was added.
        """
        last = self._nodes[-1]
        step /= float(np.abs(last.direction).max())
        half = last.q + 0.5 * step * last.direction
        twist = self.twist(half)
        middle = _Node(0.0, half, self._resolver.heading(half, twist), self._weights)
        q = last.q + step * middle.direction
        node = _Node(last.place + step, q, self._resolver.heading(q, self.twist(q)), self._weights)
        straight = float((self._weights**2 * last.direction) @ node.direction)
        if straight < _BENT or not node.heading.possible or not middle.rate:
            return 0.0
        lost = _error(_moved(self._pose, step / middle.rate * twist), node.heading.pose)
        line = twist[3:]
        speed = float(line @ line)
        if speed > 0.0:
            # What lags behind on the line is on the line.
            lost[3:] -= float(lost[3:] @ line) / speed * line
        self._lost = self._lost + lost
        self._add(node, node.heading.pose)
        return straight


def _norm(vector: Array) -> float:
    return math.sqrt(float(vector @ vector))


def _moved(pose: Array, motion: Array) -> Array:
    """Turn a pose (4, 4) about its origin, and shift it: angular first, in base axes."""
    moved = pose.copy()
    x, y, z, *shift = motion.tolist()
    angle = math.sqrt(x * x + y * y + z * z)
    if angle > 0.0:
        cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
        half = math.sin(0.5 * angle) / angle
        R = math.sin(angle) / angle * cross + 2.0 * half * half * cross @ cross
        moved[:3, :3] += R @ pose[:3, :3]
    moved[:3, 3] += shift
    return moved


def _error(target: Array, pose: Array) -> Array:
    """Give the small motion from a pose to another, angular first, in base axes."""
    R = target[:3, :3] @ pose[:3, :3].T
    turn = 0.5 * (R[2, 1] - R[1, 2]), 0.5 * (R[0, 2] - R[2, 0]), 0.5 * (R[1, 0] - R[0, 1])
    return np.array((*turn, *(target[:3, 3] - pose[:3, 3])))
