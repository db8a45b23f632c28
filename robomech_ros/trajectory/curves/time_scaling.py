"""Curves made slower or faster as a whole, to fill the limits or to last a given time."""

import numpy as np

from robomech_ros.errors import DurationTooShortError
from robomech_ros.spatial.arrays import finite_within
from robomech_ros.trajectory.curves.bounds import extremes
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import RATES, Limits, Rate
from robomech_ros.trajectory.tolerances import DURATION_ROUNDING, SHORTEST_TRAJECTORY

# Longest duration (s) that may be asked for: some thirty years, and half of what a message holds.
LONGEST_DURATION = 1e9
# An excess over limits, as a part by which the curve would have to be slower, that does not matter.
_ROUNDING = 1e-10


def stretch_needed(curve: PiecewisePolynomial, limits: Limits) -> tuple[float, int, Rate]:
    """Find by which factor a curve must last longer (or may last shorter) to fill its limits.

    Returns the factor, 0 for a curve that stands still, and the joint and the limit that bind; only
    finite limits count.
    """
    low, high = extremes(curve)
    ratios = np.maximum(np.maximum(-low, high), 0.0)[1:] / limits.rates
    needed = ratios ** (1.0 / np.arange(1.0, 4.0))[:, None]
    k, joint = np.unravel_index(int(np.argmax(needed)), needed.shape)
    return float(needed[k, joint]), int(joint), RATES[k]


def fitted(
    curve: PiecewisePolynomial, limits: Limits, duration: float | None = None
) -> PiecewisePolynomial:
    """Scale a curve to the shortest duration within finite limits, or to a desired one (s).

    Raises DurationTooShortError if the wanted duration would break a limit.
    """
    factor, joint, rate = stretch_needed(curve, limits)
    shortest = max(factor * curve.duration, SHORTEST_TRAJECTORY)
    if duration is not None:
        if duration < shortest - DURATION_ROUNDING * (1.0 + shortest):
            raise DurationTooShortError(duration, shortest, limits.joint_names[joint], rate)
        shortest = max(shortest, duration)
    if factor == 0.0:
        return PiecewisePolynomial(np.array([0.0, shortest]), curve.coefficients[:1, :1].copy())
    slower = curve.stretched(shortest / curve.duration)
    # Short segments last longer or shorter by the rounding of their breaks.
    left = stretch_needed(slower, limits)[0] - 1.0
    return slower.stretched(1.0 + 2.0 * left) if left > _ROUNDING else slower


def checked_duration(duration: float | None) -> float | None:
    """Check a wanted duration (s); None and 0 are the shortest possible, None."""
    if duration is None:
        return None
    expected = f"more than 0 and at most {LONGEST_DURATION:g} s, or 0 for the shortest possible"
    return finite_within("duration", duration, expected, 0.0, LONGEST_DURATION) or None
