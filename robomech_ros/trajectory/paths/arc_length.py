"""Arc length of curves, and curves by their arc length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.trajectory.paths.curve import Curve, as_curve, evaluated
from robomech_ros.trajectory.paths.curve_arguments import as_parameters
from robomech_ros.typing import Array, ArrayLike, IntArray

# Speed, as part of the largest one, below which a curve has no direction: a cusp.
VANISHING_SPEED = 1e-6
# An interval is halved until the last coefficients of the speed in it, times the interval, are
# below this part of the whole length: above the rounding of a sum of sixteen terms.
ARC_LENGTH = 3e-14
# Halvings of an interval at most: a billionth of a billionth of it is below rounding.
ARC_LENGTH_HALVINGS = 50
# Newton steps for the parameter at an arc length; they double the digits each time.
INVERSE_STEPS = 12

Speed = Callable[[Array], Array]

# Chebyshev polynomials, and nodes, of an interval; in between the speed is that polynomial.
_TERMS = 16
_ANGLES = (np.arange(_TERMS) + 0.5) * np.pi / _TERMS
_NODES = -np.cos(_ANGLES)
_TO_COEFFICIENTS = np.cos(np.outer(np.arange(_TERMS), np.arccos(_NODES))) * (2.0 / _TERMS)
_TO_COEFFICIENTS[0] *= 0.5
# Samples of the speed: at the ends, and in between.
_PROBED = np.linspace(-1.0, 1.0, 17)
_PROBES = np.cos(np.outer(np.arange(_TERMS), np.arccos(_PROBED)))
# The last coefficients, which tell how well the polynomial fits.
_TAIL = 3
_DEGREES = np.arange(_TERMS + 1)

_EXPECTED = "above 0: the curve stops there, and has no direction"


@dataclass(frozen=True, eq=False)
class ArcLength:
    """Length along a curve as a function of its parameter, and the reverse.

    Attributes
    ----------
    parameters : ndarray, shape (k + 1,)
        Ends of the intervals in which the speed is a polynomial up to rounding.
    lengths : ndarray, shape (k + 1,)
        Length from the start to each (m).
    speeds : ndarray, shape (k, 16)
        Chebyshev coefficients of ds/du in every interval.
    """

    parameters: Array
    lengths: Array
    speeds: Array

    @property
    def length(self) -> float:
        """Length of the whole curve (m)."""
        return float(self.lengths[-1])

    @cached_property
    def _integrals(self) -> Array:
        """Chebyshev coefficients (k, 17) of the length from the start of every interval."""
        halves = 0.5 * np.diff(self.parameters)
        return np.polynomial.chebyshev.chebint(self.speeds.T, lbnd=-1.0).T * halves[:, None]

    def at(self, u: ArrayLike) -> Array:
        """Length from the start to parameters, shape () or (m,)."""
        inside = as_parameters("parameter", u, *map(float, self.parameters[[0, -1]]))
        flat = np.atleast_1d(inside)
        k = _interval(self.parameters, flat)
        total = self.lengths[k] + self._state(k, flat)[0]
        return total if inside.ndim else total[0]

    def parameter(self, s: ArrayLike) -> Array:
        """Parameters at lengths from the start (m), shape () or (m,).

        At a length just below that of a break the parameter is below the break, so that the limit
        of a derivative from the left is found.
        """
        inside = as_parameters("s", s, 0.0, self.length)
        flat = np.atleast_1d(inside)
        k = _interval(self.lengths, flat)
        u = self._inverse(k, flat)
        return u if inside.ndim else u[0]

    def _inverse(self, k: IntArray, s: Array) -> Array:
        """Solve for the parameters at lengths in the intervals k, by Newton's method."""
        low = self.parameters[k]
        high = self.parameters[k + 1].copy()
        inner = s < self.lengths[k + 1]
        high[inner] = np.nextafter(high, low)[inner]
        wanted = s - self.lengths[k]
        u = low + (high - low) * wanted / (self.lengths[k + 1] - self.lengths[k])
        rounding = 4.0 * np.finfo(np.float64).eps * np.maximum(np.abs(high), np.abs(low))
        for _ in range(INVERSE_STEPS):
            reached, speed = self._state(k, u)
            before, u = u, np.clip(u + (wanted - reached) / speed, low, high)
            if (np.abs(u - before) <= rounding).all():
                break
        return u

    def _state(self, k: IntArray, u: Array) -> tuple[Array, Array]:
        """Length from the start of the intervals k, and speed, at parameters in them."""
        low, high = self.parameters[k], self.parameters[k + 1]
        x = np.clip((2.0 * u - low - high) / (high - low), -1.0, 1.0)
        values = np.cos(np.arccos(x)[:, None] * _DEGREES)
        length: Array = np.sum(self._integrals[k] * values, axis=1)
        speed: Array = np.sum(self.speeds[k] * values[:, :_TERMS], axis=1)
        return np.maximum(length, 0.0), speed


@dataclass(frozen=True, eq=False)
class ArcLengthCurve:
    """A curve over its arc length s (m), from 0 to its length.

    The first derivative is a unit vector.

    Attributes
    ----------
    curve : Curve
        Over its own parameter.
    measure : ArcLength
        Of that curve.
    """

    curve: Curve
    measure: ArcLength

    @property
    def length(self) -> float:
        """Length of the whole curve (m)."""
        return self.measure.length

    @cached_property
    def breaks(self) -> Array:
        """Arc lengths (m) of the ends and of all places where a derivative steps."""
        return self.measure.lengths[np.searchsorted(self.measure.parameters, self.curve.breaks)]

    def derivatives(self, s: ArrayLike) -> Array:
        """Position (m) and four derivatives with respect to s, shape (5, 3) or (5, m, 3)."""
        return evaluated(self.breaks, s, self._rows)

    def _rows(self, s: Array) -> Array:
        return by_unit_speed(self.curve.derivatives(self.measure.parameter(s)))


