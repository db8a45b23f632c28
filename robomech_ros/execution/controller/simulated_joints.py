"""Simulated joints, which follow exactly, with a lag, or by forces; with simulated faults."""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robomech_ros.execution.joints import State, at_rest
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array, BoolArray

# Rounding of sums of cycles, s.
_ROUNDING = 1e-9
# Positions that differ by less (rad or m) are the same.
_SAME = 1e-12


@dataclass(frozen=True, eq=False)
class Faults:
    """Faults of n joints: which are stuck, and what the sensors show too much (n,), rad or m.

    Commands reach the joints after a delay (s). A part of them, 0 to 1, is dropped; a joint then
    keeps the one before. The noise is the standard deviation of the positions that the sensors show
    (rad or m); the seed is that of the noise, and of which commands get lost.
    """

    stuck: BoolArray
    offset: Array
    delay: float = 0.0
    dropped: float = 0.0
    noise: float = 0.0
    seed: int = 0

    @property
    def none(self) -> bool:
        """True if nothing is wrong."""
        wrong = self.stuck.any() or self.offset.any()
        return not (wrong or self.delay or self.dropped or self.noise)


@dataclass(frozen=True, eq=False)
class DrivenMotion:
    """Motion of joints under applied forces, with the efforts of their drives (N m or N).

    ``at_limit`` (n,) is how much of the time each drive was at its limit (s).
    """

    state: State
    effort: Array
    at_limit: Array


class Plant(Protocol):
    """Joints that have mass, with the controller of their drives."""

    def drive(
        self, before: State, command: State, span: float, held: BoolArray | None
    ) -> DrivenMotion:
        """Advance by a time (s) above 0 during which the command changes to another.

        Something holds the joints ``held`` (n,) where they are. Raises RobomechError where the
        motion diverged; the joints stand at the last finite state.
        """

    def put(self, position: Array) -> DrivenMotion:
        """Place the joints at rest (rad or m), at once."""


class SimulatedJoints:
    """Moves n joints to where they should be.

    They follow with a time constant ``lag`` (s), 0 = exactly, or are moved by the forces of a
    plant. Joints that are late, after a fault or a step of the command, catch up within their
    limits of velocity. Sensors with faults show a motion within these limits, and within those of
    position. ``effort`` (n,) is what the drives exert (N m or N), None where no forces are
    simulated, and ``at_limit`` (n,) how long each drive has been at its limit since `count_anew`
    (s).
    """

    def __init__(
        self,
        position: Array,
        lag: float = 0.0,
        plant: Plant | None = None,
        limits: Limits | None = None,
    ) -> None:
        self._lag, self._plant = lag, plant
        self._limits = limits or Limits(tuple(map(str, range(len(position)))))
        self.at_limit = np.zeros(len(position))
        self.effort = None if plant is None else plant.put(position).effort
        self._faults: Faults | None = None
        self._random = np.random.default_rng()
        self._time = 0.0
        self._under_way: deque[tuple[float, State]] = deque()
        self._state = self._command = at_rest(position)
        # Last sensor reading, whether it is wrong, and whether the joints are late.
        self._shown, self._astray, self._late = self._state.position, False, False

    @property
    def position(self) -> Array:
        """True joint positions (rad or m), shape (n,)."""
        return self._state.position

    def inject(self, faults: Faults) -> None:
        """Set the simulated faults in place of the previous ones."""
        self._faults = None if faults.none else faults
        self._random = np.random.default_rng(faults.seed)

    def follow(self, desired: State, span: float) -> State:
        """Advance by a time (s) to a commanded state; return the sensor values."""
        wrong = self._faults is not None or self._astray or self._late
        if self._plant is None and not (self._lag or wrong):
            self._state = self._command = desired
            self._shown = desired.position
            return desired
        if span > 0.0:
            before = self._command
            command = self._delivered(desired, span)
            if self._plant is None:
                self._move(command, span)
            else:
                self._drive(self._plant, before, command, span)
        self._late = _apart(desired.position, self._state.position)
        return self._sensed(span)

    def put(self, position: Array, shown: Array | None = None) -> State:
        """Have the joints stand somewhere (rad or m), at once.

        Returns what the sensors show: this, or by default where the joints are.
        """
        self._under_way.clear()
        self._state = self._command = at_rest(position)
        self._late = False
        self.count_anew()
        if self._plant is not None:
            self.effort = self._plant.put(position).effort
        self._shown = position if shown is None else shown
        self._astray = _apart(self._shown, position)
        return self._sensed(0.0)

    def stand(self) -> State:
        """Tell the joints to stand where they are; returns what the sensors show.

        Joints with mass move on until their drives have stopped them, and come back.
        """
        self._under_way.clear()
        self._command = at_rest(self._state.position)
        if self._plant is None:
            self._state = self._command
        return self._sensed(0.0)

    def count_anew(self) -> None:
        """Forget how long drives were at their limits."""
        self.at_limit = np.zeros(len(self.at_limit))

    def saturation(self, names: Sequence[str]) -> str:
        """Name the drives (of joints of these names) that were at their limits; empty for none."""
        each = [
            f"joint '{name}' was at its effort limit for {time:.3g} s"
            for name, time in zip(names, self.at_limit.tolist(), strict=True)
            if time
        ]
        return ", ".join(each)

    def _drive(self, plant: Plant, before: State, command: State, span: float) -> None:
        held = None if self._faults is None else self._faults.stuck
        driven = plant.drive(before, command, span, held)
        self._state, self.effort = driven.state, driven.effort
        self.at_limit = self.at_limit + driven.at_limit

    def _delivered(self, desired: State, span: float) -> State:
        """Return the command that has got to the joints."""
        self._time += span
        faults = self._faults
        if faults is None:
            self._under_way.clear()
            self._command = desired
            return desired
        if not (faults.dropped and self._random.random() < faults.dropped):
            self._under_way.append((self._time, desired))
        due = self._time - faults.delay + _ROUNDING
        while self._under_way and self._under_way[0][0] <= due:
            self._command = self._under_way.popleft()[1]
        return self._command

    def _move(self, command: State, span: float) -> None:
        part = -math.expm1(-span / self._lag) if self._lag else 1.0
        most = self._limits.velocity * span
        change = np.clip(part * (command.position - self._state.position), -most, most)
        if self._faults is not None:
            change = np.where(self._faults.stuck, 0.0, change)
        velocity = change / span
        acceleration = (velocity - self._state.velocity) / span
        self._state = State(self._state.position + change, velocity, acceleration)

    def _sensed(self, span: float) -> State:
        """Return what the sensors show, so long (s) after they showed something last."""
        faults, state = self._faults, self._state
        shown = state.position
        if faults is not None:
            shown = shown + faults.offset
            if faults.noise:
                shown = shown + faults.noise * self._random.standard_normal(len(shown))
            lower = np.minimum(self._limits.lower, state.position)
            shown = np.clip(shown, lower, np.maximum(self._limits.upper, state.position))
        if faults is not None or self._astray:
            most = self._limits.velocity * span if span else 0.0
            shown = np.clip(shown, self._shown - most, self._shown + most)
            self._astray = _apart(shown, state.position)
        self._shown = shown
        return State(shown, state.velocity, state.acceleration)


def _apart(one: Array, other: Array) -> bool:
    return bool(np.max(np.abs(one - other)) > _SAME)
