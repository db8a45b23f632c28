"""Twists that bring the tip to a pose on a straight line, and leave it at rest there."""

import math

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.servo.commands import PoseCommand, TwistCommand
from robomech_ros.servo.twist_resolver import TwistResolver
from robomech_ros.typing import Array

# Nearer than this (m or rad) the tip is there.
_THERE = 1e-6
# The line is laid anew where the tip is farther from it than this (m or rad).
_BESIDE = 5e-5
# Used fraction of the deceleration of a plan to stop; the end is reached with this time
# constant (s).
_PART, _CREEP = 0.5, 0.1
# Slower than this part of the full speed the plan to stop says nothing about decelerations.
_SLOW = 0.02


class PoseApproach:
    """Turns a target pose into twists, one for each period.

    Position and orientation arrive together: the tip's origin on a straight line, while the tip
    turns about a fixed axis. What the resolver leaves free of the pose is not waited for.
    """

    def __init__(self, resolver: TwistResolver) -> None:
        self._resolver = resolver
        self._target: Array | None = None
        # The twist of full speed along the line (angular first), and what plans to stop take (1/s).
        self._full: Array = np.zeros(6)
        self._deceleration = math.inf

    def twist(self, command: PoseCommand, now: Array, then: Array, stop: Array) -> TwistCommand:
        """Return the twist of this period.

        The joints are at the latest knot ``now`` (n,), one second later at their present speed
        ``then`` (n,), and at ``stop`` (n,) where the plan to stop ends (rad or m).
        """
        left = self._left(command.target, now)
        left_at_stop = self._left(command.target, stop)
        if not self._on_line(command, left):
            self._lay(command, left)
        square = float(self._full @ self._full)
        if not square:
            return TwistCommand(self._full, lambda q: None, command.until)
        # How long the rest takes at full speed (s).
        rest, rest_at_stop = (float(part @ self._full) / square for part in (left, left_at_stop))
        pace = rest - float(self._left(command.target, then) @ self._full) / square
        if pace > _SLOW and rest - rest_at_stop > 0.0:
            self._deceleration = pace * pace / (2.0 * (rest - rest_at_stop))
        share = min(1.0, abs(rest) / _CREEP)
        share = min(share, math.sqrt(2.0 * _PART * self._deceleration * abs(rest)))
        if np.abs(left).max() <= _THERE:
            share = 0.0
        return TwistCommand(math.copysign(share, rest) * self._full, lambda q: None, command.until)

    def _left(self, target: Array, q: Array) -> Array:
        """Return the rotation and the way to a pose (rad and m, in base axes)."""
        T = forward_kinematics(self._resolver.chain, q)
        way = np.concatenate((np.zeros(3), target[:3, 3] - T[:3, 3]))
        return np.concatenate(
            (self._resolver.turn_left(target, T), self._resolver.held(way, target)[3:])
        )

    def _on_line(self, command: PoseCommand, left: Array) -> bool:
        if self._target is None or not np.array_equal(self._target, command.target):
            return False
        square = float(self._full @ self._full)
        beside = left - float(left @ self._full) / square * self._full if square else left
        return float(np.abs(beside).max()) <= _BESIDE

    def _lay(self, command: PoseCommand, left: Array) -> None:
        turn, way = float(np.linalg.norm(left[:3])), float(np.linalg.norm(left[3:]))
        time = max(turn / command.angular_speed, way / command.linear_speed)
        self._full = left / time if max(turn, way) > _THERE else np.zeros(6)
        self._target, self._deceleration = command.target, math.inf
