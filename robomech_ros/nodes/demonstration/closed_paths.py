"""Closed paths of the ground that rolling robots are shown on: a rounded square and an eight."""

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.typing import Array

# Pieces of a path between its points; what is between them is straight.
_PIECES = 4000
# The first zero of the Bessel function J0: with it the sine-generated curve closes.
_FIRST_ZERO = 2.404825557695773
# Sides of the square between its corners, in its radius.
_STRAIGHT = 1.0


@dataclass(frozen=True, eq=False)
class ClosedPath:
    """A path that ends where it begins, at the origin along x."""

    name: str
    #: Distances along the path from its beginning, evenly spaced (m), shape (m,).
    lengths: Array
    #: x, y (m), shape (m, 2).
    places: Array
    #: Directions of the path (rad), continuous, shape (m,).
    tangents: Array
    #: Headings of the base (rad), continuous, shape (m,).
    headings: Array

    @property
    def length(self) -> float:
        """All of it (m)."""
        return float(self.lengths[-1])

    def at(self, length: float) -> tuple[Array, Array]:
        """Return pose and motion of the base after a length (m).

        Returns ``pose``: x, y (m) and heading (rad), shape (3,); ``motion``: turn (rad/m), and the
        unit vector along the path, for each metre, shape (3,).
        """
        x, y = (float(np.interp(length, self.lengths, self.places[:, k])) for k in (0, 1))
        heading, direction = (
            float(np.interp(length, self.lengths, angles))
            for angles in (self.headings, self.tangents)
        )
        piece = min(int(length / self.length * _PIECES), _PIECES - 1)
        turn = float(np.diff(self.headings[piece : piece + 2])[0]) / self.lengths[1]
        return (
            np.array([x, y, heading]),
            np.array([turn, math.cos(direction), math.sin(direction)]),
        )

    def twists(self) -> Array:
        """Return the twists of the base at 1 m/s, shape (m, 3) (rad/s, m/s), in its own axes."""
        turn = np.gradient(self.headings, self.lengths)
        ahead = self.tangents - self.headings
        return np.column_stack([turn, np.cos(ahead), np.sin(ahead)])


def rounded_square(radius: float, *, turning: bool) -> ClosedPath:
    """Return a square whose corners are turned at a radius (m), with continuous curvature.

    A base that is ``turning`` turns once against the path, evenly; others look along it.
    """
    corner = math.pi * radius
    quarter = corner + _STRAIGHT * radius
    lengths = np.linspace(0.0, 4.0 * quarter, _PIECES + 1)
    begun, along = np.divmod(lengths, quarter)
    part = np.clip((along - 0.5 * (quarter - corner)) / corner, 0.0, 1.0)
    turned = part - np.sin(2.0 * math.pi * part) / (2.0 * math.pi)
    tangents = 0.5 * math.pi * (begun + turned)
    headings = -2.0 * math.pi * lengths / lengths[-1] if turning else tangents
    name = "square, turning against it" if turning else "square"
    return ClosedPath(name, lengths, _places(lengths, tangents), tangents, headings)


def figure_of_eight(radius: float, *, looking_ahead: bool) -> ClosedPath:
    """Return an eight with a least radius (m), whose curvature is a sine of the length.

    A base that is not ``looking_ahead``, along the path, keeps its heading.
    """
    length = 2.0 * math.pi * _FIRST_ZERO * radius
    lengths = np.linspace(0.0, length, _PIECES + 1)
    tangents = _FIRST_ZERO * (1.0 - np.cos(2.0 * math.pi * lengths / length))
    headings = tangents if looking_ahead else np.zeros(_PIECES + 1)
    name = "eight" if looking_ahead else "eight, heading kept"
    return ClosedPath(name, lengths, _places(lengths, tangents), tangents, headings)


def _places(lengths: Array, tangents: Array) -> Array:
    """Go along directions from the origin, shape (m, 2)."""
    steps = np.column_stack([np.cos(tangents), np.sin(tangents)])
    middle = 0.5 * (steps[:-1] + steps[1:]) * lengths[1]
    return np.vstack([np.zeros((1, 2)), np.cumsum(middle, axis=0)])
