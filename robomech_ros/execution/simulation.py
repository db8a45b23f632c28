"""Simulated joints, which follow exactly, or with a lag, or with the faults that are asked for."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robomech_ros.execution.joints import State
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["Faults", "JointSimulation", "at_rest"]

# What sums of cycles may be off, s.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Faults:
    """What is wrong with the joints.

    Attributes
    ----------
    stuck : ndarray of bool, shape (n,)
        Which joints do not move.
    delay : float
        How long commands take to get to the joints, s.
    dropped : float
        Part of the commands, 0 to 1, that get lost; a joint then keeps the one before.
    offset : ndarray, shape (n,)
        What the sensors show too much, rad or m.
    noise : float
        Standard deviation of the positions that the sensors show, rad or m.
    seed : int
        Of the noise, and of which commands get lost.
    """

    stuck: npt.NDArray[np.bool_]
    offset: FloatArray
    delay: float = 0.0
    dropped: float = 0.0
    noise: float = 0.0
    seed: int = 0

    @property
    def none(self) -> bool:
        """Whether nothing is wrong."""
        wrong = self.stuck.any() or self.offset.any()
        return not (wrong or self.delay or self.dropped or self.noise)


class JointSimulation:
    """Moves n joints to where they are wanted.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Where they are at first, rad or m.
    lag : float
        Time constant with which they follow, s; 0 = exactly.

    Attributes
    ----------
    position : ndarray, shape (n,)
        Where the joints really are, rad or m.
    """

    def __init__(self, position: FloatArray, lag: float = 0.0) -> None:
        self._lag = lag
        self._faults: Faults | None = None
        self._random = np.random.default_rng()
        self._time = 0.0
        self._under_way: deque[tuple[float, State]] = deque()
        self._state = self._command = at_rest(position)

    @property
    def position(self) -> FloatArray:
        """Where the joints really are, rad or m, shape (n,)."""
        return self._state.position

    def inject(self, faults: Faults) -> None:
        """Have these faults from now on, instead of those before."""
        self._faults = None if faults.none else faults
        self._random = np.random.default_rng(faults.seed)

    def follow(self, wanted: State, span: float) -> State:
        """Let time pass.

        Parameters
        ----------
        wanted : State
            What the joints are told at the end of that time.
        span : float
            How long, s.

        Returns
        -------
        State
            What the sensors show then.
        """
        if self._faults is None and not self._lag:
            self._state = self._command = wanted
            self._under_way.clear()
            return wanted
        if span > 0.0:
            self._move(self._delivered(wanted, span), span)
        return self._sensed()

    def put(self, position: FloatArray) -> State:
        """Have the joints stand somewhere (rad or m), at once; returns what the sensors show."""
        self._under_way.clear()
        self._state = self._command = at_rest(position)
        return self._sensed()

    def _delivered(self, wanted: State, span: float) -> State:
        """Give the command that has got to the joints."""
        self._time += span
        faults = self._faults
        if faults is None:
            self._command = wanted
        elif not (faults.dropped and self._random.random() < faults.dropped):
            self._under_way.append((self._time, wanted))
        due = self._time - (0.0 if faults is None else faults.delay) + _ROUNDING
        while self._under_way and self._under_way[0][0] <= due:
            self._command = self._under_way.popleft()[1]
        return self._command

    def _move(self, command: State, span: float) -> None:
        part = -math.expm1(-span / self._lag) if self._lag else 1.0
        change = part * (command.position - self._state.position)
        if self._faults is not None:
            change = np.where(self._faults.stuck, 0.0, change)
        velocity = change / span
        acceleration = (velocity - self._state.velocity) / span
        self._state = State(self._state.position + change, velocity, acceleration)

    def _sensed(self) -> State:
        faults, state = self._faults, self._state
        if faults is None:
            return state
        shown = state.position + faults.offset
        if faults.noise:
            shown = shown + faults.noise * self._random.standard_normal(len(shown))
        return State(shown, state.velocity, state.acceleration)


def at_rest(position: FloatArray) -> State:
    """Give the state of joints that stand somewhere (rad or m)."""
    still = np.zeros(len(position))
    return State(np.array(position, dtype=np.float64), still, still)
