"""Slower motion towards contact: how much of a command is followed, and what says so.

The servo knows bodies only through a guard, which finds where a motion first touches something.
"""

import math
from typing import NamedTuple, Protocol

from robomech_ros.servo.report import ServoCondition, ServoReport
from robomech_ros.typing import Array

# How far ahead a motion is examined at least (s); a proximity slows nothing that is farther away.
_LOOK_AHEAD = 0.3
# The braking that approaching contact uses, as a part of the limits; the time constant of the end
# of an approach (s).
_PART, _CREEP = 0.5, 0.1
# The robot stops this far before contact, by the travel of the fastest joint (rad or m).
_BEFORE = 1e-3
# Less than this part of a command is a halt.
_HALT = 0.01


class ContactAhead(NamedTuple):
    """The first contact on a motion.

    It comes after the part ``at`` of the motion, 0 to 1. The bodies are now apart by a distance
    (m), and are slowed down within the ``proximity`` (m) that their kind has. The words name both.
    """

    at: float
    distance: float
    proximity: float
    words: str


class ContactGuard(Protocol):
    """What knows the bodies of a robot and of its surroundings."""

    def contact(self, curve: Array) -> ContactAhead | None:
        """Find the first contact on a curve of n joints, as Bernstein coefficients (d + 1, n).

        A contact at its beginning counts only if the curve leads deeper into it.
        """

    def obstruction(self, curves: Array) -> ContactAhead | None:
        """Return a contact on successive curves (s, d + 1, n); None if they are proved free."""


class Ahead(NamedTuple):
    """Where a command leads.

    The curve (d + 1, n), as Bernstein coefficients, takes so many seconds at the full speed that
    velocity limits allow, from which stopping takes the time ``stop`` (s). That speed is the part
    ``limited`` of the commanded one.
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
    """Return how far ahead (s) a motion is examined that needs a time to stop (s)."""
    return max(_LOOK_AHEAD, stop / (2.0 * _PART))


def slowed(guard: ContactGuard, ahead: Ahead | None) -> Slowing:
    """Find how much of a command can be followed; None ahead if it moves nothing.

    With half the braking that limits allow, the robot stops at the contact. Within the proximity of
    its bodies the speed is also in proportion to their distance, or to the time until they touch if
    that leaves more.
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

    ``report`` is that on the part of the command that was followed.
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
