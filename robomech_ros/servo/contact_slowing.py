"""Slower motion towards contact: the part of a command to follow, and the report.

The servo knows bodies only through a guard, which finds where a motion first touches something.
"""

import math
from typing import NamedTuple, Protocol

from robomech_ros.servo.report import ServoCondition, ServoReport
from robomech_ros.typing import Array

# Least look-ahead (s); a proximity slows down no motion that is farther from contact.
_LOOK_AHEAD = 0.3
# Braking on the approach to contact, as a part of the limits; time constant at its end (s).
_PART, _CREEP = 0.5, 0.1
# The robot stops this far before contact, by the travel of the fastest joint (rad or m).
_BEFORE = 1e-3
# Less than this part of a command is a halt.
_HALT = 0.01


class ContactAhead(NamedTuple):
    """The first contact on a motion.

    It comes after the part ``at`` of the motion, 0 to 1. The bodies are now ``distance``
    apart (m), and slow down within ``proximity`` (m). The ``words`` name both.
    """

    at: float
    distance: float
    proximity: float
    words: str


class ContactGuard(Protocol):
    """Interface to the bodies of a robot and of its surroundings."""

    def contact(self, curve: Array) -> ContactAhead | None:
        """Find the first contact on a curve of n joints, as Bernstein coefficients (d + 1, n).

        A contact at its beginning counts only if the curve leads deeper into it.
        """

    def obstruction(self, curves: Array) -> ContactAhead | None:
        """Return a contact on successive curves (s, d + 1, n); None if they are proved free."""


class MotionAhead(NamedTuple):
    """The motion that a command leads to.

    The curve (d + 1, n), as Bernstein coefficients, takes ``seconds`` at the highest speed within
    the limits, which is the part ``limited`` of the command. Stopping from it takes ``stop`` (s).
    """

    curve: Array
    seconds: float
    stop: float
    limited: float


class Slowing(NamedTuple):
    """The part of a command that is followed, 0 to 1, and the contact that allows no more."""

    part: float
    contact: ContactAhead | None


def look_ahead(stop: float) -> float:
    """Return the look-ahead (s) for a motion that needs a time to stop (s)."""
    return max(_LOOK_AHEAD, stop / (2.0 * _PART))


def slowed(guard: ContactGuard, ahead: MotionAhead | None) -> Slowing:
    """Find the part of a command to follow; ``ahead`` is None if it moves nothing.

    Half the braking that limits allow suffices to stop before contact. Within the proximity the
    speed is also in proportion to the distance, or to the time to contact if that allows more.
    """
    found = None if ahead is None else guard.contact(ahead.curve)
    if ahead is None or found is None:
        return Slowing(1.0, None)
    travel = float(abs(ahead.curve[-1] - ahead.curve[0]).max())
    left = max(found.at - _BEFORE / max(travel, _BEFORE), 0.0) * ahead.seconds
    part = min(
        1.0,
        left / _CREEP,
        math.sqrt(2.0 * _PART * left / max(ahead.stop, 1e-9)),
        max(found.distance / max(found.proximity, 1e-9), left / _LOOK_AHEAD),
    )
    if part < _HALT:
        return Slowing(0.0, found)
    return Slowing(part * ahead.limited if part < 1.0 else 1.0, found if part < 1.0 else None)


def contact_report(found: ContactAhead, report: ServoReport, part: float) -> ServoReport:
    """Say that a contact limits the motion, unless something else stops it.

    ``report`` is about the followed part of the command.
    """
    stops = ServoCondition.SINGULARITY, ServoCondition.IMPOSSIBLE, ServoCondition.JOINT_BOUND
    if report.condition in stops:
        return report
    scale, number = part * report.scale, report.condition_number
    if part:
        condition, what = ServoCondition.APPROACHING_CONTACT, f"slowed down to {scale:.3g} before"
    else:
        condition, what = ServoCondition.CONTACT, "no motion towards"
    return ServoReport(condition, scale, number, (), f"{what} contact of {found.words}")
