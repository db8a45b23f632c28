"""Lays the way of the joints for a twist that is held, node by node and posture by posture.

Each node is corrected until the tip is where the twist, held since the first node, leads.  The way
ends at the hard stop, the condition number ``stop_at``.  It goes on beyond only if the tip loses so
little there that it remains on its line, as when a wrist passes its singularity.

A way that begins beyond the hard stop leads out, or along the singularity: the twist is carried out
wholly, whatever rates that takes.
"""

import math
from collections.abc import Callable, Generator, Iterator

import numpy as np

from robomech_ros.servo.poses import moved_pose, norm
from robomech_ros.servo.singularity_exits import Start
from robomech_ros.servo.twist_resolver import Heading, TwistResolver
from robomech_ros.typing import Array

# The most by which a joint moves from node to node (rad or m), far from and near a singularity.
_STEP, _SHORT_STEP = 0.04, 0.01
# By how much it turns from node to node (rad), where the shorter step allows that.
_TURN = 0.1
# Corrections smaller than this (rad or m) leave the square of it.
_CONVERGED = 3e-5
_CORRECTIONS = 6
# Of a step at the end of the way, the shortest (part of a step); where a way out does not begin
# with half a step, it is none.
_SHORTEST, _SHORTEST_OF_FIRST = 1e-3, 0.5
# How near to the hard stop the way ends, as part of its condition number.
_NEAR = 0.98
# The cosine between two directions that follow each other at least has.
_STRAIGHT = 0.9
# Allowed loss of the tip beyond the hard stop: m across its line, and rad of a twist that turns it
# or does not.
_LOST_WAY, _LOST_TURN, _TURNED = 8e-4, 0.1, 5e-3
# Nodes that the way beyond the hard stop has at most.  Its steps are shortened, from the short
# step above to this (rad or m), where it bends by more than the first cosine, and lengthened where
# it bends by less than the second.
_BEYOND, _SHORTEST_STEP, _BENT, _EVEN = 80, 1e-3, 0.97, 0.995
# By what part the condition number may rise on the way out, and from which on it may be any.
_RISE, _DEEP = 0.02, 2e3
# Tolerance of the tip on a path out (m, rad).
_OFF, _OFF_TURNED = 1e-5, 5e-5


class Node:
    """A posture on the way, its direction there, and where the tip should be."""

    def __init__(self, place: float, q: Array, heading: Heading, weights: Array) -> None:
        self.place, self.q, self.heading = place, q, heading
        self.rate = norm(heading.rates * weights)
        self.direction: Array = heading.rates / max(self.rate, 1e-300)


# Result of laying a node, with a yield for each examined posture.
_Found = Generator[None, None, "tuple[Node, Array] | None"]


