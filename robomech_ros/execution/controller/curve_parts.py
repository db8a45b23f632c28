"""Pieces of curves: later, cut, put one after the other, prolonged backwards; and their peaks."""

import math
from functools import cache

import numpy as np

from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

# A piece shorter than this (s) is not kept: the next one begins where it does.
_SHORTEST = 2e-3
# How finely a change of pace is looked at (s), every which of these begins a piece, and rounding.
_FINE, _COARSE, _ROUNDING = 1e-3, 5, 1e-12
# How far from a break a curve is looked at for what it is before and after that, s.
_BESIDE = 5e-6
# The polynomial that is the time itself.
_LIKE_TIME = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])


@cache
def _binomials(order: int) -> tuple[Array, Array]:
    """Return the binomial coefficients of row k and column i, and the differences i - k."""
    powers = np.maximum(np.arange(order) - np.arange(order)[:, None], 0.0)
    rows = [[float(math.comb(i, k)) for i in range(order)] for k in range(order)]
    return np.array(rows), powers


def rebased(coefficients: Array, by: float | Array) -> Array:
    """Rewrite polynomials (order + 1, n) in powers of the time since `by` (s), one or (m,)."""
    factors, powers = _binomials(len(coefficients))
    return (factors * np.asarray(by)[..., None, None] ** powers) @ coefficients


def shifted(curve: PiecewisePolynomial, by: float) -> PiecewisePolynomial:
    """Return the same curve later by a time (s)."""
    return PiecewisePolynomial(curve.breaks + by, curve.coefficients)


def part_from(curve: PiecewisePolynomial, time: float) -> PiecewisePolynomial:
    """Return the part of a curve that begins at a time (s), which becomes 0."""
    breaks = curve.breaks - time
    if len(breaks) == 1 or breaks[-1] <= 0.0:
        rest = curve.sample(curve.breaks[-1]).position
        return PiecewisePolynomial(np.zeros(1), rest[None, None])
    first = max(int(np.searchsorted(breaks, 0.0, side="right")) - 1, 0)
    coefficients = curve.coefficients[:, first:].copy()
    coefficients[:, 0] = rebased(coefficients[:, 0], float(-breaks[first]))
    return PiecewisePolynomial(np.append(0.0, breaks[first + 1 :]), coefficients)


def paced(curve: PiecewisePolynomial, ahead: Array, time: float) -> PiecewisePolynomial | None:
    """Return the part of a curve from 0 on, at another pace for a time (s).

    The place on the curve is the time plus the polynomial `ahead` (lowest power first) of it, both
    in s; None where that would go backwards.  By quintics that are exact at both their ends, where
    the curve may have steps of its accelerations.
    """
    rest = part_from(curve, time)
    if not time:
        return rest
    fine = np.linspace(0.0, time, max(round(time / _FINE), 2) + 1)
    progress = np.polynomial.Polynomial(ahead + _LIKE_TIME)
    places = progress(fine)
    if not (np.diff(places) >= -_ROUNDING).all():
        return None
    knots = np.interp(curve.breaks, places, fine)
    times = np.sort(np.concatenate((fine[::_COARSE], knots)))
    times = times[(times > _SHORTEST) & (times < time - _SHORTEST)]
    times = np.concatenate(([0.0], times[np.diff(times, prepend=0.0) > 0.25 * _SHORTEST], [time]))
    places, pace = progress(times), progress.deriv()(times)[:, None]
    there = curve.sample(places)
    through = interpolant(times, there.position, there.velocity * pace)
    rate = progress.deriv(2)(times)[:, None]
    ends = [
        curve.sample(place).acceleration * p * p + v * r
        for place, p, v, r in (
            (places[:-1] + _BESIDE, pace[:-1], there.velocity[:-1], rate[:-1]),
            (places[1:] - _BESIDE, pace[1:], there.velocity[1:], rate[1:]),
        )
    ]
    through = _with_accelerations(through, *ends)
    if len(rest.breaks) < 2:
        return through
    breaks = np.concatenate((times, time + rest.breaks[1:]))
    return chained(breaks, through.coefficients, rest.coefficients)


def _with_accelerations(
    cubics: PiecewisePolynomial, begin: Array, end: Array
) -> PiecewisePolynomial:
    """Return the quintics with the ends of s cubics, and accelerations (s, n) at both of them."""
    spans, (position, velocity, half, sixth) = cubics.spans[:, None], cubics.coefficients
    begin = 0.5 * begin - half
    end = 0.5 * end - half - 3.0 * spans * sixth
    fifth = (end - begin) / spans**3
    fourth = (3.0 * begin - 2.0 * end) / spans**2
    third = sixth + (end - 3.0 * begin) / spans
    coefficients = np.stack((position, velocity, half + begin, third, fourth, fifth))
    return PiecewisePolynomial(cubics.breaks, coefficients)


