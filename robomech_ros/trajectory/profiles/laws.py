"""Laws of motion from rest to rest, over a time and a way of 1.

The cubic spline through both points is one of them: with neither velocity nor acceleration at its
ends it has two more knots, at a quarter and at three quarters of the time.

All of them are symmetric, s(1 - tau) = 1 - s(tau), and have no velocity and no acceleration at
their ends.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., sections 6.3, 6.4 and 6.6.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Rate
from robomech_ros.typing import Array

# Septic polynomials that stand for the cycloidal motion: they differ from it by 1e-13.
_CYCLOIDAL_SEGMENTS = 32


class Rates(NamedTuple):
    """First three derivatives of s, shaped like tau."""

    velocity: Array
    acceleration: Array
    jerk: Array


@dataclass(frozen=True, eq=False)
class Law:
    """Travelled fraction s of a path as a function of the elapsed fraction tau of its time.

    The pieces are s(tau) as one joint; the ``peaks`` are the largest magnitudes of its first three
    derivatives.
    """

    peaks: dict[Rate, float]
    pieces: PiecewisePolynomial

    def progress(self, tau: Array) -> Array:
        """Return s(tau), accurate relative to the way from the nearer end."""
        way = self._begun(np.minimum(tau, 1.0 - tau))
        return np.where(tau < 0.5, way, 1.0 - way)

    def _begun(self, tau: Array) -> Array:
        return self.pieces.sample(tau).position.reshape(np.shape(tau))

    def rates(self, tau: Array) -> Rates:
        """Return its first three derivatives."""
        # Counted from the nearer end, so that both ends are at rest exactly.
        back = np.asarray(tau) > 0.5
        sample = self.pieces.sample(np.where(back, 1.0 - tau, tau))
        velocity, acceleration, jerk = (rate.reshape(np.shape(tau)) for rate in sample[1:])
        return Rates(velocity, np.where(back, -acceleration, acceleration), jerk)

    @cached_property
    def magnitudes(self) -> tuple[float, float, float]:
        """Peaks of velocity, acceleration and jerk, in this order."""
        return self.peaks["velocity"], self.peaks["acceleration"], self.peaks["jerk"]


def _pieces(breaks: list[float], *coefficients: list[float]) -> PiecewisePolynomial:
    return PiecewisePolynomial(np.array(breaks), np.array(coefficients)[:, :, None])


def _one_piece(*coefficients: float) -> PiecewisePolynomial:
    return _pieces([0.0, 1.0], *([one] for one in coefficients))


def law_of(pieces: PiecewisePolynomial) -> Law:
    """Make a law of its pieces: from 0 to 1 in a time of 1, from rest to rest, and symmetric."""
    low, high = extremes(pieces)
    largest = np.maximum(-low, high)[1:, 0].tolist()
    return Law(dict(zip(RATES, largest, strict=True)), pieces)


class _Cycloidal(Law):
    """The law of the cycloidal motion, to which its pieces only come near."""

    def _begun(self, tau: Array) -> Array:
        return _progress_cycloidal(tau)

    def rates(self, tau: Array) -> Rates:
        """Return its first three derivatives."""
        return _rates_cycloidal(tau)


def _progress_cycloidal(tau: Array) -> Array:
    turn = 2.0 * math.pi
    # The difference loses its digits near zero; there the next term is below rounding.
    small = (turn * tau) ** 3 / (6.0 * turn) * (1.0 - (turn * tau) ** 2 / 20.0)
    return np.where(tau < 1e-4, small, tau - np.sin(turn * tau) / turn)


def _rates_cycloidal(tau: Array) -> Rates:
    # Counted from the nearer end, so that both ends are at rest exactly.
    angle = 2.0 * math.pi * np.where(tau < 0.5, tau, tau - 1.0)
    return Rates(
        2.0 * np.sin(0.5 * angle) ** 2,
        2.0 * math.pi * np.sin(angle),
        4.0 * math.pi**2 * np.cos(angle),
    )


def _septic(breaks: Array, values: Array) -> PiecewisePolynomial:
    """Interpolate positions and three derivatives (4, m, n) at increasing breaks (m,)."""
    spans = np.diff(breaks)[:, None]
    factorials = np.array([math.factorial(d) for d in range(4)])[:, None, None]
    powers = spans ** np.arange(4)[:, None, None]
    # Taylor coefficients over segments of length 1, from the front and at the back.
    front, back = values[:, :-1] / factorials * powers, values[:, 1:] / factorials * powers
    ends = np.array([[math.comb(k, d) for k in range(8)] for d in range(4)], float)
    missing = back - np.tensordot(ends[:, :4], front, axes=1)
    high = np.tensordot(np.linalg.inv(ends[:, 4:]), missing, axes=1)
    scaled = np.concatenate([front, high]) / spans ** np.arange(8)[:, None, None]
    return PiecewisePolynomial(breaks, scaled)


def _cycloidal_pieces() -> PiecewisePolynomial:
    tau = np.linspace(0.0, 1.0, _CYCLOIDAL_SEGMENTS + 1)
    values = np.stack([_progress_cycloidal(tau), *_rates_cycloidal(tau)])
    return _septic(tau, values[:, :, None])


POLY345 = Law(
    {"velocity": 15.0 / 8.0, "acceleration": 10.0 * math.sqrt(3.0) / 3.0, "jerk": 60.0},
    _one_piece(0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
)
POLY4567 = Law(
    {"velocity": 35.0 / 16.0, "acceleration": 84.0 * math.sqrt(5.0) / 25.0, "jerk": 52.5},
    _one_piece(0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
)
CYCLOIDAL = _Cycloidal(
    {"velocity": 2.0, "acceleration": 2.0 * math.pi, "jerk": 4.0 * math.pi**2}, _cycloidal_pieces()
)
CUBIC = Law(
    {"velocity": 2.0, "acceleration": 8.0, "jerk": 32.0},
    _pieces(
        [0.0, 0.25, 0.75, 1.0],
        [0.0, 1.0 / 12.0, 11.0 / 12.0],
        [0.0, 1.0, 1.0],
        [0.0, 4.0, -4.0],
        [16.0 / 3.0, -16.0 / 3.0, 16.0 / 3.0],
    ),
)