class LineLaying:
    """The nodes of the way of n joints from a start, for a twist that is held.

    By the weights (n,) joints count for the length of the way (s^2/rad or s^2/m). ``twist`` gives
    the twist for q in base axes, angular first (rad/s and m/s). It has ``ended`` if it leads no
    farther than it has been laid, and is ``singular`` if it ends before a singularity, or leads
    nowhere from one.
    """

    def __init__(
        self, resolver: TwistResolver, weights: Array, start: Start, twist: Callable[[Array], Array]
    ) -> None:
        q, self._outwards = start
        self._resolver, self.weights, self.twist = resolver, weights, twist
        heading = resolver.heading(q, twist(q))
        # The condition number that no further node may reach.
        self._bound = self._bound_after(heading.condition)
        if self.leaving:
            heading = self._resolver.heading(q, twist(q), True)
        self.nodes = [Node(0.0, q, heading, weights)]
        self._pose = heading.pose
        self._lost = np.zeros(6)
        self._bend = np.zeros_like(q)
        self.ended = not heading.possible or self.nodes[0].rate == 0.0
        self.singular = False

    @property
    def leaving(self) -> bool:
        """True if the last node is beyond the hard stop, and the way began there."""
        return self._bound > self._resolver.stop_at

    def lay(self) -> Iterator[None]:
        """Lay nodes until the way ends; comes back before each posture that is examined."""
        while not self.ended:
            yield from self._lay_node()

    def _bound_after(self, condition: float) -> float:
        stop_at = self._resolver.stop_at
        if condition < stop_at:
            return stop_at
        return math.inf if condition > _DEEP else (1.0 + _RISE) * condition

    def _allows(self, node: Node) -> bool:
        if self._begins_outwards():
            return node.heading.condition < self.nodes[0].heading.condition
        return node.heading.condition < self._bound or self._bound == math.inf

    def _begins_outwards(self) -> bool:
        """Return whether the next node must lead away from a singularity."""
        return self._outwards and self.leaving and len(self.nodes) == 1

    def _lay_node(self) -> Iterator[None]:
        """Add a node, or end the way."""
        last = self.nodes[-1]
        near = last.heading.condition > self._resolver.slow_from
        largest, bend = float(np.abs(last.direction).max()), norm(self._bend * self.weights)
        step = (_SHORT_STEP if near else _STEP) / largest
        # In bends, nodes are nearer to each other.
        step = min(step, max(_SHORT_STEP / largest, _TURN / max(bend, 1e-300)))
        shortest = (_SHORTEST_OF_FIRST if self._begins_outwards() else _SHORTEST) * step
        low, found = 0.0, (yield from self._stepped(step))
        if found is not None and self._allows(found[0]):
            self._add(*found)
            return
        high, best = step, None
        while high - low > shortest:
            middle = 0.5 * (low + high)
            found = yield from self._stepped(middle)
            if found is None or not self._allows(found[0]):
                high = middle
                continue
            if self.leaving:
                # It bends here.
                self._add(*found)
                return
            low, best = middle, found
            if found[0].heading.condition > _NEAR * self._bound:
                break
        if best is not None:
            self._add(*best)
        if self.leaving or not (yield from self._passed()):
            self.ended = True
            self.singular = self.nodes[-1].heading.condition > self._resolver.slow_from

    def _add(self, node: Node, pose: Array) -> None:
        last = self.nodes[-1]
        self._bend = (node.direction - last.direction) / (node.place - last.place)
        self.nodes.append(node)
        if self._resolver.partial:
            # Free components stay where the joints have moved them.
            here = node.heading.pose
            pose = moved_pose(here, self._resolver.off(pose, here))
        self._pose = pose
        self._bound = min(self._bound, self._bound_after(node.heading.condition))

    def _stepped(self, step: float) -> _Found:
        """Find the node so much farther on, and the pose of the tip; None if there is none."""
        last, weights = self.nodes[-1], self.weights**2
        along = weights * last.direction
        time = step / last.rate
        q = last.q + step * (last.direction + 0.5 * step * self._bend)
        held = self.twist(last.q)
        for _ in range(_CORRECTIONS):
            yield
            twist = self.twist(q)
            heading = self._resolver.heading(q, twist, self.leaving)
            if not heading.possible or float(along @ heading.rates) <= 0.0:
                return None
            pose = moved_pose(self._pose, 0.5 * time * (held + twist))
            change = heading.gain @ self._resolver.off(pose, heading.pose)
            more = -float(along @ change) / float(along @ heading.rates)
            change = change + more * heading.rates
            if len(heading.null):
                # Motions without effect on the tip follow from the directions alone.
                off = last.q + self._run(step, heading.rates) - q
                change = change + (heading.null @ off) @ heading.null
            time += more
            q = q + change
            if np.abs(change).max() < _CONVERGED:
                break
        else:
            return None
        pose = moved_pose(self._pose, 0.5 * time * (held + twist))
        if self.leaving:
            yield
            heading = self._resolver.heading(q, twist, self.leaving)
            off = self._resolver.off(pose, heading.pose)
            if norm(off[3:]) > _OFF or norm(off[:3]) > _OFF_TURNED:
                return None
        length = norm((q - last.q) * self.weights)
        node = Node(0.0, q, heading, self.weights)
        turn = (node.direction - last.direction) * self.weights
        if time <= 0.0 or float(along @ node.direction) < _STRAIGHT:
            return None
        node.place = last.place + length * (1.0 + float(turn @ turn) / 24.0)
        return node, pose

    def _run(self, step: float, rates: Array) -> Array:
        """Return by how much joints move on a step to where they have rates, as the way bends."""
        last = self.nodes[-1]
        bend = (rates / max(norm(rates * self.weights), 1e-300) - last.direction) / step
        change = np.zeros_like(bend)
        if len(self.nodes) > 1:
            change = (bend - self._bend) / (step + last.place - self.nodes[-2].place)
        return step * (last.direction + step * (0.5 * bend - step / 6.0 * change))

    def _passed(self) -> Generator[None, None, bool]:
        """Lay the way through a singularity, if the tip loses next to nothing there."""
        laid, pose, lost = [self.nodes[-1]], self._pose, self._lost
        step = _SHORT_STEP
        for _ in range(_BEYOND):
            found = yield from self._step_beyond(laid[-1], pose, step)
            bend = 0.0
            if found is not None:
                node, more, bend = found
                laid.append(node)
                pose, lost = node.heading.pose, lost + more
            most = _LOST_TURN if self.twist(laid[-1].q)[:3].any() else _TURNED
            on_line = norm(lost[3:]) <= _LOST_WAY and norm(lost[:3]) <= most
            if not on_line or (bend < _BENT and step < _SHORTEST_STEP):
                return False
            if bend < _BENT:
                step *= 0.5
            elif laid[-1].heading.condition < _NEAR * self._resolver.stop_at:
                for node in laid[1:]:
                    self._add(node, node.heading.pose)
                self._lost = lost
                return True
            elif bend > _EVEN:
                step = min(2.0 * step, _SHORT_STEP)
        return False

    def _step_beyond(
        self, last: Node, pose: Array, step: float
    ) -> Generator[None, None, tuple[Node, Array, float] | None]:
        """Find a node where what is about to be lost lags behind, by a step of a joint (rad or m).

        Returns it, what was lost, and the cosine between the directions before and after it; None
        where it bends too much.
        """
        step /= float(np.abs(last.direction).max())
        half = last.q + 0.5 * step * last.direction
        twist = self.twist(half)
        yield
        middle = Node(0.0, half, self._resolver.heading(half, twist, self.leaving), self.weights)
        q = last.q + step * middle.direction
        yield
        heading = self._resolver.heading(q, self.twist(q), self.leaving)
        node = Node(last.place + step, q, heading, self.weights)
        straight = float((self.weights**2 * last.direction) @ node.direction)
        if straight < _BENT or not node.heading.possible or not middle.rate:
            return None
        lost = self._resolver.off(moved_pose(pose, step / middle.rate * twist), node.heading.pose)
        line = twist[3:]
        speed = float(line @ line)
        if speed > 0.0:
            # A lag along the line is no deviation.
            lost[3:] -= float(lost[3:] @ line) / speed * line
        return node, lost, straight
