"""Cubic splines by the second derivatives at their knots.

References
----------
J. Angeles, *Fundamentals of Robotic Mechanical Systems*, 4th ed., section 6.6; for ends at rest
with two more knots L. Biagiotti and C. Melchiorri, *Trajectory Planning for Automatic Machines
and Robots*, Springer 2008, section 4.4.4.
"""

from typing import Literal

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

CubicEnds = Literal["natural", "clamped", "parabolic", "rest", "periodic"]


def cubic_spline(
    x: Array, s: Array, ends: CubicEnds, slopes: Array | None = None
) -> PiecewisePolynomial:
    r"""Interpolate with continuous second derivatives.

    In segment k, of length :math:`\alpha_k = x_{k+1} - x_k`, the spline is
    :math:`A_k (x - x_k)^3 + B_k (x - x_k)^2 + C_k (x - x_k) + D_k` with

    .. math::

       A_k = \frac{s''_{k+1} - s''_k}{6 \alpha_k}, \quad B_k = \frac{s''_k}{2}, \quad
       C_k = \frac{s_{k+1} - s_k}{\alpha_k} - \frac{\alpha_k}{6} (s''_{k+1} + 2 s''_k), \quad
       D_k = s_k.

    Its slope is continuous where

    .. math::

       \alpha_k s''_k + 2 (\alpha_k + \alpha_{k+1}) s''_{k+1} + \alpha_{k+1} s''_{k+2} =
       6 \left( \frac{s_{k+2} - s_{k+1}}{\alpha_{k+1}} - \frac{s_{k+1} - s_k}{\alpha_k} \right),

    a tridiagonal system :math:`A s'' = 6 C s`, to which the ends add two equations.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Knots, strictly increasing, m >= 2; m >= 3 for parabolic and periodic ends.
    s : ndarray, shape (m, n)
        Values there; for periodic ends the last are the first.
    ends : str
        ``"natural"``: no second derivative; ``"clamped"``: the given slopes; ``"parabolic"``:
        a constant second derivative in the outermost segments; ``"rest"``: no first and second
        derivative, for which the outermost segments are divided into halves; ``"periodic"``:
        value, slope and second derivative are the same at both.
    slopes : ndarray, shape (2, n), optional
        First derivatives at clamped ends.

    Returns
    -------
    PiecewisePolynomial
        Of order 3.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 6.6.
    """
    if ends == "periodic":
        from scipy.interpolate import CubicSpline  # a second and 40 MB that few need

        return PiecewisePolynomial(x, CubicSpline(x, s, bc_type="periodic").c[::-1].copy())
    if ends == "rest" and len(x) == 2:
        # One segment has no room for two ends at rest: through the middle, at half of the time.
        x, s = np.insert(x, 1, x.mean()), np.insert(s, 1, s.mean(axis=0), axis=0)
    rates = np.zeros((2, s.shape[1])) if slopes is None else slopes
    lower, diagonal, upper, right = _interior(x, s)
    _end_rows(ends, x[1] - x[0], s, rates[0], (lower, diagonal, upper, right))
    # The back is the front of the mirrored spline.
    mirrored = upper[::-1], diagonal[::-1], lower[::-1], right[::-1]
    _end_rows(ends, x[-1] - x[-2], s[::-1], -rates[1], mirrored)
    from scipy.linalg.lapack import dgtsv  # 20 MB that only splines shall load

    second = np.asarray(dgtsv(lower, diagonal, upper, right)[3])
    if ends == "rest":
        x, s, second = _with_knot_from_rest(x, s, second)
        turned = _with_knot_from_rest(-x[::-1], s[::-1], second[::-1])
        x, s, second = -turned[0][::-1], turned[1][::-1], turned[2][::-1]
    return _pieces(x, s, second)


def _interior(x: Array, s: Array) -> tuple[Array, ...]:
    """Lay out A s'' = 6 C s, the continuity of the slope at inner knots, with rows for ends."""
    spans = np.diff(x)
    right = np.zeros_like(s)
    right[1:-1] = 6.0 * np.diff(np.diff(s, axis=0) / spans[:, None], axis=0)
    diagonal = np.ones(len(x))
    diagonal[1:-1] = 2.0 * (spans[:-1] + spans[1:])
    return spans.copy(), diagonal, spans.copy(), right


def _end_rows(
    end: CubicEnds, span: float, s: Array, slope: Array, rows: tuple[Array, Array, Array, Array]
) -> None:
    """Fill the equation of the first knot; of an end at rest that of the second, too."""
    lower, diagonal, upper, right = rows
    if end == "natural":
        diagonal[0], upper[0], right[0] = 1.0, 0.0, 0.0
    elif end == "parabolic":
        diagonal[0], upper[0], right[0] = 1.0, -1.0, 0.0
    elif end == "clamped":
        diagonal[0], upper[0] = 2.0 * span, span
        right[0] = 6.0 * ((s[1] - s[0]) / span - slope)
    else:
        # In place of the second derivative at the end, which is zero, that at the middle of the
        # segment is unknown; it makes up for the way, and the slope at the second knot is half of
        # the span times it and a quarter of the span times the second derivative there.
        diagonal[0], upper[0] = 6.0, 1.0
        right[0] = 24.0 * (s[1] - s[0]) / span**2
        lower[0] = 3.0 * span
        diagonal[1] -= 0.5 * span
        right[1] += 6.0 * (s[1] - s[0]) / span


def _with_knot_from_rest(x: Array, s: Array, second: Array) -> tuple[Array, Array, Array]:
    """Insert the knot in the middle of the first segment, whose second derivative is given."""
    span, middle = x[1] - x[0], second[:1]
    knot = s[:1] + middle * span**2 / 24.0
    return (
        np.concatenate([x[:1], x[:1] + 0.5 * span, x[1:]]),
        np.concatenate([s[:1], knot, s[1:]]),
        np.concatenate([np.zeros_like(middle), middle, second[1:]]),
    )


def _pieces(x: Array, s: Array, second: Array) -> PiecewisePolynomial:
    """Write A, B, C and D of every segment, the coefficients of its powers."""
    spans = np.diff(x)[:, None]
    coefficients = np.empty((4, len(spans), s.shape[1]))
    coefficients[0] = s[:-1]
    coefficients[1] = np.diff(s, axis=0) / spans - spans / 6.0 * (second[1:] + 2.0 * second[:-1])
    coefficients[2] = 0.5 * second[:-1]
    coefficients[3] = np.diff(second, axis=0) / (6.0 * spans)
    return PiecewisePolynomial(x, coefficients)