def arc_length(curve: Curve) -> ArcLengthCurve:
    r"""Reparametrise a curve by its arc length.

    .. math:: s(u) = \int_{u_0}^u |p'(v)|\, dv

    Parameters
    ----------
    curve : Curve
        Over any parameter, nowhere at a stop: its first derivative must not vanish.

    Returns
    -------
    ArcLengthCurve
        With ``.length``, accurate to 1e-12 of it.

    Raises
    ------
    BadValueError
        No curve, or one with a cusp; the message names the parameter.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.2.
    """
    curve = as_curve("curve", curve)

    def speed(u: Array) -> Array:
        return np.linalg.norm(curve.derivatives(u)[1], axis=-1)

    return ArcLengthCurve(curve, measured(speed, curve.breaks))


def measured(speed: Speed, breaks: Array, expected: str = _EXPECTED) -> ArcLength:
    """Tabulate the integral of a speed ds/du (m), by Chebyshev polynomials on halved intervals.

    The speed is smooth between the breaks.  `expected` is what the message says where it vanishes.
    """
    low, high = breaks[:-1], breaks[1:]
    fitted = _fitted(speed, low, high)
    total = float((_means(fitted) * (high - low)).sum())
    done: list[tuple[Array, Array, Array]] = []
    for _ in range(ARC_LENGTH_HALVINGS):
        tails = np.abs(fitted[:, -_TAIL:]).max(axis=1, initial=0.0) * (high - low)
        good = tails <= ARC_LENGTH * total
        done.append((low[good], high[good], fitted[good]))
        low, high = low[~good], high[~good]
        if not len(low):
            break
        middle = 0.5 * (low + high)
        low, high = np.append(low, middle), np.append(middle, high)
        fitted = _fitted(speed, low, high)
    done.append((low, high, fitted[: len(low)]))
    starts, ends, coefficients = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.argsort(starts)
    starts, ends, coefficients = starts[order], ends[order], coefficients[order]
    _check_moves(starts, ends, coefficients, expected)
    parts = _means(coefficients) * (ends - starts)
    lengths = np.concatenate([[0.0], np.cumsum(parts)])
    return ArcLength(np.append(starts, ends[-1:]), lengths, coefficients)


def by_unit_speed(r: Array) -> Array:
    """Turn derivatives (5, m, 3) by any parameter into those with respect to arc length.

    This is the chain rule with u' = 1/abs(r') and its derivatives.
    """
    u1, u2, u3, u4 = (rate[:, None] for rate in _parameter_rates(r))
    return np.stack(
        [
            r[0],
            r[1] * u1,
            r[2] * u1**2 + r[1] * u2,
            r[3] * u1**3 + 3.0 * r[2] * u1 * u2 + r[1] * u3,
            r[4] * u1**4
            + 6.0 * r[3] * u1**2 * u2
            + r[2] * (3.0 * u2**2 + 4.0 * u1 * u3)
            + r[1] * u4,
        ]
    )


def _parameter_rates(r: Array) -> tuple[Array, Array, Array, Array]:
    """Four derivatives of the parameter with respect to arc length, each (m,)."""
    g = dot(r[1], r[1])
    g1 = 2.0 * dot(r[1], r[2]) / g
    g2 = 2.0 * (dot(r[2], r[2]) + dot(r[1], r[3])) / g
    g3 = 2.0 * (3.0 * dot(r[2], r[3]) + dot(r[1], r[4])) / g
    # f = g^(-1/2) and its derivatives with respect to u, over f.
    f = 1.0 / np.sqrt(g)
    f1 = -0.5 * g1
    f2 = 0.75 * g1**2 - 0.5 * g2
    f3 = -1.875 * g1**3 + 2.25 * g1 * g2 - 0.5 * g3
    return f, f**2 * f1, f**3 * (f1**2 + f2), f**4 * (f1**3 + 4.0 * f1 * f2 + f3)


def dot(a: Array, b: Array) -> Array:
    """Scalar products of rows, shape (...)."""
    return np.sum(a * b, axis=-1)


def _fitted(speed: Speed, low: Array, high: Array) -> Array:
    """Chebyshev coefficients (k, 16) of a speed in intervals."""
    nodes = 0.5 * (high + low)[:, None] + 0.5 * (high - low)[:, None] * _NODES
    return speed(nodes.ravel()).reshape(nodes.shape) @ _TO_COEFFICIENTS.T


def _means(coefficients: Array) -> Array:
    """Mean over an interval of a polynomial with Chebyshev coefficients (k, 16)."""
    even = np.arange(0, _TERMS, 2)
    return coefficients[:, even] @ (1.0 / (1.0 - even**2))


def _interval(edges: Array, values: Array) -> IntArray:
    found = np.searchsorted(edges, values, side="right") - 1
    return np.clip(found, 0, len(edges) - 2)


def _check_moves(starts: Array, ends: Array, coefficients: Array, expected: str) -> None:
    """Refuse a curve that stops: where it does the halved intervals crowd together."""
    speeds = coefficients @ _PROBES
    k, i = np.unravel_index(int(np.argmin(speeds)), speeds.shape)
    slowest = max(float(speeds[k, i]), 0.0)
    if not slowest > VANISHING_SPEED * speeds.max():
        place = 0.5 * (starts[k] + ends[k]) + 0.5 * (ends[k] - starts[k]) * _PROBED[i]
        raise BadValueError(f"speed of the curve at parameter {place:.9g}", slowest, expected)
