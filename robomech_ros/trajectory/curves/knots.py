"""When a curve through points passes each of them.

References
----------
E. T. Y. Lee, "Choosing nodes in parametric curve interpolation", Computer-Aided Design 21, 1989
(chord length, centripetal); C.-S. Lin, P.-R. Chang and J. Y. S. Luh, "Formulation and
optimization of cubic polynomial joint trajectories for industrial robots", IEEE Transactions on
Automatic Control 28, 1983 (optimal times).
"""

from collections.abc import Callable

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import as_choice, of_shape, real_array
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.time_scaling import stretch_needed
from robomech_ros.trajectory.limits import RATES, Limits
from robomech_ros.typing import Array, ArrayLike

# Power of the distance between two points that their distance in time is proportional to.
_POWERS = {"uniform": 0.0, "centripetal": 0.5, "chord": 1.0}
SPACINGS = (*_POWERS, "balanced", "optimal")
# Shortest segment, in parts of the mean one.
_SHORTEST = 1e-3
_ITERATIONS = 60
# How often the spans are balanced, by which power of what they use of the limits, and at least.
_BALANCED, _BALANCE, _LEAST_USED = 40, 0.6, 0.05

Through = Callable[[Array], PiecewisePolynomial]


def spaced_knots(points: Array, spacing: str, scale: Array | float = 1.0) -> Array:
    """Space knots from 0 to 1 by the distances between points (m, n), measured in `scale` (n,).

    The spacing is ``"uniform"``, ``"chord"`` (proportional to the distance) or ``"centripetal"``
    (to its root).  Knots of points that coincide are kept apart a little.
    """
    power = _POWERS[as_choice("spacing", spacing, tuple(_POWERS))]
    distances = np.linalg.norm(np.diff(points, axis=0) / scale, axis=1)
    spans = distances**power
    spans = np.maximum(spans, _SHORTEST * (spans.mean() or 1.0))
    return np.concatenate([[0.0], np.cumsum(spans)]) / spans.sum()


def knots_at(at: ArrayLike, count: int) -> Array:
    """Check which part of the duration is over at each via point; add the ends 0 and 1."""
    parts = of_shape("at", real_array("at", at), (count - 2,))
    knots = np.concatenate([[0.0], parts, [1.0]])
    if not (np.diff(knots) > 0.0).all():
        raise BadValueError("at", parts.tolist(), "increasing numbers between 0 and 1")
    return knots


def balanced_knots(knots: Array, through: Through, limits: Limits) -> Array:
    """Shorten again and again the segments that are far from the limits, against the others.

    The effort is proportional to the number of points: for those too many for `optimal_knots`,
    whose duration it comes near to.  Returns the best knots that were met.
    """
    spans, shortest, best = np.diff(knots), np.inf, knots
    for _ in range(_BALANCED):
        tried = np.concatenate([[0.0], np.cumsum(spans)])
        curve = through(tried)
        factor, _, _ = stretch_needed(curve, limits)
        if not factor > 0.0:
            return knots
        if factor * tried[-1] < shortest:
            shortest, best = factor * tried[-1], tried
        segments = np.searchsorted(tried, 0.5 * (curve.breaks[1:] + curve.breaks[:-1])) - 1
        used = np.full(len(spans), _LEAST_USED * factor)
        pieces = _peaks(curve, limits).reshape(-1, len(segments)).max(axis=0)
        np.maximum.at(used, segments, pieces)
        spans = spans * used**_BALANCE
        spans = np.maximum(spans, _SHORTEST * spans.mean())
        spans /= spans.sum()
    return best


def optimal_knots(knots: Array, through: Through, limits: Limits) -> Array:
    """Find knots with a locally shortest duration, never longer than that of those given."""
    from scipy.optimize import minimize  # a second and 40 MB that few need

    curve = through(knots)
    factor, _, _ = stretch_needed(curve, limits)
    if not factor > 0.0:
        return knots
    start = np.log(factor * np.diff(knots))
    least = start.mean() + np.log(_SHORTEST)
    # No segment of a shorter motion lasts longer than the whole of this one.
    longest = np.log(factor * (knots[-1] - knots[0]))

    def after(logarithms: Array) -> Array:
        return np.concatenate([[0.0], np.cumsum(np.exp(logarithms))])

    def spare(logarithms: Array) -> Array:
        return 1.0 - _peaks(through(after(logarithms)), limits)

    found = minimize(
        lambda logarithms: float(np.exp(logarithms).sum()),
        start,
        jac=np.exp,
        method="SLSQP",
        bounds=[(least, longest)] * len(start),
        constraints={"type": "ineq", "fun": spare},
        options={"maxiter": _ITERATIONS, "ftol": 1e-7},
    ).x
    if not np.isfinite(found).all():
        return knots
    better = after(found)
    shortest = stretch_needed(through(better), limits)[0] * better[-1]
    return better if shortest < factor * (knots[-1] - knots[0]) else knots


def _peaks(curve: PiecewisePolynomial, limits: Limits) -> Array:
    """Largest ratios to the limits in each segment of a cubic curve, as powers of a stretch."""
    spans = curve.spans[:, None]
    _, b, c, d = curve.coefficients
    ends = b, b + spans * (2.0 * c + 3.0 * d * spans)
    turn = np.divide(-c, 3.0 * d, out=np.zeros_like(c), where=d != 0.0)
    middle = np.where((turn > 0.0) & (turn < spans), b - c**2 / np.where(d, 3.0 * d, 1.0), 0.0)
    peaks = (
        np.maximum(np.maximum(np.abs(ends[0]), np.abs(ends[1])), np.abs(middle)),
        2.0 * np.maximum(np.abs(c), np.abs(c + 3.0 * d * spans)),
        6.0 * np.abs(d),
    )
    ratios = [
        ((peak / getattr(limits, rate)) ** (1.0 / order)).max(axis=1)
        for order, (rate, peak) in enumerate(zip(RATES, peaks, strict=True), 1)
        if np.isfinite(getattr(limits, rate)).any()
    ]
    return np.concatenate(ratios)
