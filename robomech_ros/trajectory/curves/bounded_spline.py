"""A cubic spline that stays inside bounds between its points.

A spline through points swings out between them, and out of the bounds where a joint stands on one
of them.  With more knots between the points, whose values are free, it need not: of all that stay
inside, the one with the least squared acceleration is sought.  That is a problem of least squares
with linear inequalities, and by its dual one of least squares with numbers that are not negative.

References
----------
Lawson and Hanson, Solving least squares problems, SIAM 1995, ch. 23.
"""

import numpy as np

from robomech_ros.trajectory.curves.cubic_spline import CubicEnds, cubic_spline
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array, BoolArray

# Knots that are added between two points, until with some of these the bounds can be kept.
_ADDED = (1, 3, 7)
# Instants in each part between knots at which the bounds hold first; then also where the curve has
# extremes, in so many rounds.
_INSTANTS, _ROUNDS = 8, 8


def bounded_spline(
    knots: Array, points: Array, lower: Array, upper: Array, ends: CubicEnds = "rest"
) -> PiecewisePolynomial | None:
    """Interpolate points (m, n) at increasing knots (m,), inside bounds (n,), infinite for none.

    Ends are ``"rest"`` or ``"natural"``, as for `cubic_spline`.  Returns None where no such spline
    was found.
    """
    for added in _ADDED:
        parts = np.linspace(0.0, 1.0, added + 2)[:-1]
        finer = np.append((knots[:-1, None] + np.diff(knots)[:, None] * parts).ravel(), knots[-1])
        # Column k is the spline with value 1 at knot k and 0 at the others.
        unit = cubic_spline(finer, np.eye(len(finer)), ends)
        given = np.zeros(len(finer), dtype=bool)
        given[:: added + 1] = True
        columns = []
        for bounds in zip(points.T, lower, upper, strict=True):
            column = _values(unit, given, *bounds)
            if column is None:
                break
            columns.append(column)
        else:
            return cubic_spline(finer, np.stack(columns, axis=1), ends)
    return None


def _values(
    unit: PiecewisePolynomial, given: BoolArray, points: Array, lower: float, upper: float
) -> Array | None:
    """Find the values of one joint at all knots; None where it leaves the bounds in any case."""
    breaks = unit.breaks
    inner = breaks[:-1, None] + np.diff(breaks)[:, None] * np.arange(_INSTANTS) / _INSTANTS
    instants = inner.ravel()
    lengths = np.diff(breaks)
    weights = np.sqrt(np.append(lengths, 0.0) + np.append(0.0, lengths))
    bending = weights[:, None] * unit.sample(breaks).acceleration
    values = np.empty(len(given))
    values[given] = points
    for _ in range(_ROUNDS):
        basis = unit.sample(instants).position
        fixed = basis[:, given] @ points
        rows = np.concatenate((basis[:, ~given], -basis[:, ~given]))
        least = np.concatenate((lower - fixed, fixed - upper))
        kept = np.isfinite(least) & (np.abs(rows).max(axis=1) > 0.0)
        found = _least_distance(
            bending[:, ~given], -bending[:, given] @ points, rows[kept], least[kept]
        )
        if found is None:
            return None
        values[~given] = found
        peaks = _extreme_instants(unit, values)
        at = unit.sample(peaks).position @ values
        if not len(peaks) or max(lower - at.min(), at.max() - upper) <= 0.5 * POSITION_SLACK:
            return values
        instants = np.concatenate((instants, peaks))
    return None


def _least_distance(A: Array, b: Array, G: Array, h: Array) -> Array | None:
    """Find the least of the norm of ``A x - b`` with ``G x >= h``; None where nothing obeys."""
    from scipy.optimize import nnls  # a second and 40 MB that few need

    Q, R = np.linalg.qr(A)
    start = np.linalg.solve(R, Q.T @ b)
    turned, gap = G @ np.linalg.inv(R), h - G @ start
    E = np.concatenate((turned.T, gap[None]))
    f = np.zeros(len(E))
    f[-1] = 1.0
    residual = E @ nnls(E, f)[0] - f
    if not abs(residual[-1]) > 1e-12:
        return None
    return start + np.linalg.solve(R, -residual[:-1] / residual[-1])


def _extreme_instants(unit: PiecewisePolynomial, values: Array) -> Array:
    """Return when the spline with these values at the knots stops inside its segments (s)."""
    _, c, b, a = unit.coefficients @ values
    # Roots of c + 2 b t + 3 a t^2, the larger one first, for which nothing is lost by subtraction.
    with np.errstate(divide="ignore", invalid="ignore"):
        half = -(b + np.copysign(np.sqrt(b * b - 3.0 * a * c), b))
        roots = np.stack((half / (3.0 * a), c / half))
        inside = (roots > 0.0) & (roots < unit.spans)
    return (unit.breaks[:-1] + roots)[inside]
