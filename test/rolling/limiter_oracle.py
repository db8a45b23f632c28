"""The rule of the limiter in NumPy, for bases without steered wheels and limits alike both ways."""

import math

import numpy as np

__all__ = ["limited"]


def _first_acceleration(v, rest, limits, period):
    """The acceleration with which to begin, so that all of the jerk from then on ends at rest."""
    jerk = limits.jerk * period
    way = float(np.max(np.abs(rest - v) / (jerk * period)))
    if way <= 1.0:
        return (rest - v) / period
    # Periods of full jerk that fit: k (k + 1) / 2 of their steps cover the way.
    whole = math.floor(0.5 * (math.sqrt(8.0 * way + 1.0) - 1.0))
    share = (way + 0.5 * whole * (whole + 1.0)) / (whole + 1.0)
    return (rest - v) / period * share / way


def limited(commands, limits, period):
    """Follow commands (n, 3) that are allowed; give the twists (n, 3) after each period."""
    v, a, rest, twists = np.zeros(3), np.zeros(3), np.zeros(3), []
    for command in commands:
        low, high = 0.0, 2.0
        for _ in range(60):
            share = 0.5 * (low + high)
            aim = rest + min(share, 1.0) * (command - rest)
            gain = _first_acceleration(v, aim, limits, period)
            most = np.abs(gain - a) <= limits.jerk * period * (1.0 + 1e-11)
            if (most & (np.abs(gain) <= limits.acceleration * (1.0 + 1e-11))).all():
                low = share
            else:
                high = share
        rest = rest + min(low, 1.0) * (command - rest)
        a = _first_acceleration(v, rest, limits, period)
        v = v + a * period
        twists.append(v)
    return np.array(twists)
