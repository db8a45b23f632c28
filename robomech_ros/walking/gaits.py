"""Gaits: which leg is in the air when, in exact fractions of the cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType

from robomech_ros.errors import BadValueError


@dataclass(frozen=True)
class Gait:
    """A periodic gait.

    A leg touches down where the phase of the cycle, plus its own offset, is a whole number; it
    stands for the part ``duty`` of the cycle, then swings.

    Parameters
    ----------
    name : str
    duty : Fraction
        Part of the cycle for which each leg stands.
    offsets : mapping of int to tuple of Fraction
        For each number of legs that the gait is for, the offset of each leg: left ones from front
        to rear, then right ones from front to rear; of four, front left, front right, rear left,
        rear right.
    static : bool
        Whether at least three feet stand at any time.
    sways : bool
        Whether the trunk moves over the feet that will stand, before a leg is lifted.
    """

    name: str
    duty: Fraction
    offsets: Mapping[int, tuple[Fraction, ...]]
    static: bool = True
    sways: bool = False

    def phases(self, legs: int) -> tuple[Fraction, ...]:
        """Return the offsets of all legs of a robot.

        Raises
        ------
        BadValueError
            The gait is not for this number of legs.
        """
        if not isinstance(legs, int) or legs not in self.offsets:
            known = " or ".join(map(str, self.offsets))
            raise BadValueError(f"number of legs for the gait '{self.name}'", legs, known)
        return self.offsets[legs]

    def stances(self, legs: int) -> tuple[tuple[bool, ...], ...]:
        """List which legs stand, for each part of the cycle between touchdowns and lift-offs.

        Parameters
        ----------
        legs : int
            Number of legs of the robot.
        """
        offsets = self.phases(legs)
        ends = {(-one) % 1 for one in offsets} | {(self.duty - one) % 1 for one in offsets}
        order = sorted(ends)
        found = []
        for start, end in zip(order, [*order[1:], order[0] + 1], strict=True):
            middle = (start + end) / 2
            found.append(tuple((middle + one) % 1 < self.duty for one in offsets))
        return tuple(found)


def _offsets(order: Sequence[int], duty: Fraction, first: Fraction) -> tuple[Fraction, ...]:
    """Return the offsets of legs that lift off one after the other, in equal parts of the cycle."""
    found = [Fraction(0)] * len(order)
    for turn, leg in enumerate(order):
        found[leg] = (duty - first - Fraction(turn, len(order))) % 1
    return tuple(found)


def _gaits() -> dict[str, Gait]:
    half = Fraction(1, 2)
    slow, wave, crawl = Fraction(2, 3), Fraction(5, 6), Fraction(7, 8)
    # Legs in the order of offsets: from rear to front on one side, then on the other.
    along = (2, 1, 0, 5, 4, 3)
    ripple = (2, 4, 0, 5, 1, 3)
    corners = (2, 0, 3, 1)
    zero = Fraction(0)
    return {
        "wave": Gait("wave", wave, {6: _offsets(along, wave, zero)}),
        "ripple": Gait("ripple", slow, {6: _offsets(ripple, slow, zero)}),
        "tripod": Gait("tripod", half, {6: (zero, half, zero, half, zero, half)}),
        "crawl": Gait("crawl", crawl, {4: _offsets(corners, crawl, Fraction(1, 8))}, sways=True),
        "trot": Gait("trot", half, {4: (zero, half, half, zero)}, static=False),
    }


# The gaits by name.
GAITS: Mapping[str, Gait] = MappingProxyType(_gaits())
