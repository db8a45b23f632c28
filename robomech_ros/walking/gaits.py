"""Gaits: which leg is in the air when, in exact fractions of the cycle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import whole_number


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
        known = " or ".join(map(str, self.offsets))
        what = f"number of legs for the gait '{self.name}'"
        number = whole_number(what, legs, known, 0)
        if number not in self.offsets:
            raise BadValueError(what, legs, known)
        return self.offsets[number]

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


_ZERO, _HALF = Fraction(0), Fraction(1, 2)
_SLOW, _WAVE, _CRAWL = Fraction(2, 3), Fraction(5, 6), Fraction(7, 8)
# Legs in the order of offsets: from rear to front on one side, then on the other.
_ALONG, _RIPPLE, _CORNERS = (2, 1, 0, 5, 4, 3), (2, 4, 0, 5, 1, 3), (2, 0, 3, 1)
# The gaits by name.
GAITS: Mapping[str, Gait] = MappingProxyType(
    {
        "wave": Gait("wave", _WAVE, {6: _offsets(_ALONG, _WAVE, _ZERO)}),
        "ripple": Gait("ripple", _SLOW, {6: _offsets(_RIPPLE, _SLOW, _ZERO)}),
        "tripod": Gait("tripod", _HALF, {6: (_ZERO, _HALF) * 3}),
        "crawl": Gait("crawl", _CRAWL, {4: _offsets(_CORNERS, _CRAWL, Fraction(1, 8))}, sways=True),
        "trot": Gait("trot", _HALF, {4: (_ZERO, _HALF, _HALF, _ZERO)}, static=False),
    }
)
