"""Simulated fingers: they follow exactly, unless something between them stops them."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.execution.controller.simulated_joints import DrivenMotion
from robomech_ros.execution.joints import State, at_rest
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array, BoolArray

# Positions nearer than this (rad or m) are equal up to rounding.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class Contact:
    """Object between the fingers that stops them.

    Attributes
    ----------
    position : ndarray, shape (n,)
        Position of the n joints there, rad or m; NaN for a joint that it does not stop.
    closing : ndarray, shape (n,)
        1 where a joint closes as its position grows, -1 where it opens.
    """

    position: Array
    closing: Array


class FingerPlant:
    """Joints of fingers, as a `Plant`, at first at a position (n,), rad or m.

    Joints that something has stopped, and that are free again, catch up within their limits of
    velocity and acceleration, all of them finite. ``contact`` is what is between the fingers, None
    for nothing; it stops fingers that come from outside. The drives exert at most ``effort`` (n,),
    N m or N, NaN where that is not known. Joints that would be elsewhere if nothing stopped them
    are ``pressing``.
    """

    def __init__(self, position: Array, limits: Limits, effort: Array) -> None:
        self._limits = limits
        self.contact: Contact | None = None
        self.effort = effort
        self.put(position)

    def put(self, position: Array) -> DrivenMotion:
        """Place the joints at rest (rad or m), at once."""
        self._state = at_rest(position)
        self.pressing = np.zeros(len(position), dtype=bool)
        self._behind = self.pressing
        still = np.zeros(len(position))
        return DrivenMotion(self._state, still, still)

    def drive(
        self, before: State, command: State, span: float, held: BoolArray | None
    ) -> DrivenMotion:
        """Advance the time; see :class:`Plant`."""
        wanted = self._wanted(command, span)
        stop = self._stops(wanted)
        if held is not None:
            stop = np.where(held, self._state.position, stop)
        stopped = np.isfinite(stop) & (np.abs(wanted.position - stop) > _SAME)
        position = np.where(stopped, stop, wanted.position)
        self._state = State(
            position,
            np.where(stopped, 0.0, wanted.velocity),
            np.where(stopped, 0.0, wanted.acceleration),
        )
        away = command.position - position
        self.pressing = stopped
        self._behind = np.abs(away) > _SAME
        effort = np.where(stopped, np.sign(away) * self.effort, 0.0)
        return DrivenMotion(self._state, effort, np.where(stopped, span, 0.0))

    def _wanted(self, command: State, span: float) -> State:
        """Return where the joints would be without anything between them."""
        if not self._behind.any():
            return command
        behind, here = self._behind, self._state
        way = command.position - here.position
        fastest, push = self._limits.velocity, self._limits.acceleration
        # The speed from which the rest of the way suffices to stop, after one more step with it.
        braked = push * (np.sqrt(span * span + 2.0 * np.abs(way) / push) - span)
        speed = np.minimum(np.minimum(np.abs(here.velocity) + push * span, fastest), braked)
        velocity = np.sign(way) * speed
        return State(
            np.where(behind, here.position + velocity * span, command.position),
            np.where(behind, velocity, command.velocity),
            np.where(behind, (velocity - here.velocity) / span, command.acceleration),
        )

    def _stops(self, wanted: State) -> Array:
        """Return where each joint is stopped (rad or m), shape (n,); NaN for those that are not."""
        contact = self.contact
        if contact is None:
            return np.full(len(wanted.position), np.nan)
        outside = contact.closing * (contact.position - self._state.position) >= -_SAME
        beyond = contact.closing * (wanted.position - contact.position) > 0.0
        return np.where(outside & beyond, contact.position, np.nan)
