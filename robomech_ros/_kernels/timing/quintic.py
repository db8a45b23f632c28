"""Formulas of quintics between two samples, for numbers in kernels and for arrays elsewhere."""

from typing import Any

_EPSILON = 2.0**-52


def upper_coefficients(h: Any, rise: Any, v0: Any, v1: Any, a0: Any, a1: Any) -> Any:
    """Return coefficients 3 to 5 of the quintic that rises by ``rise`` in the time h."""
    square, half = h * h, a0 / 2.0
    # Residuals, per power of h, at the second end of the parabola through the first one.
    position = rise / (square * h) - (v0 / h + half) / h
    velocity = (v1 - v0 - a0 * h) / square
    acceleration = (a1 - a0) / h
    half = acceleration / 2.0
    return (
        10.0 * position - 4.0 * velocity + half,
        (-15.0 * position + 7.0 * velocity - acceleration) / h,
        (6.0 * position - 3.0 * velocity + half) / square,
    )


def rounding_bounds(h: Any, late: Any, position: Any, velocity: Any, acceleration: Any) -> Any:
    """Return bounds of errors of derivatives 0 to 3 between two samples, from their rounding.

    The quintic through samples h apart, the second at the time `late`, multiplies errors of
    position by up to 60 / h^3 in its jerk, errors of velocity by up to 36 / h^2 and so on; the
    factors here are larger.  The last three arguments are the largest magnitudes of all samples.
    """
    first = _EPSILON * (240.0 * position + (240.0 * abs(late) + 120.0 * h) * velocity)
    third = 20.0 * _EPSILON * acceleration
    second = first / h
    return first + third, second + third, second / h + third, (second / h + third) / h