def spliced(first: PiecewisePolynomial, then: PiecewisePolynomial) -> PiecewisePolynomial:
    """Go over from one curve to the beginning of another one, by a piece between two breaks.

    Where the curves agree, that piece is the one that the first curve has there.
    """
    begin = float(then.breaks[0])
    kept = int(np.searchsorted(first.breaks, begin - _SHORTEST, side="right"))
    # The last break that is kept is where the piece between begins.
    here, there = first.sample(first.breaks[kept - 1]), then.sample(begin)
    between = interpolant(
        [first.breaks[kept - 1], begin],
        np.vstack((here.position, there.position)),
        np.vstack((here.velocity, there.velocity)),
        np.vstack((here.acceleration, there.acceleration)) if len(then.coefficients) > 4 else None,
    )
    breaks = np.concatenate((first.breaks[:kept], then.breaks))
    return chained(breaks, first.coefficients[:, : kept - 1], between.coefficients, pieces_of(then))


def prolonged_back(curve: PiecewisePolynomial, time: float) -> PiecewisePolynomial:
    """Extend a curve backwards by a time (s) at its first velocity."""
    begin = curve.sample(curve.breaks[0])
    before = np.stack((begin.position - time * begin.velocity, begin.velocity))[:, None]
    return chained(np.append(curve.breaks[0] - time, curve.breaks), before, pieces_of(curve))


def pieces_of(curve: PiecewisePolynomial) -> Array:
    """Return the coefficients between the breaks: none of a curve that has one break."""
    return curve.coefficients[:, : len(curve.breaks) - 1]


def chained(breaks: Array, *parts: Array) -> PiecewisePolynomial:
    """Put pieces (order, s, n) of any order one after the other."""
    order = max(map(len, parts))
    filled = [np.pad(part, ((0, order - len(part)), (0, 0), (0, 0))) for part in parts]
    return PiecewisePolynomial(breaks, np.concatenate(filled, axis=1))


def peaks(curve: PiecewisePolynomial, rate: int) -> Array:
    """Return the largest accelerations (rate 2) or jerks (3) of n joints; a quintic at the most."""
    if len(curve.breaks) < 2:
        return np.zeros(curve.joints)
    return np.abs(_extremes(curve, rate)[0]).max(axis=(0, 1))


def jerks_over(curve: PiecewisePolynomial, span: float) -> Array:
    """Return the largest changes (n,) of the accelerations in a time (s) with a break, over it.

    What changes at a break counts, which the derivative of a curve does not show.
    """
    if len(curve.breaks) < 3:
        return np.zeros(curve.joints)
    given, lengths = curve.derivative(2), curve.spans[:-1, None]
    ends = given[-1, :-1]
    for lower in given[-2::-1]:
        ends = ends * lengths + lower[:-1]
    breaks, begins = curve.breaks[1:-1], given[0, 1:]
    before = curve.sample(np.maximum(breaks - span, curve.breaks[0])).acceleration
    after = curve.sample(np.minimum(breaks + span, curve.breaks[-1])).acceleration
    changes = np.abs((begins - before, after - ends, begins - ends)).max(axis=(0, 1))
    return changes / span


def highest_accelerations(curve: PiecewisePolynomial) -> tuple[Array, Array]:
    """Find when on each piece of a curve, a quintic at the most, each joint first accelerates most.

    Returns the accelerations there with their signs, (s, n), and the times (s), (s, n).
    """
    values, times = _extremes(curve, 2)
    high = np.abs(values) >= np.abs(values).max(axis=0) * (1.0 - _ROUNDING)
    first = np.where(high, times, np.inf).argmin(axis=0)[None]
    value, time = (np.take_along_axis(part, first, 0)[0] for part in (values, times))
    return value, curve.breaks[:-1, None] + time


def _extremes(curve: PiecewisePolynomial, rate: int) -> tuple[Array, Array]:
    """Return a rate at both ends of every piece and where it turns, and those times, (k, s, n)."""
    spans = np.diff(curve.breaks)[:, None]
    given = curve.derivative(rate)
    c = np.zeros((4, *given.shape[1:]))
    c[: len(given)] = given
    turns = [0.0 * c[0], spans + 0.0 * c[0]]
    with np.errstate(divide="ignore", invalid="ignore"):
        # The rate turns where c1 + 2 c2 t + 3 c3 t^2 is 0.
        if c[2].any():
            turns.append(-c[1] / (2.0 * c[2]))
        if c[3].any():
            root = np.sqrt(c[2] * c[2] - 3.0 * c[3] * c[1])
            turns += [(-c[2] - root) / (3.0 * c[3]), (root - c[2]) / (3.0 * c[3])]
    times = np.clip(np.nan_to_num(turns), 0.0, spans)
    return c[0] + times * (c[1] + times * (c[2] + times * c[3])), times
